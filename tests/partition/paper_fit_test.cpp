#include "sansmesh/partition/paper/paper_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "sansmesh/core/morton.h"
#include "sansmesh/error.h"
#include "sansmesh/partition/paper/paper_local.h"
#include "sansmesh/search/brute_force.h"
#include "support/any_threads.h"
#include "support/clouds.h"
#include "support/same_bytes.h"

namespace sansmesh::inline v1 {
namespace {

struct PaperFit {
  PartitionOfUnity field;
  PaperReport report;
  PointSet sorted;
};

PaperFit paper_fit(const PointSet& cloud, const PaperOptions& options = {}) {
  Progress progress;
  PaperReport report;
  PointSet sorted;
  PartitionOfUnity field = fit_paper_partition(cloud, options, progress, &sorted, &report);
  return {std::move(field), report, std::move(sorted)};
}

double paper_value(const ScalarField& field, const Vec3& x) {
  double f = 0;
  field.evaluate(std::span<const Vec3>(&x, 1), std::span<double>(&f, 1));
  return f;
}

std::vector<Vec3> places_in(const Box3& box, std::size_t n, unsigned seed = 5) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec3> x(n);
  for (Vec3& p : x)
    for (std::size_t k = 0; k < 3; ++k) p[k] = box.lower[k] + unit(random) * (box.upper[k] - box.lower[k]);
  return x;
}

/// n × n samples of z = height(x, y) on [−1, 1]², each moved by `jitter` along z, up and down.
template <class Height>
PointSet height_cloud(int n, const Height& height, double jitter = 0) {
  PointSet cloud;
  std::mt19937 random(3);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double x = 2 * (i + 0.5) / n - 1, y = 2 * (j + 0.5) / n - 1, e = 1e-5;
      const double gx = (height(x + e, y) - height(x - e, y)) / (2 * e),
                   gy = (height(x, y + e) - height(x, y - e)) / (2 * e);
      cloud.positions.push_back(Vec3f(Vec3{x, y, height(x, y) + (random() % 2 ? jitter : -jitter)}));
      cloud.normals.push_back(Vec3f(normalized(Vec3{-gx, -gy, 1})));
    }
  return cloud;
}

double quadric(double x, double y) { return 0.2 * x * x - 0.15 * x * y + 0.1 * y * y; }
/// Even function, so that the mean normal is the axis of z.
double quartic(double x, double y) { return 0.2 * x * x * x * x - 0.3 * x * x * y * y + 0.1 * y * y; }

TEST(PaperFit, ReproducesAPlaneInTheWholeCube) {
  const Vec3 normal = normalized(Vec3{-0.3, 0.2, 1});
  const PointSet cloud = height_cloud(60, [](double x, double y) { return 0.3 * x - 0.2 * y + 0.1; });
  const PaperFit fit = paper_fit(cloud);
  EXPECT_GT(fit.report.borrowed, 0u);  // including blocks off the plane
  for (const Vec3& x : places_in(fit.field.bounds(), 500))
    EXPECT_NEAR(paper_value(fit.field, x), dot(x - Vec3{0, 0, 0.1}, normal), 2e-6);
}

TEST(PaperFit, RaisesTheDegreeToWhatTheSurfaceNeedsAndNoFurther) {
  PaperOptions options;
  options.coverage = kNoCoverage;
  options.threshold = 1e-6;
  for (const int degree : {1, 2, 4}) {
    const PaperFit fit = degree == 1   ? paper_fit(height_cloud(30, [](double, double) { return 0.1; }), options)
                         : degree == 2 ? paper_fit(height_cloud(30, quadric), options)
                                       : paper_fit(height_cloud(30, quartic), options);
    ASSERT_EQ(fit.field.data().supports.size(), 1u);
    EXPECT_EQ(fit.field.functions()[0].degree, degree);
    for (const Vec3& x : places_in({{-1, -1, -0.5}, {1, 1, 0.5}}, 200)) {
      const double h = degree == 1 ? 0.1 : degree == 2 ? quadric(x.x, x.y) : quartic(x.x, x.y);
      EXPECT_NEAR(paper_value(fit.field, x), x.z - h, 2e-6);
    }
  }
}

TEST(PaperFit, GoesNoHigherThanItIsAllowedTo) {
  PaperOptions options;
  options.coverage = kNoCoverage;
  options.threshold = 1e-6;
  options.max_degree = 3;
  const PaperFit fit = paper_fit(height_cloud(30, quartic), options);
  EXPECT_EQ(fit.field.report().functions_of_degree[4], 0u);
  EXPECT_GT(fit.field.data().supports.size(), 1u);
}

TEST(PaperFit, AllowsADegreeByTheNumberOfSamplesAndTheirCoverage) {
  PaperOptions options;
  EXPECT_EQ(paper_degree(options, 6, 1.2), 1);
  EXPECT_EQ(paper_degree(options, 11, 1.2), 1);
  EXPECT_EQ(paper_degree(options, 12, 1.2), 2);
  EXPECT_EQ(paper_degree(options, 20, 1.2), 3);
  EXPECT_EQ(paper_degree(options, 30, 1.2), 4);
  EXPECT_EQ(paper_degree(options, 500, 0.39), 1);
  EXPECT_EQ(paper_degree(options, 500, 0.40), 2);
  EXPECT_EQ(paper_degree(options, 500, 0.80), 3);
  EXPECT_EQ(paper_degree(options, 500, 0.85), 4);
  options.coverage = kPaperCoverage;
  EXPECT_EQ(paper_degree(options, 500, 0.84), 1);
  EXPECT_EQ(paper_degree(options, 500, 0.90), 3);
  EXPECT_EQ(paper_degree(options, 500, 0.95), 4);
  // The samples cover 1/(π (1.1 · 1.5 · √3/2)²/4) of the root's support: too little for a curved function.
  options = {};
  options.threshold = 1e-6;
  EXPECT_GT(paper_fit(height_cloud(30, quadric), options).field.data().supports.size(), 1u);
}

TEST(PaperFit, IsThePlainMeanOfItsFunctions) {
  const PaperFit fit = paper_fit(test::torus(5000));
  for (const Vec3& x : places_in(fit.field.bounds(), 400)) {
    double weight = 0, value = 0;
    for (const LocalFunction& f : fit.field.functions()) {
      const double t = squared_norm(x - Vec3(f.center)) / std::pow(static_cast<double>(f.radius), 2);
      if (t >= 1) continue;
      weight += std::pow(1 - t, 4);
      value += std::pow(1 - t, 4) * local_value(f, Vec3f(x));
    }
    ASSERT_GT(weight, 0.09);  // the corner of a block: (1 − 1/1.5²)⁴
    EXPECT_NEAR(paper_value(fit.field, x), value / weight, 1e-5);
  }
}

TEST(PaperFit, GradientMatchesDifferencesInTheCubeAndBeyond) {
  const PaperFit fit = paper_fit(test::sphere(5000));
  Box3 box = fit.field.bounds();
  box.lower -= Vec3{0.3, 0.3, 0.3}, box.upper += Vec3{0.3, 0.3, 0.3};
  const std::vector<Vec3> x = places_in(box, 2000);
  std::vector<double> f(x.size());
  std::vector<Vec3> g(x.size());
  fit.field.evaluate(x, f, g);
  const double step = 5e-4;
  std::size_t off = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    Vec3 d;
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 ahead = x[i], behind = x[i];
      ahead[k] += step, behind[k] -= step;
      d[k] = (paper_value(fit.field, ahead) - paper_value(fit.field, behind)) / (2 * step);
    }
    EXPECT_TRUE(is_finite(g[i]));
    off += norm(d - g[i]) > 0.02 * (1 + norm(g[i]));
  }
  EXPECT_LE(off, x.size() / 100);  // the gradient of the far field jumps there
}

TEST(PaperFit, ValuesLieInTheirRanges) {
  const PaperFit fit = paper_fit(test::torus(3000));
  Box3 box = fit.field.bounds();
  box.lower -= Vec3{0.2, 0.2, 0.2}, box.upper += Vec3{0.2, 0.2, 0.2};
  std::mt19937 random(2);
  std::normal_distribution<double> gauss;
  for (const double radius : {1e-3, 0.02, 0.1, 0.4}) {
    const std::vector<Vec3> x = places_in(box, 200);
    std::vector<ValueRange> range(x.size());
    fit.field.ranges(x, radius, range);
    for (std::size_t i = 0; i < x.size(); ++i)
      for (int k = 0; k < 20; ++k) {
        const double f =
            paper_value(fit.field, x[i] + normalized(Vec3{gauss(random), gauss(random), gauss(random)}) * radius);
        EXPECT_GE(f, range[i].least);
        EXPECT_LE(f, range[i].most);
      }
  }
}

TEST(PaperFit, IsPositiveFarOutsideOfASolid) {
  const PaperFit fit = paper_fit(test::sphere(3000));
  for (const double far : {1.5, 2.0, 10.0, 1e3}) EXPECT_GT(paper_value(fit.field, {far, 0.3 * far, 0.1}), 0) << far;
}

/// The blocks of the supports are the leaves of the mesh's tree before it is balanced.
TEST(PaperFit, HasOneTreeForFitAndMesh) {
  const PaperFit fit = paper_fit(test::torus(20000));
  const PartitionData& data = fit.field.data();
  BlockTree tree = fit.field.mesh_blocks(1e9);
  using Key = std::pair<int, std::uint64_t>;
  const auto key = [&](std::size_t b) {
    return Key{tree[b].level, morton_code(tree[b].cell[0], tree[b].cell[1], tree[b].cell[2])};
  };
  std::set<Key> blocks, supports;
  for (const std::uint32_t b : tree.leaves()) blocks.insert(key(b));
  for (const Support& s : data.supports) supports.insert({s.level, s.code});
  EXPECT_EQ(blocks, supports);
  // Balance subdivides some of them, which keep their function: each of the mesh's blocks is in one support's block.
  tree.balance();
  EXPECT_GT(fit.report.balanced, 0u);
  EXPECT_GT(tree.leaves().size(), supports.size());
  std::set<Key> divided;
  for (const std::uint32_t b : tree.leaves()) {
    Key k = key(b);
    while (k.first > 0 && supports.count(k) == 0) k = {k.first - 1, k.second >> 3};
    ASSERT_EQ(supports.count(k), 1u);
    if (k != key(b)) divided.insert(k);
  }
  EXPECT_EQ(divided.size(), fit.report.balanced);
}

TEST(PaperFit, SubdividesForTwoSheetsWhateverTheThreshold) {
  PointSet slab = height_cloud(20, [](double, double) { return 0.1; });
  const PointSet back = height_cloud(20, [](double, double) { return -0.1; });
  for (std::size_t i = 0; i < back.size(); ++i) {
    slab.positions.push_back(back.positions[i]);
    slab.normals.push_back(-back.normals[i]);
  }
  PaperOptions options;
  options.threshold = 10;  // no error is too large
  const PaperFit fit = paper_fit(slab, options);
  EXPECT_GT(fit.report.two_sheets, 0u);
  EXPECT_EQ(fit.report.above, 0u);
  for (const double z : {-0.1, 0.1}) EXPECT_NEAR(paper_value(fit.field, {0.13, 0.21, z}), 0, 0.01);
  EXPECT_LT(paper_value(fit.field, {0.13, 0.21, 0.0}), 0);
  // On the deepest level both sheets share a support.
  options.max_depth = 2;
  EXPECT_GT(paper_fit(slab, options).report.above, 0u);
}

TEST(PaperFit, SubdividesMoreThanAThousandSamplesWithoutAFit) {
  const auto flat = [](double, double) { return 0.0; };
  EXPECT_EQ(paper_fit(height_cloud(31, flat)).field.data().supports.size(), 1u);  // 961
  const PaperFit many = paper_fit(height_cloud(32, flat));                        // 1024
  EXPECT_EQ(many.report.too_many, 1u);
  EXPECT_EQ(many.field.data().supports.size(), 8u);
  PaperOptions shallow;
  shallow.max_depth = 2;
  const PaperFit crowded = paper_fit(height_cloud(200, flat), shallow);
  EXPECT_EQ(crowded.field.report().depth, 2);
  EXPECT_TRUE(std::any_of(crowded.field.data().supports.begin(), crowded.field.data().supports.end(),
                          [](const Support& s) { return s.samples > paper::kMany; }));
  EXPECT_NEAR(paper_value(crowded.field, {0.3, 0.2, 0.1}), 0.1, 1e-6);
}

/// 64 samples determine a quartic; those in the children's supports do not.
TEST(PaperFit, FewSamplesAreNotDividedWhereThatIsWorse) {
  PaperOptions options;
  options.coverage = kNoCoverage;
  options.threshold = 1e-7;
  const PaperFit few = paper_fit(height_cloud(8, quartic, 1e-4), options);
  EXPECT_EQ(few.report.kept, 1u);
  EXPECT_EQ(few.report.above, 1u);
  EXPECT_EQ(few.field.data().supports.size(), 1u);
  // A hundred samples are divided without that test.
  const PaperFit more = paper_fit(height_cloud(10, quartic, 1e-4), options);
  EXPECT_GT(more.field.data().supports.size(), 1u);
  // So are few samples of a bowl, where smaller planes reduce the residual.
  options.threshold = 1e-3;
  options.max_degree = 1;
  const PaperFit bowl = paper_fit(height_cloud(9, quadric), options);
  EXPECT_GT(bowl.report.not_worse, 0u);
  EXPECT_GT(bowl.field.data().supports.size(), 1u);
}

/// Reference for a borrowed plane: the nearest sample, its 20 neighbours, their mean, searched directly.
TEST(PaperFit, BorrowsThePlaneOfTheNearestSamples) {
  PaperOptions options;
  options.threshold = 1e-4;
  const PaperFit fit = paper_fit(test::sphere(800), options);
  const PartitionData& data = fit.field.data();
  std::size_t borrowed = 0;
  for (std::size_t i = 0; i < data.supports.size(); ++i) {
    const LocalFunction& f = data.functions[i];
    std::size_t within = 0;
    for (const Vec3f& p : fit.sorted.positions) within += norm(p - f.center) < f.radius;
    EXPECT_EQ(within, data.supports[i].samples);
    if (!is_borrowed(data.supports[i])) continue;
    ++borrowed;
    const auto distance_from = [&](const Vec3f& c) {
      return [&fit, c](std::uint32_t a, std::uint32_t b) {
        return squared_norm(fit.sorted.positions[a] - c) < squared_norm(fit.sorted.positions[b] - c);
      };
    };
    std::vector<std::uint32_t> ids(fit.sorted.size());
    for (std::size_t k = 0; k < ids.size(); ++k) ids[k] = static_cast<std::uint32_t>(k);
    const std::uint32_t nearest = *std::min_element(ids.begin(), ids.end(), distance_from(f.center));
    std::sort(ids.begin(), ids.end(), distance_from(fit.sorted.positions[nearest]));
    Vec3 mean, normal;
    for (std::size_t k = 0; k < 20; ++k)
      mean += Vec3(fit.sorted.positions[ids[k]]) / 20.0, normal += Vec3(fit.sorted.normals[ids[k]]);
    EXPECT_NEAR(local_value(f, Vec3f(mean)), 0, 1e-5);
    EXPECT_GT(dot(Vec3(f.nu), normalized(normal)), paper::kCosBorrowed);
    EXPECT_EQ(f.degree, 1);
  }
  EXPECT_EQ(borrowed, fit.report.borrowed);
  EXPECT_GT(borrowed, 20u);
}

/// Samples in a row: the least-squares plane is perpendicular to the surface, and only the normals are correct.
TEST(PaperFit, TakesTheMeanNormalWherePlanesStandAcross) {
  PointSet row;
  std::mt19937 random(4);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (int i = 0; i < 60; ++i) {
    row.positions.push_back({(static_cast<float>(i) + 0.5f) / 30 - 1, 1e-4f * unit(random), 1e-2f * unit(random)});
    row.normals.push_back({0, 0, 1});
  }
  PaperOptions options;
  options.threshold = 1e-5;
  options.max_depth = 5;
  const PaperFit fit = paper_fit(row, options);
  ASSERT_GT(fit.report.borrowed, 0u);
  for (std::size_t i = 0; i < fit.field.data().supports.size(); ++i)
    if (is_borrowed(fit.field.data().supports[i])) EXPECT_GT(fit.field.functions()[i].nu.z, 0.99f);
}

/// Within π/6 the positions decide: normals that are 20° off do not tilt borrowed planes.
TEST(PaperFit, TakesTheLeastSquaresPlaneWhereNormalsAreALittleOff) {
  PointSet plane = height_cloud(40, [](double, double) { return 0.0; });
  for (Vec3f& n : plane.normals) n = normalized(Vec3f{std::tan(20 * std::numbers::pi_v<float> / 180), 0, 1});
  const PaperFit fit = paper_fit(plane);
  ASSERT_GT(fit.report.borrowed, 0u);
  for (std::size_t i = 0; i < fit.field.data().supports.size(); ++i)
    if (is_borrowed(fit.field.data().supports[i])) EXPECT_GT(fit.field.functions()[i].nu.z, 0.9999f);
}

TEST(PaperFit, TurnsWithItsSamples) {
  PaperOptions options;
  options.coverage = kNoCoverage;  // the samples' box is axis-aligned in the frame and not rotated with it
  const PointSet cloud = test::torus(4000);
  PointSet turned = cloud;
  const auto turn = [](auto v) { return decltype(v){v.y, v.z, v.x}; };
  for (Vec3f& p : turned.positions) p = turn(p);
  for (Vec3f& n : turned.normals) n = turn(n);
  const PaperFit a = paper_fit(cloud, options), b = paper_fit(turned, options);
  EXPECT_EQ(a.field.report().functions_of_degree, b.field.report().functions_of_degree);
  for (const Vec3& x : places_in(a.field.bounds(), 300))
    EXPECT_NEAR(paper_value(a.field, x), paper_value(b.field, turn(x)), 1e-4);
}

TEST(PaperFit, DoesNotDependOnTheOrderOfItsSamples) {
  const PointSet cloud = test::torus(4000);
  PointSet other = cloud;
  std::reverse(other.positions.begin(), other.positions.end());
  std::reverse(other.normals.begin(), other.normals.end());
  const PaperFit a = paper_fit(cloud), b = paper_fit(other);
  EXPECT_EQ(a.field.report().functions_of_degree, b.field.report().functions_of_degree);
  for (const Vec3& x : places_in(a.field.bounds(), 300))
    EXPECT_NEAR(paper_value(a.field, x), paper_value(b.field, x), 1e-5);
}

TEST(PaperFit, DoesNotDependOnThreads) {
  const PointSet cloud = test::torus(10000);
  test::compare_threads(
      [&] { return paper_fit(cloud); },
      [](const PaperFit& a, const PaperFit& b) {
        EXPECT_TRUE(test::same_bytes(a.field.data().functions.copy(), b.field.data().functions.copy()));
        EXPECT_EQ(a.report.blocks, b.report.blocks);
      });
}

TEST(PaperFit, ItsDataAreValid) {
  for (const PointSet& cloud : {test::torus(5000), test::cube(3000), height_cloud(31, quadric)})
    EXPECT_NO_THROW(paper_fit(cloud).field.data().validate());
}

TEST(PaperFit, RefusesWhatMakesNoSense) {
  const auto refuses = [](auto&& change, const char* field) {
    PaperOptions options;
    change(options);
    try {
      paper_fit(test::sphere(100), options);
      ADD_FAILURE() << field;
    } catch (const ArgumentError& error) {
      EXPECT_NE(std::string(error.what()).find(std::string("`") + field + "`"), std::string::npos) << error.what();
    }
  };
  refuses([](PaperOptions& o) { o.threshold = 0; }, "threshold");
  refuses([](PaperOptions& o) { o.max_depth = 20; }, "max_depth");
  refuses([](PaperOptions& o) { o.max_degree = 5; }, "max_degree");
  refuses([](PaperOptions& o) { o.support = 1; }, "support");
  refuses([](PaperOptions& o) { o.coverage[1] = -1; }, "coverage");
  EXPECT_THROW(paper_fit(test::sphere(3)), DataError);
  PointSet bare = test::sphere(100);
  bare.normals.clear();
  EXPECT_THROW(paper_fit(bare), DataError);
}

}  // namespace
}  // namespace sansmesh::inline v1
