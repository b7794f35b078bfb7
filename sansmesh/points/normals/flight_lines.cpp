#include "sansmesh/points/normals/flight_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>

#include "sansmesh/core/option_text.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

/// Seconds. A turn of an aircraft takes longer than the pause; within a stretch it hardly turns.
constexpr double kPause = 10, kStretch = 20;
/// Stretches with fewer samples, or less variation of the angle (rms of the tangent), do not determine the flight path.
constexpr std::size_t kFewestInStretch = 100;
constexpr double kLeastSpread = 0.01;
/// Largest unexplained share of the variance across the path: rounded angles and hills.
constexpr double kMostLeft = 0.3;
/// Larger angles (degrees) are invalid.
constexpr double kLargestAngle = 80;

constexpr std::array<std::string_view, 7> kAngleNames{"scan_angle",     "scananglerank",          "scan_angle_rank",
                                                      "scanangle",      "scalar_scan_angle_rank", "scalar_scan_angle",
                                                      "scan angle rank"};
constexpr std::array<std::string_view, 4> kLineNames{"point_source_id", "pointsourceid", "pointsourceidentifier",
                                                     "scalar_point_source_id"};
constexpr std::array<std::string_view, 4> kTimeNames{"gps_time", "gpstime", "scalar_gps_time", "scalar_gpstime"};
constexpr std::array<std::string_view, 3> kReturnNames{"return_number", "returnnumber", "scalar_return_number"};

/// First existing attribute of one component among these names, ignoring case.
const Attribute* find_named(const PointSet& points, std::span<const std::string_view> names) {
  for (const std::string_view name : names)
    for (const Attribute& a : points.attributes)
      if (lower_case(a.name) == name && a.components == 1 && a.size() == points.size()) return &a;
  return nullptr;
}

/// Sums of products of horizontal position, time and tangent of the angle, about their means.
struct StretchSums {
  double n = 0;
  std::array<double, 4> mean{};                  ///< means of x, y, t, tan θ
  std::array<std::array<double, 4>, 4> product;  ///< products of the deviations

  explicit StretchSums(std::span<const std::array<double, 4>> rows) : n(static_cast<double>(rows.size())) {
    for (const auto& row : rows)
      for (std::size_t k = 0; k < 4; ++k) mean[k] += row[k] / n;
    for (auto& p : product) p.fill(0);
    for (const auto& row : rows)
      for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t k = 0; k < 4; ++k) product[j][k] += (row[j] - mean[j]) * (row[k] - mean[k]);
  }

  /// Unit vector across the path towards positive angles; nothing if undetermined.
  std::optional<Vec3> across() const {
    const double tt = product[2][2], aa = product[3][3], ta = product[2][3];
    if (!(aa > n * kLeastSpread * kLeastSpread)) return std::nullopt;
    // Without times, or if times and angles are collinear, only the angles are used.
    const bool timed = tt > 0 && ta * ta < 0.5 * tt * aa;
    const double determinant = timed ? tt * aa - ta * ta : aa;
    const auto slope = [&](std::size_t k) {
      return timed ? (product[k][3] * tt - product[k][2] * ta) / determinant : product[k][3] / determinant;
    };
    const Vec3 w{slope(0), slope(1), 0};
    const double length = norm(w);
    if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
    const Vec3 side = w / length;
    const auto along_side = [&](std::size_t k) { return side.x * product[0][k] + side.y * product[1][k]; };
    const double total = side.x * along_side(0) + side.y * along_side(1);
    // Variance explained by time and angle together; without times, by the angle only.
    const double by_angle = along_side(3), by_time = along_side(2);
    const double explained =
        timed ? (by_angle * by_angle * tt - 2 * by_angle * by_time * ta + by_time * by_time * aa) / determinant
              : by_angle * by_angle / aa;
    const double without_angles = timed ? total - by_time * by_time / tt : total;
    if (!(total - explained <= kMostLeft * without_angles)) return std::nullopt;
    return side;
  }
};

}  // namespace

std::vector<Vec3f> directions_to_flight(const PointSet& points) {
  const Attribute* const angle = find_named(points, kAngleNames);
  if (!angle) return {};
  const std::size_t n = points.size();
  const auto numbers = [n](const Attribute* a) {
    if (!a) return std::vector<double>();
    std::vector<double> values(n);
    parallel_for(0, values.size(), 1 << 15, [&](std::size_t i) { values[i] = a->number(i); });
    return values;
  };
  const std::vector<double> angles = numbers(angle), lines = numbers(find_named(points, kLineNames)),
                            times = numbers(find_named(points, kTimeNames));
  std::vector<std::uint32_t> order;
  order.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const bool usable = std::abs(angles[i]) <= kLargestAngle && is_finite(points.positions[i]) &&
                        (times.empty() || std::isfinite(times[i])) && (lines.empty() || std::isfinite(lines[i]));
    if (usable) order.push_back(static_cast<std::uint32_t>(i));
  }
  if (order.empty()) return {};
  const auto line_of = [&](std::uint32_t i) { return lines.empty() ? 0 : lines[i]; };
  const auto time_of = [&](std::uint32_t i) { return times.empty() ? 0 : times[i]; };
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    if (line_of(a) != line_of(b)) return line_of(a) < line_of(b);
    return time_of(a) != time_of(b) ? time_of(a) < time_of(b) : a < b;
  };
  if (!std::is_sorted(order.begin(), order.end(), before)) std::sort(order.begin(), order.end(), before);

  std::vector<std::size_t> first{0};  // start of each stretch
  for (std::size_t k = 1; k < order.size(); ++k) {
    const double t = time_of(order[k]);
    if (line_of(order[k]) != line_of(order[k - 1]) || t - time_of(order[k - 1]) > kPause ||
        t - time_of(order[first.back()]) > kStretch)
      first.push_back(k);
  }
  first.push_back(order.size());
  std::vector<Vec3f> towards(n, Vec3f{0, 0, 1});
  std::vector<std::uint8_t> known(first.size() - 1, 0);
  parallel_for(0, known.size(), 1, [&](std::size_t s) {
    const std::span<const std::uint32_t> samples(order.data() + first[s], first[s + 1] - first[s]);
    if (samples.size() < kFewestInStretch) return;
    std::vector<std::array<double, 4>> rows;
    rows.reserve(samples.size());
    const auto radians = [&](std::uint32_t i) { return angles[i] * (std::numbers::pi / 180); };
    for (const std::uint32_t i : samples) {
      const Vec3f& p = points.positions[i];
      rows.push_back(
          {static_cast<double>(p.x), static_cast<double>(p.y), time_of(i) - time_of(samples[0]), std::tan(radians(i))});
    }
    const auto side = StretchSums(rows).across();
    if (!side) return;
    known[s] = 1;
    for (const std::uint32_t i : samples)
      towards[i] = Vec3f(*side * -std::sin(radians(i)) + Vec3{0, 0, std::cos(radians(i))});
  });
  if (std::find(known.begin(), known.end(), 1) == known.end()) return {};
  return towards;
}

bool is_survey_from_above(const PointSet& points) {
  return find_named(points, kReturnNames) || find_named(points, kAngleNames);
}

}  // namespace sansmesh::inline v1
