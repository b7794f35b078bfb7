// Clouds whose samples are denser in some places or in one direction.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>

#include "sansmesh/mesh_measures.h"
#include "sansmesh/reconstruct.h"
#include "support/clouds.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kTube = 0.35;  ///< minor radius of test::torus

double off_torus_of(const Vec3& x) { return std::hypot(std::hypot(x.x, x.y) - 1, x.z) - kTube; }

/// Samples of test::torus whose density falls 100-fold along x.
PointSet graded_torus(std::size_t n, unsigned seed) {
  const PointSet even = test::torus(12 * n, seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(0, 1);
  PointSet cloud;
  for (std::size_t i = 0; i < even.size() && cloud.size() < n; ++i) {
    const double along = 0.5 * (1 + static_cast<double>(even.positions[i].x) / (1 + kTube));
    if (any(random) > std::pow(0.01, along)) continue;
    cloud.positions.push_back(even.positions[i]);
    cloud.normals.push_back(even.normals[i]);
  }
  return cloud;
}

/// Scan lines of a torus: intersections with planes `gap` apart, with samples about twelve times as dense along them.
PointSet torus_lines(double gap, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(0, 1);
  PointSet cloud;
  const double turn = 2 * std::numbers::pi;
  const auto count = static_cast<int>(turn * kTube * 12 / gap);
  for (double y = -1 - kTube + any(random) * gap; y < 1 + kTube; y += gap)
    for (const double side : {-1.0, 1.0})
      for (int k = 0; k < count; ++k) {
        const double angle = turn * any(random), ring = 1 + kTube * std::cos(angle);
        if (std::abs(y) >= ring) continue;
        const double x = side * std::sqrt(ring * ring - y * y), c = std::cos(angle) / ring;
        cloud.positions.emplace_back(Vec3(x, y, kTube * std::sin(angle)));
        cloud.normals.emplace_back(Vec3(x * c, y * c, std::sin(angle)));
      }
  return cloud;
}

void expect_torus(const ReconstructResult& made, double most) {
  const MeshTopology topology = measure_topology(made.mesh);
  EXPECT_EQ(topology.boundary_edges, 0u);
  EXPECT_EQ(topology.components, 1u);
  EXPECT_EQ(topology.genus(), 1);
  double squares = 0;
  for (const Vec3f& p : made.mesh.vertices) squares += off_torus_of(Vec3(p)) * off_torus_of(Vec3(p));
  EXPECT_LT(std::sqrt(squares / static_cast<double>(made.mesh.vertices.size())), most);
}

TEST(UnevenSamples, DensityOfHundredToOne) {
  Progress silent;
  for (const unsigned seed : {1u, 2u, 3u}) {
    SCOPED_TRACE(seed);
    const ReconstructResult made = reconstruct(graded_torus(6000, seed), {}, silent);
    expect_torus(made, 0.02);
    EXPECT_EQ(made.report.lost, 0);
  }
}

TEST(UnevenSamples, ScanLinesOfTwelveToOne) {
  Progress silent;
  for (const unsigned seed : {1u, 2u, 3u}) {
    SCOPED_TRACE(seed);
    expect_torus(reconstruct(torus_lines(0.07, seed), {}, silent), 0.004);
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
