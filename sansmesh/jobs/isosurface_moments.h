// The surface on which a quantity of a volume that changes has a value, as meshes at many moments.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "sansmesh/jobs/isosurface.h"
#include "sansmesh/jobs/volume_series.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct IsosurfaceMomentsOptions {
  std::optional<std::size_t> frames = {};  ///< moments from the first step to the last; default: as many as steps
  std::optional<double> time_cell = {};    ///< as in SpaceTimeOptions; default: the shortest time between steps

  static const OptionSchema& schema();
};

struct IsosurfaceMoment {
  double time = 0;
  std::size_t vertices = 0, triangles = 0, components = 0;
  bool closed = true;
  double area = 0, volume = 0;

  static const ReportSchema& schema();
};

struct IsosurfaceMomentsReport {
  ReconstructionReport reconstruction;  ///< of the first step
  double value = 0;
  std::size_t blocks = 0;
  double cell = 0, time_cell = 0;
  std::vector<IsosurfaceMoment> moments;

  static const ReportSchema& schema();
};

struct IsosurfaceMomentsResult {
  IsosurfaceMomentsReport report;
  /// Those of VolumeModel::field; "no_surface": nothing is there at a moment; "more_triangles": fewer were asked for.
  std::vector<Note> notes;
};

/// The surface in space and time, cut at moments from the first step to the last: closed meshes, one after the other
/// handed to `use` with the number of the moment. Throws as isosurface(), ArgumentError for `carry`, `closed` and
/// `components`, which are not for these.
IsosurfaceMomentsResult isosurface_moments(VolumeSeries& series, const VolumeIsosurfaceOptions& options,
                                           const IsosurfaceMomentsOptions& moments,
                                           const std::function<void(std::size_t, const TriangleMesh&)>& use,
                                           Progress& progress);
/// Throws what isosurface_moments throws for its options, before anything is read.
void check_moments(const VolumeIsosurfaceOptions& options, const IsosurfaceMomentsOptions& moments);
/// Number of moments.
std::size_t moment_count(const VolumeSeries& series, const IsosurfaceMomentsOptions& moments);

}  // namespace sansmesh::inline v1
