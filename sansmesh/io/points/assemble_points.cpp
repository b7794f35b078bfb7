#include "sansmesh/io/points/assemble_points.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "sansmesh/core/median.h"
#include "sansmesh/core/number_words.h"

namespace sansmesh::inline v1::io {
namespace {

/// Strays are at most one position in kStrays at each end of an axis, and enlarge the box by this factor.
constexpr std::size_t kStrays = 1000, kFewestWithStrays = 20;
constexpr double kFarAway = 100;

/// Most significant decimals: floats are often written with more, whose last digits are noise; and the share of numbers
/// that may be strays.
constexpr int kMostDecimals = 4;
constexpr double kLostShare = 1e-3;
/// Significant loss if the numbers do not show their resolution: large lengths come from surveys, in metres or feet.
/// Lengths beyond the size of the Earth in metres are not surveys.
constexpr double kLostLength = 1e-2, kLargestSurvey = 4e7;

/// The unit of the last decimal of all numbers: 0.01 for 12.25, 3 and -7.1; empty if some have more decimals.
std::optional<double> decimal_resolution(std::span<const Vec3> some) {
  double factor = 1;
  for (int decimals = 0; decimals <= kMostDecimals; ++decimals, factor *= 10) {
    bool whole = true;
    for (std::size_t i = 0; whole && i < some.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const double scaled = some[i][k] * factor, slack = 4 * std::abs(scaled) * 0x1p-53;
        if (slack > 0.01) return std::nullopt;  // beyond the precision of a double
        whole = whole && std::abs(scaled - std::nearbyint(scaled)) <= slack;
      }
    if (whole) return 1 / factor;
  }
  return std::nullopt;
}

/// Rounds to a power-of-two grid of half to a quarter of `length`, so that differences of floats are rounded once. The
/// floor keeps the grid meaningful if the cloud is a single point.
double on_grid(double x, double length) {
  const double grid = std::exp2(std::floor(std::log2(std::max(length, std::abs(x) * 0x1p-24))) - 1);
  return grid > 0 ? std::round(x / grid) * grid : x;
}

/// Rounding error of float coordinates about the origin, without a few strays.
double rounding_loss(std::span<const Vec3> some, const Vec3& origin) {
  std::vector<double> losses(some.size());
  for (std::size_t i = 0; i < some.size(); ++i) {
    const Vec3 p = some[i] - origin;
    for (std::size_t k = 0; k < 3; ++k)
      losses[i] = std::max(losses[i], std::abs(p[k] - static_cast<double>(static_cast<float>(p[k]))));
  }
  const auto strays = static_cast<std::size_t>(kLostShare * static_cast<double>(some.size()));
  return nth_smallest(losses, losses.size() - 1 - strays);
}

/// Numbers of unknown positions and of positions too far away, as marked by store_positions.
std::pair<std::size_t, std::size_t> count_lost(const PointSet& points) {
  using Counts = std::pair<std::size_t, std::size_t>;
  return parallel_reduce(
      points.size(), 1 << 16, Counts{},
      [&](std::size_t first, std::size_t last) {
        Counts c;
        for (std::size_t i = first; i < last; ++i) {
          const Vec3f& p = points.positions[i];
          if (!is_finite(p)) ++(std::isinf(p.x) ? c.second : c.first);
        }
        return c;
      },
      [](const Counts& a, const Counts& b) {
        return Counts{a.first + b.first, a.second + b.second};
      });
}

}  // namespace

void keep_resolution(const Input& in, std::span<const Vec3> some, Vec3& origin) {
  if (some.empty()) return;
  double loss = rounding_loss(some, origin);
  if (loss == 0) return;
  const std::optional<double> resolution = decimal_resolution(some);
  const double most = resolution ? *resolution / 2 : kLostLength;
  if (loss <= most) return;
  Box3 box;
  for (const Vec3& p : some) box.extend(p);
  if (box.diagonal() > kLargestSurvey) return;
  if (!in.origin) {
    Vec3 middle;
    for (std::size_t k = 0; k < 3; ++k) middle[k] = on_grid(box.center()[k], box.diagonal());
    const double there = rounding_loss(some, middle);
    if (there < loss) origin = middle, loss = there;
    if (loss <= most) return;
  }
  in.warn(fmt::format(
      "coordinates are rounded by up to {:.2g}{}: they are kept as floats, and the cloud is {:.4g} across "
      "(a part of it loses less)",
      loss, resolution ? fmt::format(", the file has steps of {:g}", *resolution) : std::string(), box.diagonal()));
}

Vec3 choose_origin(const Box3& box) {
  const double diagonal = box.diagonal();
  Vec3 origin;
  for (int k = 0; k < 3; ++k) {
    const double farthest = std::max(std::abs(box.lower[k]), std::abs(box.upper[k]));
    if (farthest <= 4 * diagonal || farthest == 0) continue;
    origin[k] = on_grid(box.center()[k], std::max(diagonal, farthest * 0x1p-24));
  }
  return origin;
}

Vec3 choose_origin(const Box3& box, std::vector<Vec3>& some) {
  if (box.empty()) return {};
  if (some.size() < kFewestWithStrays) return choose_origin(box);
  const auto cut = static_cast<std::ptrdiff_t>(1 + some.size() / kStrays);
  Box3 most;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto less = [k](const Vec3& a, const Vec3& b) { return a[k] < b[k]; };
    std::nth_element(some.begin(), some.begin() + cut, some.end(), less);
    most.lower[k] = some[static_cast<std::size_t>(cut)][k];
    std::nth_element(some.begin(), some.end() - 1 - cut, some.end(), less);
    most.upper[k] = (some.end() - 1 - cut)->operator[](k);
  }
  const bool strays = most.diagonal() > 0 && box.diagonal() > kFarAway * most.diagonal();
  return choose_origin(strays ? most : box);
}

void check_extent(const Input& in, const Box3& box) {
  if (box.empty()) return;
  const Vec3 size = box.size();
  const double extent = std::max({size.x, size.y, size.z});
  if (extent > 0 && extent < in.smallest_extent)
    in.fail(fmt::format("extends over {:.3g} only, and {:g} is needed: write its coordinates in a smaller unit", extent,
                        in.smallest_extent));
}

void set_scanner(PointSet& points, const Vec3& towards) {
  Box3 box;
  for (const Vec3f& p : points.positions) {
    if (is_finite(p)) box.extend(Vec3(p));
  }
  if (box.empty()) return;
  points.scanners.assign(1, Vec3f(box.center() + towards * (1000 * box.diagonal())));
  points.scan_of_point.assign(points.size(), 0);
}

void finish(const Input& in, PointSet& points) {
  const std::size_t n = points.positions.size();
  if (n == 0) in.fail("holds no points");
  if (n > 0xfffffffeu) in.fail(fmt::format("holds {} points; at most 4,294,967,294 are supported", grouped(n)));

  const std::size_t bad_triangle = parallel_reduce(
      points.triangles.size(), 1 << 16, points.triangles.size(),
      [&](std::size_t first, std::size_t last) {
        for (std::size_t t = first; t < last; ++t) {
          for (const std::uint32_t v : points.triangles[t]) {
            if (v >= n) return t;
          }
        }
        return points.triangles.size();
      },
      [](std::size_t a, std::size_t b) { return std::min(a, b); });
  if (bad_triangle < points.triangles.size()) {
    const auto& t = points.triangles[bad_triangle];
    const std::uint32_t v = t[0] >= n ? t[0] : t[1] >= n ? t[1] : t[2];
    const std::string which = v == 0xffffffffu ? "an impossible point number" : fmt::format("point {}", grouped(v));
    in.fail(
        fmt::format("a face refers to {}, but there are only {} points (0 to {})", which, grouped(n), grouped(n - 1)));
  }

  const auto [unknown, beyond] = count_lost(points);
  const std::size_t lost = unknown + beyond;
  if (lost == n && beyond == 0) in.fail(fmt::format("holds no points with finite coordinates (0 of {})", grouped(n)));
  if (lost == n)
    in.fail(fmt::format("holds no points that can be used: {} of {} {} farther than {:g} from zero{}", grouped(beyond),
                        grouped(n), beyond == 1 ? "is" : "are", largest_coordinate,
                        unknown > 0 ? ", the others are not finite" : ""));
  if (lost > 0) {
    std::vector<std::uint8_t> gone(n);
    for (std::size_t i = 0; i < n; ++i) gone[i] = !is_finite(points.positions[i]);
    const std::size_t before = points.triangles.size();
    remove_samples(points, gone);
    if (unknown > 0)
      in.warn(fmt::format("{} of {} points are not finite and were left out", grouped(unknown), grouped(n)));
    if (beyond > 0)
      in.warn(fmt::format("{} of {} points are farther than {:g} from zero and were left out", grouped(beyond),
                          grouped(n), largest_coordinate));
    if (before > points.triangles.size()) {
      in.warn(fmt::format("{} of {} triangles referred to them and were left out",
                          grouped(before - points.triangles.size()), grouped(before)));
    }
  }

  if (!points.normals.empty()) {
    const std::size_t with_direction = parallel_reduce(
        points.size(), 1 << 16, std::size_t{0},
        [&](std::size_t first, std::size_t last) {
          std::size_t count = 0;
          for (std::size_t i = first; i < last; ++i) {
            Vec3f& normal = points.normals[i];
            // In double: squares of tiny components would vanish in float.
            const Vec3 d(normal);
            const double length = norm(d);
            const bool good = std::isfinite(length) && length > 1e-30;
            // Unit normals stay bitwise unchanged.
            if (!good)
              normal = {};
            else if (std::abs(length - 1) > 1e-6)
              normal = Vec3f(d / length);
            count += good;
          }
          return count;
        },
        [](std::size_t a, std::size_t b) { return a + b; });
    if (with_direction == 0) {
      points.normals.clear();
      in.warn("all normals are zero and were left out");
    } else if (with_direction < points.size()) {
      in.warn(fmt::format("{} of {} normals are zero or not finite and count as unknown",
                          grouped(points.size() - with_direction), grouped(points.size())));
    }
  }
}

}  // namespace sansmesh::inline v1::io
