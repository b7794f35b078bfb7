"""open3d_poisson.py CLOUD MESH DEPTH: screened Poisson reconstruction with Open3D, its defaults except for the depth."""
import sys

import open3d

cloud = open3d.io.read_point_cloud(sys.argv[1])
mesh, _ = open3d.geometry.TriangleMesh.create_from_point_cloud_poisson(cloud, depth=int(sys.argv[3]))
open3d.io.write_triangle_mesh(sys.argv[2], mesh)
