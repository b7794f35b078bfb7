// Pictures of volumes and of surfaces in volumes.
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

/// Options of pictures of an open volume.
struct SANSMESH_API VolumePicturesOptions {
  VolumePictureOptions look = {};  ///< look of the volume
  std::string opacity_by = {};     ///< array of the opacities; the volume's own array has the colours
  bool grid = false;               ///< also draws cell edges on the boundary of the volume
  bool quick = false;              ///< one ray per pixel, steps of 1.5 spacings, up to a hundredth of the light
  bool baked = false;              ///< as `quick`, through a field baked into bricks
  double bake_error = kBakeError;  ///< for `baked`: error as a share of the range above which bricks are split
  bool bar = true;                 ///< draws a colour bar
  std::string unit = {};           ///< unit of the array at the colour bar
  bool default_view = true;        ///< no view was chosen: the view of a single layer is perpendicular to it
  std::optional<int> frames = {};  ///< number of pictures of a turntable about the up axis, 2 or more; default: one

  /// Option rows, with the own rows of `look`, without `default_view`.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Renders an open volume from any viewpoint. Not thread-safe.
class SANSMESH_API VolumePictures {
 public:
  /// Uses the array that the volume was opened with (the length of vectors). `surfaces` are in the same pictures.
  /// Throws ArgumentError for bad options and unknown arrays, DataError if there is nothing to draw, Cancelled.
  VolumePictures(const VolumeModel& volume, const VolumePicturesOptions& options, std::vector<SceneFactory> surfaces,
                 Progress& progress);
  ~VolumePictures();
  VolumePictures(VolumePictures&&) noexcept;  ///< move

  /// The look with all derived values.
  const VolumePictureOptions& look() const;
  /// Draws one picture, or all of a turntable.
  void render(const UsePicture& use, Progress& progress);
  /// Draws a picture from another view.
  Image render(const ViewDirection& view, Progress& progress);
  /// Report of the last picture.
  const VolumePictureReport& report() const;
  /// Report of baking; null if not baked.
  const BakeReport* baked() const;
  /// Those of VolumeModel::field, and "picture": limitations of the last picture.
  std::vector<Note> notes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Colours and normals of a surface in a volume.
struct SANSMESH_API SurfaceInVolumeLook {
  std::string color_by = {};               ///< array of the volume, or a curvature: kCurvatureWords
  std::optional<double> color_range = {};  ///< curvature with the full colour (1 / length or 1 / length²)
  bool sharp = false;                      ///< normals change abruptly at edges and corners
  bool quick = false;                      ///< one ray per pixel, no shadows
  std::optional<int> frames = {};  ///< number of pictures of a turntable about the up axis, 2 or more; default: one
  bool bar = true;                 ///< draws a colour bar for `color_by`
  std::string unit = {};           ///< unit at the bar: of the array, or of lengths in curvatures

  static const OptionSchema& schema();  ///< option rows, one per field
  /// The curvature shown by colours, if any.
  std::optional<CurvatureQuantity> curvature() const;
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Quantity shown by colours.
struct SANSMESH_API ShownColors {
  std::string array;                           ///< empty for curvatures
  std::optional<CurvatureQuantity> curvature;  ///< empty for arrays
  double range = 0;                            ///< curvature with the full colour, in lengths of the input
  /// For an array: its colours.
  TransferFunction colors;
  BarEnds ends;  ///< whether the surface has values beyond the ends of the colours

  static const ReportSchema& schema();  ///< report rows
};

/// Renders a surface in a volume from any viewpoint by ray casting, without a mesh.
class SANSMESH_API SurfaceInVolumePictures {
 public:
  /// Shares the surface and the data of the volume. Adds notes of the fields to `notes`. Throws ArgumentError for bad
  /// options and unknown arrays, DataError, Cancelled.
  SurfaceInVolumePictures(const SurfaceInVolume& surface, const VolumeModel& volume, const SurfaceInVolumeLook& look,
                          Progress& progress, std::vector<Note>& notes);
  ~SurfaceInVolumePictures();
  SurfaceInVolumePictures(SurfaceInVolumePictures&&) noexcept;  ///< move

  /// Empty without `color_by`.
  const std::optional<ShownColors>& colors() const;
  /// Draws a picture; lengths and positions of `options` as in the input.
  Image render(const SurfaceRenderOptions& options, Progress& progress) const;
  /// Counts of all pictures so far.
  CastCounts counts() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Report of pictures of a surface in a volume.
struct DrawnSurfaceInVolume {
  std::optional<ShownColors> colors;  ///< empty without `color_by`
  CastCounts rays;                    ///< rays of all pictures
  std::vector<Note> notes;            ///< those of VolumeModel::field
};

/// Draws one picture, or all of a turntable. Throws as SurfaceInVolumePictures, and ArgumentError if the bar does not
/// fit.
SANSMESH_API DrawnSurfaceInVolume draw_surface_in_volume(const SurfaceInVolume& surface, const VolumeModel& volume,
                                                         const SurfaceInVolumeLook& look, const RenderOptions& picture,
                                                         const UsePicture& use, Progress& progress);

}  // namespace sansmesh::inline v1
