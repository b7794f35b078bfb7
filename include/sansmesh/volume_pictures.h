// Pictures of volumes, seen through, and of surfaces in them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/image.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/render_options.h"
#include "sansmesh/report.h"
#include "sansmesh/surface_options.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::inline v1 {

class VolumeModel;
struct SurfaceInVolume;

/// Pictures of an open volume.
struct SANSMESH_API VolumePicturesOptions {
  VolumePictureOptions look = {};  ///< of the volume
  std::string opacity_by = {};     ///< array that gives the opacities; the volume's own gives the colours
  bool grid = false;               ///< also the edges of the grid's cells where the volume ends
  bool baked = false;              ///< quick: one ray a pixel, long steps, from the field baked into bricks
  double bake_error = kBakeError;  ///< of `baked`: share of the range above which bricks are split
  bool bar = true;                 ///< the colour bar
  std::string unit = {};           ///< of the array, at the colour bar
  bool any_view = true;            ///< nobody chose the view: that of a single layer looks straight at it
  std::optional<int> frames = {};  ///< so many pictures around the up axis, 2 or more; default: one

  /// Of `look` its own; without `any_view`.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// A volume, seen through. Opened once; then pictures from anywhere. Not from several threads.
class SANSMESH_API VolumePictures {
 public:
  /// The array that the volume was opened with, of vectors the length. `surfaces` stand in the same pictures. Throws
  /// ArgumentError for bad options and names of no array, DataError where there is nothing to draw, Cancelled.
  VolumePictures(const VolumeModel& volume, const VolumePicturesOptions& options, std::vector<SceneFactory> surfaces,
                 Progress& progress);
  ~VolumePictures();
  VolumePictures(VolumePictures&&) noexcept;  ///< moves

  /// The look with all that was chosen.
  const VolumePictureOptions& look() const;
  /// One picture, or all of a turntable.
  void render(const UsePicture& use, Progress& progress);
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

/// Colours and normals of a surface in a volume.
struct SANSMESH_API SurfaceInVolumeLook {
  std::string color_by = {};               ///< an array of the volume, or a curvature: kCurvatureWords
  std::optional<double> color_range = {};  ///< curvature that gets the full colour (1 / length or 1 / length²)
  bool sharp = false;                      ///< normals turn sharply at edges and corners
  bool quick = false;                      ///< one ray a pixel, no shadows
  std::optional<int> frames = {};          ///< so many pictures around the up axis, 2 or more; default: one
  bool bar = true;                         ///< a colour bar, of `color_by`
  std::string unit = {};                   ///< of the array, or of lengths in curvatures, at the bar

  static const OptionSchema& schema();  ///< a row a field
  /// The curvature that colours show; nothing where they show none.
  std::optional<CurvatureQuantity> curvature() const;
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// The quantity that the colours show.
struct SANSMESH_API ShownColors {
  std::string array;                           ///< empty of curvatures
  std::optional<CurvatureQuantity> curvature;  ///< or an array
  double range = 0;                            ///< of the curvature that gets the full colour, in lengths of the input
  /// Of an array: its colours, and whether it has values below and above theirs on the surface.
  TransferFunction colors;
  BarEnds ends;  ///< of the colours

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Pictures of a surface in a volume, by rays and without a mesh. Built once; then pictures from anywhere.
class SANSMESH_API SurfaceInVolumePictures {
 public:
  /// Shares the surface and what it needs of the volume. Throws ArgumentError for bad options and names of no array,
  /// DataError, Cancelled. Notes of the fields are added to `notes`.
  SurfaceInVolumePictures(const SurfaceInVolume& surface, const VolumeModel& volume, const SurfaceInVolumeLook& look,
                          Progress& progress, std::vector<Note>& notes);
  ~SurfaceInVolumePictures();
  SurfaceInVolumePictures(SurfaceInVolumePictures&&) noexcept;  ///< moves

  /// Nothing without `color_by`.
  const std::optional<ShownColors>& colors() const;
  /// A picture; lengths and places of `options` as in the input.
  Image render(const SurfaceRenderOptions& options, Progress& progress) const;
  /// Of all pictures until now.
  CastCounts counts() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The numbers of pictures of a surface in a volume.
struct DrawnSurfaceInVolume {
  std::optional<ShownColors> colors;  ///< nothing without `color_by`
  CastCounts rays;                    ///< of all pictures
  std::vector<Note> notes;            ///< those of VolumeModel::field
};

/// One picture, or all of a turntable. Throws as SurfaceInVolumePictures, and ArgumentError where there is no room for
/// the bar.
SANSMESH_API DrawnSurfaceInVolume draw_surface_in_volume(const SurfaceInVolume& surface, const VolumeModel& volume,
                                                         const SurfaceInVolumeLook& look, const RenderOptions& picture,
                                                         const UsePicture& use, Progress& progress);

}  // namespace sansmesh::inline v1
