// Values in cells of higher order follow the cells' own shape functions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "sansmesh/error.h"
#include "sansmesh/volume/cells/nodal_basis.h"
#include "support/any_threads.h"
#include "volume/higher_order_grids.h"
#include "volume/volume_checks.h"

namespace sansmesh::test {
namespace {

using Family = HigherOrderFamily;

/// Natural coordinates inside a cell.
std::vector<Vec3> points_in(const NodalBasis& basis, std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> within(-0.5, 1);
  std::vector<Vec3> u;
  while (u.size() < count) {
    const Vec3 x{within(random), within(random), within(random)};
    if (basis.within(x, -1e-3)) u.push_back(x);
  }
  return u;
}

std::vector<HigherOrderKind> kinds() {
  std::vector<HigherOrderKind> all{
      {Family::hexahedron_20},        {Family::hexahedron_24},    {Family::wedge_15},
      {Family::pyramid_13},           {Family::wedge, {2, 2, 1}}, {Family::wedge, {3, 3, 4}},
      {Family::hexahedron, {2, 3, 4}}};
  for (const std::uint8_t n : {1, 2, 3, 5})
    for (const Family f : {Family::tetrahedron, Family::wedge, Family::hexahedron}) all.push_back({f, {n, n, n}});
  return all;
}

TEST(NodalBasis, IsOneAtItsNodeAndReproducesPolynomials) {
  for (const HigherOrderKind& kind : kinds()) {
    SCOPED_TRACE(static_cast<int>(kind.family) * 1000 + kind.orders[0] * 100 + kind.orders[1] * 10 + kind.orders[2]);
    const NodalBasis basis(kind);
    const std::size_t n = basis.nodes().size();
    ASSERT_EQ(n, node_count(kind));
    std::vector<double> values(n), more(n);
    std::vector<Vec3> slopes(n);
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_TRUE(basis.within(basis.nodes()[i], 1e-12));
      basis.evaluate(basis.nodes()[i], values, {});
      for (std::size_t j = 0; j < n; ++j) EXPECT_NEAR(values[j], i == j ? 1 : 0, 1e-11);
    }
    const int degree = std::min({kind.orders[0], kind.orders[1], kind.orders[2]});
    const auto f = [&](const Vec3& x) { return std::pow(0.3 + x.x - 0.5 * x.y + 0.25 * x.z, degree); };
    for (const Vec3& u : points_in(basis, 50, 1)) {
      basis.evaluate(u, values, slopes);
      double sum = 0;
      for (std::size_t i = 0; i < n; ++i) sum += values[i] * f(basis.nodes()[i]);
      EXPECT_NEAR(sum, f(u), 1e-11);
      for (std::size_t k = 0; k < 3; ++k) {
        Vec3 h;
        h[k] = 1e-6;
        basis.evaluate(u + h, values, {});
        basis.evaluate(u - h, more, {});
        for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(slopes[i][k], (values[i] - more[i]) / 2e-6, 1e-6);
      }
    }
  }
}

TEST(NodalBasis, RefusesImpossibleOrders) {
  EXPECT_THROW(NodalBasis({Family::tetrahedron, {0, 0, 0}}), DataError);
  EXPECT_THROW(NodalBasis({Family::hexahedron, {2, 2, 11}}), DataError);
}

/// A bend that no cell's shape functions contain.
Vec3 slightly_bent(const Vec3& x) {
  return {x.x + 0.04 * std::sin(2.5 * x.y + 4 * x.z), x.y + 0.03 * std::cos(5 * x.x - x.z), x.z + 0.05 * x.x * x.y};
}

std::vector<std::pair<std::string, HigherOrderGrid>> grids() {
  std::vector<std::pair<std::string, HigherOrderGrid>> all;
  for (const bool straight : {true, false}) {
    const std::string how = straight ? ", straight" : ", curved";
    all.push_back({"tetrahedra" + how, {Family::tetrahedron, 3, 2, slightly_bent, straight}});
    all.push_back({"tetrahedra of order 3" + how, {Family::tetrahedron, 3, 3, slightly_bent, straight}});
    all.push_back({"hexahedra" + how, {Family::hexahedron, 3, 2, slightly_bent, straight}});
    all.push_back({"hexahedra of order 3" + how, {Family::hexahedron, 3, 3, slightly_bent, straight}});
    all.push_back({"hexahedra of 20 nodes" + how, {Family::hexahedron_20, 3, 2, slightly_bent, straight}});
  }
  all.push_back({"regular tetrahedra", {Family::tetrahedron, 3, 2}});
  return all;
}

/// Without smoothing of what looks like noise.
std::unique_ptr<VolumeField> plain_field(std::shared_ptr<const SampledVolume> volume, const std::string& method) {
  Progress progress;
  VolumeReconstructionOptions options;
  options.method = method;
  options.smoothing = 0;
  return reconstruct_volume(std::move(volume), "f", options, progress);
}

/// Rough values reveal a point in the wrong cell.
double rough(const Vec3& x) { return std::sin(1e3 * x.x) + std::cos(3e3 * x.y) * std::sin(2e3 * x.z); }

TEST(HigherOrder, LinearIsTheFilesOwnFunction) {
  for (const auto& [name, grid] : grids()) {
    SCOPED_TRACE(name);
    const auto volume = volume_of(higher_order_grid(grid, rough));
    const auto field = plain_field(volume, "linear");
    const HigherOrderCells& higher = volume->higher;
    ASSERT_EQ(higher.size(), (grid.family == Family::tetrahedron ? 6u : 1u) * 27u);
    const NodalBasis basis(higher.kinds[0]);
    std::vector<double> weights(basis.nodes().size());
    std::vector<Vec3> slopes(basis.nodes().size()), x;
    std::vector<double> expected;
    for (std::size_t h = 0; h < higher.size(); ++h) {
      // Outer faces may be curved: straight pieces leave some of the cell outside.
      Vec3 middle;
      for (const std::uint32_t i : higher[h]) middle += volume->positions[i] / static_cast<double>(higher[h].size());
      if (std::max({std::abs(middle.x - 0.5), std::abs(middle.y - 0.5), std::abs(middle.z - 0.5)}) > 0.2) continue;
      for (const Vec3& u : points_in(basis, 40, static_cast<unsigned>(h))) {
        basis.evaluate(u, weights, slopes);
        Vec3 at;
        double value = 0;
        for (std::size_t i = 0; i < weights.size(); ++i) {
          at += volume->positions[higher[h][i]] * weights[i];
          value += weights[i] * rough(volume->positions[higher[h][i]]);
        }
        x.push_back(at), expected.push_back(value);
      }
    }
    ASSERT_GE(x.size(), 40u);
    std::vector<double> values(x.size()), plus(x.size()), minus(x.size());
    std::vector<Vec3> gradients(x.size());
    std::vector<std::uint8_t> inside(x.size());
    field->evaluate(x, {values, gradients, inside});
    for (std::size_t i = 0; i < x.size(); ++i) {
      ASSERT_EQ(inside[i], 1);
      ASSERT_NEAR(values[i], expected[i], 1e-9) << i;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      std::vector<Vec3> y = x, z = x;
      for (std::size_t i = 0; i < x.size(); ++i) y[i][k] += 1e-6, z[i][k] -= 1e-6;
      field->evaluate(y, {plus}), field->evaluate(z, {minus});
      for (std::size_t i = 0; i < x.size(); ++i)
        ASSERT_NEAR(gradients[i][k], (plus[i] - minus[i]) / 2e-6, 1e-4 * (1 + norm(gradients[i]))) << i;
    }
  }
}

TEST(HigherOrder, StraightCellsReproducePolynomialsOfTheirDegree) {
  const auto square = [](const Vec3& x) { return 1 + x.x * x.x - 2 * x.x * x.y + 0.5 * x.z * x.z + x.y * x.z - x.y; };
  for (const Family family : {Family::tetrahedron, Family::hexahedron, Family::hexahedron_20}) {
    const auto volume = volume_of(higher_order_grid({family, 3, 2, {[](const Vec3& x) { return x; }}}, square));
    for (const char* method : {"linear", "mls-detail", "mls"}) {
      SCOPED_TRACE(method);
      const Errors errors = errors_of(*field_of(volume, method), points_within(*volume, 500), square);
      EXPECT_LT(errors.most, std::string(method) == "linear" ? 1e-13 : 2e-6);
    }
  }
}

TEST(HigherOrder, LinearFunctionsAreReproducedInCurvedCells) {
  for (const auto& [name, grid] : grids())
    for (const char* method : {"linear", "mls-detail", "mls", "amls"}) {
      SCOPED_TRACE(name + " " + method);
      const auto volume = volume_of(higher_order_grid(grid, linear_function));
      const Errors errors = errors_of(*field_of(volume, method), points_within(*volume, 500), linear_function);
      EXPECT_LT(errors.most, std::string(method) == "linear" ? 1e-11 : 1e-5);
    }
}

TEST(HigherOrder, ContinuousAcrossCurvedFaces) {
  for (const auto& [name, grid] : grids()) {
    SCOPED_TRACE(name);
    const auto volume = volume_of(higher_order_grid(grid, rough));
    const auto field = plain_field(volume, "linear");
    // Along lines through the middle; jumps of rough data would be of order 1.
    std::vector<Vec3> x;
    constexpr std::size_t kSteps = 20000;
    for (std::size_t i = 0; i < kSteps; ++i) {
      const double t = 0.3 + 0.4 * static_cast<double>(i) / kSteps;
      x.push_back({t, 0.35 + 0.3 * t, 0.6 - 0.2 * t});
    }
    std::vector<double> values(x.size());
    std::vector<Vec3> gradients(x.size());
    field->evaluate(x, {values, gradients});
    double steepest = 0;
    for (const Vec3& g : gradients) steepest = std::max(steepest, norm(g));
    for (std::size_t i = 1; i < x.size(); ++i)
      ASSERT_LE(std::abs(values[i] - values[i - 1]), 1.1 * steepest * norm(x[i] - x[i - 1])) << i;
  }
}

TEST(HigherOrder, CellsWithHiddenOrMergedNodesStayPieces) {
  GridData data = higher_order_grid({Family::tetrahedron, 2, 2, {[](const Vec3& x) { return x; }}}, linear_function);
  GridBlock& block = data.blocks[0];
  const std::uint32_t gone = block.higher[0][1];
  std::size_t touched = 0;
  for (std::size_t h = 0; h < block.higher.size(); ++h) {
    const auto nodes = block.higher[h];
    touched += std::find(nodes.begin(), nodes.end(), gone) != nodes.end();
  }
  block.hidden_points.assign(block.points.size(), 0);
  block.hidden_points[gone] = 1;
  const auto volume = volume_of(data);
  EXPECT_EQ(volume->higher.size(), block.higher.size() - touched);
  const Errors errors = errors_of(*field_of(volume, "linear"), points_within(*volume, 300), linear_function);
  EXPECT_LT(errors.most, 1e-12);
  block.higher.nodes[0] = 1u << 30;
  EXPECT_THROW(volume_of(data), DataError);
}

TEST(HigherOrder, PolynomialsAreHardlyEverWorseThanTheCells) {
  const auto f = [](const Vec3& x) {
    return std::sin(7 * x.x + 2 * x.y) + 0.5 * std::cos(6 * x.y - 5 * x.z) * (1 + x.z);
  };
  for (const auto& [family, n] : {std::pair{Family::tetrahedron, std::size_t{4}},
                                  {Family::tetrahedron, std::size_t{8}},
                                  {Family::hexahedron_20, std::size_t{5}},
                                  {Family::hexahedron, std::size_t{5}}}) {
    SCOPED_TRACE(static_cast<int>(family) * 100 + static_cast<int>(n));
    const GridData data = higher_order_grid({family, n, 2, slightly_bent, false}, f);
    const auto volume = volume_of(data), pieces = volume_of(without_higher_order(data));
    const auto x = points_within(*volume, 20000);
    const Errors own = errors_of(*plain_field(volume, "linear"), x, f);
    const Errors linear = errors_of(*plain_field(pieces, "linear"), x, f);
    const Errors blended = errors_of(*plain_field(volume, "mls-detail"), x, f);
    EXPECT_LT(own.mean, linear.mean / 3);
    EXPECT_LT(blended.mean, 0.9 * own.mean);
    EXPECT_LT(blended.most, 1.1 * own.most);
  }
}

TEST(HigherOrder, ErrorsFallWithTheThirdPowerOfTheStep) {
  const auto f = [](const Vec3& x) { return std::sin(3 * x.x + x.y) * std::cos(2 * x.z - x.y); };
  for (const Family family : {Family::tetrahedron, Family::hexahedron, Family::hexahedron_20}) {
    double before = 0;
    for (const std::size_t n : {4u, 8u}) {
      const auto volume = volume_of(higher_order_grid({family, n, 2, slightly_bent}, f));
      const double error = errors_of(*plain_field(volume, "linear"), points_within(*volume, 5000), f).mean;
      if (before > 0) EXPECT_GT(before / error, 6);  // linear interpolation: 4
      before = error;
    }
  }
}

TEST(HigherOrder, DoesNotDependOnThreads) {
  const auto volume = volume_of(higher_order_grid({Family::hexahedron, 3, 2, slightly_bent, false}, rough));
  const auto x = points_within(*volume, 2000);
  expect_equal_for_any_threads([&] {
    std::vector<double> values(x.size());
    plain_field(volume, "mls-detail")->evaluate(x, {values});
    return values;
  });
}

}  // namespace
}  // namespace sansmesh::test
