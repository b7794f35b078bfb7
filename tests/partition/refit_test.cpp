// Refitted supports: identical to the bit with the same options, different only where requested with others.
#include <algorithm>
#include <string>

#include "partition/edit_checks.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

struct NamedCloud {
  const char* name;
  PointSet cloud;
};
std::vector<NamedCloud> clouds() {
  PointSet far = torus(6000);
  far.origin = {431234.5, 5812345.25, 812};
  return {{"sphere", sphere(8000)},
          {"noisy sphere", sphere(8000, 0.02)},
          {"uneven sphere", uneven_sphere(4000, 0.002)},
          {"cube", cube(8000)},
          {"far torus", far}};
}

TEST(Refit, OfAllIsTheFitAgainToTheBit) {
  for (const auto& [name, cloud] : clouds()) {
    SCOPED_TRACE(name);
    const Fitted f = fit(cloud);
    Progress progress;
    const EditResult again = refit(f.data, everything(f.data), f.data.options, f.samples(), progress);
    expect_same(again.data, f.data);
    again.data.validate();
    EXPECT_EQ(again.changes, f.data.supports.size());
    EXPECT_EQ(again.supports, f.data.supports.size());
  }
}

// All inputs of a fit are within a few of its edges (samples, noise and risks of the neighbours), and those samples are
// all present: a part is reproduced exactly, up to its rim.
TEST(Refit, OfAPartIsTheFitAgainToTheBit) {
  for (const auto& [name, cloud] : clouds()) {
    SCOPED_TRACE(name);
    const Fitted f = fit(cloud);
    Progress progress;
    for (const std::size_t at : {std::size_t{0}, f.positions.size() / 2, f.positions.size() - 1})
      for (const float radius : {0.0f, 0.1f, 0.5f}) {
        const Selection chosen = in_ball(f.data, f.positions[at], radius);
        ASSERT_FALSE(chosen.empty());
        const EditResult again = refit(f.data, chosen, f.data.options, f.samples(), progress);
        expect_same(again.data, f.data);
        EXPECT_EQ(again.changes, chosen.size());
        EXPECT_EQ(again.supports, chosen.size());
      }
  }
}

TEST(Refit, AfterAnEditBringsTheFitBack) {
  const Fitted f = fit(cube(8000));
  Progress progress;
  const Selection chosen = in_ball(f.data, {1, 1, 1}, 0.5f);
  const EditResult flat = set_degree(f.data, chosen, 1, f.samples(), progress);
  const EditResult erased = set_constant(f.data, chosen, 1);
  for (const PartitionData* edited : {&flat.data, &erased.data})
    expect_same(refit(*edited, chosen, f.data.options, f.samples(), progress).data, f.data);
}

TEST(Refit, LeavesAllOthersUntouched) {
  const Fitted f = fit(cube(8000));
  Progress progress;
  PartitionOptions other = f.data.options;
  other.error = 0.02;
  other.sharp = false;
  other.max_degree = 2;
  other.support = 1.9;
  const Selection chosen = in_ball(f.data, {1, 1, 1}, 0.4f);
  const EditResult edited = refit(f.data, chosen, other, f.samples(), progress);
  edited.data.validate();
  expect_sums(edited.data);
  EXPECT_EQ(edited.data.supports.size() + chosen.size(), f.data.supports.size() + edited.supports);
  std::size_t kept = 0, smooth = 0;
  for (std::size_t i = 0; i < edited.data.supports.size(); ++i) {
    const Support& s = edited.data.supports[i];
    const auto old = std::find_if(f.data.supports.begin(), f.data.supports.end(),
                                  [&](const Support& o) { return o.level == s.level && o.code == s.code; });
    if (old != f.data.supports.end() &&
        same_support(edited.data, i, f.data, static_cast<std::size_t>(old - f.data.supports.begin()))) {
      ++kept;
    } else {
      ++smooth;
      EXPECT_EQ(s.creased, 0);
      EXPECT_LE(edited.data.functions[i].degree, 2);
      const LocalFunction& g = edited.data.functions[i];
      EXPECT_NEAR(g.radius, 1.9 * 0.8660254 * f.data.edge / (1 << s.level), 1e-5);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_GE(g.center[k] - g.radius, edited.changed.lower[k]);
        EXPECT_LE(g.center[k] + g.radius, edited.changed.upper[k]);
      }
    }
  }
  EXPECT_EQ(kept, f.data.supports.size() - chosen.size());
  EXPECT_EQ(smooth, edited.supports);
  for (const std::uint32_t i : chosen) {
    EXPECT_TRUE(edited.changed.contains(f.data.functions[i].center - Vec3f{1, 1, 1} * f.data.functions[i].radius));
    EXPECT_TRUE(edited.changed.contains(f.data.functions[i].center + Vec3f{1, 1, 1} * f.data.functions[i].radius));
  }
}

TEST(Refit, FollowsItsOptions) {
  const Fitted f = fit(torus(20000));
  Progress progress;
  const Selection all = everything(f.data);
  PartitionOptions coarse = f.data.options;
  coarse.error = 0.01;
  EXPECT_LT(refit(f.data, all, coarse, f.samples(), progress).data.supports.size(), f.data.supports.size());
  PartitionOptions shallow = f.data.options;
  shallow.max_depth = 3;
  EXPECT_EQ(refit(f.data, all, shallow, f.samples(), progress).data.report.depth, 3);
  PartitionOptions planes = f.data.options;
  planes.max_degree = 1;
  const PartitionData flat = refit(f.data, all, planes, f.samples(), progress).data;
  EXPECT_EQ(flat.report.functions_of_degree[1], flat.supports.size());
}

}  // namespace
}  // namespace sansmesh::inline v1
