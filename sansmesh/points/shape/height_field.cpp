#include "sansmesh/points/shape/height_field.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kColumnSamples = 16;
/// Least number of samples for a plane.
constexpr std::size_t kFewestInColumn = 6;
/// Largest numbers of samples used.
constexpr std::size_t kColumnsSamples = 100000, kReliefSamples = 50000;
/// Largest rms distance of a column's samples from their plane, in spacings or noise levels, for a single sheet. Two
/// sheets one spacing apart deviate by half a spacing.
constexpr double kSheetSpacings = 0.4, kSheetNoises = 2;
/// Kurtosis (fourth moment over squared second): 3 for noise, 1 for two sheets, 1.7 for two sheets with noise of a
/// quarter of their distance. Below this, apparent noise is two sheets.
constexpr double kLeastKurtosis = 2.2;
/// Least share of single sheets if the cloud is very flat, flat, or a survey. (Closed objects have 0.00 to 0.03,
/// airborne scans 0.2 to 0.95.)
constexpr double kOneSheetIfFlat = 0.15, kOneSheet = 0.5, kOneSheetOfSurvey = 0.1;
constexpr double kFlat = 0.1, kLargestRelief = 0.2;

/// Sums for the least-squares plane of heights.
struct PlaneSums {
  double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;

  void add(const Vec3& p) {
    n += 1, x += p.x, y += p.y, z += p.z;
    xx += p.x * p.x, xy += p.x * p.y, yy += p.y * p.y;
    xz += p.x * p.z, yz += p.y * p.z;
  }

  /// Slopes along x and y, and the height at the origin.
  Vec3 plane() const {
    const double cxx = xx - x * x / n, cyy = yy - y * y / n, cxy = xy - x * y / n;
    const double cxz = xz - x * z / n, cyz = yz - y * z / n, determinant = cxx * cyy - cxy * cxy;
    Vec3 slope;
    if (determinant > 1e-6 * cxx * cyy)
      slope = {(cxz * cyy - cyz * cxy) / determinant, (cyz * cxx - cxz * cxy) / determinant, 0};
    return {slope.x, slope.y, (z - slope.x * x - slope.y * y) / n};
  }
};

/// Samples grouped by square columns.
struct Columns {
  std::vector<KeyIndex> samples;   ///< column by column
  std::vector<std::size_t> first;  ///< start of each column, and the end

  std::size_t size() const { return first.size() - 1; }
};

/// Selects one column in 2^`skip`, with all of its samples.
Columns make_columns(std::span<const Vec3f> positions, const Box3f& box, double edge, int skip) {
  constexpr std::size_t kChunk = 1 << 15;
  using Keys = std::vector<KeyIndex>;
  Columns columns;
  columns.samples = parallel_reduce(
      positions.size(), kChunk, Keys{},
      [&](std::size_t begin, std::size_t end) {
        Keys keys;
        for (std::size_t i = begin; i < end; ++i) {
          const auto cell = [&](float at, float lower) {
            return std::uint64_t{
                whole_part<std::uint32_t>((static_cast<double>(at) - static_cast<double>(lower)) / edge)};
          };
          const Vec3f& p = positions[i];
          if (!is_finite(p)) continue;
          const std::uint64_t key = cell(p.x, box.lower.x) << 32 | cell(p.y, box.lower.y);
          // Fibonacci hashing of both numbers decorrelates neighbouring columns.
          const std::uint64_t mixed = (key ^ key >> 29) * 0x9e3779b97f4a7c15u;
          if (skip == 0 || mixed >> (64 - skip) == 0) keys.push_back({key, static_cast<unsigned>(i)});
        }
        return keys;
      },
      [](Keys a, const Keys& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
      });
  parallel_sort(columns.samples);
  for (std::size_t i = 0; i < columns.samples.size(); ++i)
    if (i == 0 || columns.samples[i].key != columns.samples[i - 1].key) columns.first.push_back(i);
  columns.first.push_back(columns.samples.size());
  return columns;
}

/// Numbers of samples in single-sheet columns: closer to a plane than `thin`; and possibly, given their noise, closer
/// than `thick`, with the sums of squares and fourth powers of their distances.
struct SheetCount {
  std::size_t thin = 0, thick = 0;
  double squares = 0, fourths = 0;

  SheetCount operator+(const SheetCount& o) const {
    return {thin + o.thin, thick + o.thick, squares + o.squares, fourths + o.fourths};
  }
};

SheetCount count_in_one_sheet(std::span<const Vec3f> positions, const Columns& columns, double thin, double thick) {
  return parallel_reduce(
      columns.size(), 1024, SheetCount{},
      [&](std::size_t begin, std::size_t end) {
        SheetCount count;
        for (std::size_t c = begin; c < end; ++c) {
          const std::span<const KeyIndex> samples(columns.samples.data() + columns.first[c],
                                                  columns.first[c + 1] - columns.first[c]);
          if (samples.size() < kFewestInColumn) continue;
          const Vec3 at(positions[samples[0].index]);
          PlaneSums sums;
          for (const KeyIndex& s : samples) sums.add(Vec3(positions[s.index]) - at);
          const Vec3 plane = sums.plane();
          double squares = 0, fourths = 0;
          for (const KeyIndex& s : samples) {
            const Vec3 p = Vec3(positions[s.index]) - at;
            const double height = p.z - plane.x * p.x - plane.y * p.y - plane.z, square = height * height;
            squares += square, fourths += square * square;
          }
          const double rms = std::sqrt(squares / sums.n);
          if (rms <= thin)
            count.thin += samples.size();
          else if (rms <= thick)
            count = count + SheetCount{0, samples.size(), squares, fourths};
        }
        return count;
      },
      [](const SheetCount& a, const SheetCount& b) { return a + b; });
}

/// Interquartile range of the heights over the plane through all samples.
double middle_height(std::span<const Vec3f> positions, const Vec3& at) {
  PlaneSums all;
  std::vector<Vec3> some;
  const std::size_t step = 1 + positions.size() / kReliefSamples;
  for (std::size_t i = 0; i < positions.size(); i += step)
    if (is_finite(positions[i])) some.push_back(Vec3(positions[i]) - at), all.add(some.back());
  if (some.size() < 4) return 0;
  const Vec3 plane = all.plane();
  std::vector<double> heights;
  heights.reserve(some.size());
  for (const Vec3& p : some) heights.push_back(p.z - plane.x * p.x - plane.y * p.y - plane.z);
  const std::size_t quarter = heights.size() / 4;
  const double lower = nth_smallest(heights, quarter);
  return nth_smallest(heights, heights.size() - 1 - quarter) - lower;
}

}  // namespace

HeightFieldShape measure_height_field(const PointSet& points, double noise) {
  const std::span<const Vec3f> positions(points.positions);
  Box3f box;
  std::size_t finite = 0;
  for (const Vec3f& p : positions)
    if (is_finite(p)) box.extend(p), ++finite;
  if (finite < 10 * kFewestInColumn) return {};
  const double width = static_cast<double>(box.size().x), depth = static_cast<double>(box.size().y);
  if (!(width > 0) || !(depth > 0)) return {};
  int skip = 0;
  while (finite >> skip > kColumnsSamples) ++skip;
  // The samples may cover less than the box: the second round uses the occupied columns.
  const double n = static_cast<double>(finite), least_edge = 1e-6 * std::max(width, depth);
  double area = width * depth, edge = 0;
  Columns columns;
  for (int round = 0; round < 2; ++round) {
    edge = std::max(std::sqrt(area * kColumnSamples / n), least_edge);
    columns = make_columns(positions, box, edge, skip);
    if (columns.size() == 0) return {};
    area = std::ldexp(static_cast<double>(columns.size()) * edge * edge, skip);
  }
  const SheetCount sheets =
      count_in_one_sheet(positions, columns, kSheetSpacings * edge / std::sqrt(kColumnSamples), kSheetNoises * noise);
  const double kurtosis =
      sheets.squares > 0 ? sheets.fourths * static_cast<double>(sheets.thick) / (sheets.squares * sheets.squares) : 0;
  const double in_one_sheet = static_cast<double>(sheets.thin + (kurtosis > kLeastKurtosis ? sheets.thick : 0));
  return {in_one_sheet / static_cast<double>(columns.samples.size()),
          middle_height(positions, Vec3(box.center())) / std::sqrt(area)};
}

bool is_height_field(const HeightFieldShape& shape, bool survey) {
  if (!(shape.relief <= kLargestRelief)) return false;
  return shape.one_sheet >= (survey ? kOneSheetOfSurvey : shape.relief <= kFlat ? kOneSheetIfFlat : kOneSheet);
}

}  // namespace sansmesh::inline v1
