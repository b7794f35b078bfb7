#include "sansmesh/convert.h"

#include <algorithm>
#include <array>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

/// The first three rows of its matrix, one after the other.
template <>
struct schema_detail::Field<AffineMap> {
  static constexpr auto kind = OptionKind::numbers;
  static constexpr int count = 12;
  static OptionValue get(const AffineMap& m) {
    std::vector<double> rows;
    for (std::size_t k = 0; k < 3; ++k) rows.insert(rows.end(), {m.x[k], m.y[k], m.z[k], m.shift[k]});
    return rows;
  }
  static AffineMap from(const OptionValue& value) {
    const auto& n = std::get<std::vector<double>>(value);
    AffineMap m;
    for (std::size_t k = 0; k < 3; ++k)
      m.x[k] = n.at(4 * k), m.y[k] = n.at(4 * k + 1), m.z[k] = n.at(4 * k + 2), m.shift[k] = n.at(4 * k + 3);
    return m;
  }
};

namespace {

struct UnitOfLength {
  std::string_view name;
  double meters;
};
constexpr UnitOfLength kUnitsOfLength[] = {{"um", 1e-6}, {"mm", 1e-3},   {"cm", 1e-2},   {"m", 1},
                                           {"km", 1e3},  {"in", 0.0254}, {"ft", 0.3048}, {"us-ft", 1200.0 / 3937}};
constexpr OptionRange kSome = {1, 2'000'000'000};
constexpr std::string_view kUpAxes[] = {"y", "z"};

ArgumentError not_axes(std::string_view text) {
  return ArgumentError(ArgumentFault{.field = "axes",
                                     .value = "'" + printable(text, 60) + "'",
                                     .allowed = "x, y and z in some order, each with or without '-': x,-z,y",
                                     .remedy = {}});
}

void validate_fields(const OptionSchema& schema, void* step) {
  for_each_option(schema, step,
                  [](const OptionRow& row, void* owner) { set_option(row, owner, option_value(row, owner)); });
}

struct ValidateStep {
  template <class Step>
  void operator()(Step step) const {
    validate_fields(Step::schema(), &step);
    further(step);
  }

 private:
  template <class Step>
  void further(const Step&) const {}
  void further(const TransformStep& s) const {
    if (s.inverse) s.map.inverse();
  }
  void further(const RotateStep& s) const { AffineMap::rotation(s.axis, s.degrees); }
  void further(const ScaleStep& s) const {
    for (std::size_t k = 0; k < 3; ++k)
      if (s.factors[k] == 0) throw ArgumentError("`scale` by 0 flattens everything");
  }
  void further(const AxesStep& s) const { axes_map(s.axes); }
  void further(const UnitStep& s) const { meters_of_unit(s.from), meters_of_unit(s.to); }
  void further(const CropStep& s) const {
    if (s.box.empty()) throw ArgumentError("a box has the least x, y, z first, and the largest after them");
  }
};

}  // namespace

AffineMap axes_map(std::string_view text) {
  Vec3 row[3];
  std::size_t seen = 0;
  std::string_view rest = text;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t comma = rest.find(',');
    if ((comma == std::string_view::npos) != (k == 2)) throw not_axes(text);
    std::string_view axis = rest.substr(0, comma);
    rest = k < 2 ? rest.substr(comma + 1) : std::string_view();
    while (!axis.empty() && axis.front() == ' ') axis.remove_prefix(1);
    while (!axis.empty() && axis.back() == ' ') axis.remove_suffix(1);
    const bool minus = axis.starts_with('-');
    if (minus || axis.starts_with('+')) axis.remove_prefix(1);
    if (axis != "x" && axis != "y" && axis != "z") throw not_axes(text);
    const auto at = static_cast<std::size_t>(axis[0] - 'x');
    row[k][at] = minus ? -1 : 1;
    seen |= std::size_t{1} << at;
  }
  if (seen != 7) throw not_axes(text);
  return {{row[0].x, row[1].x, row[2].x}, {row[0].y, row[1].y, row[2].y}, {row[0].z, row[1].z, row[2].z}, {}};
}

double meters_of_unit(std::string_view name) {
  std::string known;
  for (const UnitOfLength& u : kUnitsOfLength) {
    if (name == u.name) return u.meters;
    known += (known.empty() ? "" : ", ") + std::string(u.name);
  }
  throw ArgumentError(ArgumentFault{
      .field = "unit", .value = "'" + printable(name, 60) + "'", .allowed = "one of " + known, .remedy = {}});
}

std::string_view step_name(const ConvertStep& step) {
  struct Name {
    std::string_view operator()(const TransformStep& s) const { return s.inverse ? "inverse_transform" : "transform"; }
    std::string_view operator()(const TranslateStep&) const { return "translate"; }
    std::string_view operator()(const CenterStep&) const { return "center"; }
    std::string_view operator()(const RotateStep&) const { return "rotate"; }
    std::string_view operator()(const ScaleStep&) const { return "scale"; }
    std::string_view operator()(const AxesStep&) const { return "new_axes"; }
    std::string_view operator()(const UpStep&) const { return "up"; }
    std::string_view operator()(const UnitStep&) const { return "to_unit"; }
    std::string_view operator()(const CropStep& s) const { return s.inside ? "box" : "outside_box"; }
    std::string_view operator()(const SpacingStep&) const { return "point_spacing"; }
    std::string_view operator()(const CountStep&) const { return "point_count"; }
    std::string_view operator()(const EveryStep&) const { return "every"; }
    std::string_view operator()(const ChooseStep& s) const { return s.keep ? "keep" : "drop"; }
    std::string_view operator()(const WeldStep&) const { return "weld"; }
    std::string_view operator()(const FlipStep& s) const {
      return s.faces ? (s.normals ? "flip" : "flip_faces") : "flip_normals";
    }
  };
  return std::visit(Name(), step);
}

void validate_step(const ConvertStep& step) { std::visit(ValidateStep(), step); }

const OptionSchema& TransformStep::schema() {
  using O = TransformStep;
  static constexpr OptionRow rows[] = {option<&O::map>({.text = "3 rows of 4 numbers", .name = "matrix"}),
                                       option<&O::inverse>({.text = "By its inverse"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

const OptionSchema& TranslateStep::schema() {
  static constexpr OptionRow rows[] = {option<&TranslateStep::by>({.text = "How far", .unit = "length"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

const OptionSchema& CenterStep::schema() {
  static constexpr OptionSchema schema{{}};
  return schema;
}

const OptionSchema& RotateStep::schema() {
  using O = RotateStep;
  static constexpr OptionRow rows[] = {
      option<&O::axis>({.text = "Axis"}), option<&O::degrees>({.text = "Angle", .unit = "degrees"}),
      option<&O::about>({.text = "What stays where it is", .unit = "length", .from_data = "0,0,0"}),
      option<&O::about_center>({.text = "The middle of the box stays where it is", .excludes = "about"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

const OptionSchema& ScaleStep::schema() {
  using O = ScaleStep;
  static constexpr OptionRow rows[] = {
      option<&O::factors>({.text = "A factor for each axis, none of them 0"}),
      option<&O::about>({.text = "What stays where it is", .unit = "length", .from_data = "0,0,0"}),
      option<&O::about_center>({.text = "The middle of the box stays where it is", .excludes = "about"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

const OptionSchema& AxesStep::schema() {
  static constexpr OptionRow rows[] = {
      option<&AxesStep::axes>({.text = "Which axes the new x, y and z are, such as x,-z,y"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

const OptionSchema& UpStep::schema() {
  static constexpr OptionRow rows[] = {option<&UpStep::to>({.text = "The axis that points up", .choices = kUpAxes})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

const OptionSchema& UnitStep::schema() {
  using O = UnitStep;
  static constexpr OptionRow rows[] = {option<&O::from>({.text = "Unit of lengths before"}),
                                       option<&O::to>({.text = "Unit of lengths after"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

const OptionSchema& CropStep::schema() {
  using O = CropStep;
  static constexpr OptionRow rows[] = {option<&O::box>({.text = "Least and largest coordinates", .unit = "length"}),
                                       option<&O::inside>({.text = "What lies in it, or else outside"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

const OptionSchema& SpacingStep::schema() {
  static constexpr OptionRow rows[] = {
      option<&SpacingStep::distance>({.text = "Least distance", .unit = "length", .range = positive()})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

const OptionSchema& CountStep::schema() {
  static constexpr OptionRow rows[] = {option<&CountStep::count>({.text = "Points that stay", .range = kSome})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

const OptionSchema& EveryStep::schema() {
  static constexpr OptionRow rows[] = {
      option<&EveryStep::every>({.text = "Points of which the first stays", .range = kSome})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

const OptionSchema& ChooseStep::schema() {
  using O = ChooseStep;
  static constexpr OptionRow rows[] = {option<&O::names>({.text = "normals, colors and names of attributes"}),
                                       option<&O::keep>({.text = "Only these, or else all but these"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

const OptionSchema& WeldStep::schema() {
  static constexpr OptionRow rows[] = {
      option<&WeldStep::distance>({.text = "Largest distance", .unit = "length", .range = at_least(0)})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

const OptionSchema& FlipStep::schema() {
  using O = FlipStep;
  static constexpr OptionRow rows[] = {option<&O::faces>({.text = "Turn faces over"}),
                                       option<&O::normals>({.text = "Turn normals round"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

}  // namespace sansmesh::inline v1
