#include "sansmesh/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "sansmesh/core/option_text.h"
#include "sansmesh/error.h"
#include "sansmesh/io/transform_file.h"

namespace sansmesh::inline v1 {

/// The first three rows of the matrix, row by row.
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
                                     .allowed = "x, y and z in some order, each with or without '-': x,-z,y"});
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
      if (s.factors[k] == 0) throw ArgumentError("`scale` by 0 makes everything flat");
  }
  void further(const AxesStep& s) const { axes_map(s.axes); }
  void further(const UnitStep& s) const {
    if (!s.from.empty()) meters_of_unit(s.from);
    meters_of_unit(s.to);
  }
  void further(const CropStep& s) const {
    if (s.box.empty()) throw ArgumentError("a box has the least x,y,z first, then the largest");
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
  std::vector<std::string_view> known;
  for (const UnitOfLength& u : kUnitsOfLength) {
    if (name == u.name) return u.meters;
    known.push_back(u.name);
  }
  throw ArgumentError(ArgumentFault{.field = "unit",
                                    .value = "'" + printable(name, 60) + "'",
                                    .allowed = fmt::format("one of {}", fmt::join(known, ", "))});
}

std::string_view step_name(const ConvertStep& step) {
  struct Name {
    std::string_view operator()(const AboutStep&) const { return "about"; }
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
    std::string_view operator()(const ClassifyGroundStep&) const { return "classify_ground"; }
  };
  return std::visit(Name(), step);
}

void validate_step(const ConvertStep& step) { std::visit(ValidateStep(), step); }

const OptionSchema& AboutStep::schema() {
  using O = AboutStep;
  static constexpr OptionRow rows[] = {
      option<&O::fixed_point>({.text = "Fixed point", .unit = "length", .from_data = "0,0,0", .name = "place"}),
      option<&O::center>({.text = "The centre of the bounding box is fixed", .excludes = "place"})};
  return option_schema<rows>();
}

const OptionSchema& TransformStep::schema() {
  using O = TransformStep;
  static constexpr OptionRow rows[] = {option<&O::map>({.text = "3 rows of 4 numbers", .name = "matrix"}),
                                       option<&O::inverse>({.text = "Apply the inverse"})};
  return option_schema<rows>();
}

const OptionSchema& TranslateStep::schema() {
  static constexpr OptionRow rows[] = {option<&TranslateStep::by>({.text = "Translation", .unit = "length"})};
  return option_schema<rows>();
}

const OptionSchema& CenterStep::schema() {
  static constexpr OptionSchema schema{{}};
  return schema;
}

const OptionSchema& ClassifyGroundStep::schema() {
  static constexpr OptionSchema schema{{}};
  return schema;
}

const OptionSchema& RotateStep::schema() {
  using O = RotateStep;
  static constexpr OptionRow rows[] = {
      option<&O::axis>({.text = "Axis"}), option<&O::degrees>({.text = "Angle", .unit = "degrees"}),
      option<&O::about>({.text = "Fixed point", .unit = "length", .from_data = "0,0,0"}),
      option<&O::about_center>({.text = "The centre of the bounding box is fixed", .excludes = "about"})};
  return option_schema<rows>();
}

const OptionSchema& ScaleStep::schema() {
  using O = ScaleStep;
  static constexpr OptionRow rows[] = {
      option<&O::factors>({.text = "One factor per axis, none of them 0"}),
      option<&O::about>({.text = "Fixed point", .unit = "length", .from_data = "0,0,0"}),
      option<&O::about_center>({.text = "The centre of the bounding box is fixed", .excludes = "about"})};
  return option_schema<rows>();
}

const OptionSchema& AxesStep::schema() {
  static constexpr OptionRow rows[] = {
      option<&AxesStep::axes>({.text = "Axes that become the new x, y and z: x,-z,y"})};
  return option_schema<rows>();
}

const OptionSchema& UpStep::schema() {
  static constexpr OptionRow rows[] = {option<&UpStep::to>({.text = "Axis that points up", .choices = kUpAxes})};
  return option_schema<rows>();
}

const OptionSchema& UnitStep::schema() {
  using O = UnitStep;
  static constexpr OptionRow rows[] = {
      option<&O::from>({.text = "Unit of lengths before", .from_data = "that of the input"}),
      option<&O::to>({.text = "Unit of lengths after"})};
  return option_schema<rows>();
}

const OptionSchema& CropStep::schema() {
  using O = CropStep;
  static constexpr OptionRow rows[] = {option<&O::box>({.text = "Least and largest coordinates", .unit = "length"}),
                                       option<&O::inside>({.text = "Keep the inside; otherwise the outside"})};
  return option_schema<rows>();
}

const OptionSchema& SpacingStep::schema() {
  static constexpr OptionRow rows[] = {
      option<&SpacingStep::distance>({.text = "Least distance", .unit = "length", .range = positive()})};
  return option_schema<rows>();
}

const OptionSchema& CountStep::schema() {
  static constexpr OptionRow rows[] = {option<&CountStep::count>({.text = "Number of points to keep", .range = kSome})};
  return option_schema<rows>();
}

const OptionSchema& EveryStep::schema() {
  static constexpr OptionRow rows[] = {
      option<&EveryStep::every>({.text = "Keep one of this many points", .range = kSome})};
  return option_schema<rows>();
}

const OptionSchema& ChooseStep::schema() {
  using O = ChooseStep;
  static constexpr OptionRow rows[] = {option<&O::names>({.text = "normals, colors and names of attributes"}),
                                       option<&O::keep>({.text = "Keep only these; otherwise drop them"})};
  return option_schema<rows>();
}

const OptionSchema& WeldStep::schema() {
  static constexpr OptionRow rows[] = {
      option<&WeldStep::distance>({.text = "Largest distance", .unit = "length", .range = at_least(0)})};
  return option_schema<rows>();
}

const OptionSchema& FlipStep::schema() {
  using O = FlipStep;
  static constexpr OptionRow rows[] = {option<&O::faces>({.text = "Reverse faces"}),
                                       option<&O::normals>({.text = "Reverse normals"})};
  return option_schema<rows>();
}

namespace {

/// Error in the text of a step; set_option adds the name of the step.
ArgumentError step_must_be(const std::string& allowed, const std::string& text) {
  return ArgumentError(ArgumentFault{.field = {}, .value = "'" + printable(text, 60) + "'", .allowed = allowed});
}

const std::string& text_in(const OptionValue& value) { return std::get<std::string>(value); }
double real_in(const OptionValue& value) { return std::get<double>(value); }
std::size_t whole_in(const OptionValue& value) { return static_cast<std::size_t>(std::get<std::int64_t>(value)); }

ConvertStep transform_of(const OptionValue& value, bool inverse) {
  return TransformStep{.map = read_transform(text_in(value)), .inverse = inverse};
}

/// "z,90" or "x,y,z,degrees".
ConvertStep rotation_of(const OptionValue& value) {
  std::string numbers = text_in(value);
  constexpr const char* kUnit[] = {"1,0,0", "0,1,0", "0,0,1"};
  for (std::size_t k = 0; k < 3; ++k)
    if (numbers.starts_with(std::string{static_cast<char>('x' + k), ','})) numbers.replace(0, 1, kUnit[k]);
  const auto v = numbers_in(numbers, 4);
  if (!v) throw step_must_be("an axis (x, y, z, or its three numbers) and degrees: z,90", text_in(value));
  return RotateStep{.axis = {(*v)[0], (*v)[1], (*v)[2]}, .degrees = (*v)[3]};
}

ConvertStep scaling_of(const OptionValue& value) {
  auto v = numbers_in(text_in(value));
  if (v && v->size() == 1) v->resize(3, v->front());
  if (!v || v->size() != 3 || std::find(v->begin(), v->end(), 0.0) != v->end())
    throw step_must_be("a factor, or three with commas between them, none of them 0", text_in(value));
  return ScaleStep{.factors = {(*v)[0], (*v)[1], (*v)[2]}};
}

ConvertStep about_of(const OptionValue& value) {
  if (text_in(value) == "center") return AboutStep{.center = true};
  const auto v = numbers_in(text_in(value), 3);
  if (!v) throw step_must_be("x,y,z or center", text_in(value));
  return AboutStep{.fixed_point = Vec3{(*v)[0], (*v)[1], (*v)[2]}};
}

ConvertStep crop_of(const OptionValue& value, bool inside) {
  const CropStep step{.box = schema_detail::Field<Box3>::from(value), .inside = inside};
  const Vec3 &lower = step.box.lower, &upper = step.box.upper;
  if (!(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z))
    throw step_must_be("the least x,y,z and the largest x,y,z of a box", option_words(value));
  return step;
}

ConvertStep choice_of(const OptionValue& value, bool keep) {
  return ChooseStep{.names = between_commas(text_in(value)), .keep = keep};
}

/// Row that makes and validates a step.
template <auto make>
constexpr OptionRow step_row(OptionKind kind, const OptionFacts& facts, int count = 1) {
  return option_step<ConvertStep, [](const OptionValue& value) {
    ConvertStep step = make(value);
    validate_step(step);
    return step;
  }>(kind, facts, count);
}

constexpr OptionRow kStepRows[] = {
    step_row<[](const OptionValue& v) { return transform_of(v, false); }>(
        OptionKind::text, {.text = "Apply the 4 × 4 matrix in this file: 4 rows of 4 numbers, or JSON",
                           .unit = "file",
                           .name = "transform"}),
    step_row<[](const OptionValue& v) { return transform_of(v, true); }>(
        OptionKind::text, {.text = "Apply the inverse of such a matrix", .unit = "file", .name = "inverse_transform"}),
    step_row<[](const OptionValue& v) -> ConvertStep { return TranslateStep{schema_detail::Field<Vec3>::from(v)}; }>(
        OptionKind::numbers,
        {.text = "Move by x,y,z, without loss of precision", .unit = "length", .name = "translate"}, 3),
    step_row<[](const OptionValue&) -> ConvertStep { return CenterStep{}; }>(
        OptionKind::flag, {.text = "Move the centre of the bounding box to 0,0,0", .name = "center"}),
    step_row<rotation_of>(OptionKind::text, {.text = "Rotate about an axis, counter-clockwise: z,90 or x,y,z,degrees",
                                             .unit = "axis,degrees",
                                             .name = "rotate"}),
    step_row<scaling_of>(
        OptionKind::text,
        {.text = "Scale by a factor, or by one per axis; negative factors mirror", .unit = "factor", .name = "scale"}),
    step_row<about_of>(
        OptionKind::text,
        {.text = "Fixed point of later `rotate` and `scale`: x,y,z or center, the centre of the current bounding "
                 "box",
         .unit = "place",
         .from_data = "0,0,0",
         .name = "about"}),
    step_row<[](const OptionValue& v) -> ConvertStep { return AxesStep{text_in(v)}; }>(
        OptionKind::text,
        {.text = "Axes that become the new x, y and z: y,x,z swaps two (a mirror image), x,-z,y rotates y up into z up",
         .unit = "axes",
         .name = "new_axes",
         .old_name = "axes"}),
    step_row<[](const OptionValue& v) -> ConvertStep { return UpStep{static_cast<StepUp>(whole_in(v))}; }>(
        OptionKind::choice,
        {.text = "Up axis: z rotates y up into z up, y the reverse", .unit = "axis", .choices = kUpAxes, .name = "up"}),
    step_row<[](const OptionValue& v) -> ConvertStep { return UnitStep{.from = {}, .to = text_in(v)}; }>(
        OptionKind::text, {.text = "Unit of the output's lengths", .unit = "unit", .name = "to_unit"}),
    step_row<[](const OptionValue& v) { return crop_of(v, true); }>(
        OptionKind::numbers,
        {.text = "Keep the inside of this box; meshes are cut", .unit = "length", .name = "box", .old_name = "crop"},
        6),
    step_row<[](const OptionValue& v) { return crop_of(v, false); }>(
        OptionKind::numbers,
        {.text = "Keep the outside of this box", .unit = "length", .name = "outside_box", .old_name = "crop_out"}, 6),
    step_row<[](const OptionValue& v) -> ConvertStep { return SpacingStep{real_in(v)}; }>(
        OptionKind::real, {.text = "Thin points until no two are closer than this (Poisson disc sampling)",
                           .unit = "length",
                           .range = positive(),
                           .name = "point_spacing",
                           .old_name = "spacing"}),
    step_row<[](const OptionValue& v) -> ConvertStep { return CountStep{whole_in(v)}; }>(
        OptionKind::whole, {.text = "Thin points to this number, at random with a fixed seed",
                            .range = kSome,
                            .name = "point_count",
                            .old_name = "count"}),
    step_row<[](const OptionValue& v) -> ConvertStep { return EveryStep{whole_in(v)}; }>(
        OptionKind::whole, {.text = "Thin points to every n-th", .range = kSome, .name = "every"}),
    step_row<[](const OptionValue& v) { return choice_of(v, true); }>(
        OptionKind::text, {.text = "Keep only these normals, colors and attributes, separated by commas",
                           .unit = "names",
                           .name = "keep"}),
    step_row<[](const OptionValue& v) { return choice_of(v, false); }>(
        OptionKind::text, {.text = "Drop these normals, colors and attributes", .unit = "names", .name = "drop"}),
    step_row<[](const OptionValue& v) -> ConvertStep { return WeldStep{real_in(v)}; }>(
        OptionKind::real, {.text = "Merge vertices (or points) no farther apart than this; 0 merges coincident ones",
                           .unit = "length",
                           .range = at_least(0),
                           .name = "weld"}),
    step_row<[](const OptionValue&) -> ConvertStep { return FlipStep{}; }>(
        OptionKind::flag, {.text = "Reverse faces and normals", .name = "flip"}),
    step_row<[](const OptionValue&) -> ConvertStep { return FlipStep{.faces = true, .normals = false}; }>(
        OptionKind::flag, {.text = "Reverse faces only", .name = "flip_faces"}),
    step_row<[](const OptionValue&) -> ConvertStep { return FlipStep{.faces = false, .normals = true}; }>(
        OptionKind::flag, {.text = "Reverse normals only", .name = "flip_normals"}),
    step_row<[](const OptionValue&) -> ConvertStep { return ClassifyGroundStep{}; }>(
        OptionKind::flag, {.text = "Find the ground of an airborne survey: class 2; all else without a class: 1",
                           .name = "classify_ground"})};

}  // namespace

std::span<const OptionRow> convert_step_rows() { return kStepRows; }

}  // namespace sansmesh::inline v1
