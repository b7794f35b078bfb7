// Readers of points and meshes, one per format, each in its own source: X_read.cpp.
#pragma once

#include "sansmesh/io/input.h"
#include "sansmesh/point_set.h"
#include "sansmesh/polyline_set.h"

namespace sansmesh::inline v1::io {

PointSet read_ply(const Input& in);
PointSet read_obj(const Input& in);
/// Binary and text glTF 2.0.
PointSet read_glb(const Input& in);
PointSet read_off(const Input& in);
PointSet read_stl(const Input& in);
PointSet read_table(const Input& in);
PointSet read_pcd(const Input& in);
PointSet read_las(const Input& in);
PointSet read_vtp(const Input& in);
PointSet read_conf(const Input& in);
/// All scans of an E57 file, with their poses.
PointSet read_e57(const Input& in);
/// read_points with a smaller limit on the extent: volumes are computed in double.
PointSet read_points_of_volume(const std::string& file, ReadReport& report);
/// The lines of a .vtp file; an empty set if it has none.
PolylineSet read_vtp_lines(const Input& in);
/// The lines of an .obj file; an empty set if it has none.
PolylineSet read_obj_lines(const Input& in);
/// Lines and polylines of a .dxf file.
PolylineSet read_dxf_lines(const Input& in);

}  // namespace sansmesh::inline v1::io
