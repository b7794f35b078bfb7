// What a conversion does to a cloud or a mesh: one struct a step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sansmesh/affine_map.h"
#include "sansmesh/box.h"
#include "sansmesh/option.h"

namespace sansmesh::inline v1 {

/// What follows turns and scales about this, unless it says so itself: "about".
struct AboutStep {
  std::optional<Vec3> place = {};  ///< default: 0
  bool center = false;             ///< the middle of the box as it then is
  static const OptionSchema& schema();
};
/// By a map or its inverse: "transform", "inverse_transform".
struct TransformStep {
  AffineMap map = {};
  bool inverse = false;
  static const OptionSchema& schema();
};
/// Loses no digit, however far: "translate".
struct TranslateStep {
  Vec3 by = {};
  static const OptionSchema& schema();
};
/// The middle of the box around everything goes to 0: "center".
struct CenterStep {
  static const OptionSchema& schema();
};
/// About an axis, counter-clockwise: "rotate".
struct RotateStep {
  Vec3 axis = {0, 0, 1};
  double degrees = 0;
  std::optional<Vec3> about = {};  ///< what stays where it is; default: 0
  bool about_center = false;       ///< the middle of the box as it then is
  static const OptionSchema& schema();
};
/// By a factor for each axis, none of them 0; negative ones mirror, and turn faces over: "scale".
struct ScaleStep {
  Vec3 factors = {1, 1, 1};
  std::optional<Vec3> about = {};  ///< as in RotateStep
  bool about_center = false;
  static const OptionSchema& schema();
};
/// "y,x,z" swaps two (a mirror image), "x,-z,y" turns y up into z up: "axes".
struct AxesStep {
  std::string axes = "x,y,z";
  static const OptionSchema& schema();
};
enum class StepUp : std::uint8_t { y, z };
/// To z: what pointed up along y points up along z; to y: the other way: "up".
struct UpStep {
  StepUp to = StepUp::z;
  static const OptionSchema& schema();
};
/// Units of lengths, of before and after: um, mm, cm, m, km, in, ft, us-ft: "to_unit".
struct UnitStep {
  std::string from = {};  ///< default: ConvertOptions::unit
  std::string to = "m";
  static const OptionSchema& schema();
};
/// What lies in the box, or outside of it; meshes are cut along it: "crop", "crop_out".
struct CropStep {
  Box3 box = {};
  bool inside = true;
  static const OptionSchema& schema();
};
/// Fewer points: no two closer than this, and none missing that would be farther from all (length, > 0): "spacing".
struct SpacingStep {
  double distance = 0;
  static const OptionSchema& schema();
};
/// Fewer points: so many, drawn by chance, always the same ones: "count".
struct CountStep {
  std::size_t count = 0;
  static const OptionSchema& schema();
};
/// Fewer points: the first of every so many: "every".
struct EveryStep {
  std::size_t every = 0;
  static const OptionSchema& schema();
};
/// Of normals, colors and attributes only these, or all but these: "keep", "drop".
struct ChooseStep {
  std::vector<std::string> names = {};
  bool keep = true;
  static const OptionSchema& schema();
};
/// Vertices (or points) no farther from each other than this become one (length; 0: at the same place): "weld".
struct WeldStep {
  double distance = 0;
  static const OptionSchema& schema();
};
/// Faces turned over, normals turned round: "flip", "flip_faces", "flip_normals".
struct FlipStep {
  bool faces = true, normals = true;
  static const OptionSchema& schema();
};

using ConvertStep =
    std::variant<AboutStep, TransformStep, TranslateStep, CenterStep, RotateStep, ScaleStep, AxesStep, UpStep, UnitStep,
                 CropStep, SpacingStep, CountStep, EveryStep, ChooseStep, WeldStep, FlipStep>;

/// What may be done, as the options of a list of steps.
std::span<const OptionRow> convert_step_rows();

/// "crop_out".
std::string_view step_name(const ConvertStep& step);
/// Throws ArgumentError.
void validate_step(const ConvertStep& step);

/// "x,-z,y": the axes whose coordinates the new x, y and z are. Throws ArgumentError.
AffineMap axes_map(std::string_view axes);
/// Of um, mm, cm, m, km, in, ft and us-ft. Throws ArgumentError that names them.
double meters_of_unit(std::string_view unit);

}  // namespace sansmesh::inline v1
