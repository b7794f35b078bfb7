#include "sansmesh/deform/maps/displacement_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "deform/handle_sets.h"
#include "sansmesh/error.h"
#include "support/any_threads.h"

namespace sansmesh::test {
namespace {

const Box3 kBox{{-1, -0.5, 0}, {1, 1, 2}};

DisplacementMap lattice_of(const SpaceMap& map, const std::array<std::size_t, 3>& sizes = {21, 17, 19}) {
  Progress progress;
  return displacement_map(map, kBox, sizes, progress);
}

/// Points in the box, and some outside it.
std::vector<Vec3> places_in_box(std::size_t n, double beyond = 0) {
  std::vector<Vec3> x = random_places(n, 3, 0.5 + beyond);
  for (Vec3& v : x)
    v = {kBox.center().x + v.x * kBox.size().x, kBox.center().y + v.y * kBox.size().y,
         kBox.center().z + v.z * kBox.size().z};
  return x;
}

/// x + a polynomial, with a gap where x > 0.3.
class Formula final : public SpaceMap {
 public:
  explicit Formula(bool bent, bool gaps = false) : bent_(bent), gaps_(gaps) {}
  Vec3 at(const Vec3& x) const {
    const Vec3 affine{1.5 * x.x + 0.25 * x.y + 1, x.y - 0.5 * x.z, 0.75 * x.z + 0.25 * x.x};
    return bent_ ? affine + Vec3{0.2 * x.x * x.y, 0.3 * std::sin(x.z), 0.1 * x.x * x.x} : affine;
  }
  Jacobian slopes(const Vec3& x) const {
    Jacobian j{Vec3{1.5, 0, 0.25}, Vec3{0.25, 1, 0}, Vec3{0, -0.5, 0.75}};
    if (bent_)
      j[0] += Vec3{0.2 * x.y, 0, 0.2 * x.x}, j[1] += Vec3{0.2 * x.x, 0, 0}, j[2] += Vec3{0, 0.3 * std::cos(x.z), 0};
    return j;
  }
  void map(std::span<const Vec3> x, const MappedPoints& wanted) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (!wanted.positions.empty()) wanted.positions[i] = at(x[i]);
      if (!wanted.jacobians.empty()) wanted.jacobians[i] = slopes(x[i]);
      if (!wanted.gaps.empty())
        wanted.gaps[i] = x[i].x < -0.8 ? -std::numeric_limits<double>::infinity() : x[i].x - 0.3;
    }
  }
  bool has_gaps() const override { return gaps_; }

 private:
  bool bent_, gaps_;
};

TEST(DisplacementMap, IsExactForAffineMaps) {
  const Formula map(false);
  const DisplacementMap lattice = lattice_of(map);
  const std::vector<Vec3> x = places_in_box(300);
  EXPECT_LT(largest_error(lattice, x, [&](const Vec3& v) { return map.at(v); }), 1e-6);  // rounding to float
  const std::vector<Jacobian> j = jacobians(lattice, x);
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(norm(j[i][k] - map.slopes(x[i])[k]), 1e-5);
}

TEST(DisplacementMap, ErrorsFallByTheSquareOfTheSpacing) {
  const Formula map(true);
  const std::vector<Vec3> x = places_in_box(300);
  double position = 0, slope = 0;
  for (const std::size_t n : {11u, 21u}) {
    const DisplacementMap lattice = lattice_of(map, {n, n, n});
    const double now = largest_error(lattice, x, [&](const Vec3& v) { return map.at(v); });
    double slope_now = 0;
    std::vector<Vec3> inner = x;
    std::erase_if(inner, [](const Vec3& v) {
      return std::abs(v.x) > 0.7 || v.y < -0.3 || v.y > 0.8 || v.z < 0.25 || v.z > 1.75;
    });
    const std::vector<Jacobian> j = jacobians(lattice, inner);
    for (std::size_t i = 0; i < inner.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) slope_now = std::max(slope_now, norm(j[i][k] - map.slopes(inner[i])[k]));
    if (n == 21) {
      EXPECT_NEAR(position / now, 4, 1);
      EXPECT_NEAR(slope / slope_now, 4, 1.5);
    }
    position = now, slope = slope_now;
  }
}

TEST(DisplacementMap, StaysTheSameBeyondItsBox) {
  const Formula map(true);
  const DisplacementMap lattice = lattice_of(map);
  const Vec3 corner = kBox.upper, beyond = corner + Vec3{1, 2, 3}, beside = kBox.center() + Vec3{5, 0, 0};
  EXPECT_LT(norm(mapped(lattice, {beyond})[0] - beyond - (mapped(lattice, {corner})[0] - corner)), 1e-14);
  const Jacobian j = jacobians(lattice, {beside})[0];
  EXPECT_EQ(j[0], (Vec3{1, 0, 0}));  // constant outside
  EXPECT_GT(norm(j[1] - Vec3{0, 1, 0}), 0.1);
  EXPECT_TRUE(std::isnan(mapped(lattice, {{std::numeric_limits<double>::quiet_NaN(), 0, 0}})[0].x));
}

TEST(DisplacementMap, ImagesHoldAllThatComesFromABox) {
  const MlsDeformation map(loose_handles(20, 1, 0.6), {});
  const DisplacementMap lattice = lattice_of(map);
  const std::vector<Vec3> corners = places_in_box(60, 0.3), shares = random_places(30, 9, 0.5);
  double tightest = 0;
  for (std::size_t b = 0; b + 1 < corners.size(); b += 2) {
    Box3 box;
    box.extend(corners[b]);
    // Small boxes, and all sizes up to the whole.
    box.extend(b % 4 == 0 ? corners[b] + Vec3{0.02, 0.03, 0.01} : corners[b + 1]);
    std::vector<Vec3> x;
    for (const Vec3& s : shares)
      x.push_back(box.center() + Vec3{s.x * box.size().x, s.y * box.size().y, s.z * box.size().z});
    Box3 image, seen;
    lattice.images({&box, 1}, {&image, 1});
    for (const Vec3& y : mapped(lattice, x)) {
      EXPECT_TRUE(image.contains(y));
      seen.extend(y);
    }
    if (b % 4 != 0) tightest = std::max(tightest, seen.size().x / image.size().x);
  }
  EXPECT_GT(tightest, 0.4);  // bounds are not trivial
}

TEST(DisplacementMap, KeepsGaps) {
  const DisplacementMap lattice = lattice_of(Formula(false, true), {41, 31, 21});
  ASSERT_TRUE(lattice.has_gaps());
  const std::vector<Vec3> x{{0.5, 0.1, 1}, {0, 0, 1}, {-0.99, 0.2, 1}};
  std::vector<double> gaps(3);
  std::vector<Vec3> gradients(3);
  lattice.map(x, {{}, {}, gaps, gradients});
  EXPECT_NEAR(gaps[0], 0.2, 1e-6);
  EXPECT_NEAR(gaps[1], -0.3, 1e-6);
  EXPECT_LT(gaps[2], -1);
  EXPECT_TRUE(std::isfinite(gaps[2]));
  EXPECT_LT(norm(gradients[0] - Vec3{1, 0, 0}), 1e-5);
  lattice_of(Formula(false)).map(x, {{}, {}, gaps, gradients});
  EXPECT_EQ(gaps[0], -std::numeric_limits<double>::infinity());
  EXPECT_EQ(gradients[0], Vec3{});
}

TEST(DisplacementMap, GoesThroughABlockOfAGrid) {
  const DisplacementMap lattice = lattice_of(Formula(true, true));
  GridBlock block = displacement_block(lattice);
  const DisplacementMap back = displacement_map_of(block);
  EXPECT_EQ(back.lattice().sizes, lattice.lattice().sizes);
  EXPECT_LT(norm(back.lattice().box.upper - kBox.upper), 1e-14);
  EXPECT_EQ(back.displacements().copy(), lattice.displacements().copy());
  EXPECT_EQ(back.gaps().copy(), lattice.gaps().copy());
  const auto refuses = [](const GridBlock& b, const char* part) {
    try {
      displacement_map_of(b);
    } catch (const DataError& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
      return;
    }
    ADD_FAILURE() << part;
  };
  GridBlock other = block;
  other.axes[1][3] += 0.01;
  refuses(other, "evenly");
  other = block, other.directions = {Vec3{0, 1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}};
  refuses(other, "parallel");
  other = block, other.point_arrays.erase("displacement");
  refuses(other, "`displacement`");
  other = block, other.kind = GridKind::scattered;
  refuses(other, "lattice");
}

TEST(DisplacementMap, RefusesWhatIsNoLattice) {
  Progress progress;
  const Formula map(false);
  EXPECT_THROW(displacement_map(map, kBox, {1, 5, 5}, progress), ArgumentError);
  EXPECT_THROW(displacement_map(map, {{0, 0, 0}, {1, 0, 1}}, {5, 5, 5}, progress), ArgumentError);
  EXPECT_THROW(DisplacementMap(kBox, {3, 3, 3}, std::vector<Vec3f>(26)), ArgumentError);
  EXPECT_EQ(lattice_sizes(kBox, 65), (std::array<std::size_t, 3>{65, 49, 65}));
  EXPECT_EQ(lattice_sizes({{0, 0, 0}, {1, 0, 1}}, 10), (std::array<std::size_t, 3>{10, 2, 10}));
}

TEST(DisplacementMap, IsTheSameForAnyThreads) {
  const MlsDeformation map(loose_handles(20), {});
  const std::vector<Vec3> x = places_in_box(3000, 0.1);
  expect_equal_for_any_threads([&] {
    const DisplacementMap lattice = lattice_of(map, {33, 20, 40});
    return std::pair(lattice.displacements().copy(), std::pair(mapped(lattice, x), jacobians(lattice, x)));
  });
}

}  // namespace
}  // namespace sansmesh::test
