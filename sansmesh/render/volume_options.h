// What a picture of a volume is to look like.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/render/render_options.h"
#include "sansmesh/render/transfer_function.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct IsoSurface {
  double value = 0;
  std::optional<Vec3f> color;  ///< sRGB 0..1; default: that of the value by the transfer function
  double opacity = 1;          ///< 0..1
};

/// Takes away all x with offset < ⟨normal, x⟩ < offset + thickness: a half-space, or a slab.
struct VolumeCut {
  Vec3 normal{1, 0, 0};  ///< of any length but 0; offset and thickness are measured along its unit vector
  double offset = 0;     ///< in the unit and the coordinates of the data
  double thickness = std::numeric_limits<double>::infinity();
};

/// "V", "V:COLOR", "V:COLOR:OPACITY" or "V::OPACITY", with COLOR as "#rrggbb". Throws ArgumentError.
IsoSurface iso_surface_of(const std::string& text);
/// As options of schemas (sansmesh/option.h): as iso_surface_of reads it, to the last digit.
std::string text_of_option(const IsoSurface& iso);
inline void option_of_text(std::string_view text, IsoSurface& iso) { iso = iso_surface_of(std::string(text)); }
/// What is taken away: "x>1.5", "y<0", "-1<z<2", or "NX,NY,NZ>OFFSET" for any direction. Throws ArgumentError.
VolumeCut volume_cut_of(const std::string& text);

/// Pictures of volumes.
struct VolumePictureOptions {
  RenderOptions picture = {};  ///< as of meshes; `shadows`, `ground` and `occlusion_rays` mean nothing here
  /// Colours and opacities; default: the preset, or what suggest_transfer_function says.
  std::optional<TransferFunction> transfer = {};
  /// A name of transfer_function_presets(); not beside `transfer`. Its opacities lie over the values of the field that
  /// gives the opacities.
  std::string preset = {};
  double opacity_factor = 1;          ///< extinction is multiplied by this, 0..1000; 0: iso-surfaces and cut faces only
  std::vector<IsoSurface> isos = {};  ///< of the field that gives the colours; at most 16
  std::vector<VolumeCut> clips = {};  ///< at most 16
  /// Cut faces show their values, except such as the transfer function leaves clear. Those of gaps in a deformed
  /// volume that is seen by its iso-surfaces only: what is not below the least of these.
  bool clip_faces = true;
  bool shading = true;  ///< light on the gradients; without, colours are those of the transfer function
  /// Length of steps in local distances of samples, 0.05..4; between two samples the value is a cubic.
  double step = 1;
  /// What is left of the light behind where a ray ends, 0..0.1.
  double least_light = 0.002;
  bool skip_empty = true;  ///< leaps over what is clear

  bool color_bar = false;        ///< to the right of the picture, which it makes wider
  std::string color_title = {};  ///< of the colour bar: what is shown and its unit
  bool axes = false;             ///< the outline of the box with ticks
  std::string unit = {};         ///< of lengths, at the axes
  std::string title = {};        ///< above the picture

  /// Some of those that `picture` does not have.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

}  // namespace sansmesh::inline v1
