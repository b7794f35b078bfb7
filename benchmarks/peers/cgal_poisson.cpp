// cgal_poisson CLOUD MESH: CGAL's Poisson reconstruction on a Delaunay refinement, with its documented defaults.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/compute_average_spacing.h>
#include <CGAL/poisson_surface_reconstruction.h>
#include <CGAL/property_map.h>

#include "cloud_io.h"

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Sample = std::pair<Kernel::Point_3, Kernel::Vector_3>;

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  std::vector<Sample> samples;
  for (const OrientedPoint& p : read_cloud(argv[1])) samples.push_back({{p.x, p.y, p.z}, {p.nx, p.ny, p.nz}});
  const CGAL::First_of_pair_property_map<Sample> position;
  const CGAL::Second_of_pair_property_map<Sample> normal;
  const double spacing =
      CGAL::compute_average_spacing<CGAL::Sequential_tag>(samples, 6, CGAL::parameters::point_map(position));
  CGAL::Surface_mesh<Kernel::Point_3> mesh;
  if (!CGAL::poisson_surface_reconstruction_delaunay(samples.begin(), samples.end(), position, normal, mesh, spacing))
    return 1;
  std::vector<std::array<float, 3>> vertices;
  std::vector<std::array<std::int32_t, 3>> triangles;
  for (auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    vertices.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())});
  }
  for (auto f : mesh.faces()) {
    std::array<std::int32_t, 3> t{};
    int k = 0;
    for (auto v : CGAL::vertices_around_face(mesh.halfedge(f), mesh)) t[k++] = static_cast<std::int32_t>(v.idx());
    triangles.push_back(t);
  }
  write_mesh(argv[2], vertices, triangles);
}
