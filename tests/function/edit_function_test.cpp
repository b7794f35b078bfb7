// Editing functions in input coordinates.
#include "sansmesh/function/edit_function.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "function/edit_shapes.h"
#include "sansmesh/error.h"
#include "sansmesh/partition/partition_of_unity.h"
#include "support/same_bytes.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

/// Survey coordinates: far from zero, in another unit than the field.
const Vec3 kFar{431234.5, 5812345.25, 812};
constexpr float kScale = 256;  // a power of two: the same blocks in both units
PointSet surveyed(PointSet cloud) {
  cloud.origin = kFar;
  for (Vec3f& p : cloud.positions) p *= kScale;
  return cloud;
}

bool same_function(const FittedFunction& a, const FittedFunction& b) {
  const PartitionData &p = a.field.data(), &q = b.field.data();
  bool same = same_bytes(p.functions, q.functions) && same_bytes(p.supports, q.supports) && a.history == b.history &&
              p.flatness.size() == q.flatness.size() && p.report.area == q.report.area &&
              p.report.functions == q.report.functions;
  for (std::size_t l = 0; same && l < p.flatness.size(); ++l) same = same_bytes(p.flatness[l].gap, q.flatness[l].gap);
  return same;
}
FittedFunction copy_of(const FittedFunction& f) {
  return {PartitionOfUnity(f.field.data()), f.frame, f.samples, f.history, f.notes};
}

double value_at(const FittedFunction& f, const Vec3& x) {
  const Vec3 p = f.frame.from_input(x);
  double v = 0;
  f.field.evaluate(std::span<const Vec3>(&p, 1), std::span<double>(&v, 1));
  return f.frame.to_input(v);
}

/// Points within about a spacing of the samples, all around them (input coordinates), in blocks with a support, where
/// the far field has no share.
std::vector<Vec3> near_surface(const FittedFunction& f, std::size_t n) {
  std::mt19937 random(11);
  std::normal_distribution<double> gauss;
  std::vector<Vec3> points;
  const auto& samples = f.samples->positions;
  const PartitionData& data = f.field.data();
  while (points.size() < n) {
    const Vec3f p(Vec3(samples[random() % samples.size()]) +
                  Vec3{gauss(random), gauss(random), gauss(random)} * (0.5 * f.field.report().spacing));
    for (std::size_t i = 0; i < data.supports.size(); ++i) {
      const Vec3f d = p - data.functions[i].center;
      const float half = 0.49f * data.edge / static_cast<float>(1 << data.supports[i].level);
      if (std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) > half) continue;
      points.push_back(f.frame.to_input(data.origin + Vec3(p)));
      break;
    }
  }
  return points;
}

const std::vector<decltype(Edit::action)>& actions() {
  static const std::vector<decltype(Edit::action)> all{
      SetDegree{0},   SetDegree{1},      SetDegree{2},    Refit{}, Refit{2, 4, {}, 2.0, false},
      SetConstant{1}, SetConstant{-0.5}, RemoveSupports{}};
  return all;
}

TEST(FunctionEditor, TakesCoordinatesOfTheInput) {
  FunctionEditor editor(fitted(surveyed(sphere(6000))));
  ASSERT_NE(editor.function().frame.unit, 1);
  Progress progress;
  const Vec3 pole = kFar + Vec3{0, 0, kScale};
  EXPECT_NEAR(value_at(editor.function(), pole), 0, 0.1);
  const EditReport report = editor.apply(edit_in_ball(pole, 0.2 * kScale, SetConstant{1}), progress);
  EXPECT_GT(report.chosen, 3u);
  EXPECT_LT(report.chosen, editor.function().field.report().functions / 4);
  EXPECT_EQ(report.supports, report.chosen);
  EXPECT_TRUE(report.changed.contains(pole));
  EXPECT_LT(norm(report.changed.center() - pole), 0.3 * kScale);
  EXPECT_GT(report.changed.diagonal(), 0.4 * kScale);
  EXPECT_LT(report.changed.diagonal(), 3 * kScale);
  EXPECT_GT(value_at(editor.function(), pole), 0.05 * kScale);
  EXPECT_NEAR(value_at(editor.function(), kFar - Vec3{0, 0, kScale}), 0, 0.1);
  EXPECT_EQ(editor.edits(), 1u);
  EXPECT_EQ(editor.function().history.back(), report.what);
  EXPECT_NE(report.what.find("outside"), std::string::npos) << report.what;
}

TEST(FunctionEditor, SelectionsInTheUnitOfTheInput) {
  // The same selections of the same shape in both coordinates select as many supports.
  const FittedFunction here = fitted(bumpy(6000)), there = fitted(surveyed(bumpy(6000)));
  ASSERT_EQ(here.field.report().functions, there.field.report().functions);
  Progress progress;
  const auto at = [](const Vec3& x) { return kFar + x * kScale; };
  std::vector<std::pair<EditSelection, EditSelection>> pairs(8);
  pairs[0].first.ball = {{0, 0, 1}, 0.4}, pairs[0].second.ball = {at({0, 0, 1}), 0.4 * kScale};
  pairs[1].first.box = Box3{{0.1, -2, -2}, {0.4, 2, 0.3}},
  pairs[1].second.box = Box3{at({0.1, -2, -2}), at({0.4, 2, 0.3})};
  pairs[2].first.half_space = {{0, 0.123, 0}, {0, 5, 1}}, pairs[2].second.half_space = {at({0, 0.123, 0}), {0, 5, 1}};
  const double error = 0.9 * here.field.data().supports[7].error * here.frame.unit;
  pairs[3].first.error_above = error, pairs[3].second.error_above = error * kScale;
  pairs[4].first.coverage_below = pairs[4].second.coverage_below = 1;
  pairs[5].first.samples_below = pairs[5].second.samples_below = 60;
  pairs[6].first.level_from = pairs[6].second.level_from = here.field.report().depth;
  pairs[7].first.sheet_at = Vec3{0, 0, 1}, pairs[7].second.sheet_at = at({0, 0, 1});
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    FunctionEditor a(copy_of(here)), b(copy_of(there));
    const std::size_t n = a.apply({pairs[k].first, SetConstant{1}}, progress).chosen,
                      m = b.apply({pairs[k].second, SetConstant{1}}, progress).chosen;
    EXPECT_GT(n, 0u) << k;
    EXPECT_NEAR(static_cast<double>(n), static_cast<double>(m), 0.03 * static_cast<double>(n)) << k;
  }
}

TEST(FunctionEditor, Sheets) {
  PointSet cloud = two_spheres();
  std::mt19937 random(2);
  std::normal_distribution<float> gauss;
  for (int i = 0; i < 25; ++i) {  // stray samples
    cloud.positions.push_back(Vec3f{0, 3, 0} + Vec3f{gauss(random), gauss(random), gauss(random)} * 0.1f);
    cloud.normals.push_back(normalized(Vec3f{gauss(random), gauss(random), gauss(random)}));
  }
  Progress progress;
  const FittedFunction function =
      fit_surface_function(prepare_cloud(cloud, {.normals = NormalUse::as_given}, progress), {}, progress);
  const auto left = [&](const EditSelection& select) {
    FunctionEditor editor(copy_of(function));
    editor.apply({select, RemoveSupports{}}, progress);
    bool big = false, small = false, strays = false;
    for (const Support& s : editor.function().field.data().supports) {
      const Vec3 p = function.frame.to_input(function.field.data().origin + Vec3(s.foot));
      big |= norm(p) < 1.4, small |= norm(p - Vec3{2, 0, 0}) < 0.6, strays |= norm(p - Vec3{0, 3, 0}) < 0.7;
    }
    return std::string(big ? "big " : "") + (small ? "small " : "") + (strays ? "strays " : "");
  };
  EditSelection select;
  select.spurious_sheets = true;
  EXPECT_EQ(left(select), "big small ");
  select = {};
  select.all_but_largest = true;
  EXPECT_EQ(left(select), "big ");
  select = {};
  select.sheet_at = Vec3{2.3, 0.4, 0};
  EXPECT_EQ(left(select), "big strays ");
  select.sheet_at = Vec3{-30, 0, 0};
  EXPECT_EQ(left(select), "big small strays ") << "no sheet is there";

  // A removed sheet is not replaced by the next one.
  FunctionEditor editor(copy_of(function));
  select.sheet_at = Vec3{2.3, 0.4, 0};
  EXPECT_GT(editor.apply({select, RemoveSupports{}}, progress).chosen, 0u);
  EXPECT_EQ(editor.apply({select, RemoveSupports{}}, progress).chosen, 0u);
  EXPECT_EQ(editor.function().history.size(), 1u) << "what does nothing is not remembered";

  // Removed supports are not restored when others are refitted.
  const std::size_t before = editor.function().field.data().supports.size();
  EditSelection big;
  big.ball = {{0, 0, 0}, 1.3};
  EXPECT_GT(editor.apply({big, Refit{}}, progress).chosen, 0u);
  EXPECT_EQ(editor.function().field.data().supports.size(), before);
}

TEST(FunctionEditor, NothingChangesOutsideOfWhatItSays) {
  for (const PointSet& cloud : {surveyed(bumpy(5000)), cube(6000)}) {
    const FittedFunction before = fitted(cloud);
    const double size = before.field.bounds().diagonal();
    const std::vector<Vec3> points = near_surface(before, 6000);
    std::vector<Vec3> inner;
    for (const Vec3& p : points) inner.push_back(before.frame.from_input(p));
    std::vector<double> old(points.size()), now(points.size());
    before.field.evaluate(inner, old);
    Progress progress;
    for (const auto& action : actions()) {
      FunctionEditor editor(copy_of(before));
      // Far from the middle: at a corner, where another degree is another function.
      const auto far = [](const Vec3& a, const Vec3& b) { return norm(a) < norm(b); };
      const Vec3 center =
          points[static_cast<std::size_t>(std::max_element(inner.begin(), inner.end(), far) - inner.begin())];
      const EditReport report =
          editor.apply(edit_in_ball(center, 0.15 * static_cast<double>(norm(cloud.positions[0])), action), progress);
      editor.function().field.evaluate(inner, now);
      std::size_t differ = 0, outside = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const bool in = report.changed.contains(points[i]);
        outside += !in;
        differ += in && old[i] != now[i];
        if (!in) {
          // The far field changes slightly everywhere, and has a share where supports are thin.
          ASSERT_NEAR(old[i], now[i], 5e-4 * size) << report.what;
        }
      }
      EXPECT_GT(outside, points.size() / 3) << size;
      const Refit* refit = std::get_if<Refit>(&action);
      if (!refit || refit->support) {
        EXPECT_GT(differ, 20u) << report.what;
      }
    }
  }
}

TEST(FunctionEditor, UndoBringsBackEveryBit) {
  const FittedFunction function = fitted(cube(6000));
  FunctionEditor editor(copy_of(function));
  Progress progress;
  std::vector<FittedFunction> stages;
  std::vector<std::vector<Box3>> changed;
  stages.push_back(copy_of(function)), changed.push_back({});
  for (std::size_t i = 0; i < actions().size(); ++i) {
    const Vec3 at = Vec3{1, 1, -1 + 0.25 * static_cast<double>(i)};
    editor.apply(edit_in_ball(at, 0.2, actions()[i]), progress);
    stages.push_back(copy_of(editor.function())), changed.push_back(editor.changed());
    EXPECT_FALSE(same_function(stages[i], stages[i + 1])) << i;
  }
  const auto expect_stage = [&](std::size_t i) {
    EXPECT_TRUE(same_function(editor.function(), stages[i])) << i;
    EXPECT_EQ(editor.edits(), i);
    ASSERT_EQ(editor.changed().size(), changed[i].size());
    for (std::size_t k = 0; k < changed[i].size(); ++k) EXPECT_EQ(editor.changed()[k].lower, changed[i][k].lower);
  };
  const std::size_t n = actions().size();
  EXPECT_EQ(editor.edits(), n);
  EXPECT_THROW(editor.apply({{}, Undo{static_cast<int>(n) + 1}}, progress), ArgumentError);
  expect_stage(n);
  EXPECT_THROW(editor.apply({{}, Undo{0}}, progress), ArgumentError);
  EXPECT_THROW(editor.apply({{}, Undo{-3}}, progress), ArgumentError);
  expect_stage(n);
  const EditReport report = editor.apply({{}, Undo{}}, progress);
  EXPECT_FALSE(report.changed.empty());
  expect_stage(n - 1);
  editor.apply({{}, Undo{3}}, progress);
  expect_stage(n - 4);
  // Other edits may follow, and be undone.
  editor.apply(edit_in_ball({-1, -1, -1}, 0.3, SetDegree{1}), progress);
  EXPECT_EQ(editor.edits(), n - 3);
  editor.apply({{}, Undo{static_cast<int>(n) - 3}}, progress);
  expect_stage(0);
  EXPECT_THROW(editor.apply({{}, Undo{}}, progress), ArgumentError);
}

TEST(FunctionEditor, NothingSelectedIsAnEditThatDoesNothing) {
  const FittedFunction function = fitted(sphere(2000));
  FunctionEditor editor(copy_of(function));
  Progress progress;
  for (const auto& action : actions()) {
    const EditReport report = editor.apply(edit_in_ball({100, 0, 0}, 1, action), progress);
    EXPECT_EQ(report.chosen, 0u);
    EXPECT_TRUE(report.changed.empty());
    EXPECT_TRUE(same_bytes(editor.function().field.data().functions, function.field.data().functions));
  }
  EXPECT_TRUE(editor.changed().empty());
  EXPECT_EQ(editor.edits(), actions().size());
  editor.apply({{}, Undo{static_cast<int>(actions().size())}}, progress);
  EXPECT_TRUE(same_function(editor.function(), function));
}

TEST(FunctionEditor, FailuresLeaveTheFunctionAsItWas) {
  FittedFunction bare = fitted(sphere(2000));
  FunctionEditor editor(copy_of(bare));
  bare.samples = std::make_shared<PointSet>();
  FunctionEditor without(copy_of(bare));
  Progress progress;
  const FittedFunction first = copy_of(editor.function());
  EditSelection some;
  some.ball = {{0, 0, 1}, 0.3};
  EXPECT_THROW(editor.apply({some, SetDegree{7}}, progress), ArgumentError);
  EXPECT_THROW(editor.apply({some, SetDegree{-1}}, progress), ArgumentError);
  EXPECT_THROW(editor.apply({some, SetConstant{0}}, progress), ArgumentError);
  EXPECT_THROW(editor.apply({some, SetConstant{std::nan("")}}, progress), ArgumentError);
  EXPECT_THROW(editor.apply({some, Refit{9, {}, {}, {}, {}}}, progress), ArgumentError);
  EXPECT_THROW(editor.apply({some, Refit{{}, {}, -1.0, {}, {}}}, progress), ArgumentError);
  EXPECT_THROW(editor.apply({{}, RemoveSupports{}}, progress), DataError);
  EditSelection bad = some;
  bad.ball->radius = 0;
  EXPECT_THROW(editor.apply({bad, SetDegree{1}}, progress), ArgumentError);
  for (const auto& action : {decltype(Edit::action)(SetDegree{1}), decltype(Edit::action)(Refit{})}) {
    try {
      without.apply({some, action}, progress);
      ADD_FAILURE();
    } catch (const DataError& error) {
      EXPECT_NE(std::string(error.what()).find("samples were not kept"), std::string::npos) << error.what();
    }
  }
  bad = {};
  bad.spurious_sheets = true;
  EXPECT_THROW(without.apply({bad, RemoveSupports{}}, progress), DataError);
  progress.cancel();
  EXPECT_THROW(editor.apply({some, SetDegree{1}}, progress), Cancelled);
  EXPECT_TRUE(same_function(editor.function(), first));
  EXPECT_EQ(editor.edits(), 0u);
  EXPECT_EQ(without.edits(), 0u);
  EXPECT_TRUE(editor.changed().empty());
  // Edits that need no samples work without them.
  Progress fresh;
  EXPECT_NO_THROW(without.apply({some, SetConstant{1}}, fresh));
  EXPECT_NO_THROW(without.apply({some, RemoveSupports{}}, fresh));
}

}  // namespace
}  // namespace sansmesh::inline v1
