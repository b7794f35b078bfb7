// What `sansmesh render` was asked for.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cloud_input.h"
#include "console.h"
#include "option_groups.h"
#include "picture_objects.h"
#include "sansmesh/render/surface_picture.h"
#include "surface_options.h"

namespace sansmesh::cli {

/// The attribute, and what --color-by calls it.
inline constexpr const char* kConfidence = "confidence";

struct RenderArguments {
  CloudInput input;
  std::string output;
  PictureArguments picture;
  std::string background = "gradient";
  CloudUse cloud;               ///< what is done to the samples
  SurfaceArguments of_samples;  ///< of --surface: cast rays at a surface of the samples

  SurfaceRenderOptions options;           ///< what a surface without a mesh has beyond `picture`; complete once chosen
  std::optional<SurfaceOptions> surface;  ///< of `of_samples`, once chosen
  std::string color_by;               ///< confidence, curvature or an attribute as colour; else the samples' colours
  std::optional<double> color_range;  ///< curvature with the full colour
  std::optional<std::pair<double, double>> value_range;  ///< of an attribute: what gets the colours at the ends
  std::string unit;                                      ///< of lengths, or of the attribute: at the bar of colours
  bool no_bar = false;
  ObjectLooks objects;
  std::optional<bool> stored_rays;    ///< of a projection: rays start from polynomials stored with the samples
  std::optional<std::size_t> splats;  ///< so many points of the surface as splats that blend; 0: as many as suit it
  int frames = 0;                     ///< of a turntable; 0: one picture
  // Once complete:
  bool separate = false;  ///< objects stand side by side in the picture
  bool of_lines = false;  ///< the one object is lines (.vtp)

  /// Several files that are read as one.
  bool joined() const { return objects.as_one && input.files.size() > 1; }
  std::size_t objects_drawn() const { return joined() || surface || splats ? 1 : input.files.size(); }
  /// Puts together what was chosen. Throws ArgumentError for options that would not be heeded.
  void complete();
  /// The same for those that no object of these kinds heeds.
  void check_kinds(const std::vector<ObjectKind>& kinds) const;
};

/// Removes samples that belong to no surface, and says how many.
void leave_out_outliers(PointSet& points, const std::string& name, Console& console);

/// Samples that have been read already.
struct ReadCloud {
  PointSet points;
  ReadReport read;
};

/// A picture straight from samples or of a function. The arguments are complete. Crests of a cloud that is given are
/// those of estimates at its samples, else those of the surface.
void run_surface_picture(const RenderArguments& arguments, Console& console, std::optional<ReadCloud> cloud = {});

}  // namespace sansmesh::cli
