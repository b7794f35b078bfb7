// Pictures of surfaces of a flow, with streaks that run along it.
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

/// Pictures of surfaces of a flow, with streaks that run along it.
struct SANSMESH_API FlowPictureOptions {
  TraceSurfaceOptions trace = {};  ///< the surface

  bool textured = true;               ///< with streaks along the flow
  FlowTextureOptions streaks = {};    ///< its `phase` follows from the frame
  bool splats = false;                ///< particles as discs that blend, not the mesh
  double opacity = 1;                 ///< of the surface where it is seen at right angles, 0..1
  std::optional<double> arrows = {};  ///< along the flow, so far apart (length); 0: as its size suggests
  std::string color_by = "time";      ///< time, speed, seed, none, or an array of a steady volume
  std::optional<int> frames = {};     ///< so many, in which the streaks move with the flow; default: one picture
  double turn = 0;                    ///< degrees that the view goes around in them, −3600..3600

  std::string volume_array = {};      ///< array of a steady volume that is seen through around it
  std::string preset = {};            ///< its colours and opacities
  double opacity_factor = 1;          ///< multiplies its opacity
  std::vector<IsoSurface> isos = {};  ///< of that array, else of the speed

  bool bar = true;             ///< colour bars
  std::string label = {};      ///< of that of the surface; default: `color_by`
  std::string unit = {};       ///< of what is shown
  std::string title = {};      ///< above the picture
  RenderOptions picture = {};  ///< its width is that of picture and bars together
  bool any_view = true;        ///< nobody chose the view: that of a single layer looks straight at it

  /// The rows of these options, those of `picture` among them.
  static const OptionSchema& schema();
  /// Throws ArgumentError for bad options, and for such as mean nothing together.
  void validate() const;
  /// Whether a volume is seen through around the surface.
  bool in_volume() const { return !volume_array.empty() || !isos.empty(); }
};

/// Outcome of flow_pictures().
struct SANSMESH_API FlowPicturesResult {
  FlowSurfaceReport surface;  ///< of the surface itself
  int width = 0, height = 0;  ///< of each picture
  std::vector<Note> notes;    ///< those of trace_surface; "reconstruction"

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Throws ArgumentError for what the flow has not, before long work.
SANSMESH_API void check_colors(const FlowModel& flow, const FlowPictureOptions& options);

/// A picture, or frames of one, each handed over as it is made. `beside`: what stands in the same picture. Throws
/// ArgumentError for bad options, DataError that begins with the flow's source; Cancelled.
SANSMESH_API FlowPicturesResult flow_pictures(const FlowModel& flow, const FlowPictureOptions& options,
                                              std::vector<SceneFactory> beside, const UsePicture& use,
                                              Progress& progress);

}  // namespace sansmesh::inline v1
