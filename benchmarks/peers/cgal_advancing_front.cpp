// cgal_advancing_front CLOUD MESH: CGAL's advancing front reconstruction with its defaults (normals are not used).
#include <CGAL/Advancing_front_surface_reconstruction.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include "cloud_io.h"

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  std::vector<Kernel::Point_3> points;
  std::vector<std::array<float, 3>> vertices;
  for (const OrientedPoint& p : read_cloud(argv[1])) {
    points.emplace_back(p.x, p.y, p.z);
    vertices.push_back({p.x, p.y, p.z});
  }
  std::vector<std::array<std::size_t, 3>> facets;
  CGAL::advancing_front_surface_reconstruction(points.begin(), points.end(), std::back_inserter(facets));
  std::vector<std::array<std::int32_t, 3>> triangles;
  for (const auto& f : facets)
    triangles.push_back(
        {static_cast<std::int32_t>(f[0]), static_cast<std::int32_t>(f[1]), static_cast<std::int32_t>(f[2])});
  write_mesh(argv[2], vertices, triangles);
}
