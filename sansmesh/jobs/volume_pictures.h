// Pictures of a volume, seen through.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sansmesh/image.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/baked_volume.h"
#include "sansmesh/render/picture_scene.h"
#include "sansmesh/render/volume_picture.h"
#include "sansmesh/volumes.h"

namespace sansmesh::inline v1 {

struct VolumePicturesOptions {
  VolumePictureOptions look = {};
  std::string opacity_by = {};  ///< array that gives the opacities; the volume's own gives the colours
  bool grid = false;            ///< also the edges of the grid's cells where the volume ends
  bool baked = false;           ///< quick: one ray a pixel, long steps, from the field baked into bricks
  double bake_error = BakeOptions().tolerance;  ///< of `baked`: share of the range above which bricks are split
  bool bar = true;                              ///< the colour bar
  std::string unit = {};                        ///< of the array, at the colour bar
  bool any_view = true;                         ///< nobody chose the view: that of a single layer looks straight at it

  /// Of `look` those that RenderOptions does not have; without `any_view`.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Opened once; then pictures from anywhere.
class VolumePictures {
 public:
  /// The array that the volume was opened with, of vectors the length. `surfaces` stand in the same pictures. Throws
  /// ArgumentError for bad options and names of no array, DataError where there is nothing to draw, Cancelled.
  VolumePictures(const VolumeModel& volume, const VolumePicturesOptions& options, std::vector<PictureSurface> surfaces,
                 Progress& progress);
  ~VolumePictures();
  VolumePictures(VolumePictures&&) noexcept;

  /// The look with all that was chosen.
  const VolumePictureOptions& look() const;
  /// The same, seen from somewhere else.
  Image render(const ViewDirection& view, Progress& progress);
  /// Of the last picture.
  const VolumePictureReport& report() const;
  /// Null if it was not baked.
  const BakeReport* baked() const;
  /// Those of VolumeModel::field, and "picture" with what may not be as wished of the last picture.
  std::vector<Note> notes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sansmesh::inline v1
