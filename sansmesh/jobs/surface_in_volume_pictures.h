// Pictures of a surface in a volume, by rays and without a mesh.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/image.h"
#include "sansmesh/jobs/surface_in_volume.h"
#include "sansmesh/jobs/volume_model.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/picture_notes.h"
#include "sansmesh/render/surface_caster.h"
#include "sansmesh/render/surface_picture.h"
#include "sansmesh/render/transfer_function.h"
#include "sansmesh/report.h"
#include "sansmesh/surface/curvature_colors.h"

namespace sansmesh::inline v1 {

struct SurfaceInVolumeLook {
  std::string color_by = {};               ///< an array of the volume, or a curvature: kCurvatureWords
  std::optional<double> color_range = {};  ///< curvature that gets the full colour (1 / length or 1 / length²)
  bool sharp = false;                      ///< normals turn sharply at edges and corners

  static const OptionSchema& schema();
  /// The curvature that colours show; nothing where they show none.
  std::optional<CurvatureColorOptions::Quantity> curvature() const;
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// The quantity that the colours show.
struct ShownColors {
  std::string array;  ///< empty of curvatures
  std::optional<CurvatureColorOptions::Quantity> curvature;
  double range = 0;  ///< of the curvature that gets the full colour, in lengths of the input
  /// Of an array: its colours, and whether it has values below and above theirs on the surface.
  TransferFunction colors;
  BarEnds ends;

  static const ReportSchema& schema();
};

/// Built once; then pictures from anywhere.
class SurfaceInVolumePictures {
 public:
  /// `surface` must outlive this. Throws ArgumentError for bad options and names of no array, DataError, Cancelled.
  /// Notes of the fields are added to `notes`.
  SurfaceInVolumePictures(const SurfaceInVolume& surface, VolumeModel& volume, const SurfaceInVolumeLook& look,
                          Progress& progress, std::vector<Note>& notes);
  ~SurfaceInVolumePictures();
  SurfaceInVolumePictures(SurfaceInVolumePictures&&) noexcept;

  const std::optional<ShownColors>& colors() const;
  /// `options`: lengths and places as in the input.
  Image render(const SurfaceRenderOptions& options, Progress& progress) const;
  /// Of all pictures until now.
  CastCounts counts() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sansmesh::inline v1
