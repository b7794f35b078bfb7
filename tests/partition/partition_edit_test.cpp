// Supports that change their degree, become constants or are removed: intended changes and invariants.
#include "sansmesh/partition/edit/partition_edit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "partition/edit_checks.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh_measures.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

TEST(SetDegree, EveryDegreeOnASphere) {
  const Fitted f = fit(sphere(20000));
  Progress progress;
  double last = 1e30;
  for (int degree = 0; degree <= 4; ++degree) {
    SCOPED_TRACE(degree);
    const EditResult edited = set_degree(f.data, everything(f.data), degree, f.samples(), progress);
    edited.data.validate();
    expect_sums(edited.data);
    for (std::size_t i = 0; i < edited.data.supports.size(); ++i) {
      ASSERT_EQ(edited.data.functions[i].degree, degree);
      ASSERT_EQ(edited.data.functions[i].radius, f.data.functions[i].radius);
      ASSERT_EQ(edited.data.supports[i].code, f.data.supports[i].code);
    }
    const double error = error_on_sphere(edited.data);
    EXPECT_LT(error, degree % 2 == 0 && degree > 0 ? 0.5 * last : 1.1 * last);
    last = error;
  }
  EXPECT_LT(last, 1e-4);
}

TEST(SetDegree, PlanesLeaveTheSquareOfTheRadius) {
  // The best plane over a disc of radius r on a sphere of radius 1 is off by about a tenth of r².
  Progress progress;
  std::vector<double> ratio;
  for (const int depth : {3, 4, 5}) {
    PartitionOptions options;
    options.max_depth = depth;
    options.error = 1e-9;
    const Fitted f = fit(sphere(60000), options);
    const double radius = 1.5 * 0.8660254 * f.data.edge / (1 << f.data.report.depth);
    ASSERT_EQ(f.data.report.depth, depth);
    const PartitionData flat = set_degree(f.data, everything(f.data), 1, f.samples(), progress).data;
    ratio.push_back(error_on_sphere(flat) / (radius * radius));
    double rms = 0;
    for (const Support& s : flat.supports)
      rms += static_cast<double>(s.error) / static_cast<double>(flat.supports.size());
    EXPECT_NEAR(rms / (radius * radius), 0.097, 0.02) << depth;
  }
  for (const double r : ratio) EXPECT_NEAR(r / ratio[0], 1, 0.4);
}

TEST(SetDegree, LeavesAllOthersUntouchedAndTakesCreasesAway) {
  const Fitted f = fit(cube(8000));
  Progress progress;
  const Selection chosen = in_ball(f.data, {1, 1, 1}, 0.5f);
  std::size_t creased = 0;
  for (const std::uint32_t i : chosen) creased += f.data.supports[i].creased;
  ASSERT_GT(creased, 5u);
  ASSERT_LT(creased, f.data.report.creased);
  for (const int degree : {0, 1, 3}) {
    const EditResult edited = set_degree(f.data, chosen, degree, f.samples(), progress);
    edited.data.validate();
    expect_sums(edited.data);
    EXPECT_EQ(edited.data.report.creased, f.data.report.creased - creased);
    for (const std::uint32_t i : chosen) {
      // Few samples do not determine a cubic.
      const bool few = edited.data.supports[i].samples < 20;
      if (degree < 3 || !few) {
        EXPECT_EQ(edited.data.functions[i].degree, degree);
      }
      EXPECT_LE(edited.data.functions[i].degree, degree);
      EXPECT_EQ(edited.data.functions[i].next, 0);
    }
    for (const std::uint32_t i : others(f.data, chosen)) EXPECT_TRUE(same_support(edited.data, i, f.data, i)) << i;
    // The tree of the mesh is shared, not copied.
    EXPECT_EQ(edited.data.flatness[2].gap.data(), f.data.flatness[2].gap.data());
  }
}

TEST(SetDegree, KeepsTheRadiusThatARefitGave) {
  const Fitted f = fit(sphere(8000));
  Progress progress;
  PartitionOptions wide = f.data.options;
  wide.support = 2;
  const PartitionData data = refit(f.data, everything(f.data), wide, f.samples(), progress).data;
  const PartitionData edited = set_degree(data, everything(data), 2, f.samples(), progress).data;
  edited.validate();
  for (std::size_t i = 0; i < edited.supports.size(); ++i) {
    EXPECT_EQ(edited.functions[i].radius, data.functions[i].radius);
    EXPECT_GE(edited.functions[i].scale, 0.999f * data.functions[i].radius);  // fitted over all of its ball
  }
}

TEST(SetConstant, Erases) {
  const Fitted f = fit(sphere(8000));
  const Selection chosen = in_ball(f.data, {0, 0, 1}, 0.3f);
  for (const float value : {0.01f, 1.0f, 100.0f}) {
    const EditResult edited = set_constant(f.data, chosen, value);
    edited.data.validate();
    expect_sums(edited.data);
    const PartitionOfUnity field(edited.data);
    for (const std::uint32_t i : chosen) {
      EXPECT_EQ(edited.data.supports[i].state, Support::constant);
      EXPECT_EQ(edited.data.supports[i].area, 0);
      EXPECT_TRUE(edited.data.functions[i].is_constant());
      EXPECT_FLOAT_EQ(local_value(edited.data.functions[i], f.data.functions[i].center),
                      value * f.data.functions[i].radius);
    }
    for (const std::uint32_t i : others(f.data, chosen)) EXPECT_TRUE(same_support(edited.data, i, f.data, i)) << i;
    // Larger values may be bounded by the radius.
    const double radius = f.data.functions[chosen[0]].radius, full = std::min<double>(value, 1) * radius;
    EXPECT_GT(value_at(edited.data, {0, 0, 1}), 0.5 * full);
  }
  const EditResult edited = set_constant(f.data, chosen, 1);
  EXPECT_LT(edited.data.report.area, f.data.report.area - 0.2);
  const TriangleMesh mesh = mesh_of(edited.data);
  EXPECT_TRUE(measure_topology(mesh).closed());
  float highest = -1, lowest = 1;
  for (const Vec3f& v : mesh.vertices) highest = std::max(highest, v.z), lowest = std::min(lowest, v.z);
  EXPECT_LT(highest, 0.99f);
  EXPECT_NEAR(lowest, -1, 0.01);
}

TEST(SetConstant, Fills) {
  const Fitted f = fit(sphere(8000));
  const Selection chosen = in_ball(f.data, {0, 0, 1}, 0.3f);
  const EditResult edited = set_constant(f.data, chosen, -1);
  edited.data.validate();
  EXPECT_LT(value_at(edited.data, {0, 0, 1}), 0);
  const TriangleMesh mesh = mesh_of(edited.data);
  EXPECT_TRUE(measure_topology(mesh).closed());
  float highest = -1;
  for (const Vec3f& v : mesh.vertices) highest = std::max(highest, v.z);
  EXPECT_GT(highest, 1.03f);
}

TEST(SetConstant, ConstantsCanBeEditedAgain) {
  const Fitted f = fit(cube(8000));
  Progress progress;
  const Selection chosen = in_ball(f.data, {1, 1, 1}, 0.4f);
  const PartitionData erased = set_constant(f.data, chosen, 1).data;
  const PartitionData filled = set_constant(erased, chosen, -2).data;
  EXPECT_LT(local_value(filled.functions[chosen[0]], filled.functions[chosen[0]].center), 0);
  const PartitionData planes = set_degree(erased, chosen, 1, f.samples(), progress).data;
  planes.validate();
  for (const std::uint32_t i : chosen) {
    EXPECT_EQ(planes.supports[i].state, Support::fitted);
    EXPECT_EQ(planes.functions[i].degree, 1);
  }
  expect_same(planes, set_degree(f.data, chosen, 1, f.samples(), progress).data);
}

TEST(SetConstant, RejectsValuesThatMeanNothing) {
  const Fitted f = fit(sphere(1000));
  const float inf = std::numeric_limits<float>::infinity();
  for (const float bad : {0.0f, 1e-4f, -1e-4f, 1e4f, inf, -inf, std::nanf("")})
    EXPECT_THROW(set_constant(f.data, {0}, bad), ArgumentError) << bad;
  for (const double good : {kLeastConstant, -kLeastConstant, kMostConstant, -kMostConstant})
    EXPECT_NO_THROW(set_constant(f.data, {0}, static_cast<float>(good))) << good;
}

TEST(RemoveSupports, LeavesTheOthers) {
  const Fitted f = fit(cube(8000));
  const Selection chosen = in_ball(f.data, {1, 1, 1}, 0.4f), rest = others(f.data, chosen);
  const EditResult edited = remove_supports(f.data, chosen);
  edited.data.validate();
  expect_sums(edited.data);
  EXPECT_EQ(edited.supports, 0u);
  ASSERT_EQ(edited.data.supports.size(), rest.size());
  for (std::size_t i = 0; i < rest.size(); ++i) EXPECT_TRUE(same_support(edited.data, i, f.data, rest[i])) << i;
  EXPECT_TRUE(measure_topology(mesh_of(edited.data)).closed());
  EXPECT_THROW(remove_supports(f.data, everything(f.data)), DataError);
}

TEST(Edits, OfNothingChangeNothing) {
  const Fitted f = fit(sphere(2000));
  Progress progress;
  for (const EditResult& r :
       {set_degree(f.data, {}, 1, f.samples(), progress), refit(f.data, {}, {}, f.samples(), progress),
        set_constant(f.data, {}, 1), remove_supports(f.data, {})}) {
    expect_same(r.data, f.data);
    EXPECT_TRUE(r.changed.empty());
    EXPECT_EQ(r.changes, 0u);
    EXPECT_EQ(r.supports, 0u);
  }
}

template <class Error, class Work>
void expect_error(const char* part, Work&& work) {
  try {
    work();
    ADD_FAILURE() << "no error that says: " << part;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(Edits, SayWhatTheyCannotDo) {
  const Fitted f = fit(sphere(2000));
  Progress progress;
  const Selection all = everything(f.data);
  expect_error<DataError>("samples were not kept", [&] { set_degree(f.data, all, 1, {}, progress); });
  expect_error<DataError>("samples were not kept", [&] { refit(f.data, all, f.data.options, {}, progress); });
  for (const int degree : {-1, 5, 100})
    expect_error<ArgumentError>("degree", [&] { set_degree(f.data, all, degree, f.samples(), progress); });
  PartitionOptions options;
  options.max_depth = 40;
  expect_error<ArgumentError>("max_depth", [&] { refit(f.data, all, options, f.samples(), progress); });
  options = {};
  options.error = -1;
  expect_error<ArgumentError>("error", [&] { refit(f.data, all, options, f.samples(), progress); });
  // Samples of another cloud.
  const std::vector<Vec3f> far(10, Vec3f{1, 1, 1} * 0.999f), up(10, Vec3f{0, 0, 1});
  expect_error<DataError>("samples", [&] { set_degree(f.data, all, 1, {far, up}, progress); });
  SupportQuery query;
  query.flags = std::vector<std::uint8_t>(3);
  expect_error<ArgumentError>("flag", [&] { select_supports(f.data, query); });
}

TEST(Edits, DoNotDependOnTheThreads) {
  const Fitted f = fit(cube(20000));
  Progress progress;
  const Selection chosen = in_ball(f.data, {1, 1, 1}, 0.9f);
  PartitionOptions other = f.data.options;
  other.max_degree = 3;
  test::compare_threads(
      [&] {
        return std::vector{refit(f.data, chosen, other, f.samples(), progress).data,
                           set_degree(f.data, chosen, 2, f.samples(), progress).data,
                           set_constant(f.data, chosen, 1).data, remove_supports(f.data, chosen).data};
      },
      [](const auto& one, const auto& many) {
        for (std::size_t i = 0; i < one.size(); ++i) expect_same(one[i], many[i]);
      });
}

TEST(Edits, CanBeCancelled) {
  const Fitted f = fit(sphere(2000));
  Progress progress;
  progress.cancel();
  EXPECT_THROW(refit(f.data, everything(f.data), {}, f.samples(), progress), Cancelled);
  EXPECT_THROW(set_degree(f.data, everything(f.data), 1, f.samples(), progress), Cancelled);
}

}  // namespace
}  // namespace sansmesh::inline v1
