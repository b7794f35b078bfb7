// Transfer functions, cuts, iso-surfaces, options and reports of pictures of volumes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/option.h"
#include "sansmesh/render_options.h"
#include "sansmesh/report.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Control point of colours.
struct ColorPoint {
  double value = 0;                                                        ///< data value
  Vec3f color;                                                             ///< sRGB 0..1
  friend bool operator==(const ColorPoint&, const ColorPoint&) = default;  ///< equal in all fields
};

/// Control point of opacities.
struct OpacityPoint {
  double value = 0;    ///< data value
  double opacity = 0;  ///< 0..1: share of light that a layer of the reference length absorbs
  friend bool operator==(const OpacityPoint&, const OpacityPoint&) = default;  ///< equal in all fields
};

/// Interpolation of colours between control points. `step`: piecewise constant, each colour holds up to the next point.
enum class ColorMixing : std::uint8_t { rgb, lab, step };

/// Value that opacity 1 is clamped to, because full opacity would need infinite extinction.
constexpr double kMostOpacity = 0.99999;

/// Piecewise linear colour and opacity, constant beyond the outermost points. Two points may have the same value: the
/// function jumps there.
struct SANSMESH_API TransferFunction {
  std::string name = {};                     ///< used in files and lists
  std::vector<ColorPoint> colors = {};       ///< ascending by value; at least one
  std::vector<OpacityPoint> opacities = {};  ///< ascending by value; at least one
  ColorMixing mixing = ColorMixing::lab;     ///< interpolation of colours
  /// Length to which opacities refer, in the unit of the data; default: a fiftieth of the volume's diagonal.
  std::optional<double> reference_length = {};

  Vec3f color(double value) const;     ///< sRGB
  double opacity(double value) const;  ///< 0..1
  /// Lowest and highest value of all control points.
  std::pair<double, double> range() const;
  /// The same function with its range mapped linearly to another one.
  TransferFunction over(double lower, double upper) const;
  /// Throws ArgumentError if points are missing, not ascending or not finite, or colours or opacities are outside 0..1.
  void validate() const;
  friend bool operator==(const TransferFunction&, const TransferFunction&) = default;  ///< equal in all fields
};

/// Names of transfer functions: "ct-bone", "ct-soft-tissue", "mr", "flow", "diverging", "gray".
SANSMESH_API std::span<const std::string_view> transfer_function_presets();

/// Parses this library's JSON (docs/formats/transfer-function.md) or ParaView's colour maps (a list of objects with
/// RGBPoints; the first is used). Errors name `file`. Throws FileError.
SANSMESH_API TransferFunction parse_transfer_function(std::string_view json, const std::string& file);
/// Reads the same from a file.
SANSMESH_API TransferFunction read_transfer_function(const std::string& file);
/// This library's JSON; parse_transfer_function() restores the same function.
SANSMESH_API std::string transfer_function_json(const TransferFunction& function);

/// Whether values exceed the range of a colour bar. They have the colours of its ends, which are then pointed.
struct BarEnds {
  bool below = false, above = false;  ///< the range
};

/// Iso-surface in a volume.
struct IsoSurface {
  double value = 0;                 ///< data value
  std::optional<Vec3f> color = {};  ///< sRGB 0..1; default: the colour of the transfer function
  double opacity = 1;               ///< 0..1
};

/// Removes all x with offset < ⟨normal, x⟩ < offset + thickness: a half-space or a slab.
struct VolumeCut {
  Vec3 normal{1, 0, 0};  ///< any length but 0; offset and thickness are measured along its unit vector
  double offset = 0;     ///< in the unit and the coordinates of the data
  double thickness =
      std::numeric_limits<double>::infinity();  ///< thickness of the removed slab; infinity: a half-space
};

/// Parses "V", "V:COLOR", "V:COLOR:OPACITY" or "V::OPACITY", with COLOR as "#rrggbb". Throws ArgumentError.
SANSMESH_API IsoSurface iso_surface_of(const std::string& text);
/// Conversions for option schemas (sansmesh/option.h), in the notation of iso_surface_of(), exact to the last digit.
SANSMESH_API std::string text_of_option(const IsoSurface& iso);
inline void option_of_text(std::string_view text, IsoSurface& iso) { iso = iso_surface_of(std::string(text)); }
/// Parses the removed part: "x>1.5", "y<0", "-1<z<2", or "NX,NY,NZ>OFFSET" for any direction. Throws ArgumentError.
SANSMESH_API VolumeCut volume_cut_of(const std::string& text);

/// Options of pictures of volumes.
struct SANSMESH_API VolumePictureOptions {
  RenderOptions picture = {};  ///< as for meshes; `shadows`, `ground` and `occlusion_rays` are ignored
  /// Colours and opacities; default: the preset, or a suggestion that suits the values.
  std::optional<TransferFunction> transfer = {};
  /// A name of transfer_function_presets(); not with `transfer`. Its opacities span the values of the field that gives
  /// the opacities.
  std::string preset = {};
  double opacity_factor = 1;          ///< multiplies extinction, 0..1000; 0: only iso-surfaces and cut faces
  std::vector<IsoSurface> isos = {};  ///< iso-surfaces of the field that gives the colours; at most 16
  std::vector<VolumeCut> clips = {};  ///< at most 16
  /// Cut faces show their values, except those that the transfer function makes clear. If only iso-surfaces are
  /// visible, faces of gaps in a deformed volume show the values that are not below the least iso-value.
  bool clip_faces = true;
  bool shading = true;  ///< shading by gradients; false: the plain colours of the transfer function
  /// Step length in units of the local sample spacing, 0.05..4; between two steps the value is a cubic.
  double step = 1;
  /// A ray ends when the transmitted share of the light behind falls below this, 0..0.1.
  double least_light = 0.002;
  bool skip_empty = true;  ///< skips clear cells
  /// Estimated error of a pixel's mean light, in levels of 255, above which it gets more of its samples, 0..255. 0: all
  /// pixels have all.
  double pixel_error = 0.4;

  bool color_bar = false;        ///< adds a colour bar to the right; the picture becomes wider
  std::string color_title = {};  ///< quantity and unit, for the colour bar
  bool axes = false;             ///< the outline of the box with ticks
  std::string unit = {};         ///< unit of lengths, for the axes
  std::string title = {};        ///< above the picture

  /// The rows of most of these options, including those of `picture`.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Report of a picture of a volume.
struct SANSMESH_API VolumePictureReport {
  TransferFunction transfer;  ///< the function used
  std::string why;            ///< reason for it, if it was suggested
  /// Remarks on the result: iso-values that do not occur in the volume, baked fields that are too coarse. Usually
  /// empty.
  std::vector<std::string> notes;
  std::uint64_t rays = 0, evaluations = 0;  ///< rays, and evaluations of the field
  /// Estimated error of the step length: mean and largest change of a channel if steps are halved, on one pixel in 256,
  /// in levels of 0..255. It does not include the error of the field. Computed only if `check_steps` is true.
  double step_error_mean = 0, step_error_most = 0;

  static const ReportSchema& schema();  ///< one row per value
};

/// Default error of baked fields above which bricks are split, as a share of the range of the values.
inline constexpr double kBakeError = 0.004;

/// Accuracy of a baked field.
struct SANSMESH_API BakeReport {
  double least = 0, most = 0;  ///< range of the values found in the volume
  /// Errors as shares of the range, at those of 20,000 points spread evenly over the box that are in the volume; if
  /// fewer than one in 50 is, also at as many of the samples. These points differ from those that decide on splits. The
  /// largest is an estimate, not a bound.
  double error_mean = 0, error_most = 0;
  std::size_t checked = 0;  ///< number of points of these errors
  /// Largest error at the centres of all cells in the volume, which decides on splits; an estimate, not a bound.
  double cell_error_most = 0;
  std::size_t bricks = 0, bytes = 0;  ///< size of the baked field
  std::uint64_t evaluations = 0;      ///< evaluations of the field so far
  int levels = 0;                     ///< levels of bricks
  /// No brick is left to split: the tolerance holds, or cells are half the spacing (beyond which nothing is known), or
  /// cells are as fine as the spacing and either two splits in a row did not help (values that jump) or only samples
  /// show where the volume is. False: the memory limit was reached, or refine() is to continue.
  bool finished = false;

  static const ReportSchema& schema();  ///< one row per value
};

}  // namespace sansmesh::inline v1
