#include "sansmesh/surface/layer_projection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/search/kd_tree.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kSpacing = 0.05;

/// Lattice points of spacing 0.05 near the surface of a `distance` with gradient, weighted as a layer one spacing
/// thick; rotated so that no lattice plane is in the surface.
template <class Distance>
LayerSamples layer_of(const Distance& distance) {
  LayerSamples found;
  for (int k = -26; k <= 26; ++k)
    for (int j = -26; j <= 26; ++j)
      for (int i = -26; i <= 26; ++i) {
        const Vec3 x = Vec3{i + 0.13, j + 0.29, k + 0.41} * kSpacing;
        Vec3 normal;
        const double d = distance(x, normal) / kSpacing;
        if (std::abs(d) > 2.2) continue;
        found.positions.emplace_back(x);
        found.normals.emplace_back(normal);
        found.weights.push_back(static_cast<float>(std::exp(-d * d)));
        found.spacing.push_back(static_cast<float>(kSpacing));
        found.reach.push_back(std::abs(d) < 1.3 ? static_cast<float>(1.25 * kSpacing) : 0);
      }
  return found;
}

double to_sphere(const Vec3& x, Vec3& normal) {
  normal = normalized(x);
  return norm(x) - 1;
}

double to_plane(const Vec3& x, Vec3& normal) {
  normal = normalized(Vec3{1, 2, 3});
  return dot(x, normal) - 0.1;
}

std::vector<Vec3> beside(const LayerSamples& layer, double share) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> u(-share * kSpacing, share * kSpacing);
  std::vector<Vec3> x;
  for (std::size_t i = 0; i < layer.positions.size(); i += 37)
    if (layer.reach[i] > 0) x.push_back(Vec3(layer.positions[i]) + Vec3{u(random), u(random), u(random)});
  return x;
}

std::vector<FootPoint> feet_of(const LayerSamples& layer, const LayerOptions& options, const std::vector<Vec3>& x) {
  const LayerProjection projection(layer, options);
  std::vector<FootPoint> feet(x.size());
  projection.project(x, feet);
  return feet;
}

TEST(LayerProjection, OneStepLandsOnASphereOfTheRightCurvature) {
  const LayerSamples layer = layer_of(to_sphere);
  const std::vector<Vec3> x = beside(layer, 0.3);
  ASSERT_GT(x.size(), 100u);
  for (const bool line_search : {false, true}) {
    LayerOptions options;
    options.line_search = line_search;
    double xx = 0, xy = 0, yy = 0;
    for (const FootPoint& f : feet_of(layer, options, x)) {
      ASSERT_TRUE(f.defined);
      EXPECT_NEAR(norm(f.position), 1, 0.03 * kSpacing);
      EXPECT_GT(dot(f.normal, normalized(f.position)), std::cos(0.01));  // outward, to half a degree
      xx += f.xx, xy += f.xy, yy += f.yy;
    }
    // Away from q the weights by distance pull the layer's middle towards the plane: a third of the curvature is
    // missing.
    const auto n = static_cast<double>(x.size());
    EXPECT_NEAR(xx / n, -0.7, 0.1);
    EXPECT_NEAR(xy / n, 0, 0.05);
    EXPECT_NEAR(yy / n, -0.7, 0.1);
  }
}

/// From the largest distance within a ball; without weights by distance the position of the sphere is less exact.
TEST(LayerProjection, PredictorFindsTheLayerFromAfar) {
  LayerSamples layer = layer_of(to_sphere);
  for (float& r : layer.reach) r *= 3;
  LayerOptions options;
  options.corrector = false, options.smoothing = 3;
  std::vector<Vec3> x;
  for (const Vec3& d : {Vec3{1, 0, 0}, Vec3{1, 2, 3}, Vec3{-3, 1, 0}})
    for (const double r : {-3.0, -1.5, 2.0, 3.0}) x.push_back(normalized(d) * (1 + r * kSpacing));
  for (const FootPoint& f : feet_of(layer, options, x)) {
    ASSERT_TRUE(f.defined);
    EXPECT_NEAR(norm(f.position), 1, 0.25 * kSpacing);
    EXPECT_GT(dot(f.normal, normalized(f.position)), 0.999);
  }
}

/// Alternating direction and offset converge to the plane of least squares, if they start near it.
TEST(LayerProjection, AlternationEndsAtTheMinimumThatIsKnown) {
  const LayerSamples layer = layer_of(to_sphere);
  const std::vector<Vec3> x = beside(layer, 0.2);
  LayerOptions options;
  options.corrector = false;
  const std::vector<FootPoint> known = feet_of(layer, options, x);
  options.alternating = true;
  const std::vector<FootPoint> turns = feet_of(layer, options, x);
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_LT(norm(known[i].position - turns[i].position), 0.02 * kSpacing);
    EXPECT_GT(dot(known[i].normal, turns[i].normal), 0.9999);
  }
}

TEST(LayerProjection, LeavesAPlaneInPlaceWhateverTheLattice) {
  const LayerSamples layer = layer_of(to_plane);
  const std::vector<Vec3> x = beside(layer, 0.4);
  Vec3 normal;
  // Without the box's faces, where only one side is sampled.
  std::vector<Vec3> inner;
  for (const Vec3& p : x)
    if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < 1) inner.push_back(p);
  for (const FootPoint& f : feet_of(layer, {}, inner)) {
    EXPECT_LT(std::abs(to_plane(f.position, normal)), 0.01 * kSpacing);
    EXPECT_GT(dot(f.normal, normal), 0.99999);
    EXPECT_NEAR(f.xx, 0, 0.25);
    EXPECT_NEAR(f.yy, 0, 0.25);
  }
}

/// A wall of four spacings: if the direction of samples were ignored, its sides would attract each other.
TEST(LayerProjection, KeepsTheSidesOfAThinWallApart) {
  constexpr double kHalf = 2 * kSpacing;
  const auto wall = [&](const Vec3& x, Vec3& normal) {
    Vec3 up;
    const double h = to_plane(x, up);
    normal = h > 0 ? up : -up;
    return std::abs(h) - kHalf;
  };
  const LayerSamples layer = layer_of(wall);
  std::vector<Vec3> inner;
  for (const Vec3& p : beside(layer, 0.3))
    if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < 1) inner.push_back(p);
  Vec3 normal;
  LayerOptions options;
  options.smoothing = 3;
  double apart = 0, mixed = 0;
  for (const FootPoint& f : feet_of(layer, options, inner)) apart = std::max(apart, std::abs(wall(f.position, normal)));
  options.separate_sheets = false;
  for (const FootPoint& f : feet_of(layer, options, inner)) mixed = std::max(mixed, std::abs(wall(f.position, normal)));
  EXPECT_LT(apart, 0.05 * kSpacing);
  EXPECT_GT(mixed, 5 * apart);
}

TEST(LayerProjection, IsUndefinedFarAwayAndAtPointsThatAreNotFinite) {
  const LayerSamples layer = layer_of(to_sphere);
  const std::vector<Vec3> x{{0, 0, 0}, {3, 0, 0}, {std::nan(""), 0, 0}, {1, 0, 0}};
  const std::vector<FootPoint> feet = feet_of(layer, {}, x);
  EXPECT_FALSE(feet[0].defined);
  EXPECT_FALSE(feet[1].defined);
  EXPECT_FALSE(feet[2].defined);
  EXPECT_TRUE(feet[3].defined);
  EXPECT_EQ(feet[1].position, x[1]);
}

TEST(LayerProjection, DoesNotDependOnThreadsNorOnTheBatch) {
  const LayerSamples layer = layer_of(to_sphere);
  const std::vector<Vec3> x = beside(layer, 0.3);
  test::expect_equal_for_any_threads([&] {
    std::vector<double> numbers;
    for (const FootPoint& f : feet_of(layer, {}, x))
      numbers.insert(numbers.end(), {f.position.x, f.position.y, f.position.z, f.normal.x, f.xx});
    return numbers;
  });
}

TEST(LayerProjection, RefusesWhatMakesNoSense) {
  LayerSamples layer = layer_of(to_plane);
  LayerOptions options;
  options.smoothing = 0;
  EXPECT_THROW(LayerProjection(layer, options), ArgumentError);
  options = {};
  options.predictor = options.corrector = false;
  EXPECT_THROW(LayerProjection(layer, options), ArgumentError);
  for (float& r : layer.reach) r = 0;
  EXPECT_THROW(LayerProjection(layer, {}), DataError);
}

}  // namespace
}  // namespace sansmesh::inline v1
