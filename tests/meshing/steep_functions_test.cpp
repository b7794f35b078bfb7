// Solids with fitted functions that are steeper than distances: no block that the surface crosses is left out, and
// large blocks contain only what survey() reports.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "sansmesh/csg/solid.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/function/function_solid.h"
#include "sansmesh/polygonize/creases/crease_blocks.h"
#include "support/sanitizers.h"
#include "support/thin_shapes.h"

namespace sansmesh::inline v1 {
namespace {

std::shared_ptr<const FittedFunction> fitted(const test::ThinShape& shape, double spacing) {
  Progress progress;
  return std::make_shared<const FittedFunction>(fit_surface_function(test::even_samples(shape, spacing), {}, progress));
}

/// Pairs of points with opposite signs, bisected to adjacent numbers: points of the surface.
std::vector<Vec3> on_surface(const Solid& solid, std::size_t tries) {
  const Box3 box = solid.bounds();
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec3> a(tries), b(tries);
  const double step = 0.03 * box.diagonal();
  for (std::size_t i = 0; i < tries; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      a[i][k] = box.lower[k] + box.size()[k] * unit(random);
      b[i][k] = a[i][k] + step * (2 * unit(random) - 1);
    }
  std::vector<double> fa(tries), fb(tries);
  solid.evaluate(a, fa);
  solid.evaluate(b, fb);
  std::size_t n = 0;
  for (std::size_t i = 0; i < tries; ++i)
    if ((fa[i] < 0) != (fb[i] < 0)) a[n] = a[i], b[n] = b[i], fa[n++] = fa[i];
  a.resize(n), b.resize(n);
  std::vector<Vec3> middle(n);
  std::vector<double> f(n);
  for (int k = 0; k < 40; ++k) {
    for (std::size_t i = 0; i < n; ++i) middle[i] = (a[i] + b[i]) * 0.5;
    solid.evaluate(middle, f);
    for (std::size_t i = 0; i < n; ++i) ((fa[i] < 0) == (f[i] < 0) ? a : b)[i] = middle[i];
  }
  return middle;
}

/// Number of points in blocks that are larger than a cell.
std::size_t in_large_blocks(const Solid& solid, const std::vector<Vec3>& x, double cell, std::optional<double> slope) {
  CreaseBlockOptions options;
  options.cell = options.smooth_cell = cell;
  options.slope = slope;
  Progress progress;
  const BlockTree tree = crease_blocks(solid, solid.bounds(), options, progress);
  const double cells = static_cast<double>(1u << tree.depth()) / tree.edge();
  return static_cast<std::size_t>(std::count_if(x.begin(), x.end(), [&](const Vec3& p) {
    const Vec3 at = (p - tree.lower()) * cells;
    const std::int64_t block = tree.find(tree.depth(), static_cast<std::int64_t>(at.x), static_cast<std::int64_t>(at.y),
                                         static_cast<std::int64_t>(at.z));
    return block < 0 || tree.block_edge(static_cast<std::size_t>(block)) > 1.001 * cell;
  }));
}

struct Steep {
  const char* name;
  test::ThinShape shape;
};
void PrintTo(const Steep& s, std::ostream* out) { *out << s.name; }

class SteepFunctions : public testing::TestWithParam<Steep> {};

/// All blocks along the surface have the edge of a cell. An estimated slope that was right almost everywhere left some
/// blocks of the surface undivided.
TEST_P(SteepFunctions, LoseNoPart) {
  SANSMESH_NOT_SANITIZED("judges meshes; others mesh functions as solids");
  constexpr double kSpacing = 0.05;
  const Solid thin = function_solid(fitted(GetParam().shape, kSpacing));
  const Box3 box = thin.bounds();
  const double far = 1.2 * box.size().x;
  std::size_t lost_by_guess = 0;
  for (const Solid& solid : {thin, csg::unite(thin, csg::sphere(box.center() + Vec3{far, 0, 0}, 0.1)),
                             csg::subtract(thin, csg::cylinder(box.center(), {0, 0, 1}, 0.1)),
                             csg::subtract(csg::box(box.lower, box.upper), thin)}) {
    const std::vector<Vec3> x = on_surface(solid, 200000);
    ASSERT_GT(x.size(), 1000u);
    for (const double cell : {0.3 * kSpacing, 0.6 * kSpacing}) {
      EXPECT_EQ(in_large_blocks(solid, x, cell, std::nullopt), 0u);
      lost_by_guess += in_large_blocks(solid, x, cell, kAssumedSlope);
    }
  }
  EXPECT_GT(lost_by_guess, 0u);
}

INSTANTIATE_TEST_SUITE_P(Meshing, SteepFunctions,
                         testing::Values(Steep{"gyroid", test::gyroid_shell(0.1, 0.7)},
                                         Steep{"tube", test::thin_tube(0.1)}),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace sansmesh::inline v1
