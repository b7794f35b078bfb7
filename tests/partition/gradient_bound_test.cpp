// The fitted function approximates a distance on thin shapes of high genus: steep gradients in the sense of the
// diagnosis are rare within the supports. benchmark_gradient_bound measures the exact gradients.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include "sansmesh/function/fitted_function.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/points/sampling/sample_faces.h"
#include "sansmesh/polygonize/polygonize.h"
#include "support/places.h"
#include "support/sanitizers.h"
#include "support/thin_shapes.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kPoints = 200000;

FittedFunction fit_shape(PointSet cloud) {
  Progress progress;
  return fit_surface_function(std::move(cloud), {}, progress);
}

/// Points in the balls of the supports, the domain of definition.
std::vector<Vec3> in_domain(const FittedFunction& s, std::size_t count) {
  const PartitionData& data = s.field.data();
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> gauss;
  std::vector<Vec3> x(count);
  for (Vec3& p : x) {
    const LocalFunction& f = data.functions[random() % data.supports.size()];
    const Vec3 d = normalized(Vec3{gauss(random), gauss(random), gauss(random)});
    p = data.origin + Vec3(f.center) + d * (f.radius * std::cbrt(unit(random)));
  }
  return x;
}

/// Checks that 999 of 1000 gradients are within kPlausibleGradient.
void expect_sound(const FittedFunction& s) {
  const std::vector<Vec3> x = in_domain(s, kPoints);
  std::vector<double> values(x.size());
  std::vector<Vec3> gradients(x.size());
  s.field.evaluate(x, values, gradients);
  std::size_t steep = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_TRUE(std::isfinite(values[i]));
    steep += !(norm(gradients[i]) < kPlausibleGradient);
  }
  EXPECT_LT(steep, x.size() / 1000);
}

/// Analytic gradients equal differences of the values, except for a few next to creases.
void expect_gradients_of_values(const FittedFunction& s) {
  const std::vector<Vec3> x = in_domain(s, 4000);
  float least = 1e30f;
  for (std::size_t i = 0; i < s.field.data().supports.size(); ++i)
    least = std::min(least, s.field.data().functions[i].radius);
  const double step = 0.005 * static_cast<double>(least);  // values are of single precision
  std::vector<double> values(x.size()), around(6 * x.size());
  std::vector<Vec3> gradients(x.size()), moved;
  s.field.evaluate(x, values, gradients);
  for (const Vec3& p : x)
    for (std::size_t k = 0; k < 3; ++k)
      for (const double side : {-step, step}) {
        moved.push_back(p);
        moved.back()[k] += side;
      }
  s.field.evaluate(moved, around);
  std::size_t off = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double* f = &around[6 * i];
    const Vec3 g = Vec3{f[1] - f[0], f[3] - f[2], f[5] - f[4]} / (2 * step);
    off += norm(g - gradients[i]) > 0.05;
  }
  EXPECT_LT(off, x.size() / 100);
}

MeshTopology topology(const FittedFunction& s) {
  Progress progress;
  return measure_topology(mesh_function(s, {}, progress));
}

struct Thin {
  const char* name;
  test::ThinShape shape;
  double spacing;
  std::size_t components;
  int genus;
};
void PrintTo(const Thin& t, std::ostream* out) { *out << t.name; }

class ThinShapes : public testing::TestWithParam<Thin> {};

/// Checks gradients, and that the function has the right shape.
TEST_P(ThinShapes, StayAboutADistance) {
  SANSMESH_NOT_SANITIZED("judges slopes of large functions; others fit and mesh, too");
  const FittedFunction s = fit_shape(test::even_samples(GetParam().shape, GetParam().spacing));
  expect_sound(s);
  expect_gradients_of_values(s);
  const MeshTopology t = topology(s);
  EXPECT_TRUE(t.closed());
  EXPECT_EQ(t.components, GetParam().components);
  EXPECT_EQ(t.genus(), GetParam().genus);
}

INSTANTIATE_TEST_SUITE_P(GradientBound, ThinShapes,
                         testing::Values(Thin{"plate_3", test::perforated_plate(0.06, 4, false), 0.02, 1, 16},
                                         Thin{"plate_4", test::perforated_plate(0.08, 4, false), 0.02, 1, 16},
                                         Thin{"plate_sharp", test::perforated_plate(0.08, 4, true), 0.02, 1, 16},
                                         Thin{"tube_5", test::thin_tube(0.1), 0.02, 1, 1},
                                         Thin{"tori_3", test::linked_tori(3, 0.045), 0.03, 3, 3},
                                         Thin{"tori_4", test::linked_tori(3, 0.06), 0.03, 3, 3},
                                         Thin{"tori_6", test::linked_tori(5, 0.09), 0.03, 5, 5}),
                         [](const auto& of) { return std::string(of.param.name); });

class GyroidShells : public testing::TestWithParam<double> {};

/// The rims are as thin as the width of supports there: single supports disagree with the far field.
TEST_P(GyroidShells, AreBounded) {
  SANSMESH_NOT_SANITIZED("judges slopes of large functions; others fit and mesh, too");
  const double wall = GetParam();
  const test::ThinShape shape = test::gyroid_shell(wall, 0.8);
  const FittedFunction s = fit_shape(test::even_samples(shape, 0.03));
  expect_sound(s);
  expect_gradients_of_values(s);
  const MeshTopology t = topology(s);
  EXPECT_TRUE(t.closed());
  // The reference, extracted from the shape itself.
  BlockTree blocks(shape.box.lower, shape.box.size().x);
  for (std::size_t i = 0; i < blocks.size(); ++i)
    if (blocks[i].level < 6) blocks.subdivide(i);
  Progress progress;
  const MeshTopology truth = measure_topology(polygonize(shape, blocks, {}, {}, progress));
  EXPECT_TRUE(truth.closed());
  EXPECT_EQ(t.components, truth.components);
  EXPECT_EQ(t.euler, truth.euler);
}

INSTANTIATE_TEST_SUITE_P(GradientBound, GyroidShells, testing::Values(0.15, 0.2, 0.25));

/// The plates above have as many handles and equally thin walls.
TEST(ExtraGradientBound, FertilityReduced) {
  SANSMESH_NOT_SANITIZED("judges slopes of large functions; others fit and mesh, too");
  const std::string file = test::shared_points("fertility_4k.off");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "an extra: there is no " << file;
  const FittedFunction s = fit_shape(sample_faces(read_points(file), 60000));
  expect_sound(s);
  expect_gradients_of_values(s);
  const MeshTopology t = topology(s);
  EXPECT_TRUE(t.closed());
  EXPECT_EQ(t.genus(), 4);
}

}  // namespace
}  // namespace sansmesh::inline v1
