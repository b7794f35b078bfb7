// The curves in which planes cut a surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sansmesh/jobs/any_surface.h"
#include "sansmesh/measure/section.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

enum class SectionAxis : std::uint8_t { x, y, z };

/// Single planes, a series of them across an axis, or both; without either three planes through the middle of the box.
struct SectionOptions {
  std::vector<CutPlane> planes = {};
  std::optional<SectionAxis> axis = {};
  std::optional<double> first = {};     ///< position of the first of the series (length)
  std::optional<double> interval = {};  ///< from one to the next (length, not 0); default: spread over the box
  std::optional<int> count = {};        ///< 1..100000; default: 1, or as many as steps fit into the box
  /// Of functions and isosurfaces: lattice squares along the longer side of the box, 2..4096.
  std::optional<int> resolution = {};

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct SectionReport {
  std::size_t curves = 0, open_curves = 0;
};

struct SectionResult {
  std::vector<Section> sections;  ///< a plane each: single ones, then the series
  SectionReport report;
  /// "open_curves": the surface has borders there.
  std::vector<Note> notes;

  static const ReportSchema& schema();
};

/// Of a function the curves of the function itself, without a mesh. Throws ArgumentError for bad options, and for a
/// resolution of meshes, which are cut exactly; DataError of points, and without finite vertices; Cancelled.
SectionResult section(const AnySurface& surface, const SectionOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
