// The surface on which a quantity of a volume has a value, as a mesh.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sansmesh/dataset/isosurface.h"
#include "sansmesh/jobs/volume_model.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct VolumeIsosurfaceOptions {
  std::optional<double> value = {};  ///< default: the middle of the array's range
  /// Other arrays at the vertices, interpolated in the grid's own way: "all", "none", or names with commas between.
  std::string carry = "all";
  IsosurfaceOptions mesh = {};

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct VolumeIsosurfaceReport {
  ReconstructionReport reconstruction;
  double value = 0;
  IsosurfaceReport mesh;

  static const ReportSchema& schema();
};

struct VolumeIsosurfaceResult {
  TriangleMesh mesh;
  VolumeIsosurfaceReport report;
  /// Those of VolumeModel::field; "mesh": what became of the mesh; "not_carried": an array does not fit into floats.
  std::vector<Note> notes;
};

/// Of the array that the volume was opened with. Throws as VolumeModel::isosurface, ArgumentError for bad options and
/// where an array of several components needs a value, DataError where nothing is found, Cancelled.
VolumeIsosurfaceResult isosurface(VolumeModel& volume, const VolumeIsosurfaceOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
