// The inspection map: how far every place of a part lies from where it should.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/measure/signed_distance.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Lengths in the unit of the input. What is absent follows from the data.
struct DistanceMapOptions {
  /// Places farther off than this belong to something else and are left out (> 0). Default: a tenth of the diagonal of
  /// the reference's box.
  std::optional<double> max_distance = {};
  std::optional<double> tolerance = {};  ///< the statistics tell which share keeps within it (>= 0)
  /// Half of the range of the histogram and of the colours (> 0). Default: what 99 % of the area stays within, rounded
  /// up to two digits, but at least kSmallestRange.
  std::optional<double> color_range = {};
  bool skip_border = false;  ///< leave out places whose closest point lies on the border of an open reference
  bool reversed = false;     ///< the map lies on the reference, distances are to the part, with their sign reversed

  static const OptionSchema& schema();
  /// Throws ArgumentError saying which.
  void validate() const;
};

/// Over what was measured. On a mesh every vertex weighs as much as a third of the area of its triangles, so that dense
/// places count no more than others; points all weigh the same. NaN where nothing was measured.
struct DistanceStatistics {
  double mean = 0, mean_absolute = 0, rms = 0, deviation = 0;  ///< deviation: from the mean
  double p05 = 0, median = 0, p95 = 0;                         ///< of the signed distance
  double p95_absolute = 0;
  double lowest = 0, highest = 0;          ///< over all that was measured, whatever its weight
  Vec3 lowest_at, highest_at;              ///< on the mapped surface, world coordinates
  std::optional<double> within_tolerance;  ///< share, 0..1
  double area = 0;                         ///< that was measured; of points: their number
  /// Share of the weight in bins of equal width over −range..range (0..range without sides), and what lies beyond.
  std::vector<double> histogram;
  double below_range = 0, above_range = 0;
  double range = 0;
  bool smallest_range = false;  ///< it is the smallest, since nearly everything lies nearer

  static const ReportSchema& schema();
};

struct DistanceMap {
  std::vector<float> distance;  ///< of every vertex; positive outside; NaN where it was left out
  bool has_sides = true;        ///< false: only absolute values are known
  double max_distance = 0;      ///< as used
  std::size_t measured = 0;     ///< vertices with a distance
  std::size_t beyond = 0;       ///< left out: farther than max_distance
  std::size_t not_found = 0;    ///< left out: no surface could be found from there (MeasuredPoint::lost)
  std::size_t at_border = 0;    ///< whose closest point lies on a border; left out only with skip_border
  std::size_t not_finite = 0;   ///< left out: vertices that are not finite, or that no triangle uses
  DistanceStatistics statistics;

  static const ReportSchema& schema();
};

inline constexpr std::size_t kHistogramBins = 41;  ///< odd: one bin lies around 0

/// Least range that is chosen by itself, of the diagonal of the reference's box: below it lies rounding.
inline constexpr double kSmallestRange = 1e-6;

/// Distances at the vertices of a mesh that triangles use, or at all points if there are no triangles. Parallel, the
/// same for any number of threads. Throws DataError if there are no finite points, ArgumentError for bad options.
DistanceMap distance_map(const TriangleMesh& part, const SignedDistance& reference, const DistanceMapOptions& options,
                         Progress& progress);

/// The colour of a distance: blue inside, white at 0, red outside, full at ±range; grey where it was left out.
std::array<std::uint8_t, 3> distance_color(float distance, double range);

/// Writes distances as the attribute "quality" of the vertices (left out: NaN; the name that viewers of meshes know; of
/// a mesh without triangles "distance") and their colours into the mesh.
void apply_map(TriangleMesh& part, const DistanceMap& map, double range);

}  // namespace sansmesh::inline v1
