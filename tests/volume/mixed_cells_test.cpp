// Cells of mixed materials, whose means neither polynomials nor fronts explain.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "sansmesh/field/level_field.h"
#include "support/sanitizers.h"
#include "volume/cell_means.h"
#include "volume/volume_checks.h"

namespace sansmesh::test {
namespace {

constexpr double kHot = 1e4;
constexpr std::size_t kCells = 12;

struct MeansGridOfMixtures {
  std::string name;
  GridData data;
};

/// Mass-weighted means of 1 outside and kHot inside a sphere: the hot gas has a density between 0.001 and 1 times that
/// of the cold one, a different one in each cell.
GridData mixed_means(GridData data) {
  SphereFront front;
  front.width = 0.02 / kCells;
  set_front_means(data, front);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> exponent(-3, 0);
  for (GridBlock& block : data.blocks) {
    std::vector<double> shares = *block.cell_arrays.find<double>("f");
    for (double& share : shares) {
      share = std::clamp(share, 0.0, 1.0);
      const double hot = share * std::pow(10.0, exponent(random)), cold = 1 - share;
      share = share > 0.999 ? kHot : (kHot * hot + cold) / (hot + cold);
    }
    block.cell_arrays.set("f", std::move(shares));
  }
  return data;
}

std::vector<MeansGridOfMixtures> mixtures() {
  const auto zero = [](const Vec3&) { return 0.0; };
  return {{"two levels", mixed_means(two_level_amr(kCells, zero))},
          {"hexahedra", mixed_means(bent_grid({kCells + 1, kCells + 1, kCells + 1}, zero))}};
}

/// Mean angle (degrees) between gradients and the normals of the sphere where values along radii pass `level`.
double askew_normals(const VolumeField& field, double level) {
  const SphereFront front;
  std::mt19937 random(3);
  std::normal_distribution<double> number(0, 1);
  constexpr std::size_t kRays = 600;
  constexpr double kReach = 2.0 / kCells;
  std::vector<Vec3> n(kRays), x(kRays), slopes(kRays);
  for (Vec3& ray : n) {
    const double a = number(random), b = number(random), c = number(random);
    ray = normalized(Vec3{a, b, c});
  }
  std::vector<double> low(kRays, front.radius - kReach), high(kRays, front.radius + kReach), values(kRays);
  for (int halving = 0; halving < 30; ++halving) {
    for (std::size_t i = 0; i < kRays; ++i) x[i] = front.center + n[i] * (0.5 * (low[i] + high[i]));
    field.evaluate(x, {values, slopes});
    for (std::size_t i = 0; i < kRays; ++i) (values[i] > level ? low[i] : high[i]) = 0.5 * (low[i] + high[i]);
  }
  double angle = 0;
  for (std::size_t i = 0; i < kRays; ++i)
    angle += std::acos(std::clamp(-dot(normalized(slopes[i]), n[i]), -1.0, 1.0)) * 57.29577951308232 / kRays;
  return angle;
}

TEST(MixedCells, HaveSmoothSurfaces) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others make the same fields");
  for (const MeansGridOfMixtures& grid : mixtures()) {
    SCOPED_TRACE(grid.name);
    const auto volume = volume_of(grid.data, Association::cells);
    Progress progress;
    const auto angle = [&](const char* method) {
      return askew_normals(*reconstruct_volume(volume, "f", {.method = method, .logarithm = true}, progress), 100);
    };
    const double linear = angle("linear"), ours = angle("mls-detail");
    EXPECT_LT(ours, 0.7 * linear);
  }
}

/// No value leaves the range of the means by more than one and a half times it; small steps change little.
TEST(MixedCells, StayWithinTheirMeansAndAreContinuous) {
  for (const MeansGridOfMixtures& grid : mixtures()) {
    SCOPED_TRACE(grid.name);
    const auto volume = volume_of(grid.data, Association::cells);
    Progress progress;
    const auto field = reconstruct_volume(volume, "f", {.method = "mls-detail", .logarithm = true}, progress);
    const auto x = points_within(*volume, 3000);
    std::vector<double> values(x.size()), near(x.size());
    std::vector<Vec3> slopes(x.size()), moved = x;
    field->evaluate(x, {values, slopes});
    const double range = std::log(kHot);
    for (const double v : values) {
      ASSERT_GE(std::log(v), -1.5 * range - 1e-4);
      ASSERT_LE(std::log(v), 2.5 * range + 1e-4);
    }
    // A step of 10⁻⁵ of the box, that is 3·10⁻⁴ of the smallest cells, changes logarithms by no more than the same
    // share of 30 times the range.
    for (Vec3& at : moved) at.x = std::min(at.x + 1e-5, 1.0);
    field->evaluate(moved, {near});
    for (std::size_t i = 0; i < x.size(); ++i) ASSERT_LE(std::abs(std::log(near[i] / values[i])), 0.01 * range) << i;
  }
}

/// The function for a level set of a logarithm has the same level set, and rises more evenly through fronts.
TEST(LevelSets, OfLogarithmsFollowFronts) {
  const auto zero = [](const Vec3&) { return 0.0; };
  SphereFront front;
  front.width = 0.02 / kCells;
  GridData data = two_level_amr(kCells, zero);
  set_front_means(data, front);
  for (GridBlock& block : data.blocks) {
    std::vector<double> values = *block.cell_arrays.find<double>("f");
    for (double& v : values) v = 1 + 2 * std::clamp(v, 0.0, 1.0);
    block.cell_arrays.set("f", std::move(values));
  }
  const auto volume = volume_of(data, Association::cells);
  Progress progress;
  const auto field = reconstruct_volume(volume, "f", {.method = "mls-detail", .logarithm = true}, progress);
  const auto* const levels = dynamic_cast<const LevelField*>(field.get());
  ASSERT_NE(levels, nullptr);
  std::vector<Vec3> x;
  for (int i = 0; i < 400; ++i)
    x.push_back(front.center + normalized(Vec3{std::sin(i * 1.0), std::cos(i * 1.7), std::sin(i * 2.3 + 1)}) *
                                   (front.radius + (i % 21 - 10) * 0.004));
  const double level = 2;
  std::vector<double> plain(x.size()), even(x.size()), moved(x.size());
  std::vector<Vec3> slopes(x.size());
  field->evaluate(x, {plain});
  levels->evaluate_level(level, x, {even, slopes});
  std::vector<Vec3> next = x;
  constexpr double kStep = 1e-5;
  for (std::size_t i = 0; i < x.size(); ++i) next[i] = x[i] + normalized(slopes[i]) * kStep;
  levels->evaluate_level(level, next, {moved});
  std::size_t different = 0, agree = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::abs(plain[i] / level - 1) > 1e-3) ASSERT_EQ(plain[i] > level, even[i] > level) << i;
    if (std::abs(plain[i] / even[i] - 1) > 0.05) ++different;
    if (std::abs((moved[i] - even[i]) / kStep - norm(slopes[i])) <= 0.05 * norm(slopes[i])) ++agree;
  }
  EXPECT_GT(different, x.size() / 10);
  EXPECT_GT(agree, x.size() * 9 / 10);
}

}  // namespace
}  // namespace sansmesh::test
