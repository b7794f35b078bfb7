#include "sansmesh/measure/distance_map.h"

#include <gtest/gtest.h>

#include <numbers>
#include <numeric>
#include <random>

#include "measure/measure_shapes.h"
#include "sansmesh/error.h"
#include "sansmesh/measure/field_signed_distance.h"
#include "sansmesh/measure/mesh_signed_distance.h"
#include "sansmesh/mesh/edit/refine_edges.h"
#include "support/any_threads.h"
#include "support/mesh_checks.h"

namespace sansmesh::inline v1 {
namespace {

DistanceMap compare(const TriangleMesh& part, const TriangleMesh& reference, const DistanceMapOptions& options = {}) {
  Progress progress;
  return distance_map(part, *signed_distance(reference), options, progress);
}

TEST(DistanceMap, SphereAgainstALargerOne) {
  const TriangleMesh small = test::octasphere(5), large = test::scaled(test::octasphere(6), 1.01f);
  const DistanceMap inner = compare(small, large);
  EXPECT_EQ(inner.measured, small.vertices.size());
  // Faces of the large sphere are up to 1e-4 inside it.
  for (const float d : inner.distance) ASSERT_NEAR(d, -0.01, 2e-4);
  const DistanceMap outer = compare(large, small);
  for (const float d : outer.distance) ASSERT_NEAR(d, 0.01, 8e-4);
  const DistanceStatistics& s = inner.statistics;
  EXPECT_NEAR(s.mean, -0.01, 1e-4);
  EXPECT_NEAR(s.mean_absolute, 0.01, 1e-4);
  EXPECT_NEAR(s.rms, 0.01, 1e-4);
  EXPECT_LT(s.deviation, 1e-4);
  EXPECT_NEAR(s.area, 4 * std::numbers::pi, 0.02);
  EXPECT_LE(s.lowest, s.p05);
  EXPECT_LE(s.p05, s.median);
  EXPECT_LE(s.median, s.p95);
  EXPECT_LE(s.p95, s.highest);
  EXPECT_NEAR(norm(s.highest_at), 1, 1e-6);

  // Reversed with the opposite sign: the same figures, measured on the reference.
  const DistanceMap reversed = compare(large, small, {.reversed = true});
  EXPECT_NEAR(reversed.statistics.mean, -0.01, 5e-4);
}

TEST(DistanceMap, TorusAgainstAThickerOne) {
  const TriangleMesh torus = test::torus_mesh(200, 100);
  TriangleMesh thin = torus;
  for (std::size_t i = 0; i < thin.vertices.size(); ++i) {
    const Vec3 p(thin.vertices[i]);
    const double r = std::hypot(p.x, p.y);
    const Vec3 core{p.x / r, p.y / r, 0};
    thin.vertices[i] = Vec3f(core + (p - core) * (0.33 / 0.35));
  }
  const DistanceMap map = compare(thin, torus, {.within = 0.021});
  for (const float d : map.distance) ASSERT_NEAR(d, -0.02, 3e-4);
  EXPECT_DOUBLE_EQ(*map.statistics.within_tolerance, 1);
  EXPECT_DOUBLE_EQ(*compare(thin, torus, {.within = 0.01}).statistics.within_tolerance, 0);
}

TEST(DistanceMap, FieldAndMeshAgree) {
  const TriangleMesh part = test::scaled(test::octasphere(5), 0.98f), sphere = test::octasphere(6);
  const test::SphereField field(1);
  Progress progress;
  const DistanceMap a = compare(part, sphere), b = distance_map(part, FieldDistance(field), {}, progress);
  for (std::size_t i = 0; i < a.distance.size(); ++i) ASSERT_NEAR(a.distance[i], b.distance[i], 2e-4);
}

TEST(DistanceMap, WeightsAreAreas) {
  // Two squares: one at height 1 with four vertices, one of the same size at 2 with many.
  TriangleMesh part;
  const auto add_square = [&](int n, float x, float z) {
    const auto base = static_cast<std::uint32_t>(part.vertices.size()), row = static_cast<std::uint32_t>(n + 1);
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) part.vertices.push_back({x + float(i) / float(n), float(j) / float(n), z});
    for (std::uint32_t j = 0; j + 1 < row; ++j)
      for (std::uint32_t i = 0; i + 1 < row; ++i) {
        const std::uint32_t a = base + j * row + i;
        part.triangles.push_back({a, a + 1, a + row + 1});
        part.triangles.push_back({a, a + row + 1, a + row});
      }
  };
  add_square(1, 0, 1);
  add_square(20, 2, 2);
  part.vertices.push_back({0, 0, 50});  // unused
  TriangleMesh floor;
  floor.vertices = {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}};
  floor.triangles = {{0, 1, 2}, {0, 2, 3}};
  const DistanceMap map = compare(part, floor, {.max_distance = 10, .color_range = 3});
  const DistanceStatistics& s = map.statistics;
  EXPECT_NEAR(s.mean, 1.5, 1e-6);
  EXPECT_NEAR(s.rms, std::sqrt(2.5), 1e-6);
  EXPECT_NEAR(s.deviation, 0.5, 1e-6);
  EXPECT_NEAR(s.area, 2, 1e-6);
  EXPECT_NEAR(s.p05, 1, 1e-6);
  EXPECT_NEAR(s.p95, 2, 1e-6);
  EXPECT_EQ(map.not_finite, 1u);
  EXPECT_TRUE(std::isnan(map.distance.back()));
  EXPECT_EQ(s.histogram.size(), kHistogramBins);
  EXPECT_NEAR(std::accumulate(s.histogram.begin(), s.histogram.end(), 0.0) + s.below_range + s.above_range, 1, 1e-12);
  // Bins of 6/41: 1 is in bin 27, 2 in bin 34.
  EXPECT_NEAR(s.histogram[27], 0.5, 1e-12);
  EXPECT_NEAR(s.histogram[34], 0.5, 1e-12);
}

TEST(DistanceMap, CountsPointsLeftOut) {
  TriangleMesh part = test::octasphere(3);
  part.vertices[0] = {NAN, 0, 0};
  part.vertices[1] = {-40, 0, 0};
  const TriangleMesh sphere = test::octasphere(4);
  const DistanceMap map = compare(part, sphere, {.max_distance = 1.0});
  EXPECT_EQ(map.not_finite, 1u);
  EXPECT_EQ(map.beyond, 1u);
  EXPECT_EQ(map.measured, part.vertices.size() - 2);
  EXPECT_TRUE(std::isnan(map.distance[0]));
  EXPECT_TRUE(std::isnan(map.distance[1]));
  EXPECT_LT(map.statistics.mean_absolute, 0.1);
  apply_map(part, map, 0.1);
  EXPECT_EQ(part.colors[1], (std::array<std::uint8_t, 3>{150, 150, 150}));
  EXPECT_EQ(part.attributes.find<float>("quality")->size(), part.vertices.size());

  TriangleMesh far = test::octasphere(1);
  far.origin = {1000, 0, 0};
  const DistanceMap none = compare(far, sphere);
  EXPECT_EQ(none.measured, 0u);
  EXPECT_EQ(none.beyond, far.vertices.size());
  EXPECT_TRUE(std::isnan(none.statistics.mean));
  EXPECT_THROW(compare({}, sphere), DataError);
  EXPECT_THROW(compare(sphere, {}), DataError);
}

TEST(DistanceMap, CountsLostAndFarPointsSeparately) {
  TriangleMesh part;
  part.vertices = {{0, 0, 0}, {1.01f, 0, 0}, {3, 0, 0}};
  const test::SphereField sphere(1);
  Progress progress;
  const DistanceMap map = distance_map(part, FieldDistance(sphere), {.max_distance = 1.5}, progress);
  EXPECT_EQ(map.measured, 1u);
  EXPECT_EQ(map.beyond, 1u);
  EXPECT_EQ(map.not_found, 1u);  // no direction leads out of the centre
}

TEST(DistanceMap, BordersCanBeLeftOut) {
  TriangleMesh half = test::octasphere(4);
  std::erase_if(half.triangles, [&](const Triangle& t) {
    return std::min({half.vertices[t[0]].z, half.vertices[t[1]].z, half.vertices[t[2]].z}) < -1e-6f;
  });
  const TriangleMesh part = test::scaled(test::octasphere(4), 1.02f);
  const DistanceMap all = compare(part, half, {.max_distance = 9}),
                    some = compare(part, half, {.max_distance = 9, .skip_border = true});
  EXPECT_LT(all.statistics.lowest, -1);
  EXPECT_LT(some.statistics.highest, 0.03);
  EXPECT_GT(some.statistics.lowest, 0.01);
  EXPECT_EQ(all.at_border, some.at_border);
  EXPECT_EQ(some.measured + some.at_border, part.vertices.size());
  EXPECT_NEAR(double(some.measured) / double(all.measured), 0.5, 0.05);
}

TEST(DistanceMap, PointsAgainstPoints) {
  TriangleMesh cloud = test::octasphere(5);
  cloud.triangles.clear();
  const TriangleMesh moved = test::scaled(cloud, 1.03f);
  const DistanceMap unsigned_map = compare(moved, cloud);
  EXPECT_FALSE(unsigned_map.has_sides);
  EXPECT_NEAR(unsigned_map.statistics.mean, 0.03, 1e-4);
  EXPECT_GE(unsigned_map.statistics.lowest, 0);
  EXPECT_EQ(unsigned_map.statistics.below_range, 0);
  cloud.normals = cloud.vertices;
  const DistanceMap signed_map = compare(test::scaled(cloud, 0.97f), cloud);
  EXPECT_TRUE(signed_map.has_sides);
  EXPECT_NEAR(signed_map.statistics.mean, -0.03, 1e-4);
}

TEST(DistanceMap, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh part = test::torus_mesh(300, 150), reference = test::torus_mesh(170, 90);
  test::compare_threads([&] { return compare(part, reference, {.within = 1e-4}); },
                        [](const DistanceMap& one, const DistanceMap& many) {
                          EXPECT_EQ(one.distance, many.distance);
                          EXPECT_EQ(one.statistics.rms, many.statistics.rms);
                          EXPECT_EQ(one.statistics.histogram, many.statistics.histogram);
                        });
}

TEST(DistanceMap, IdenticalSurfacesAreAtZero) {
  const DistanceMap map = compare(test::octasphere(4), test::octasphere(4));
  EXPECT_EQ(map.statistics.mean_absolute, 0);
  // Without other data the range is a millionth of the diagonal, not 0.
  EXPECT_TRUE(map.statistics.smallest_range);
  EXPECT_NEAR(map.statistics.range, kSmallestRange * 2 * std::sqrt(3.0), 1e-7);
  EXPECT_FALSE(compare(test::octasphere(4), test::octasphere(3)).statistics.smallest_range);
  EXPECT_FALSE(compare(test::octasphere(4), test::octasphere(4), {.color_range = 1e-9}).statistics.smallest_range);
  EXPECT_NEAR(map.statistics.histogram[kHistogramBins / 2], 1, 1e-9);
  EXPECT_EQ(distance_color(0, 0), distance_color(0, 1));
}

TEST(DistanceMap, ChecksItsOptions) {
  const TriangleMesh sphere = test::octasphere(1);
  EXPECT_THROW(compare(sphere, sphere, {.max_distance = 0}), ArgumentError);
  EXPECT_THROW(compare(sphere, sphere, {.within = -1}), ArgumentError);
  EXPECT_THROW(compare(sphere, sphere, {.color_range = NAN}), ArgumentError);
}

TEST(RefineEdges, ShortEdgesSameSurface) {
  TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 2, 3});
  box.normals.assign(8, {0, 0, 1});
  box.colors.assign(8, {10, 20, 30});
  EXPECT_TRUE(refine_edges(box, 0.2));
  double area = 0;
  for (const Triangle& t : box.triangles) {
    const Vec3 a(box.vertices[t[0]]), b(box.vertices[t[1]]), c(box.vertices[t[2]]);
    area += 0.5 * norm(cross(b - a, c - a));
    EXPECT_LE(std::max({norm(b - a), norm(c - b), norm(a - c)}), 0.2 + 1e-6);
  }
  EXPECT_NEAR(area, 22, 1e-4);
  const test::Topology topology = test::topology_of(box);
  EXPECT_TRUE(topology.closed_manifold());
  EXPECT_EQ(topology.euler, 2);
  EXPECT_EQ(box.normals.size(), box.vertices.size());
  EXPECT_EQ(box.colors.size(), box.vertices.size());
  EXPECT_EQ(box.colors.back(), (std::array<std::uint8_t, 3>{10, 20, 30}));
  TriangleMesh again = test::box_mesh({0, 0, 0}, {1, 1, 1});
  EXPECT_FALSE(refine_edges(again, 1e-4, 1000));
  EXPECT_LE(again.triangles.size(), 1000u);
  EXPECT_THROW(refine_edges(again, 0), ArgumentError);
}

/// Samples of two parallel sheets, `gap` apart, facing away from each other, with noise along z. Of the sphere's map
/// only the distances and the feet matter.
struct NoisySheets {
  TriangleMesh points;
  DistanceMap map;

  NoisySheets(double gap, double noise, const std::array<double, 2>& offset) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(0, 1);
    std::normal_distribution<double> height(0, noise);
    for (int side = 0; side < 2; ++side)
      for (int i = 0; i < 5000; ++i) {
        const double x = place(random), y = place(random), up = side == 0 ? 1 : -1;
        const double d = offset[static_cast<std::size_t>(side)] + height(random);
        points.vertices.push_back(Vec3f(Vec3{x, y, up * (0.5 * gap + d)}));
        points.normals.push_back({0, 0, static_cast<float>(up)});
        map.feet.push_back(Vec3f(Vec3{x, y, up * 0.5 * gap}));
        map.distance.push_back(static_cast<float>(d));
      }
  }
};

TEST(LocalMedians, OutermostSamplesHaveTheDistanceOfTheirPlace) {
  constexpr double kNoise = 0.02;
  NoisySheets sheets(1, kNoise, {0, 0.03});
  const std::vector<float> shown = local_medians(sheets.points, sheets.map, 0.05);
  double sum = 0, own = 0;
  int outermost = 0;
  for (std::size_t i = 0; i < 5000; ++i) {
    EXPECT_LT(std::abs(shown[i]), 2 * kNoise);
    if (static_cast<double>(sheets.map.distance[i]) < 1.5 * kNoise) continue;
    ++outermost, sum += static_cast<double>(shown[i]), own += static_cast<double>(sheets.map.distance[i]);
  }
  ASSERT_GT(outermost, 200);
  EXPECT_GT(own / outermost, 1.5 * kNoise);
  EXPECT_LT(std::abs(sum / outermost), 0.1 * kNoise);
  for (std::size_t i = 5000; i < 10000; ++i) EXPECT_NEAR(shown[i], 0.03, 1.5 * kNoise);
}

TEST(LocalMedians, SheetsOfAThinPlateStayApartAndLeftOutPointsStayLeftOut) {
  NoisySheets sheets(0.01, 1e-4, {0, 0.03});
  sheets.map.distance[3] = std::numeric_limits<float>::quiet_NaN();
  sheets.map.feet[3].x = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> shown = local_medians(sheets.points, sheets.map, 0.05);
  for (std::size_t i = 0; i < 10000; ++i)
    if (i != 3) EXPECT_NEAR(shown[i], i < 5000 ? 0 : 0.03, 1e-3) << i;
  EXPECT_TRUE(std::isnan(shown[3]));
  sheets.map.feet.clear();
  EXPECT_THROW(local_medians(sheets.points, sheets.map, 0.05), ArgumentError);
}

TEST(LocalMedians, FeetOfACloudAreOnTheOtherSurface) {
  TriangleMesh cloud = test::octasphere(4);
  cloud.triangles.clear();
  for (Vec3f& p : cloud.vertices) p *= 1.1f;
  cloud.vertices[5] = {50, 0, 0};
  const DistanceMap map = compare(cloud, test::octasphere(5));
  ASSERT_EQ(map.feet.size(), cloud.vertices.size());
  for (std::size_t i = 0; i < map.feet.size(); ++i)
    if (i != 5) EXPECT_NEAR(norm(map.feet[i]), 1, 2e-3);
  EXPECT_TRUE(std::isnan(map.feet[5].x));
  EXPECT_TRUE(compare(test::octasphere(2), test::octasphere(3)).feet.empty());
}

}  // namespace
}  // namespace sansmesh::inline v1
