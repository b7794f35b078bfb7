// Pictures of volumes: what values look like, where a volume is cut open, and what came of a picture.
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

/// A control point of colours.
struct ColorPoint {
  double value = 0;                                                        ///< of the data
  Vec3f color;                                                             ///< sRGB 0..1
  friend bool operator==(const ColorPoint&, const ColorPoint&) = default;  ///< equal in all
};

/// A control point of opacities.
struct OpacityPoint {
  double value = 0;    ///< of the data
  double opacity = 0;  ///< 0..1: share of the light that a layer as thick as the reference length keeps back
  friend bool operator==(const OpacityPoint&, const OpacityPoint&) = default;  ///< equal in all
};

/// How colours are mixed between control points. `step`: not at all, each holds up to the next one.
enum class ColorMixing : std::uint8_t { rgb, lab, step };

/// Opacity 1 means this much: a light that nothing at all gets through would need an infinite extinction.
constexpr double kMostOpacity = 0.99999;

/// Piecewise linear in colour and in opacity; beyond the outermost points the values of these go on. Two points may
/// have the same value: the function jumps there.
struct SANSMESH_API TransferFunction {
  std::string name = {};                     ///< in files and lists
  std::vector<ColorPoint> colors = {};       ///< by value, ascending; at least one
  std::vector<OpacityPoint> opacities = {};  ///< by value, ascending; at least one
  ColorMixing mixing = ColorMixing::lab;     ///< of colours between points
  /// Length that opacities are meant for, in the unit of the data; default: a fiftieth of the volume's diagonal.
  std::optional<double> reference_length = {};

  Vec3f color(double value) const;     ///< sRGB
  double opacity(double value) const;  ///< 0..1
  /// Lowest and highest value of all control points.
  std::pair<double, double> range() const;
  /// The same function with its range moved linearly to another one.
  TransferFunction over(double lower, double upper) const;
  /// Throws ArgumentError: no points, not ascending, not finite, colours or opacities beyond 0..1.
  void validate() const;
  friend bool operator==(const TransferFunction&, const TransferFunction&) = default;  ///< equal in all
};

/// Names of transfer functions: "ct-bone", "ct-soft-tissue", "mr", "flow", "diverging", "gray".
SANSMESH_API std::span<const std::string_view> transfer_function_presets();

/// JSON of ours (docs/formats/transfer-function.md) or ParaView's colour maps (a list of objects with RGBPoints, of
/// which the first is taken). `file` is named in errors. Throws FileError.
SANSMESH_API TransferFunction parse_transfer_function(std::string_view json, const std::string& file);
/// The same of a file.
SANSMESH_API TransferFunction read_transfer_function(const std::string& file);
/// JSON of ours: what parse_transfer_function reads back the same.
SANSMESH_API std::string transfer_function_json(const TransferFunction& function);

/// Whether there are values beyond the range of a bar: they get the colours of its ends, which are then pointed.
struct BarEnds {
  bool below = false, above = false;  ///< the range
};

/// A surface of one value in a volume.
struct IsoSurface {
  double value = 0;                 ///< of the data
  std::optional<Vec3f> color = {};  ///< sRGB 0..1; default: that of the value by the transfer function
  double opacity = 1;               ///< 0..1
};

/// Takes away all x with offset < ⟨normal, x⟩ < offset + thickness: a half-space, or a slab.
struct VolumeCut {
  Vec3 normal{1, 0, 0};  ///< of any length but 0; offset and thickness are measured along its unit vector
  double offset = 0;     ///< in the unit and the coordinates of the data
  double thickness = std::numeric_limits<double>::infinity();  ///< of what is taken away; infinity: a half-space
};

/// "V", "V:COLOR", "V:COLOR:OPACITY" or "V::OPACITY", with COLOR as "#rrggbb". Throws ArgumentError.
SANSMESH_API IsoSurface iso_surface_of(const std::string& text);
/// As options of schemas (sansmesh/option.h): as iso_surface_of reads it, to the last digit.
SANSMESH_API std::string text_of_option(const IsoSurface& iso);
inline void option_of_text(std::string_view text, IsoSurface& iso) { iso = iso_surface_of(std::string(text)); }
/// What is taken away: "x>1.5", "y<0", "-1<z<2", or "NX,NY,NZ>OFFSET" for any direction. Throws ArgumentError.
SANSMESH_API VolumeCut volume_cut_of(const std::string& text);

/// Pictures of volumes.
struct SANSMESH_API VolumePictureOptions {
  RenderOptions picture = {};  ///< as of meshes; `shadows`, `ground` and `occlusion_rays` mean nothing here
  /// Colours and opacities; default: the preset, or what suits the values.
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

  /// The rows of most of these options, those of `picture` among them.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// How a picture of a volume came to be.
struct SANSMESH_API VolumePictureReport {
  TransferFunction transfer;  ///< that was used
  std::string why;            ///< it was taken, if it was suggested
  /// Lines on what may not be as wished: iso-surfaces of values that were not found in the volume, baked fields that
  /// are not as fine as they should be. Mostly none.
  std::vector<std::string> notes;
  std::uint64_t rays = 0, evaluations = 0;  ///< rays, and values asked of the field
  /// What steps of half the length would change, on one pixel in 256: mean and largest difference of a channel, in
  /// levels of 0..255. This is the error of the steps, apart from that of the field. Not found for `check_steps` false.
  double step_error_mean = 0, step_error_most = 0;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Error of baked fields above which bricks are split, if nothing is said: a share of the range of the values.
inline constexpr double kBakeError = 0.004;

/// How near a baked field is to the field that it stands for.
struct SANSMESH_API BakeReport {
  double least = 0, most = 0;  ///< of the values found in the volume
  /// At those of 20,000 points spread evenly over the box that are in the volume, and where fewer than one in 50 is, as
  /// many of the places, too; they are others than the points that decided what was split. Shares of the range. The
  /// largest is that of these points, no bound: between them the field may be farther off.
  double error_mean = 0, error_most = 0;
  std::size_t checked = 0;  ///< points that these errors were found at
  /// Largest at the middles of all cells in the volume, which decided; no bound either.
  double cell_error_most = 0;
  std::size_t bricks = 0, bytes = 0;  ///< that they take
  std::uint64_t evaluations = 0;      ///< of the field, so far
  int levels = 0;                     ///< of bricks
  /// Nothing is left to split: the tolerance holds, or cells are half the spacing, beyond which nothing is known, or
  /// as fine as it where splits did not help twice in a row (values that jump), or where only places tell of the
  /// volume. False: the memory was at its end, or refine() is to go on.
  bool finished = false;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

}  // namespace sansmesh::inline v1
