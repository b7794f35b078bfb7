#include "sansmesh/points/ground/ground_heights.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/core/boxes.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/points/ground/breaklines.h"
#include "sansmesh/points/ground/local_plane.h"
#include "sansmesh/points/ground/sided_plane.h"

namespace sansmesh::inline v1 {
namespace {

/// Largest number of cells: 4 GB in a file.
constexpr double kMostHeights = 1e9;
/// Bins on each side of the one of a centre.
constexpr std::ptrdiff_t kBinReach = 2;
/// Least number of samples or means around a centre, and of quadrants that contain some.
constexpr std::size_t kFewestForHeight = 6;
constexpr int kSurrounding = 3;
/// Least number of samples for a plane if breaklines hide the others.
constexpr std::size_t kFewestForPlane = 3;
/// Within this many spacings of a sample, a centre on the border of the samples needs two quadrants only.
constexpr double kBorder = 1;

/// Deviation of samples from their plane that may be a step or an edge: in spacings, and over the median deviation. The
/// median is that of so many centres.
constexpr double kStepSpacings = 0.15, kStepDeviations = 3;
constexpr double kJudgedCentres = 2000;

/// Samples in square bins, and means of 2^l × 2^l bins.
struct Bins {
  double edge = 0, left = 0, bottom = 0;
  struct Level {
    std::ptrdiff_t columns = 0, rows = 0;
    std::vector<std::array<float, 4>> means;  ///< x, y, z, number of samples
  };
  std::vector<Level> levels;  ///< level 0 has the bins themselves
  std::vector<std::uint32_t> first, samples;
};

Bins make_bins(const PointSet& points, double edge, std::size_t levels) {
  Bins bins;
  const Box3f box = finite_bounds(points.positions);
  bins.edge = edge;
  bins.left = static_cast<double>(box.lower.x), bins.bottom = static_cast<double>(box.lower.y);
  const auto count = [&](float extent) { return whole_part<std::ptrdiff_t>(static_cast<double>(extent) / edge) + 1; };
  Bins::Level level{count(box.size().x), count(box.size().y), {}};
  level.means.assign(static_cast<std::size_t>(level.columns * level.rows), {});
  std::vector<std::uint32_t> bin_of(points.size());
  bins.first.assign(level.means.size() + 1, 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 p(points.positions[i]);
    bin_of[i] = std::numeric_limits<std::uint32_t>::max();
    if (!is_finite(p)) continue;
    const auto c = index_in<std::ptrdiff_t>((p.x - bins.left) / edge, 0, level.columns - 1);
    const auto r = index_in<std::ptrdiff_t>((p.y - bins.bottom) / edge, 0, level.rows - 1);
    bin_of[i] = static_cast<std::uint32_t>(r * level.columns + c);
    ++bins.first[bin_of[i] + 1];
    auto& m = level.means[bin_of[i]];
    m[3] += 1;
    const float share = 1 / m[3];
    m[0] += share * (static_cast<float>(p.x - bins.left) - m[0]);
    m[1] += share * (static_cast<float>(p.y - bins.bottom) - m[1]);
    m[2] += share * (static_cast<float>(p.z) - m[2]);
  }
  for (std::size_t i = 1; i < bins.first.size(); ++i) bins.first[i] += bins.first[i - 1];
  bins.samples.resize(bins.first.back());
  std::vector<std::uint32_t> next = bins.first;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (bin_of[i] != std::numeric_limits<std::uint32_t>::max())
      bins.samples[next[bin_of[i]]++] = static_cast<std::uint32_t>(i);
  bins.levels.push_back(std::move(level));
  while (bins.levels.size() < levels && (bins.levels.back().columns > 1 || bins.levels.back().rows > 1)) {
    const Bins::Level& a = bins.levels.back();
    Bins::Level b{(a.columns + 1) / 2, (a.rows + 1) / 2, {}};
    b.means.assign(static_cast<std::size_t>(b.columns * b.rows), {});
    for (std::ptrdiff_t r = 0; r < a.rows; ++r)
      for (std::ptrdiff_t c = 0; c < a.columns; ++c) {
        const auto& from = a.means[static_cast<std::size_t>(r * a.columns + c)];
        auto& to = b.means[static_cast<std::size_t>(r / 2 * b.columns + c / 2)];
        if (!(from[3] > 0)) continue;
        to[3] += from[3];
        for (std::size_t k = 0; k < 3; ++k) to[k] += from[3] / to[3] * (from[k] - to[k]);
      }
    bins.levels.push_back(std::move(b));
  }
  return bins;
}

/// Heights of a breakline continue one of its sides within this many spacings and deviations of the plane there.
constexpr double kContinues = 0.15, kContinuingDeviations = 3;
/// Share of the way to a sample on a breakline that is not to cross it.
constexpr double kBeforeLine = 1 - 1e-3;

/// Height at a position relative to the corner of the bins; NaN where it is unknown.
class HeightFinder {
 public:
  /// `least`: deviation of samples from their plane from which there may be a step or an edge (length).
  HeightFinder(const PointSet& points, const Bins& bins, const Breaklines* lines, double least)
      : points_(points), bins_(bins), lines_(lines), least_(least), planes_(bins.edge) {}

  double at(double x, double y) {
    const double height = find(x, y, lines_);
    if (!std::isnan(height) || !lines_) return height;
    const bool sees_some = seen_ > 0;
    const double across = find(x, y, nullptr);
    // Within the samples, few on this side are better than many on the other.
    return !std::isnan(across) && sees_some ? height_of_few(x, y) : across;
  }
  /// Deviation of the samples from their plane; nothing in gaps.
  std::optional<double> deviation_at(double x, double y) {
    gather(x, y, 0, lines_);
    if (!is_surrounded(0)) return std::nullopt;
    return planes_.deviation(values_);
  }

 private:
  bool is_surrounded(std::size_t level, std::size_t fewest = kFewestForHeight) const {
    const bool near = level == 0 && nearest_ <= kBorder * bins_.edge * kBorder * bins_.edge;
    return values_.size() >= fewest && std::popcount(quadrants_) >= (near ? kSurrounding - 1 : kSurrounding);
  }

  double find(double x, double y, const Breaklines* lines) {
    for (std::size_t l = 0; l < bins_.levels.size(); ++l) {
      gather(x, y, l, lines);
      if (is_surrounded(l))
        return bounded(l == 0 ? planes_.height(values_, least_) : fit_local_plane(values_, bins_.edge, scratch_).height,
                       l);
      // In a corner between lines, more distant means are those of the other side.
      if (l == 0 && !pieces_.empty() && seen_ >= kFewestForPlane && is_surrounded(l, kFewestForPlane))
        return height_of_few(x, y);
    }
    return std::numeric_limits<double>::quiet_NaN();
  }

  /// Height of the samples on this side of the breaklines if there are at least one, but few: that of their plane from
  /// three on, else their mean.
  double height_of_few(double x, double y) {
    gather(x, y, 0, lines_);
    if (seen_ >= kFewestForPlane) return bounded(fit_local_plane(values_, bins_.edge, scratch_).height, 0);
    double sum = 0, weights = 0;
    for (const PlaneValue& v : values_) sum += v.weight * v.z, weights += v.weight;
    return sum / weights;
  }

  /// Planes continue the heights of their values no farther than the nearest one is away.
  double bounded(double height, std::size_t level) const {
    double low = std::numeric_limits<double>::infinity(), high = -low, nearest = low;
    for (const PlaneValue& v : values_) {
      low = std::min(low, v.z), high = std::max(high, v.z);
      nearest = std::min(nearest, v.x * v.x + v.y * v.y);
    }
    const double reach = std::ldexp((kBinReach + 0.5) * bins_.edge, static_cast<int>(level));
    const double beyond = (high - low) * std::sqrt(nearest) / reach;
    return std::clamp(height, low - beyond, high + beyond);
  }

  /// Adds a sample at (dx, dy) from the centre.
  void add(double dx, double dy, double z, double reach) {
    const double squared = dx * dx + dy * dy, weight = tukey_weight(std::sqrt(squared) / reach);
    if (!(weight > 0)) return;
    values_.push_back({dx, dy, z, weight});
    surround(dx, dy);
  }
  void surround(double dx, double dy) {
    quadrants_ |= 1u << ((dx > 0 ? 1 : 0) + (dy > 0 ? 2 : 0));
    nearest_ = std::min(nearest_, dx * dx + dy * dy);
  }

  bool sees(double x, double y, double dx, double dy) const {
    return std::none_of(pieces_.begin(), pieces_.end(),
                        [&](const Breaklines::Piece& piece) { return piece.separates(x, y, x + dx, y + dy); });
  }

  void gather(double x, double y, std::size_t l, const Breaklines* lines) {
    values_.clear(), pieces_.clear(), quadrants_ = 0, nearest_ = std::numeric_limits<double>::infinity();
    const Bins::Level& level = bins_.levels[l];
    const double edge = std::ldexp(bins_.edge, static_cast<int>(l)), reach = (kBinReach + 0.5) * edge;
    const auto column = static_cast<std::ptrdiff_t>(std::floor(x / edge));
    const auto row = static_cast<std::ptrdiff_t>(std::floor(y / edge));
    const auto for_each_bin = [&](std::ptrdiff_t around, auto&& call) {
      for (std::ptrdiff_t r = std::max<std::ptrdiff_t>(0, row - around); r <= std::min(level.rows - 1, row + around);
           ++r)
        for (std::ptrdiff_t c = std::max<std::ptrdiff_t>(0, column - around);
             c <= std::min(level.columns - 1, column + around); ++c)
          call(c, r);
    };
    if (lines) {
      for_each_bin(kBinReach + 1, [&](auto c, auto r) { lines->append_pieces(l, c, r, pieces_); });
      // A piece is at most an edge long.
      std::erase_if(pieces_,
                    [&](const Breaklines::Piece& p) { return std::hypot(p.x() - x, p.y() - y) > reach + edge / 2; });
    }
    for_each_bin(kBinReach, [&](std::ptrdiff_t c, std::ptrdiff_t r) {
      const auto bin = static_cast<std::size_t>(r * level.columns + c);
      const auto& m = level.means[bin];
      if (!(m[3] > 0)) return;
      const auto add_seen = [&](double dx, double dy, double z) {
        if (pieces_.empty() || sees(x, y, dx, dy)) add(dx, dy, z, reach);
      };
      if (l > 0) {
        if (pieces_.empty() || !lines->crosses(l, c, r))
          add_seen(static_cast<double>(m[0]) - x, static_cast<double>(m[1]) - y, static_cast<double>(m[2]));
        return;
      }
      for (std::uint32_t k = bins_.first[bin]; k < bins_.first[bin + 1]; ++k) {
        const Vec3 p(points_.positions[bins_.samples[k]]);
        add_seen(p.x - bins_.left - x, p.y - bins_.bottom - y, p.z);
      }
    });
    if (l == 0) seen_ = values_.size();
    if (!pieces_.empty()) add_lines(x, y, reach);
  }

  /// Adds the heights of the breaklines that continue the samples on this side; all if there are no samples next to
  /// the centre, none if there are too few for a plane.
  void add_lines(double x, double y, double reach) {
    const bool judged = values_.size() >= kFewestForPlane, alone = values_.empty() && seen_ == 0;
    LocalPlane plane;
    double tolerance = 0;
    if (judged) {
      plane = fit_local_plane(values_, bins_.edge, scratch_);
      scratch_.clear();
      for (const PlaneValue& v : values_)
        scratch_.push_back(std::abs(v.z - plane.height - plane.rise_x * v.x - plane.rise_y * v.y));
      tolerance = kContinues * bins_.edge + kContinuingDeviations * kDeviationOverMedian * median(scratch_);
    }
    for (const Breaklines::Piece& piece : pieces_) {
      const double dx = piece.x() - x, dy = piece.y() - y;
      if (dx * dx + dy * dy >= reach * reach || !sees(x, y, kBeforeLine * dx, kBeforeLine * dy)) continue;
      const auto off = [&](double z) { return std::abs(z - plane.height - plane.rise_x * dx - plane.rise_y * dy); };
      const bool continues = piece.height && (alone || (judged && off(*piece.height) <= tolerance));
      if (continues)
        add(dx, dy, *piece.height, reach);
      else
        surround(dx, dy);
    }
  }

  const PointSet& points_;
  const Bins& bins_;
  const Breaklines* lines_;
  double least_;
  SidedPlanes planes_;
  std::vector<PlaneValue> values_;
  std::vector<Breaklines::Piece> pieces_;
  std::vector<double> scratch_;
  unsigned quadrants_ = 0;
  double nearest_ = 0;
  std::size_t seen_ = 0;  ///< samples on this side of the breaklines at level 0
};

std::optional<Breaklines> breaklines_in(const Bins& bins, const PointSet& points, const PolylineSet* lines) {
  if (!lines || lines->size() == 0) return std::nullopt;
  BreaklineBins of{bins.edge, points.origin + Vec3{bins.left, bins.bottom, 0}};
  for (const Bins::Level& level : bins.levels) of.columns.push_back(level.columns), of.rows.push_back(level.rows);
  return Breaklines(*lines, of);
}

/// The deviation from which there may be a step or an edge, from the usual one.
template <class X, class Y>
double least_step(HeightFinder finder, const PixelMap<float>& map, const X& x_of, const Y& y_of, double spacing) {
  const double cells = static_cast<double>(map.width) * map.height;
  const int step = std::max(1, whole_part<int>(std::sqrt(cells / kJudgedCentres)));
  std::vector<double> usual;
  for (int r = step / 2; r < map.height; r += step)
    for (int c = step / 2; c < map.width; c += step)
      if (const auto deviation = finder.deviation_at(x_of(c), y_of(r))) usual.push_back(*deviation);
  return std::max(kStepSpacings * spacing, usual.empty() ? 0 : kStepDeviations * median(usual));
}

}  // namespace

GroundHeights make_ground_heights(const PointSet& points, const GroundHeightOptions& options, Progress& progress) {
  progress.begin("heights");
  const Box3f box = finite_bounds(points.positions);
  if (box.empty()) throw DataError("no finite points");
  const double cell = options.cell;
  const auto below = [&](double x) { return std::floor(x / cell); };
  const double left = below(points.origin.x + static_cast<double>(box.lower.x));
  const double right = below(points.origin.x + static_cast<double>(box.upper.x)) + 1;
  const double bottom = below(points.origin.y + static_cast<double>(box.lower.y));
  const double top = below(points.origin.y + static_cast<double>(box.upper.y)) + 1;
  if (!((right - left) * (top - bottom) <= kMostHeights))
    throw DataError("there would be " + grouped(whole_part<std::size_t>((right - left) * (top - bottom))) +
                    " cells: at most 1,000,000,000 are possible");
  // A gap is surrounded at the level whose reach is half its width.
  std::size_t levels = 1;
  for (double reach = kBinReach * options.spacing; 2 * reach < options.gap; reach *= 2) ++levels;
  const Bins bins = make_bins(points, options.spacing, levels);
  const std::optional<Breaklines> lines = breaklines_in(bins, points, options.breaklines);
  HeightGrid grid{{static_cast<int>(right - left), static_cast<int>(top - bottom)},
                  cell,
                  left * cell,
                  top * cell,
                  points.reference};
  const auto x_of = [&](int c) { return grid.left + (c + 0.5) * cell - points.origin.x - bins.left; };
  const auto y_of = [&](int r) { return grid.top - (r + 0.5) * cell - points.origin.y - bins.bottom; };
  const Breaklines* const separating = lines ? &*lines : nullptr;
  const double least = least_step(HeightFinder(points, bins, separating, 0), grid.heights, x_of, y_of, options.spacing);
  parallel_ranges(0, static_cast<std::size_t>(grid.heights.height), 4, [&](std::size_t begin, std::size_t end) {
    HeightFinder finder(points, bins, separating, least);
    for (int r = static_cast<int>(begin); r < static_cast<int>(end); ++r)
      for (int c = 0; c < grid.heights.width; ++c)
        grid.heights.at(c, r) = static_cast<float>(points.origin.z + finder.at(x_of(c), y_of(r)));
  });
  return {std::move(grid), lines ? lines->lines_inside() : 0};
}

}  // namespace sansmesh::inline v1
