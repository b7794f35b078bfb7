#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <random>

#include "sansmesh/volume/methods/cell_agreement.h"
#include "sansmesh/volume/methods/degree_field.h"
#include "support/any_threads.h"
#include "support/sanitizers.h"
#include "volume/airfoil.h"
#include "volume/volume_checks.h"

namespace sansmesh::test {
namespace {

double cubic_function(const Vec3& x) {
  return 0.3 + x.x - 2 * x.y * x.z + x.x * x.x * x.y - 0.5 * x.z * x.z * x.z + x.x * x.y * x.z;
}
Vec3 cubic_gradient(const Vec3& x) {
  return {1 + 2 * x.x * x.y + x.y * x.z, -2 * x.z + x.x * x.x + x.x * x.z, -2 * x.y - 1.5 * x.z * x.z + x.x * x.y};
}
double wave(const Vec3& x) { return std::sin(3 * x.x) * std::cos(2 * x.y + x.z) + 0.3 * x.z; }

std::unique_ptr<VolumeField> detail_of(std::shared_ptr<const SampledVolume> volume, bool robust) {
  Progress progress;
  VolumeReconstructionOptions options;
  options.method = "mls-detail", options.robust = robust;
  return reconstruct_volume(std::move(volume), "f", options, progress);
}

TEST(MlsDetail, ReproducesLinearFunctionsOnEveryGrid) {
  for (const NamedGrid& grid : all_grids(linear_function)) {
    SCOPED_TRACE(grid.name);
    const auto volume = volume_of(grid.data, grid.association);
    const auto field = field_of(volume, "mls-detail");
    const auto x = points_within(*volume, 500);
    std::vector<double> values(x.size()), spacings(x.size());
    std::vector<Vec3> gradients(x.size());
    std::vector<std::uint8_t> inside(x.size()), degrees(x.size());
    field->evaluate(x, {values, gradients, inside});
    dynamic_cast<const DegreeField&>(*field).degrees(x, degrees);
    field->spacing(x, spacings);
    for (std::size_t i = 0; i < x.size(); ++i) {
      ASSERT_NEAR(values[i], linear_function(x[i]), 1e-5) << i;
      ASSERT_NEAR(norm(gradients[i] - kLinearGradient), 0, 1e-3) << i;
      ASSERT_EQ(inside[i], 1) << i;
      ASSERT_GE(degrees[i], 1) << i;
      ASSERT_GT(spacings[i], 0) << i;
    }
  }
}

TEST(MlsDetail, ReproducesCubicsAwayFromTheBoundary) {
  for (const auto& [name, data] : {std::pair{"lattice", lattice_grid({8, 8, 8}, cubic_function)},
                                   std::pair{"stretched", stretched_grid({8, 8, 8}, cubic_function, 1.1)},
                                   std::pair{"bent", bent_grid({8, 8, 8}, cubic_function)},
                                   std::pair{"tetrahedra", tetrahedra_grid({8, 8, 8}, cubic_function)}}) {
    SCOPED_TRACE(name);
    const auto volume = volume_of(data);
    const auto field = field_of(volume, "mls-detail");
    const Vec3 middle = volume->bounds().center();
    std::vector<Vec3> x = points_within(*volume, 2000);
    std::erase_if(x, [&](const Vec3& p) { return norm(p - middle) > 0.2; });
    ASSERT_GT(x.size(), 20u);
    std::vector<double> values(x.size());
    std::vector<Vec3> gradients(x.size());
    std::vector<std::uint8_t> degrees(x.size());
    field->evaluate(x, {values, gradients});
    dynamic_cast<const DegreeField&>(*field).degrees(x, degrees);
    for (std::size_t i = 0; i < x.size(); ++i) {
      ASSERT_NEAR(values[i], cubic_function(x[i]), 2e-6) << i;
      ASSERT_NEAR(norm(gradients[i] - cubic_gradient(x[i])), 0, 2e-4) << i;
      ASSERT_EQ(degrees[i], 3) << i;
    }
  }
}

TEST(MlsDetail, IsNeverWorseThanLinearAndOnAverageMuchBetter) {
  for (const NamedGrid& grid : all_grids(wave)) {
    SCOPED_TRACE(grid.name);
    if (grid.name.ends_with("cells")) continue;  // cell values are means there, not function values
    const auto volume = volume_of(grid.data, grid.association);
    const auto x = points_within(*volume, 5000);
    const Errors linear = errors_of(*field_of(volume, "linear"), x, wave);
    const Errors detail = errors_of(*field_of(volume, "mls-detail"), x, wave);
    // Cells of higher order are much better than linear interpolation themselves. Of twelve samples around an axis, in
    // tetrahedra, half of the parabolas is trusted.
    const double gain = !volume->higher.empty() ? 1.5 : grid.name == "tetrahedra of an o-grid" ? 1.8 : 2.5;
    EXPECT_LE(detail.most, linear.most);
    EXPECT_LE(gain * detail.mean, linear.mean);
  }
}

TEST(MlsDetail, IsNeverWorseThanLinearInTheFarFieldOfAnAirfoil) {
  SANSMESH_NOT_SANITIZED("judges accuracy");
  // Steps grow as fast as the lengths over which flows fall: there cubics do not converge.
  for (const double growth : {1.5, 2.0})
    for (const bool tets : {false, true})
      for (const VolumeFunction& f : {VolumeFunction(airfoil_pressure), VolumeFunction(airfoil_velocity)}) {
        SCOPED_TRACE(std::to_string(growth) + (tets ? ", tetrahedra" : ""));
        GridData data = airfoil_grid(growth, f);
        if (tets) data = one_block(tetrahedra_of(data.blocks[0]), f);
        const auto volume = volume_of(data);
        auto x = points_within(*volume, 60000);
        std::erase_if(x, [](const Vec3& p) { return norm(p) < 6; });
        ASSERT_GT(x.size(), 5000u);
        const Errors linear = errors_of(*field_of(volume, "linear"), x, f);
        const Errors detail = errors_of(*field_of(volume, "mls-detail"), x, f);
        EXPECT_LE(detail.mean, 1.01 * linear.mean);
        EXPECT_LE(detail.most, (tets ? 1.2 : 1.05) * linear.most);
      }
}

TEST(MlsDetail, OfOverlappingBlocksWithAFrontIsBetterThanLinear) {
  SANSMESH_NOT_SANITIZED("judges accuracy");
  const auto zero = [](const Vec3&) { return 0.0; };
  for (const std::size_t n : {8u, 12u}) {
    SCOPED_TRACE(n);
    const GridData data = three_overlapping_blocks(n, zero);
    const Box3 box = volume_of(data)->bounds();
    const VolumeFunction front = [&](const Vec3& x) {
      const Vec3 d = x - box.lower, size = box.size();
      return std::tanh(9 * (d.z / size.z - d.x / size.x - d.y / size.y));
    };
    const auto volume = with_values_at_samples(*volume_of(data), front);
    const auto x = points_within(*volume, 50000);
    const Errors linear = errors_of(*field_of(volume, "linear"), x, front);
    const Errors detail = errors_of(*field_of(volume, "mls-detail"), x, front);
    EXPECT_LE(1.3 * detail.mean, linear.mean);
    EXPECT_LE(detail.most, (n == 8 ? 1.2 : 1.0) * linear.most);
  }
}

TEST(MlsDetail, IsNeverWorseThanLinearOnCoarseStretchedTetrahedra) {
  // Layers that double in size, the last step three radians long: only much finer layers determine the last one.
  for (unsigned seed = 1; seed <= 4; ++seed) {
    std::mt19937 random(seed);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
    const double phase = 6 * uniform(), number = 4 + 2 * uniform(), growth = 1.8 + 0.4 * uniform();
    const VolumeFunction f = [=](const Vec3& x) { return std::cos(number * x.z + phase) * (1.3 + std::cos(4 * x.y)); };
    const auto volume = volume_of(one_block(tetrahedra_of(lattice_block({8, 8, 8}, {}, {1, 1, 1}, growth)), f));
    const auto x = points_within(*volume, 5000);
    const Errors linear = errors_of(*field_of(volume, "linear"), x, f);
    const Errors detail = errors_of(*field_of(volume, "mls-detail"), x, f);
    EXPECT_LE(detail.mean, linear.mean) << seed;
    EXPECT_LE(detail.most, linear.most) << seed;
  }
}

TEST(MlsDetail, IsNeverWorseThanLinearAtFrontsThatEndInCoarseCells) {
  // Steps grow by half each: the largest contain the whole front, whose position is undetermined.
  for (const double offset : {-0.1, 0.0, 0.2})
    for (const double growth : {1.4, 1.5}) {
      SCOPED_TRACE(std::to_string(offset) + ", " + std::to_string(growth));
      const VolumeFunction front = [&](const Vec3& x) { return std::tanh(9 * (x.z - x.x - x.y + offset)); };
      const auto volume = volume_of(bent_grid({10, 10, 10}, front, growth));
      const auto x = points_within(*volume, 20000);
      EXPECT_LE(errors_of(*field_of(volume, "mls-detail"), x, front).most,
                1.01 * errors_of(*field_of(volume, "linear"), x, front).most);
    }
}

TEST(MlsDetail, IsNeverWorseThanLinearOnThinTetrahedra) {
  const VolumeFunction hills = [](const Vec3& x) {
    return (1.25 + std::cos(5.4 * x.y)) * std::cos(6 * x.z) / (6 + 6 * (3 * x.x - 1) * (3 * x.x - 1));
  };
  const auto volume = volume_of(one_block(tetrahedra_of(lattice_block({20, 20, 20}, {}, {1, 1, 1}, 1.2)), hills));
  const auto x = points_within(*volume, 50000);
  EXPECT_LE(errors_of(*field_of(volume, "mls-detail"), x, hills).most,
            errors_of(*field_of(volume, "linear"), x, hills).most);
}

TEST(CellAgreement, DoubtsDeviatingPolynomials) {
  const auto volume = volume_of(bent_grid({6, 6, 6}, wave));
  Progress progress;
  const VolumeValues values = volume_values(*volume, "f");
  LocalPolynomials p = fit_local_polynomials(*volume, values, {}, progress);
  // Equal polynomials have no doubt, and the correction is the whole difference to linear interpolation.
  std::vector<double> constants(volume->size());
  std::vector<float> coefficients(p.coefficients.size(), 0.0f);
  for (std::size_t i = 0; i < constants.size(); ++i) {
    constants[i] = linear_function(volume->positions[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 row(p.metrics[i].rows[k]);
      coefficients[p.first[i] + k] = static_cast<float>(dot(kLinearGradient, row) / squared_norm(row));
    }
  }
  const std::vector<std::uint8_t> unsplit(volume->size(), 0);
  p.constants = constants, p.coefficients = coefficients;
  const VolumeValues flat{"f", 1, constants, {}};
  const auto at = [&](std::size_t i, std::size_t m, const Vec3& x) {
    return p.constants[i] + p.full_rise(i, m, p.metric(*volume, i)(x - volume->positions[i]));
  };
  const std::size_t own = 2 + 6 * (2 + 6 * 2), beside = own + 1, far = 0;
  EXPECT_NEAR(CellAgreement(*volume, flat, at, unsplit).of(own).gain, 0, 1e-12);
  EXPECT_NEAR(CellAgreement(*volume, flat, at, unsplit).of(own).doubt, 0, 1e-12);
  // One constant is off by 1: it moves the mean of eight by an eighth, in four of the eight adjacent cells.
  constants[own] += 1;
  p.constants = constants;
  const CellAgreement off(*volume, flat, at, unsplit);
  EXPECT_NEAR(off.of(own).gain, 1.0 / 64, 1e-5);
  EXPECT_NEAR(off.of(own).doubt, 49.0 / 64, 1e-5);
  EXPECT_NEAR(off.of(beside).doubt, 0.5 / 64, 1e-5);
  EXPECT_NEAR(off.of(far).doubt, 0, 1e-12);
}

TEST(MlsDetail, InterpolatesInConformingCells) {
  const auto volume = volume_of(bent_grid({6, 7, 5}, wave, 1.2));
  const auto field = field_of(volume, "mls-detail");
  EXPECT_LT(errors_of(*field, volume->positions, wave).most, 1e-6);
}

TEST(MlsDetail, ErrorsFallWithTheFourthOrder) {
  double before = 0;
  for (const std::size_t n : {9u, 17u}) {
    const auto volume = volume_of(bent_grid({n, n, n}, wave));
    std::vector<Vec3> x = points_within(*volume, 20000);
    const Vec3 middle = volume->bounds().center();
    std::erase_if(x, [&](const Vec3& p) { return norm(p - middle) > 0.3; });
    const double mean = errors_of(*field_of(volume, "mls-detail"), x, wave).mean;
    if (before > 0) EXPECT_GT(before / mean, 9);  // 2⁴ in the limit
    before = mean;
  }
}

TEST(MlsDetail, GradientsAreDerivativesOfTheValues) {
  const auto check = [](const GridData& data, Association association) {
    const auto volume = volume_of(data, association);
    const auto field = field_of(volume, "mls-detail");
    // Differences cross cell faces, where gradients may jump slightly.
    EXPECT_LE(wrong_gradients(*field, points_within(*volume, 300)), 6u);
  };
  check(bent_grid({6, 7, 5}, wave), Association::points);
  check(mixed_grid({7, 4, 4}, wave), Association::points);
  check(stretched_grid({7, 6, 5}, wave), Association::points);
  check(two_level_amr(8, wave), Association::cells);
}

TEST(MlsDetail, StepsHaveNoSmearingOrRinging) {
  const VolumeFunction step = [](const Vec3& x) { return x.x + 0.3 * x.y < 0.52 ? 1.0 : 5.0; };
  for (const auto& [name, data] :
       {std::pair{"lattice", lattice_grid({14, 14, 14}, step)}, std::pair{"bent", bent_grid({14, 14, 14}, step)}}) {
    SCOPED_TRACE(name);
    const auto volume = volume_of(data);
    const auto x = points_within(*volume, 20000);
    const auto robust = detail_of(volume, true), plain = detail_of(volume, false);
    std::vector<double> values(x.size());
    robust->evaluate(x, {values});
    for (const double v : values) {  // a four-hundredth of the step
      ASSERT_GE(v, 1 - 0.01);
      ASSERT_LE(v, 5 + 0.01);
    }
    EXPECT_LT(errors_of(*robust, x, step).mean, 0.9 * errors_of(*plain, x, step).mean);
    EXPECT_LT(errors_of(*robust, x, step).mean, errors_of(*field_of(volume, "linear"), x, step).mean);
  }
}

TEST(MlsDetail, HasNoCracksAcrossLevelsAndBordersOfBlocks) {
  // Points on both sides of the border of the finer part, 1e-6 apart.
  const auto amr = volume_of(two_level_amr(8, wave), Association::cells);
  const auto field = field_of(amr, "mls-detail");
  std::vector<Vec3> pairs;
  std::mt19937 random(3);
  for (int i = 0; i < 500; ++i) {
    const double y = 0.3 + 0.4 * (random() / 4294967296.0), z = 0.3 + 0.4 * (random() / 4294967296.0);
    pairs.push_back({0.25 - 5e-7, y, z});
    pairs.push_back({0.25 + 5e-7, y, z});
  }
  std::vector<double> values(pairs.size());
  std::vector<Vec3> gradients(pairs.size());
  field->evaluate(pairs, {values, gradients});
  for (std::size_t i = 0; i < pairs.size(); i += 2) {
    ASSERT_NEAR(values[i], values[i + 1], 1e-5);
    ASSERT_NEAR(norm(gradients[i] - gradients[i + 1]), 0, 1e-2);
  }
}

TEST(MlsDetail, OnAmrIsThreeTimesBetterThanLinear) {
  const auto shared = with_values_at_samples(*volume_of(two_level_amr(12, wave), Association::cells), wave);
  const auto x = points_within(*shared, 5000);
  const Errors linear = errors_of(*field_of(shared, "linear"), x, wave);
  const Errors detail = errors_of(*field_of(shared, "mls-detail"), x, wave);
  EXPECT_LE(detail.most, linear.most);
  EXPECT_LE(2.5 * detail.mean, linear.mean);
}

TEST(MlsDetail, IsNeverWorseThanLinearWhereSamplesInCellsAreTooFarApart) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others make the same fields");
  // A front and peaks that the outermost samples do not resolve: everything beyond is extrapolation.
  const VolumeFunction front = [](const Vec3& x) { return std::tanh(9 * (x.z - x.x - x.y)); };
  const VolumeFunction peaks = [](const Vec3& x) {
    return 0.75 * std::exp(-20 * squared_norm(x - Vec3{0.22, 0.22, 0.22})) +
           0.5 * std::exp(-20 * squared_norm(x - Vec3{0.78, 0.33, 0.56})) -
           0.2 * std::exp(-81 * squared_norm(x - Vec3{0.44, 0.78, 0.56}));
  };
  const auto check = [](const GridData& data, const VolumeFunction& function) {
    const auto volume = volume_of(data, Association::cells);
    const Box3 box = volume->bounds();
    const Vec3 size = box.size();
    const VolumeFunction f = [&](const Vec3& x) {
      const Vec3 d = x - box.lower;
      return function({d.x / size.x, d.y / size.y, d.z / size.z});
    };
    const auto sampled = with_values_at_samples(*volume, f);
    const auto x = points_within(*sampled, 50000);
    const Errors linear = errors_of(*field_of(sampled, "linear"), x, f);
    const Errors detail = errors_of(*field_of(sampled, "mls-detail"), x, f);
    EXPECT_LE(detail.most, linear.most);
    EXPECT_LE(detail.mean, linear.mean);
  };
  const auto zero = [](const Vec3&) { return 0.0; };
  check(bent_grid({20, 20, 20}, zero, 1.5), peaks);
  for (const auto& function : {front, peaks}) {
    check(mixed_grid({10, 10, 10}, zero), function);
    check(two_level_amr(12, zero), function);
    check(bent_grid({10, 10, 10}, zero), function);
  }
}

TEST(MlsDetail, DoesNotReachAcrossGaps) {
  // Two slabs a hundredth apart, with values 0 and 1, as cells: neither depends on the other.
  const auto slab = [](double from, double to, double value) {
    GridBlock block =
        curvilinear_block(lattice_block({6, 6, 3}, {0, 0, from}, {1, 1, to}), [](const Vec3& x) { return x; });
    set_function(block, [value](const Vec3&) { return value; });
    return block;
  };
  GridData data;
  data.blocks = {slab(0, 0.1, 0), slab(0.11, 0.21, 1)};
  for (const Association a : {Association::points, Association::cells}) {
    const auto volume = volume_of(data, a);
    const auto field = field_of(volume, "mls-detail");
    const auto x = points_within(*volume, 1000);
    std::vector<double> values(x.size());
    field->evaluate(x, {values});
    for (std::size_t i = 0; i < x.size(); ++i) ASSERT_NEAR(values[i], x[i].z > 0.105 ? 1 : 0, 1e-6);
  }
}

TEST(MlsDetail, ReportsSparseSamples) {
  const VolumeFunction rough = [](const Vec3& x) {
    const double t = std::sin(12.9898 * x.x + 78.233 * x.y + 37.719 * x.z) * 43758.5453;
    return t - std::floor(t);
  };
  const auto volume = volume_of(tetrahedra_grid({8, 8, 8}, rough));
  Progress progress;
  VolumeReconstructionReport report;
  reconstruct_volume(volume, "f", {.method = "mls-detail", .smoothing = 0}, progress, &report);
  EXPECT_EQ(report.notes.size(), 1u);
  // What remains of noise is no sparsity.
  reconstruct_volume(volume, "f", {.method = "mls-detail"}, progress, &report);
  EXPECT_EQ(report.options.smoothing, 1);
  EXPECT_TRUE(report.notes.empty());
  VolumeReconstructionReport fine;
  reconstruct_volume(volume_of(tetrahedra_grid({8, 8, 8}, wave)), "f", {.method = "mls-detail"}, progress, &fine);
  EXPECT_TRUE(fine.notes.empty());
  EXPECT_EQ(std::accumulate(fine.by_degree.begin(), fine.by_degree.end(), std::size_t{0}), 512u);
}

/// Coefficients are floats: their rounding is neither a correction nor a doubt.
TEST(MlsDetail, TrustsRoundedLinearFunctions) {
  for (const VolumeFunction& f : {VolumeFunction([](const Vec3& x) { return 1 + x.x; }),
                                  VolumeFunction([](const Vec3& x) { return 1e9 + 0.3 * x.x - 0.7 * x.y; })}) {
    const auto volume = volume_of(lattice_grid({16, 16, 16}, f));
    Progress progress;
    VolumeReconstructionReport report;
    ReconstructionCoefficients fitted;
    reconstruct_volume(volume, "f", {.method = "mls-detail"}, progress, &report, &fitted);
    EXPECT_TRUE(report.notes.empty());
    for (std::size_t i = 0; i < volume->size(); ++i) EXPECT_EQ(fitted.polynomials.trust[i], 1.0f);
  }
}

TEST(MlsDetail, IsFiniteEverywhereAndZeroAtNonFinitePoints) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), huge = 1e300;
  const std::vector<Vec3> x{{nan, 0, 0}, {0, 1.0 / 0.0, 0}, {huge, -huge, huge}, {50, 60, 70}, {-0.01, 0.5, 0.5}};
  for (const NamedGrid& grid : all_grids(wave)) {
    SCOPED_TRACE(grid.name);
    const auto field = field_of(volume_of(grid.data, grid.association), "mls-detail");
    std::vector<double> values(x.size(), 7);
    std::vector<Vec3> gradients(x.size());
    std::vector<std::uint8_t> inside(x.size(), 9);
    field->evaluate(x, {values, gradients, inside});
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_TRUE(std::isfinite(values[i]) && is_finite(gradients[i])) << i;
    EXPECT_EQ(values[0], 0);
    EXPECT_EQ(values[1], 0);
  }
}

TEST(MlsDetail, AnswersDependOnThePointAlone) {
  for (const auto& volume :
       {volume_of(o_grid({17, 5, 6}, wave)), volume_of(two_level_amr(8, wave), Association::cells)}) {
    const auto x = points_within(*volume, 3000);
    std::vector<double> alone(x.size());
    const auto field = field_of(volume, "mls-detail");
    for (std::size_t i = 0; i < x.size(); i += 7)
      field->evaluate(std::span(x).subspan(i, 1), {std::span(alone).subspan(i, 1)});
    const auto all = [&] {
      std::vector<double> values(x.size());
      field_of(volume, "mls-detail")->evaluate(x, {values});
      return values;
    };
    expect_equal_for_any_threads(all);
    const auto together = all();
    for (std::size_t i = 0; i < x.size(); i += 7) ASSERT_EQ(together[i], alone[i]) << i;
  }
}

}  // namespace
}  // namespace sansmesh::test
