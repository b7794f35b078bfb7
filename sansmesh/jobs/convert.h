// Clouds and meshes moved, cropped, thinned and welded, a step after the other.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/jobs/cloud_or_mesh.h"
#include "sansmesh/jobs/convert_steps.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

struct ConvertOptions {
  bool points = false;                  ///< of a mesh the vertices alone, from the start
  std::string unit = {};                ///< of the input's lengths, for UnitStep
  std::vector<ConvertStep> steps = {};  ///< in their order

  static const OptionSchema& schema();
  /// Throws ArgumentError.
  void validate() const;
};

/// What there was after a step.
struct ConvertedBy {
  std::string_view step;  ///< its name
  std::string remark;     ///< what became of the data, in words; may be empty
  std::size_t size = 0;   ///< points or vertices
  std::optional<std::size_t> triangles;

  static const ReportSchema& schema();
};

struct ConvertReport {
  std::string size_words;               ///< of what came: "1,234 points"
  std::size_t size = 0, triangles = 0;  ///< of what came
  std::vector<ConvertedBy> steps;

  static const ReportSchema& schema();
};

struct ConvertResult {
  CloudOrMesh data;
  ConvertReport report;
  /// "nonmanifold_weld": edges of three triangles or more were made; "unturned": attributes of three numbers that
  /// nobody knows to be directions.
  std::vector<Note> notes;
};

/// Throws FileError early where neither a mesh nor points can be written there. `points`: these are wanted.
void check_converted(const std::string& file, bool points);
/// Meshes become points where the format of the file has no faces: "no_faces". Points never become a mesh: throws
/// FileError.
std::vector<Note> fit_to_format(CloudOrMesh& data, const std::string& file);

/// Throws ArgumentError for bad options, DataError naming the step where one cannot be done or leaves nothing,
/// Cancelled.
ConvertResult convert(PointSet read, const ConvertOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
