// Half-planes and polygons as cuts: detours around them and gaps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "deform/cut_support.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

using test::blocked;
using test::detour;
using test::gap;
using test::random_point;

std::vector<std::shared_ptr<const PlanarOccluder>> planar_cuts() {
  return {test::tilted_half_plane(), polygon_occluder(test::l_shape())};
}

/// The shortest path over densely sampled points of the border.
double brute_force_way(const PlanarOccluder& cut, const Vec3& h, const Vec3& x) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& border : cut.borders())
    for (const auto& e : border) {
      const double from = std::isinf(e.length) ? -5 : 0, to = std::isinf(e.length) ? 5 : e.length;
      for (int i = 0; i <= 20000; ++i) {
        const double t = from + (to - from) * i / 20000;
        const Vec3 b = cut.in_space({e.begin.a + e.along.a * t, e.begin.b + e.along.b * t});
        least = std::min(least, norm(h - b) + norm(b - x));
      }
    }
  return least;
}

TEST(PlanarCut, WaysAroundAreTheShortest) {
  std::mt19937 random(1);
  for (const auto& cut : planar_cuts()) {
    int shadowed = 0;
    for (int i = 0; i < 60; ++i) {
      const Vec3 h = random_point(random), x = random_point(random);
      const Detour found = detour(*cut, h, x);
      if (!blocked(*cut, h, x)) {
        EXPECT_EQ(found.extra, 0);
        EXPECT_EQ(found.gradient, Vec3{});
        continue;
      }
      ++shadowed;
      const double way = brute_force_way(*cut, h, x) - norm(x - h);
      EXPECT_LE(found.extra, way + 1e-12);
      EXPECT_NEAR(found.extra, way, 1e-6);
      EXPECT_GT(found.extra, 0);
    }
    EXPECT_GT(shadowed, 8);
  }
}

/// Largest difference of `value` between neighbours of n + 1 parameters from 0 to 1.
template <class Value>
double largest_jump(int n, const Value& value) {
  double most = 0, before = value(0.0);
  for (int i = 1; i <= n; ++i) {
    const double now = value(static_cast<double>(i) / n);
    most = std::max(most, std::abs(now - before));
    before = now;
  }
  return most;
}

TEST(PlanarCut, DampingIsContinuousAcrossTheShadowsEdgeAndAsPrintedJumps) {
  const Vec3 h{0.3, 0.1, 0.7};
  const auto cut = half_plane({0, 0, 0}, {0, 0, 1}, {1, 0, 0});
  // A circle around the handle's foot, on the far side: in and out of the shadow.
  const auto place = [](double t) { return Vec3{std::cos(6.28 * t), 0.2 + std::sin(6.28 * t), -0.4}; };
  const auto damping = [&](double t) {
    const double d = norm(place(t) - h);
    return d / (d + detour(*cut, h, place(t)).extra);
  };
  const auto printed = [&](double t) {
    const double d = norm(place(t) - h), extra = detour(*cut, h, place(t)).extra;
    return blocked(*cut, h, place(t)) ? d / (d + d + extra) : 1.0;
  };
  EXPECT_LT(largest_jump(2000, damping), 2e-3);
  EXPECT_LT(largest_jump(200000, damping), 2e-5);  // proportional to the steps
  EXPECT_GT(largest_jump(2000, printed), 0.4);
  EXPECT_GT(largest_jump(200000, printed), 0.4);
}

TEST(PlanarCut, PolygonsAreContinuousWhereNothingIsCrossed) {
  std::mt19937 random(2);
  const auto cut = polygon_occluder(test::l_shape());
  int mixed = 0;
  for (int i = 0; i < 40; ++i) {
    const Vec3 h = random_point(random) + cut->normal(), a = random_point(random), b = random_point(random);
    // Straight lines on the far side of the plane.
    const auto far = [&](const Vec3& p) { return p - cut->normal() * (std::max(0.0, cut->height(p)) + 0.05); };
    const Vec3 from = far(a), to = far(b);
    const auto extra = [&](double t) { return detour(*cut, h, from + (to - from) * t).extra; };
    EXPECT_LT(largest_jump(1000, extra), 2 * norm(to - from) / 1000);
    mixed += (extra(0) > 0) != (extra(1) > 0);
  }
  EXPECT_GT(mixed, 4);
}

TEST(PlanarCut, WaysGrowWithOcclusion) {
  const Vec3 h{0.5, 0, 0.7};
  const auto cut = half_plane({0, 0, 0}, {0, 0, 1}, {1, 0, 0});
  double before = 0;
  for (int i = 1; i <= 1000; ++i) {  // around the edge, from the beginning of its shadow
    const double angle = std::atan2(0.7, 0.5) + std::numbers::pi + i * 1e-3;
    const Vec3 x{0.8 * std::cos(angle), 0.1, 0.8 * std::sin(angle)};
    if (x.z >= 0) break;
    const double extra = detour(*cut, h, x).extra / norm(x - h);
    EXPECT_GT(extra, before) << i;
    before = extra;
  }
  EXPECT_GT(before, 0.1);
}

TEST(PlanarCut, GradientsOfWaysAreThoseOfDifferences) {
  std::mt19937 random(3);
  for (const auto& cut : planar_cuts()) {
    int shadowed = 0;
    for (int i = 0; i < 300; ++i) {
      const Vec3 h = random_point(random), x = random_point(random);
      const Detour found = detour(*cut, h, x);
      if (found.extra == 0 || std::abs(cut->height(x)) < 1e-3) continue;
      ++shadowed;
      for (std::size_t k = 0; k < 3; ++k) {
        Vec3 step;
        step[k] = 1e-6;
        const double slope = (detour(*cut, h, x + step).extra - detour(*cut, h, x - step).extra) / 2e-6;
        EXPECT_NEAR(found.gradient[k], slope, 2e-5);
      }
    }
    EXPECT_GT(shadowed, 50);
  }
}

/// A smooth source map with derivatives.
Vec3 source_of(const Vec3& x, std::array<Vec3, 3>* jacobian = nullptr) {
  if (jacobian)
    *jacobian = {Vec3{1, 0.2 * std::cos(x.x), 0.3}, Vec3{0, 1, 0.5 * std::cos(2 * x.y)}, Vec3{0.1, 0, 1 - 0.4 * x.z}};
  return {x.x + 0.1 * x.z, x.y + 0.2 * std::sin(x.x), x.z + 0.3 * x.x + 0.25 * std::sin(2 * x.y) - 0.2 * x.z * x.z};
}

TEST(PlanarCut, GapsAreWhereTheSourceIsAcross) {
  std::mt19937 random(4);
  for (const auto& cut : planar_cuts()) {
    int open = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vec3 x = random_point(random), u = random_point(random, 0.3) + x;
      const double depth = gap(*cut, x, u, {}).depth;
      EXPECT_EQ(depth > 0, blocked(*cut, x, u));
      open += depth > 0;
    }
    EXPECT_GT(open, 100);
    // Without motion: no gap anywhere.
    const Vec3 on = cut->in_space({0.01, 0.02});
    EXPECT_LE(gap(*cut, on, on, {}).depth, 0);
    EXPECT_LT(gap(*cut, {0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}, {}).depth, 0);
  }
}

TEST(PlanarCut, GapsAreContinuousWithGradients) {
  std::mt19937 random(5);
  for (const auto& cut : planar_cuts()) {
    int checked = 0;
    for (int i = 0; i < 300; ++i) {
      const Vec3 x = random_point(random);
      std::array<Vec3, 3> jacobian;
      const Vec3 u = source_of(x, &jacobian);
      const Gap found = gap(*cut, x, u, jacobian);
      if (std::abs(cut->height(x)) < 1e-3 || std::abs(cut->height(u)) < 1e-3) continue;
      const auto depth = [&](const Vec3& p) { return gap(*cut, p, source_of(p), {}).depth; };
      const auto slopes = test::depth_slopes(depth, x, found.depth);
      if (!slopes) continue;
      ++checked;
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found.gradient[k], (*slopes)[k], 1e-5);
    }
    EXPECT_GT(checked, 200);
    for (int i = 0; i < 20; ++i) {  // along lines, through faces and past the border
      const Vec3 from = random_point(random), to = random_point(random);
      const auto depth = [&](double t) {
        const Vec3 p = from + (to - from) * t;
        return gap(*cut, p, source_of(p), {}).depth;
      };
      EXPECT_LT(largest_jump(20000, depth), 0.02);
    }
  }
}

TEST(PlanarCut, NearItsFacesTheDepthOfAGapIsTheDistance) {
  const auto cut = half_plane({0, 0, 0}, {0, 0, 1}, {1, 0, 0});
  // Matter at z > 0 has moved up by 0.2: the gap is 0 < z < 0.2.
  const std::array<Vec3, 3> same = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  for (const double d : {1e-3, 1e-4}) {
    const Gap lower = gap(*cut, {0.5, 0, d}, {0.5, 0, d - 0.2}, same);
    const Gap upper = gap(*cut, {0.5, 0, 0.2 - d}, {0.5, 0, -d}, same);
    EXPECT_NEAR(lower.depth, d, 0.01 * d);
    EXPECT_NEAR(upper.depth, d, 0.01 * d);
    EXPECT_NEAR(lower.gradient.z, 1, 0.02);
    EXPECT_NEAR(upper.gradient.z, -1, 0.02);
    EXPECT_LT(gap(*cut, {0.5, 0, 0.2 + d}, {0.5, 0, d}, same).depth, 0);
  }
}

TEST(PlanarCut, BordersPassThroughTriangles) {
  const auto cut = half_plane({0, 0, 0}, {0, 0, 1}, {1, 0, 0});
  std::vector<Vec3> found;
  cut->border_points({-1, 0.5, 1}, {1, 0.5, 1}, {0.1, 0.5, -1}, found);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(norm(found[0] - Vec3{0, 0.5, 0}), 0, 1e-15);
  cut->border_points({1, 0.5, 1}, {2, 0.5, 1}, {1.1, 0.5, -1}, found);
  EXPECT_EQ(found.size(), 1u);
  const auto square = polygon_occluder({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}});
  found.clear();
  square->border_points({-2, 0.5, 1}, {3, 0.5, 1}, {0.5, 0.5, -3}, found);
  EXPECT_EQ(found.size(), 2u);
}

TEST(PlanarCut, BadOnesAreRefused) {
  EXPECT_THROW(half_plane({}, {0, 0, 0}, {1, 0, 0}), ArgumentError);
  EXPECT_THROW(half_plane({}, {0, 0, 1}, {0, 0, 2}), ArgumentError);
  EXPECT_THROW(half_plane({}, {0, 0, 1}, {NAN, 0, 2}), ArgumentError);
  EXPECT_THROW(polygon_occluder({}), ArgumentError);
  EXPECT_THROW(polygon_occluder({{{0, 0, 0}, {1, 0, 0}}}), ArgumentError);
  EXPECT_THROW(polygon_occluder({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}}), ArgumentError);
  EXPECT_THROW(polygon_occluder({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.1}}}), ArgumentError);
  EXPECT_THROW(polygon_occluder({{{0, 0, 0}, {1, 0, 0}, {0.2, 1, 0}, {0.9, 1.5, 0}}}), ArgumentError);
  EXPECT_THROW(polygon_occluder({{}}), ArgumentError);
  EXPECT_THROW(polygon_occluder({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {}}), ArgumentError);
}

TEST(Polygon, HolesLieWithinTheOutlineAndApart) {
  const auto square = [](double x, double y, double half) {
    return std::vector<Vec3>{
        {x - half, y - half, 1}, {x + half, y - half, 1}, {x + half, y + half, 1}, {x - half, y + half, 1}};
  };
  const auto why = [](const std::vector<std::vector<Vec3>>& loops) -> std::string {
    try {
      polygon_occluder(loops);
    } catch (const ArgumentError& e) {
      return e.what();
    }
    return "";
  };
  const std::vector<Vec3> outline = square(0, 0, 2);
  EXPECT_EQ(why({outline, square(1, 0, 0.5), square(-1, 0, 0.5)}), "");
  EXPECT_EQ(why({outline, square(1, 0, 0.5), square(5, 0, 1)}), "hole 2 of a polygon does not lie within its outline");
  EXPECT_EQ(why({outline, square(0, 0, 3)}), "hole 1 of a polygon does not lie within its outline");
  EXPECT_EQ(why({outline, outline}), "hole 1 of a polygon touches its outline");
  EXPECT_NE(why({outline, square(1.5, 0, 0.5)}), "");
  EXPECT_EQ(why({outline, square(0, 0, 1), square(0, 0, 0.5)}), "hole 2 of a polygon lies within hole 1");
  EXPECT_EQ(why({outline, square(0, 0, 0.5), square(0, 0, 1)}), "hole 1 of a polygon lies within hole 2");
  EXPECT_EQ(why({outline, square(1, 0, 1.5)}), "edges of a polygon cross each other");
}

}  // namespace
}  // namespace sansmesh::inline v1
