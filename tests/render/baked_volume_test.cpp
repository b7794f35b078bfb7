#include "sansmesh/render/volume/baked_volume.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "render/analytic_volumes.h"
#include "sansmesh/error.h"
#include "sansmesh/render/volume/volume_picture.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

using test::FormulaVolume;
using test::linear_volume;

/// Smooth except for a steep ridge in one corner: bricks of several levels are adjacent.
FormulaVolume hill() {
  FormulaVolume v;
  const auto parts = [](const Vec3& x) {
    const Vec3 d = x - Vec3{0.1, 0.15, 0.2};
    const double e = std::exp(-400 * squared_norm(d));
    return std::pair{e, d * (-800 * e)};
  };
  v.value = [=](const Vec3& x) { return parts(x).first + 0.2 * std::sin(3 * x.x) * x.y; };
  v.gradient = [=](const Vec3& x) {
    return parts(x).second + Vec3{0.6 * std::cos(3 * x.x) * x.y, 0.2 * std::sin(3 * x.x), 0};
  };
  v.step = 1.0 / 90;
  return v;
}

std::vector<Vec3> anywhere(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(0, 1);
  std::vector<Vec3> x(count);
  for (Vec3& p : x) p = {u(random), u(random), u(random)};
  return x;
}

struct EvaluatedField {
  std::vector<double> values;
  std::vector<Vec3> gradients;
  std::vector<std::uint8_t> inside;
  EvaluatedField(const VolumeField& field, std::span<const Vec3> x)
      : values(x.size()), gradients(x.size()), inside(x.size()) {
    field.evaluate(x, {values, gradients, inside});
  }
};

TEST(BakedVolume, LinearFieldsStayAsTheyAre) {
  const FormulaVolume field = linear_volume({1, -2, 0.5}, 3);
  Progress progress;
  const BakedVolume baked(field, {}, progress);
  EXPECT_LT(baked.report().error_most, 1e-6);
  EXPECT_TRUE(baked.report().finished);
  const std::vector<Vec3> x = anywhere(2000, 1);
  const EvaluatedField exact(field, x), found(baked, x);
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(found.values[i], exact.values[i], 2e-6);
    EXPECT_LT(norm(found.gradients[i] - exact.gradients[i]), 1e-6);
    EXPECT_EQ(found.inside[i], 1);
  }
}

TEST(BakedVolume, ErrorsAreAsReported) {
  const FormulaVolume field = hill();
  Progress progress;
  for (const double tolerance : {0.02, 0.01, 0.005}) {
    BakeOptions options;
    options.tolerance = tolerance;
    const BakedVolume baked(field, options, progress);
    const BakeReport& r = baked.report();
    EXPECT_TRUE(r.finished);
    EXPECT_LE(r.cell_error_most, tolerance);
    EXPECT_GT(r.levels, 1);
    const std::vector<Vec3> x = anywhere(20000, 2);
    const EvaluatedField exact(field, x), found(baked, x);
    double sum = 0, most = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double e = std::abs(found.values[i] - exact.values[i]) / (r.most - r.least);
      sum += e, most = std::max(most, e);
    }
    // At other points than those that decided on splits, errors are similar.
    EXPECT_LE(most, 1.5 * tolerance);
    EXPECT_LE(most, 1.5 * r.error_most);
    EXPECT_NEAR(sum / static_cast<double>(x.size()), r.error_mean, 0.1 * r.error_mean);
  }
}

TEST(BakedVolume, HasNoCracks) {
  const FormulaVolume field = hill();
  Progress progress;
  BakeOptions options;
  options.tolerance = 0.005;
  const BakedVolume baked(field, options, progress);
  ASSERT_GT(baked.report().levels, 3);
  // Across all planes that may contain faces of bricks of any level.
  std::vector<Vec3> x;
  for (const Vec3& p : anywhere(40000, 3)) {
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 a = p;
      a[k] = std::round(p[k] * 64) / 64;
      Vec3 b = a;
      a[k] -= 1e-9, b[k] += 1e-9;
      x.push_back(a), x.push_back(b);
    }
  }
  const EvaluatedField found(baked, x);
  double jump = 0, bend = 0;
  for (std::size_t i = 0; i < x.size(); i += 2) {
    jump = std::max(jump, std::abs(found.values[i] - found.values[i + 1]));
    bend = std::max(bend, norm(found.gradients[i] - found.gradients[i + 1]));
  }
  EXPECT_LT(jump, 2e-6);
  EXPECT_LT(bend, 5e-5);
}

TEST(BakedVolume, RangesHoldAllValues) {
  const FormulaVolume field = hill();
  Progress progress;
  const BakedVolume baked(field, {}, progress);
  const std::vector<Vec3> a = anywhere(200, 4), d = anywhere(200, 5), u = anywhere(50, 6);
  std::vector<Box3> boxes;
  for (std::size_t i = 0; i < a.size(); ++i) boxes.push_back({a[i], a[i] + d[i] * 0.3});
  std::vector<ValueRange> found(boxes.size());
  baked.ranges(boxes, found);
  std::size_t narrow = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    std::vector<Vec3> x;
    for (const Vec3& p : u)
      x.push_back(boxes[i].lower + Vec3{p.x * 0.3 * d[i].x, p.y * 0.3 * d[i].y, p.z * 0.3 * d[i].z});
    for (const double v : EvaluatedField(baked, x).values) {
      EXPECT_GE(v, found[i].least - 1e-6);
      EXPECT_LE(v, found[i].most + 1e-6);
    }
    narrow += found[i].most - found[i].least < 0.5;
  }
  EXPECT_GT(narrow, boxes.size() / 2);
}

TEST(BakedVolume, RefinementTendsToTheField) {
  const FormulaVolume field = hill();
  Progress progress;
  BakeOptions options;
  options.tolerance = 0.005;
  BakedVolume baked(field, options, 0, progress);
  VolumePictureOptions look;
  look.picture.view.width = look.picture.view.height = 64;
  look.picture.quality.samples = 1;
  look.transfer = TransferFunction{"", {{0, {0, 0, 0.4f}}, {1, {1, 0.9f, 0.4f}}}, {{0, 0}, {0.05, 0}, {1, 0.9}}};
  const auto picture = [&](const VolumeField& f) { return render_volume({&f, nullptr, nullptr, {}}, look, progress); };
  const Image direct = picture(field);
  const auto distance = [&] {
    const Image image = picture(baked);
    double sum = 0;
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        sum += std::abs(static_cast<double>(image.pixels[i][k] - direct.pixels[i][k]));
    return 255 * sum / static_cast<double>(3 * image.pixels.size());
  };
  const double coarse = distance();
  double error = baked.report().error_mean;
  int rounds = 0;
  while (baked.refine(progress)) {
    EXPECT_LE(baked.report().error_mean, error * 1.01);
    error = baked.report().error_mean;
    ++rounds;
  }
  EXPECT_GT(rounds, 2);
  EXPECT_TRUE(baked.report().finished);
  EXPECT_LT(distance(), 0.3 * coarse);
  EXPECT_LT(distance(), 0.3);
  // The same result as baking at once.
  const BakedVolume at_once(field, options, progress);
  EXPECT_EQ(at_once.report().bricks, baked.report().bricks);
  const std::vector<Vec3> x = anywhere(3000, 7);
  EXPECT_TRUE(EvaluatedField(at_once, x).values == EvaluatedField(baked, x).values);
}

TEST(BakedVolume, KeepsToItsMemory) {
  const FormulaVolume field = hill();
  Progress progress;
  BakeOptions options;
  options.tolerance = 1e-5, options.memory = std::size_t{2} << 20;
  const BakedVolume baked(field, options, progress);
  EXPECT_FALSE(baked.report().finished);
  EXPECT_LE(baked.report().bricks * 9 * 9 * 9 * 16, options.memory);
  EXPECT_GT(baked.report().bricks * 9 * 9 * 9 * 16, options.memory / 2);
  EXPECT_GT(baked.report().cell_error_most, options.tolerance);
}

TEST(BakedVolume, KnowsInsideAndAnswersEverywhere) {
  FormulaVolume field = hill();
  const Vec3 center{0.5, 0.5, 0.5};
  field.in = [=](const Vec3& x) { return norm(x - center) < 0.4; };
  Progress progress;
  const BakedVolume baked(field, {}, progress);
  const std::vector<Vec3> x = anywhere(5000, 8);
  const EvaluatedField found(baked, x);
  std::vector<double> spacing(x.size());
  baked.spacing(x, spacing);
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_GE(spacing[i], field.step);
    if (std::abs(norm(x[i] - center) - 0.4) > 0.05) EXPECT_EQ(found.inside[i], field.in(x[i]) ? 1 : 0);
  }
  const double nan = std::numeric_limits<double>::quiet_NaN(), far = 1e30;
  const std::vector<Vec3> odd{
      {nan, 0, 0}, {far, far, -far}, {0, std::numeric_limits<double>::infinity(), 0}, {1, 1, 1}};
  const EvaluatedField strange(baked, odd);
  for (std::size_t i = 0; i < odd.size(); ++i) {
    EXPECT_TRUE(std::isfinite(strange.values[i]) && is_finite(strange.gradients[i]));
    if (!is_finite(odd[i])) EXPECT_EQ(strange.values[i], 0);
  }
  EXPECT_EQ(strange.inside[1], 0);
}

TEST(BakedVolume, PlacesLeadToPartsThatNoNodeHits) {
  test::TwoSpecks specks({0, 0, 0});
  // A bend in each speck that only cells of a fraction of its size can follow.
  const auto nearest = [&specks](const Vec3& x) {
    return specks.centers[norm(x - specks.centers[0]) < norm(x - specks.centers[1]) ? 0 : 1];
  };
  specks.field.value = [=](const Vec3& x) { return squared_norm(x - nearest(x)); };
  specks.field.gradient = [=](const Vec3& x) { return (x - nearest(x)) * 2; };
  const std::vector<Vec3> points = specks.points();
  Progress progress;
  const BakedVolume blind(specks.field, {}, progress);
  BakeOptions options;
  options.samples = points, options.tolerance = 0.02;
  const BakedVolume baked(specks.field, options, progress);
  EXPECT_EQ(blind.report().checked, 0u);
  EXPECT_EQ(baked.report().checked, points.size());
  EXPECT_TRUE(baked.report().finished);
  EXPECT_LE(baked.report().cell_error_most, options.tolerance);
  EXPECT_LT(baked.report().error_most, 3 * options.tolerance);
  const EvaluatedField exact(specks.field, points), found(baked, points), missed(blind, points);
  double worst = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(missed.inside[i], 0);
    if (norm(points[i] - nearest(points[i])) < 0.8 * specks.radius) EXPECT_EQ(found.inside[i], 1) << i;
    worst = std::max(worst, std::abs(found.values[i] - exact.values[i]));
  }
  EXPECT_LT(worst, 3 * options.tolerance * (baked.report().most - baked.report().least));
  // The report shows that the memory limit was reached.
  options.memory = std::size_t{1} << 20;
  EXPECT_FALSE(BakedVolume(specks.field, options, progress).report().finished);
}

TEST(BakedVolume, MagnitudesOfValuesAndLengthsChangeNothingButTheFactor) {
  const FormulaVolume field = hill();
  const auto baked_answers = [&](double factor, double length) {
    FormulaVolume other = field;
    other.value = [&field, factor, length](const Vec3& x) { return factor * field.value(x / length); };
    other.gradient = [&field, factor, length](const Vec3& x) { return field.gradient(x / length) * (factor / length); };
    other.box = {field.box.lower * length, field.box.upper * length};
    other.step = field.step * length;
    Progress progress;
    const BakedVolume baked(other, {}, progress);
    std::vector<Vec3> x = anywhere(300, 4);
    for (Vec3& p : x) p = p * length;
    return EvaluatedField(baked, x);
  };
  const EvaluatedField expected = baked_answers(1, 1);
  for (const auto& [factor, length] :
       {std::pair{0x1p-200, 1.0}, {0x1p200, 1.0}, {1.0, 0x1p-140}, {0x1p-110, 0x1p100}}) {
    const EvaluatedField found = baked_answers(factor, length);
    EXPECT_EQ(found.inside, expected.inside);
    for (std::size_t i = 0; i < expected.values.size(); ++i) {
      ASSERT_EQ(found.values[i], factor * expected.values[i]) << factor << " " << length;
      // Except for values below the range of normal floats.
      for (std::size_t k = 0; k < 3; ++k)
        ASSERT_NEAR(found.gradients[i][k] * (length / factor), expected.gradients[i][k], 1e-37)
            << factor << " " << length;
    }
  }
}

TEST(BakedVolume, SameForAnyThreads) {
  const FormulaVolume field = hill();
  const std::vector<Vec3> x = anywhere(5000, 9);
  test::expect_equal_for_any_threads([&] {
    Progress progress;
    const BakedVolume baked(field, {}, progress);
    return EvaluatedField(baked, x).values;
  });
}

TEST(BakedVolume, BadRequestsAreNamed) {
  const FormulaVolume field = hill();
  Progress progress;
  BakeOptions options;
  options.tolerance = 0;
  EXPECT_THROW(BakedVolume(field, options, progress), ArgumentError);
  options = {};
  options.memory = 1000;
  EXPECT_THROW(BakedVolume(field, options, progress), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
