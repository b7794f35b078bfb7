// The inspection map: how far every place of a part lies from where it should.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/affine_map.h"
#include "sansmesh/jobs/any_surface.h"
#include "sansmesh/measure/distance_map.h"
#include "sansmesh/mesh/align_surfaces.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

enum class MapSide : std::uint8_t { part, reference };
/// In the order of the enumerators.
inline constexpr std::string_view kSideWords[] = {"part", "reference"};

struct CompareOptions {
  DistanceMapOptions map = {};  ///< its `reversed` follows from `on`
  /// On which of them the map lies; the sign of distances stays the part's.
  MapSide on = MapSide::part;
  /// First halve edges of the mapped mesh until none is longer (length, > 0).
  std::optional<double> refine = {};
  /// First move the part onto the reference.
  bool align = false;
  SurfaceAlignmentOptions alignment = {};

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct CompareReport {
  MapSide on = MapSide::part;       ///< as used
  std::optional<double> tolerance;  ///< as asked for (length)
  double diagonal = 0;              ///< of the reference
  std::optional<SurfaceAlignment> alignment;
  AffineMap motion;  ///< of the part, if it was aligned

  static const ReportSchema& schema();
};

struct CompareResult {
  TriangleMesh mesh;  ///< of the part or the reference, with distances and their colours (apply_map)
  DistanceMap map;    ///< of its vertices
  CompareReport report;
  /// Those of align; "edges_stay_long": refining would take too many triangles; "coarse": only corners of large
  /// triangles are compared; "no_sign": the other side is points without normals.
  std::vector<Note> notes;

  static const ReportSchema& schema();
};

/// Statistics and colours of signed distances, positive outside of the reference. Throws ArgumentError for bad options,
/// and where a function is to be moved; DataError that begins with a name; Cancelled.
CompareResult compare(const AnySurface& part, const AnySurface& reference, const CompareOptions& options,
                      Progress& progress);

/// How the part was moved, statistics and what was left out, in lines for people. `other`: name of what it was compared
/// with.
std::vector<std::string> summary_of(const CompareResult& compared, const CompareOptions& options,
                                    const std::string& other);
/// The distribution of the distances as bars.
std::vector<std::string> histogram_of(const DistanceMap& map);

}  // namespace sansmesh::inline v1
