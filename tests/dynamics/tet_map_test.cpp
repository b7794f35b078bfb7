#include "sansmesh/dynamics/tet_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "sansmesh/core/error.h"
#include "sansmesh/core/matrix3.h"
#include "sansmesh/dynamics/tet_embedding.h"
#include "sansmesh/dynamics/tet_geometry.h"
#include "support/any_threads.h"

namespace sansmesh {
namespace {

/// A twisted bar: its vertices at rest and moved.
struct Twisted {
  TetMesh mesh = box_of_tets({0, 0, 0}, {3, 1, 1}, 12, 4, 4);
  std::vector<Vec3> moved = mesh.vertices;

  Twisted() {
    for (Vec3& p : moved) {
      const double angle = 0.4 * p.x;
      p = {p.x + 0.2 * p.y * p.y, p.y * std::cos(angle) - p.z * std::sin(angle),
           p.y * std::sin(angle) + p.z * std::cos(angle)};
    }
  }
};

std::vector<Vec3> points_in(const Box3& box, std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec3> points(n);
  for (Vec3& p : points) {
    const Vec3 s = box.size();
    p = box.lower + Vec3{s.x * uniform(random), s.y * uniform(random), s.z * uniform(random)};
  }
  return points;
}

TEST(TetMap, GoesBackToWhereThingsCameFrom) {
  const Twisted bar;
  const TetMap forward(bar.mesh.tets, bar.mesh.vertices, bar.moved), back(bar.mesh.tets, bar.moved, bar.mesh.vertices);
  const std::vector<Vec3> x = points_in(bounds(bar.mesh), 2000, 3);
  std::vector<Vec3> there(x.size()), again(x.size());
  forward.map(x, {there, {}, {}, {}});
  back.map(there, {again, {}, {}, {}});
  for (std::size_t i = 0; i < x.size(); ++i) ASSERT_LT(norm(again[i] - x[i]), 1e-12) << i;
}

}  // namespace
}  // namespace sansmesh
