// Edits of functions fitted by the published method: degrees, constants, and selection by coverage.
#include <gtest/gtest.h>

#include <cmath>

#include "sansmesh/core/boxes.h"
#include "sansmesh/error.h"
#include "sansmesh/function_edits.h"
#include "sansmesh/partition/edit/partition_edit.h"
#include "sansmesh/partition/fit/partition_fit.h"
#include "sansmesh/partition/paper/paper_fit.h"
#include "sansmesh/partition/paper/paper_local.h"
#include "support/any_threads.h"
#include "support/clouds.h"
#include "support/same_bytes.h"

namespace sansmesh::inline v1 {
namespace {

struct Edited {
  PartitionOfUnity field;
  PointSet samples;
  const PartitionData& data() const { return field.data(); }
  EditSamples edit_samples() const { return {samples.positions, samples.normals}; }
};

Edited fit_for_edits(const PointSet& cloud, const PaperOptions& options = {}) {
  Progress progress;
  PointSet sorted;
  PartitionOfUnity field = fit_paper_partition(cloud, options, progress, &sorted);
  return {std::move(field), std::move(sorted)};
}

Selection in_ball(const PartitionData& data, const Vec3f& center, float radius) {
  SupportQuery query;
  query.ball = {center - Vec3f(data.origin), radius};
  return select_supports(data, query);
}

Selection failing(const PartitionData& data, const PaperCoverage& coverage = kThesisCoverage) {
  SupportQuery query;
  query.coverage_fails = coverage;
  return select_supports(data, query);
}

std::size_t count_borrowed(const PartitionData& data) {
  std::size_t n = 0;
  for (const Support& s : data.supports) n += is_borrowed(s);
  return n;
}

double edited_value(const PartitionData& data, const Vec3& x) {
  double f = 0;
  PartitionOfUnity(data).evaluate(std::span<const Vec3>(&x, 1), std::span<double>(&f, 1));
  return f;
}

/// The unit sphere, with a small dome of few samples beside it that makes a separate sheet.
PointSet sphere_with_dome(float at) {
  PointSet cloud = test::sphere(6000);
  for (int i = 0; i < 40; ++i) {
    const int row = i / 8;
    const float u = 0.02f * static_cast<float>(i % 8 - 4), v = 0.02f * static_cast<float>(row - 2);
    cloud.positions.push_back({u, v, at});
    cloud.normals.push_back({0, 0, 1});
  }
  return cloud;
}

TEST(PaperEdit, SelectsWhereCoverageFailsAndSetsTheDegreeThatItAllows) {
  PaperOptions bold;
  bold.coverage = kNoCoverage;
  bold.threshold = 2e-4;
  const Edited fit = fit_for_edits(test::torus(4000), bold);
  const Selection bad = failing(fit.data());
  const std::size_t borrowed = count_borrowed(fit.data());
  ASSERT_GT(bad.size(), borrowed);  // including curved ones
  for (const std::uint32_t i : bad) {
    const Support& s = fit.data().supports[i];
    const int degree = fit.data().functions[i].degree;
    EXPECT_TRUE(is_borrowed(s) || s.coverage < kThesisCoverage[static_cast<std::size_t>(degree) - 2]);
  }
  Progress progress;
  const EditResult r = set_degree(fit.data(), bad, kAutomaticDegree, fit.edit_samples(), progress);
  EXPECT_EQ(r.changes, bad.size() - borrowed);
  EXPECT_EQ(failing(r.data).size(), borrowed);
  EXPECT_NO_THROW(r.data.validate());
  // A fit with coverage thresholds has no degree to lower.
  PaperOptions careful = bold;
  careful.coverage = kThesisCoverage;
  const Edited good = fit_for_edits(test::torus(4000), careful);
  EXPECT_EQ(failing(good.data()).size(), count_borrowed(good.data()));
}

TEST(PaperEdit, TheDegreeOfTheFitGivesTheFitBack) {
  const Edited fit = fit_for_edits(test::torus(4000));
  Selection all;
  for (std::uint32_t i = 0; i < fit.data().supports.size(); ++i) all.push_back(i);
  Progress progress;
  const EditResult r = set_degree(fit.data(), all, kAutomaticDegree, fit.edit_samples(), progress);
  EXPECT_TRUE(test::same_bytes(r.data.functions, fit.data().functions));
  EXPECT_TRUE(test::same_bytes(r.data.supports, fit.data().supports));
}

TEST(PaperEdit, SetsDegreesThatTheSamplesDetermine) {
  const Edited fit = fit_for_edits(test::sphere(5000));
  Progress progress;
  const Selection chosen = in_ball(fit.data(), {0, 0, 1}, 0.3f);
  for (const int degree : {0, 1, 2, 3, 4}) {
    const EditResult r = set_degree(fit.data(), chosen, degree, fit.edit_samples(), progress);
    std::size_t lower = 0;
    for (const std::uint32_t i : chosen) {
      if (is_borrowed(r.data.supports[i])) continue;
      const LocalFunction& f = r.data.functions[i];
      EXPECT_LE(f.degree, degree);
      lower += f.degree < degree;
      if (f.degree > 1) EXPECT_GE(r.data.supports[i].samples, 2u * kBasisSize[static_cast<std::size_t>(f.degree)]);
    }
    EXPECT_EQ(r.lower, lower);
    if (degree == 4) EXPECT_LT(std::abs(edited_value(r.data, {0, 0, 1})), 1e-3);
  }
  EXPECT_THROW(set_degree(fit.data(), chosen, 5, fit.edit_samples(), progress), ArgumentError);
  EXPECT_THROW(set_degree(fit.data(), chosen, 1, {}, progress), DataError);
}

TEST(PaperEdit, AutomaticConstantsTakeTheSideOfTheOthers) {
  for (const float at : {1.45f, 0.4f}) {  // outside of the sphere, and inside
    const Edited fit = fit_for_edits(sphere_with_dome(at));
    const Vec3 below{0, 0, at - 0.02}, above{0, 0, at + 0.02};
    ASSERT_LT(edited_value(fit.data(), below), 0);
    ASSERT_GT(edited_value(fit.data(), above), 0);
    const Selection dome = in_ball(fit.data(), {0, 0, at}, 0.25f);
    const EditResult r = set_automatic_constant(fit.data(), dome);
    for (const Vec3& x : {below, above}) EXPECT_EQ(edited_value(r.data, x) > 0, at > 1) << at;
    for (const std::uint32_t i : dome) EXPECT_EQ(r.data.supports[i].state, Support::constant);
    EXPECT_NO_THROW(r.data.validate());
    EXPECT_NEAR(edited_value(r.data, {0, 0, -1}), edited_value(fit.data(), {0, 0, -1}), 1e-6);
  }
}

TEST(PaperEdit, AutomaticConstantsOfTheDefaultsFunctionsTakeTheSideOfTheOthersToo) {
  Progress progress;
  const PartitionOfUnity field = fit_partition_of_unity(sphere_with_dome(1.45f), {}, progress);
  const Selection dome = in_ball(field.data(), {0, 0, 1.45f}, 0.15f);
  ASSERT_FALSE(dome.empty());
  const EditResult r = set_automatic_constant(field.data(), dome);
  EXPECT_GT(edited_value(r.data, {0, 0, 1.43}), 0);
}

TEST(PaperEdit, LeavesWhatItDoesNotTouch) {
  const Edited fit = fit_for_edits(sphere_with_dome(1.45f));
  const EditResult r = set_automatic_constant(fit.data(), in_ball(fit.data(), {0, 0, 1.45f}, 0.2f));
  const PointSet points = test::sphere(500);
  for (const Vec3f& p : points.positions)
    if (!any_contains(r.regions, p - Vec3f(fit.data().origin)))
      EXPECT_EQ(edited_value(r.data, Vec3(p)), edited_value(fit.data(), Vec3(p)));
}

TEST(PaperEdit, AllCannotBeJudgedByTheOthers) {
  const Edited fit = fit_for_edits(test::sphere(1000));
  Selection all;
  for (std::uint32_t i = 0; i < fit.data().supports.size(); ++i) all.push_back(i);
  EXPECT_THROW(set_automatic_constant(fit.data(), all), DataError);
}

TEST(PaperEdit, PartsAreNotFittedAgain) {
  const Edited fit = fit_for_edits(test::sphere(1000));
  Progress progress;
  EXPECT_THROW(refit(fit.data(), {0}, fit.data().options, fit.edit_samples(), progress), DataError);
}

}  // namespace
}  // namespace sansmesh::inline v1
