// What `sansmesh render` was asked for.
#pragma once

#include <optional>
#include <string>
#include <utility>

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
  bool flat = false, no_shadows = false;
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
  bool stored_rays = false;           ///< of a projection: rays start from polynomials stored with the samples
  std::optional<std::size_t> splats;  ///< so many points of the surface as splats that blend; 0: as many as suit it
  int frames = 0;                     ///< of a turntable; 0: one picture
  bool separate = false;              ///< once chosen: each file is an object of its own in the picture
};

/// Samples that have been read already.
struct ReadCloud {
  PointSet points;
  ReadReport read;
};

/// A picture straight from samples or of a function. The arguments are complete. Crests of a cloud that is given are
/// those of estimates at its samples, else those of the surface.
void run_surface_picture(const RenderArguments& arguments, Console& console, std::optional<ReadCloud> cloud = {});

}  // namespace sansmesh::cli
