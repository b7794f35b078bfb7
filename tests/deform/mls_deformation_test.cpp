#include "sansmesh/deform/mls/mls_deformation.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "deform/handle_sets.h"
#include "support/any_threads.h"
#include "support/same_bytes.h"

namespace sansmesh::test {
namespace {

Vec3 moved_rigidly(const Vec3& x) { return turned(x - Vec3{0.1, 0.2, 0}, {1, 2, 3}, 2.5) + Vec3{1, -2, 0.5}; }
Vec3 moved_similarly(const Vec3& x) { return moved_rigidly(x) * 1.7; }
Vec3 moved_affinely(const Vec3& x) {
  return {1.1 * x.x + 0.3 * x.y - 1, 0.8 * x.y - 0.2 * x.z, x.z + 0.4 * x.x - 0.1 * x.y + 2};
}
Vec3 bent(const Vec3& x) {
  return moved_affinely(x) + Vec3{0.2 * x.x * x.y, 0.1 * x.z * x.z - 0.3 * x.x * x.x, 0.2 * x.y * x.z};
}
Vec3 bent_twice(const Vec3& x) {
  return bent(x) + Vec3{0.1 * x.x * x.x * x.y, 0.2 * x.x * x.y * x.z, -0.1 * x.z * x.z * x.z};
}

std::string name_of(const MlsDeformationOptions& o) {
  const char* const names[] = {"affine", "similarity", "rigid", "nonlinear"};
  return std::string(names[static_cast<int>(o.kind)]) + " " + std::to_string(o.degree) + ", alpha " +
         std::to_string(o.alpha);
}

TEST(MlsDeformation, ReproducesWhatTheKindCanDo) {
  const std::vector<Vec3> x = random_places(200, 5, 1.5);
  for (const double alpha : {0.5, 0.8, 1.0, 2.0, 8.0}) {
    for (const MlsDeformationOptions& options : all_kinds(alpha)) {
      SCOPED_TRACE(name_of(options));
      const auto expect = [&](const Deform& source) {
        EXPECT_LT(largest_error(MlsDeformation(handles_from(30, source), options), x, source),
                  alpha > 2 ? 1e-7 : 1e-10);
      };
      expect([](const Vec3& v) { return v; });
      expect(moved_rigidly);
      if (options.kind != DeformationKind::rigid) expect(moved_similarly);
      if (options.kind == DeformationKind::affine || options.kind == DeformationKind::nonlinear) expect(moved_affinely);
      if (options.kind == DeformationKind::nonlinear) expect(bent);
      if (options.kind == DeformationKind::nonlinear && options.degree == 3) expect(bent_twice);
    }
  }
}

TEST(MlsDeformation, InterpolatesHandles) {
  const std::vector<Handle> handles = loose_handles(25);
  for (const double alpha : {0.5, 1.0, 1.7, 8.0}) {
    for (const MlsDeformationOptions& options : all_kinds(alpha)) {
      SCOPED_TRACE(name_of(options));
      const MlsDeformation map(handles, options);
      for (const Handle& h : handles) {
        EXPECT_EQ(mapped(map, {h.q})[0], h.p);
        double before = 1;
        for (const double away : {1e-2, 1e-4, 1e-6, 1e-9, 1e-13}) {
          const double error = norm(mapped(map, {h.q + Vec3{0.6, 0.8, 0} * away})[0] - h.p);
          EXPECT_LT(error, 60 * away + 1e-15);
          EXPECT_LE(error, before);
          before = error + 1e-15;
        }
      }
    }
  }
}

TEST(MlsDeformation, JacobiansAgreeWithDifferences) {
  const std::vector<Vec3> x = random_places(60, 8);
  for (const double alpha : {0.6, 1.0, 2.0, 3.3}) {
    for (const MlsDeformationOptions& options : all_kinds(alpha)) {
      SCOPED_TRACE(name_of(options));
      EXPECT_LT(jacobian_error(MlsDeformation(loose_handles(25), options), x, 3e-4), 1e-5);
    }
  }
}

TEST(MlsDeformation, JacobiansNearAndAtHandlesAreTheirLimits) {
  const std::vector<Handle> handles = loose_handles(25);
  for (const double alpha : {1.0, 2.0, 8.0}) {
    for (const MlsDeformationOptions& options : all_kinds(alpha)) {
      SCOPED_TRACE(name_of(options));
      const MlsDeformation map(handles, options);
      for (const Handle& h : {handles[0], handles[7]}) {
        const Jacobian at = jacobians(map, {h.q})[0];
        for (const double away : {1e-5, 1e-7, 1e-9, 1e-12, 1e-16}) {
          const Jacobian near = jacobians(map, {h.q + Vec3{0, 0.6, 0.8} * away})[0];
          for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(norm(near[k] - at[k]), 300 * away + 1e-9) << away;
        }
      }
    }
  }
}

TEST(MlsDeformation, TurnsWithEverything) {
  // Both spaces are rotated independently.
  const auto turn_q = [](const Vec3& v) { return turned(v, {3, 1, -2}, 1.1) + Vec3{2, 0, 1}; };
  const auto turn_p = [](const Vec3& v) { return turned(v, {0, 1, 1}, -2) - Vec3{1, 1, 0}; };
  const auto turn_both = [](const Vec3& v) { return turned(v, {3, 1, -2}, 1.1); };
  std::vector<Handle> handles = loose_handles(22);
  handles[3].p_end = Vec3{0.2, 0.4, 0.5}, handles[3].q_end = Vec3{0.3, 0.1, 0.2};
  const std::vector<Vec3> x = random_places(40, 2);
  for (const MlsDeformationOptions& options : all_kinds()) {
    SCOPED_TRACE(name_of(options));
    std::vector<Handle> other = handles;
    for (Handle& h : other) {
      h.q = turn_q(h.q), h.p = turn_p(h.p);
      if (h.q_end) h.q_end = turn_q(*h.q_end), h.p_end = turn_p(*h.p_end);
    }
    std::vector<Vec3> y;
    for (const Vec3& v : x) y.push_back(turn_q(v));
    const MlsDeformation map(handles, options);
    const std::vector<Vec3> once = mapped(map, x), turned_once = mapped(MlsDeformation(other, options), y);
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_LT(norm(turned_once[i] - turn_p(once[i])), 1e-11);
  }
  // For collinear handles, or too few to determine the rotation about a line, the smallest rotation is used: it is
  // equivariant under common rotations.
  for (std::size_t n = 1; n < 4; ++n) {
    std::vector<Handle> few(handles.begin(), handles.begin() + static_cast<std::ptrdiff_t>(n)), other;
    if (n == 3) few[2].q = few[0].q * 0.3 + few[1].q * 0.7;
    other = few;
    for (Handle& h : other) h.q = turn_both(h.q), h.p = turn_both(h.p);
    const MlsDeformation a(few, {}), b(other, {});
    for (const Vec3& v : x) EXPECT_LT(norm(mapped(b, {turn_both(v)})[0] - turn_both(mapped(a, {v})[0])), 1e-12);
  }
}

TEST(MlsDeformation, FewHandlesMoveAndTurnAsLittleAsTheyCan) {
  Handle a, b, c;
  a.q = {1, 2, 3}, a.p = {2, 2, 5};
  b.q = {2, 2, 3}, b.p = {2, 3, 5};
  const std::vector<Vec3> x = random_places(20, 4, 3);
  for (const DeformationKind kind : {DeformationKind::rigid, DeformationKind::similarity}) {
    const auto options = of_kind(kind);
    EXPECT_LT(largest_error(MlsDeformation({a}, options), x, [](const Vec3& v) { return v + Vec3{1, 0, 2}; }), 1e-15);
    const Deform quarter = [](const Vec3& v) {
      return turned(v - Vec3{1, 2, 3}, {0, 0, 1}, std::acos(0.0)) + Vec3{2, 2, 5};
    };
    EXPECT_LT(largest_error(MlsDeformation({a, b}, options), x, quarter), 1e-14);
    // Bent: not collinear before.
    c.q = {3, 2, 3}, c.p = {2, 3.5, 6};
    EXPECT_LT(jacobian_error(MlsDeformation({a, b, c}, options), x, 1e-3), 1e-6);
    EXPECT_LT(jacobian_error(MlsDeformation(reversed({a, b, c}), options), random_places(20, 4, 6), 1e-3), 1e-6);
  }
}

TEST(MlsDeformation, NineHandlesAreEnoughForDegreeTwo) {
  // One polynomial less than all: those whose Laplacian is 0. A sphere leaves the same one undetermined.
  const Deform harmonic = [](const Vec3& v) {
    return moved_affinely(v) + Vec3{v.x * v.y, v.x * v.x - v.y * v.y, v.z * v.z - 0.5 * (v.x * v.x + v.y * v.y)};
  };
  const auto options = of_kind(DeformationKind::nonlinear);
  const std::vector<Vec3> x = random_places(50, 3);
  EXPECT_LT(largest_error(MlsDeformation(handles_from(9, harmonic), options), x, harmonic), 1e-9);
  EXPECT_LT(jacobian_error(MlsDeformation(loose_handles(9), options), x, 1e-4), 1e-3);
  std::vector<Handle> sphere = handles_from(30, harmonic);
  for (Handle& h : sphere) h.q = normalized(h.q), h.p = harmonic(h.q);
  EXPECT_LT(largest_error(MlsDeformation(sphere, options), x, harmonic), 1e-10);
  EXPECT_LT(
      largest_error(MlsDeformation(handles_from(19, harmonic), of_kind(DeformationKind::nonlinear, 3)), x, harmonic),
      1e-9);
}

TEST(MlsDeformation, WeightsCount) {
  std::vector<Handle> handles = loose_handles(8), twice = handles;
  handles[2].weight = 2;
  twice.push_back(twice[2]);
  const std::vector<Vec3> x = random_places(30, 3);
  const std::vector<Vec3> heavy = mapped(MlsDeformation(handles, {}), x),
                          doubled = mapped(MlsDeformation(twice, {}), x);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_LT(norm(heavy[i] - doubled[i]), 1e-13);
  handles[2].weight = 1e9;  // other handles are still interpolated
  EXPECT_EQ(mapped(MlsDeformation(handles, {}), {handles[4].q})[0], handles[4].p);
}

TEST(MlsDeformation, LargerAlphaKeepsHandlesToThemselves) {
  Handle still, gone, other;
  still.q = still.p = {0, 0, 0}, gone.q = {1, 0, 0}, gone.p = {1, 1, 0}, other.q = other.p = {0, 1, 1};
  double before = 1;
  for (const double alpha : {0.5, 1.0, 1.3, 2.0, 4.0}) {
    const double moved =
        mapped(MlsDeformation({still, gone, other}, of_kind(DeformationKind::rigid, 2, alpha)), {{0.3, 0, 0}})[0].y;
    EXPECT_LT(std::abs(moved), before);
    before = std::abs(moved);
  }
}

TEST(MlsDeformation, SegmentsAreInterpolatedAndAreManyPoints) {
  std::vector<Handle> handles = loose_handles(20);
  Handle bar;
  bar.q = {-0.5, 0.1, 0.2}, bar.q_end = Vec3{0.4, 0.3, -0.1}, bar.p = {-0.4, 0.4, 0.1}, bar.p_end = Vec3{0.3, 0.8, 0.2};
  for (const double alpha : {1.0, 1.4, 3.0}) {
    for (const MlsDeformationOptions& options : all_kinds(alpha)) {
      SCOPED_TRACE(name_of(options));
      std::vector<Handle> with = handles, points = handles;
      with.push_back(bar);
      const MlsDeformation map(with, options);
      const Vec3 aside = normalized(Vec3{0.2, -0.9, 0});
      for (const double t : {0.0, 0.25, 0.7, 1.0}) {
        const Vec3 q = bar.q + (*bar.q_end - bar.q) * t, p = bar.p + (*bar.p_end - bar.p) * t;
        EXPECT_LT(norm(mapped(map, {q})[0] - p), 1e-15) << t;
        for (const double away : {1e-4, 1e-8, 1e-11, 1e-14})
          EXPECT_LT(norm(mapped(map, {q + aside * away})[0] - p), 60 * away + 1e-12) << t;
      }
      // The integral is the limit of the sum.
      constexpr int kPoints = 4000;
      for (int k = 0; k < kPoints; ++k) {
        const double t = (k + 0.5) / kPoints;
        Handle h;
        h.q = bar.q + (*bar.q_end - bar.q) * t, h.p = bar.p + (*bar.p_end - bar.p) * t, h.weight = 1.0 / kPoints;
        points.push_back(h);
      }
      const std::vector<Vec3> x{{0.3, 0.8, 0.4}, {-0.2, 0.3, 0.1}, {-0.9, 0.1, 0.3}};
      const std::vector<Vec3> whole = mapped(map, x), summed = mapped(MlsDeformation(points, options), x);
      for (std::size_t i = 0; i < x.size(); ++i) EXPECT_LT(norm(whole[i] - summed[i]), 1e-6);
      EXPECT_LT(jacobian_error(map, random_places(20, 6), 1e-4), 1e-4);
    }
  }
}

TEST(MlsDeformation, DirectionsTurnTheSurroundings) {
  // A handle with a frame defines a rigid motion; with a normal it rotates as little as possible.
  Handle h;
  h.q = {1, 0, 0}, h.p = {0, 2, 0};
  const auto turn = [](const Vec3& v) { return turned(v, {1, 1, 0}, 2.0); };
  const auto put = [&](int n) {
    h.directions.clear();
    const Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int k = 0; k < n; ++k) h.directions.push_back({turn(axes[k]), axes[k]});
  };
  const std::vector<Vec3> x = random_places(20, 3, 2);
  put(3);
  const Deform motion = [&](const Vec3& v) { return turn(v - h.q) + h.p; };
  EXPECT_LT(largest_error(MlsDeformation({h}, {}), x, motion), 1e-12);
  EXPECT_LT(largest_error(MlsDeformation({h}, of_kind(DeformationKind::affine)), x, motion), 1e-13);
  put(1);
  EXPECT_LT(norm(mapped(MlsDeformation({h}, {}), {h.q + Vec3{0.3, 0, 0}})[0] - (h.p + turn({0.3, 0, 0}))), 1e-13);
  // Among other handles, the map at the handle rotates as its frame does.
  put(3);
  std::vector<Handle> many = loose_handles(20);
  for (Handle& other : many) other.q.x -= 3, other.p.x -= 3;
  many.push_back(h);
  for (const MlsDeformationOptions& options : all_kinds()) {
    SCOPED_TRACE(name_of(options));
    const MlsDeformation map(many, options);
    EXPECT_EQ(mapped(map, {h.q})[0], h.p);
    const Jacobian j = jacobians(map, {h.q})[0];
    for (std::size_t k = 0; k < 3 && options.degree == 2; ++k) EXPECT_LT(norm(j[k] - h.directions[k].before), 1e-6);
    EXPECT_LT(jacobian_error(map, random_places(20, 6), 1e-4), 1e-5);
  }
}

/// Across the plane x = 0, below z = 0, the detour is the sum of both distances from it.
class Wall final : public Occluder {
 public:
  void detours(const Vec3& handle, std::span<const Vec3> x, std::span<Detour> found) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      found[i] = {};
      const double depth = -x[i].z;
      if (handle.x * x[i].x < 0 && depth > 0) found[i] = {depth * depth, {0, 0, -2 * depth}};
    }
  }
  void gaps(std::span<const Vec3> x, std::span<const Vec3> sources, std::span<const std::array<Vec3, 3>>,
            std::span<Gap> found) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const bool apart = x[i].x * sources[i].x < 0;
      found[i] = {(apart ? 1 : -1) * std::abs(x[i].x), {x[i].x > 0 ? 1.0 : -1.0, 0, 0}};
    }
  }
  void crossings(const Vec3&, const Vec3&, std::vector<double>&) const override {}
  void border_points(const Vec3&, const Vec3&, const Vec3&, std::vector<Vec3>&) const override {}
};

TEST(MlsDeformation, CutsDampAndOpen) {
  std::vector<Handle> handles = loose_handles(25);
  Handle bar;
  bar.q = {-0.5, 0.1, 0.2}, bar.q_end = Vec3{0.4, 0.3, -0.1}, bar.p = bar.q, bar.p_end = bar.q_end;
  for (MlsDeformationOptions options : all_kinds()) {
    SCOPED_TRACE(name_of(options));
    options.damping = 3;
    const MlsDeformation map(handles, options, {std::make_shared<Wall>()}), whole(handles, options);
    EXPECT_TRUE(map.has_gaps());
    EXPECT_FALSE(whole.has_gaps());
    std::vector<Vec3> x = random_places(40, 6);
    std::erase_if(x, [](const Vec3& v) { return std::abs(v.x) < 0.01 || std::abs(v.z) < 0.01; });
    EXPECT_LT(jacobian_error(map, x, 1e-4), 1e-4);
    std::size_t differ = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
      differ += norm(mapped(map, {x[i]})[0] - mapped(whole, {x[i]})[0]) > 1e-11;
    EXPECT_GT(differ, x.size() / 4);
    EXPECT_LT(differ, x.size());
    for (const Handle& h : handles) EXPECT_EQ(mapped(map, {h.q})[0], h.p);
    std::vector<double> gaps(x.size()), none(x.size());
    std::vector<Vec3> gradients(x.size());
    map.map(x, {{}, {}, gaps, gradients});
    whole.map(x, {{}, {}, none, {}});
    const std::vector<Vec3> sources = mapped(map, x);
    for (std::size_t i = 0; i < x.size(); ++i) {
      EXPECT_EQ(gaps[i] > 0, sources[i].x * x[i].x < 0);
      EXPECT_EQ(norm(gradients[i]), 1);
      EXPECT_EQ(none[i], -std::numeric_limits<double>::infinity());
    }
  }
}

TEST(MlsDeformation, IsTheSameForAnyThreadsAndBatches) {
  std::vector<Handle> handles = loose_handles(22);
  handles[3].p_end = Vec3{0.2, 0.4, 0.5}, handles[3].q_end = Vec3{0.3, 0.1, 0.2};
  const std::vector<Vec3> x = random_places(1000, 2);
  for (const MlsDeformationOptions& options : all_kinds()) {
    const MlsDeformation map(handles, options);
    expect_equal_for_any_threads([&] { return std::pair(mapped(map, x), jacobians(map, x)); });
    const std::vector<Vec3> all = mapped(map, x);
    for (std::size_t i = 0; i < x.size(); i += 97) EXPECT_EQ(mapped(map, {x[i]})[0], all[i]);
  }
}

/// Number of points whose image depends on the other points of the batch.
std::size_t differ_in_company(const SpaceMap& map, const std::vector<Vec3>& x) {
  const std::vector<Vec3> all = mapped(map, x);
  std::size_t different = 0;
  for (const std::size_t first : {1, 2, 3, 5}) {
    const std::vector<Vec3> part = mapped(map, {x.begin() + static_cast<std::ptrdiff_t>(first), x.end()});
    for (std::size_t i = 0; i < part.size(); ++i)
      different += same_bytes(std::span(part).subspan(i, 1), std::span(all).subspan(first + i, 1)) ? 0 : 1;
  }
  return different;
}

Eigen::Vector3d eigen(const Vec3& v) { return {v.x, v.y, v.z}; }

/// The rigid map at x by singular values, and the relative advantage of its alignment over the next best: the result is
/// determined up to rounding divided by that.
struct OracleAt {
  Eigen::Vector3d mean_q, mean_p, image;
  double certainty;
};
OracleAt oracle_at(const std::vector<Handle>& handles, const Vec3& x) {
  OracleAt o{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), {}, 0};
  double total = 0;
  for (const Handle& h : handles) {
    const double w = 1 / squared_norm(h.q - x);
    total += w, o.mean_q += w * eigen(h.q), o.mean_p += w * eigen(h.p);
  }
  o.mean_q /= total, o.mean_p /= total;
  Eigen::Matrix3d b = Eigen::Matrix3d::Zero();
  for (const Handle& h : handles)
    b += (eigen(h.p) - o.mean_p) * (eigen(h.q) - o.mean_q).transpose() / squared_norm(h.q - x);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(b, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const Eigen::Vector3d& values = svd.singularValues();
  o.image = o.mean_p + svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose() *
                           (eigen(x) - o.mean_q);
  o.certainty = (values[1] + sign * values[2]) / values[0];
  return o;
}

TEST(MlsDeformation, NeverFlips) {
  // Isotropic sets, (nearly) planar ones, and ones from 10⁻⁹ to 10⁻⁶ off a line; moved at random, rigidly, or mirrored.
  std::mt19937 random(23);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto place = [&] { return Vec3{u(random), u(random), u(random)}; };
  std::size_t certain = 0;
  for (int round = 0; round < 10'000; ++round) {
    const double thin = round % 5 == 0 ? 0 : std::pow(10, -7.5 + 1.5 * u(random));
    const Vec3 axis = place();
    std::vector<Handle> handles(3 + static_cast<std::size_t>(round % 6));
    for (Handle& h : handles) {
      h.q = place();
      if (round % 4 > 0) h.q.z *= thin;
      if (round % 4 > 2) h.q.y *= thin;
      const Vec3 mirrored{h.q.x, h.q.y, -h.q.z};
      h.p = round % 3 == 0 ? place() : turned(round % 3 == 1 ? h.q : mirrored, axis, round);
      if (round % 7 == 0) h.p += place() * 1e-3;
    }
    const Vec3 x = place() * 1.5;
    const Eigen::Vector3d found = eigen(mapped(MlsDeformation(handles, {}), {x})[0]);
    const OracleAt o = oracle_at(handles, x);
    ASSERT_NEAR((found - o.mean_p).norm(), (eigen(x) - o.mean_q).norm(), 1e-12)
        << round;  // rotations preserve distances
    if (o.certainty < 1e-6) continue;
    ++certain;
    ASSERT_LT((found - o.image).norm(), 1e-13 / o.certainty + 1e-12) << round << " " << o.certainty;
  }
  EXPECT_GT(certain, 6000u);
}

TEST(MlsDeformation, SetsThatBecomeALineTurnAsItDoes) {
  // Two rows of handles at this distance from a line: the rotation about it vanishes at about the square root of
  // rounding.
  const Vec3 axis{0.3, 1, 2};
  const auto motion = [&](const Vec3& v) { return turned(v, axis, 2.0) + Vec3{1, 2, 0}; };
  const auto map = [&](double off) {
    std::vector<Handle> handles = handles_from(10, [](const Vec3& v) { return v; });
    for (Handle& h : handles) h.q.y *= off, h.q.z *= off, h.p = motion(h.q);
    return MlsDeformation(handles, {});
  };
  const std::vector<Vec3> x = random_places(50, 9), line = mapped(map(0), x);
  for (const double off : {1e-12, 1e-11, 3e-10, 1e-9, 1e-8, 3e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-2}) {
    const MlsDeformation near = map(off);
    const std::vector<Vec3> found = mapped(near, x);
    for (std::size_t i = 0; i < x.size(); ++i) {
      EXPECT_LT(norm(mapped(near, {{x[i].x, 0, 0}})[0] - motion({x[i].x, 0, 0})), 1e-7) << off;
      if (off < 2e-9) EXPECT_LT(norm(found[i] - line[i]), 1e-3) << off;
      if (off > 5e-6) EXPECT_LT(norm(found[i] - motion(x[i])), 1e-12 / (off * off)) << off;
    }
  }
}

TEST(MlsDeformation, PlacesBesideDifficultOnesAreTheSame) {
  // Flattened sets of points: some points need rotations about a weak axis, more steps or other roots than their
  // neighbours in a vector.
  const std::vector<Vec3> x = random_places(20'000, 3, 1.3);
  for (const double thin : {0.05, 0.1, 0.15, 0.2}) {
    for (const DeformationKind kind : {DeformationKind::affine, DeformationKind::similarity, DeformationKind::rigid}) {
      std::vector<Handle> handles = loose_handles(12);
      for (Handle& h : handles) h.q.y *= thin, h.q.z *= thin, h.p.y *= thin, h.p.z *= thin;
      EXPECT_EQ(differ_in_company(MlsDeformation(handles, of_kind(kind)), x), 0u) << thin;
      for (Handle& h : handles) h.p.x *= -1;
      const MlsDeformation mirrored(handles, of_kind(kind));
      EXPECT_EQ(differ_in_company(mirrored, x), 0u) << thin;
      if (thin == 0.1) expect_equal_for_any_threads([&] { return mapped(mirrored, x); });
    }
  }
  EXPECT_EQ(differ_in_company(MlsDeformation(loose_handles(25), of_kind(DeformationKind::nonlinear, 2, 1.7)),
                              random_places(2000, 3, 1.3)),
            0u);
}

TEST(MlsDeformation, ForwardAndBackwardInterpolateTheSameHandles) {
  const std::vector<Handle> handles = loose_handles(15);
  const MlsDeformation back(handles, {}), forth(reversed(handles), {});
  for (const Handle& h : handles) {
    EXPECT_EQ(mapped(back, {h.q})[0], h.p);
    EXPECT_EQ(mapped(forth, {h.p})[0], h.q);
  }
}

}  // namespace
}  // namespace sansmesh::test
