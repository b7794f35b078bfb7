// Pictures of flow surfaces with streaks along the flow.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/flow.h"
#include "sansmesh/image.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/render_options.h"
#include "sansmesh/report.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::inline v1 {

/// Options of pictures of flow surfaces.
struct SANSMESH_API FlowPictureOptions {
  TraceSurfaceOptions trace = {};  ///< the surface

  bool textured = true;             ///< draws streaks along the flow
  FlowTextureOptions streaks = {};  ///< `phase` follows from the frame
  bool splats = false;              ///< draws particles as blended discs instead of the mesh
  double opacity = 1;               ///< opacity of the surface seen perpendicularly, 0..1
  std::optional<double> arrows =
      {};                          ///< draws arrows along the flow at this distance (length); 0: derived from the size
  std::string color_by = "time";   ///< time, speed, seed, none, or an array of a steady volume
  std::optional<int> frames = {};  ///< number of frames, in which the streaks move with the flow; default: one picture
  double turn = 0;                 ///< rotation of the view over the frames in degrees, −3600..3600

  std::string volume_array = {};      ///< array of a steady volume that is rendered around the surface
  std::string preset = {};            ///< its colours and opacities
  double opacity_factor = 1;          ///< factor of its opacity
  std::vector<IsoSurface> isos = {};  ///< iso-surfaces of that array, or else of the speed

  bool bar = true;             ///< draws colour bars
  std::string label = {};      ///< label of the surface's bar; default: `color_by`
  std::string unit = {};       ///< unit of the displayed quantity
  std::string title = {};      ///< title above the picture
  RenderOptions picture = {};  ///< its width includes the bars
  bool default_view = true;    ///< no view was chosen: the view of a single layer is perpendicular to it

  /// Option rows, those of `picture` included.
  static const OptionSchema& schema();
  /// Throws ArgumentError for bad options and for options that exclude each other.
  void validate() const;
  /// Whether a volume is rendered around the surface.
  bool in_volume() const { return !volume_array.empty() || !isos.empty(); }
};

/// Result of flow_pictures().
struct SANSMESH_API FlowPicturesResult {
  FlowSurfaceReport surface;  ///< report of the surface
  int width = 0, height = 0;  ///< size of each picture
  std::vector<Note> notes;    ///< those of trace_surface; "reconstruction"

  static const ReportSchema& schema();  ///< report rows
};

/// Throws ArgumentError early for arrays that the flow does not have.
SANSMESH_API void check_colors(const FlowModel& flow, const FlowPictureOptions& options);

/// Draws a picture, or frames, each passed to `use` as it is made. `beside`: further surfaces in the same picture.
/// Throws ArgumentError for bad options, DataError that begins with the flow's source; Cancelled.
SANSMESH_API FlowPicturesResult flow_pictures(const FlowModel& flow, const FlowPictureOptions& options,
                                              std::vector<SceneFactory> beside, const UsePicture& use,
                                              Progress& progress);

}  // namespace sansmesh::inline v1
