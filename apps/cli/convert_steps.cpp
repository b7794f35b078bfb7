#include "convert_steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "command_line.h"
#include "option_groups.h"
#include "option_values.h"
#include "sansmesh/io/transform_file.h"
#include "schema_options.h"

namespace sansmesh::cli {
namespace {

constexpr const char *kMoves = "Moves", *kSelection = "Selection", *kChanges = "Changes";

/// "z,90" or "x,y,z,degrees".
RotateStep rotation_of(const std::string& text) {
  const std::size_t comma = std::min(text.find(','), text.size());
  std::string numbers = text;
  for (std::size_t k = 0; k < 3; ++k)
    if (text.substr(0, comma) == std::string(1, static_cast<char>('x' + k))) {
      const char* const unit[] = {"1,0,0", "0,1,0", "0,0,1"};
      numbers.replace(0, 1, unit[k]);
    }
  const auto v = numbers_in(numbers, 4);
  if (!v) throw must_be("an axis (x, y, z, or its three numbers) and degrees: z,90", text);
  return {.axis = {(*v)[0], (*v)[1], (*v)[2]}, .degrees = (*v)[3]};
}

Vec3 factors_of(const std::string& text) {
  auto v = numbers_in(text);
  if (v && v->size() == 1) v->resize(3, v->front());
  if (!v || v->size() != 3 || std::find(v->begin(), v->end(), 0.0) != v->end())
    throw must_be("a factor, or three with commas between them, none of them 0", text);
  return {(*v)[0], (*v)[1], (*v)[2]};
}

Box3 box_of(const std::vector<double>& v) {
  if (!(v[0] <= v[3] && v[1] <= v[4] && v[2] <= v[5]))
    throw must_be("the least x,y,z and the largest x,y,z of a box", fmt::format("{}", fmt::join(v, ",")));
  return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
}

}  // namespace

void ConvertSteps::check() const {
  require(from_unit.empty() == to_unit.empty(), "--unit and --to-unit belong together: from which unit to which");
  require(!about_waits, "--about is for --rotate and --scale after it, and none follows");
}

void add_convert_steps(CommandLine& c, ConvertSteps& s) {
  const auto step = [&s](ConvertStep one) {
    in_words_of_the_line([&] { validate_step(one); });
    s.steps.push_back(std::move(one));
  };
  const auto turn = [&s, step](auto one) {
    s.about_waits = false;
    one.about = s.about;
    one.about_center = s.about_center;
    step(std::move(one));
  };
  c.add_option_function(
       "--transform", [step](const std::string& file) { step(TransformStep{.map = read_transform(file)}); },
       "By the 4 × 4 matrix in this file: 4 rows of 4 numbers, or JSON")
      .type_name("FILE")
      .group(kMoves)
      .in_order();
  c.add_option_function(
       "--inverse-transform",
       [step](const std::string& file) { step(TransformStep{.map = read_transform(file), .inverse = true}); },
       "By the inverse of such a matrix")
      .type_name("FILE")
      .group(kMoves)
      .in_order();
  c.add_option_function(
       "--translate",
       [step](const std::vector<double>& v) {
         step(TranslateStep{.by = {v[0], v[1], v[2]}});
       },
       "By x,y,z; loses no digit, however far")
      .numbers(3)
      .type_name("X,Y,Z")
      .group(kMoves)
      .in_order();
  c.add_flag_callback(
       "--center", [step] { step(CenterStep{}); }, "The middle of the box around everything to 0,0,0")
      .group(kMoves)
      .in_order();
  c.add_option_function(
       "--rotate", [turn](const std::string& text) { turn(rotation_of(text)); },
       "About an axis, counter-clockwise: z,90 or x,y,z,degrees")
      .type_name("AXIS,DEGREES")
      .group(kMoves)
      .in_order();
  c.add_option_function(
       "--scale", [turn](const std::string& text) { turn(ScaleStep{.factors = factors_of(text)}); },
       "By a factor, or by one for each axis (negative ones mirror, and turn faces over)")
      .type_name("FACTOR")
      .group(kMoves)
      .in_order();
  c.add_option_function(
       "--about",
       [&s](const std::string& text) {
         s.about_waits = true;
         s.about_center = text == "center";
         s.about.reset();
         if (s.about_center) return;
         const auto v = numbers_in(text, 3);
         if (!v) throw must_be("x,y,z or center", text);
         s.about = Vec3{(*v)[0], (*v)[1], (*v)[2]};
       },
       "What stays where it is by --rotate and --scale after this: x,y,z or center, the middle of the box as it then "
       "is [0,0,0]")
      .type_name("PLACE")
      .group(kMoves)
      .in_order();
  c.add_option_function(
       "--new-axes", [step](const std::string& text) { step(AxesStep{.axes = text}); },
       "Which axes the new x, y and z are: y,x,z swaps two (a mirror image), x,-z,y turns y up into z up")
      .type_name("AXES")
      .once_called("--axes")
      .group(kMoves)
      .in_order();
  c.add_option_function(
       "--up",
       [step](const std::string& axis) {
         if (axis != "y" && axis != "z") throw ValueError("must be y or z, not " + axis);
         step(UpStep{.to = axis == "y" ? StepUp::y : StepUp::z});
       },
       "z: what pointed up along y points up along z; y: the other way")
      .type_name("AXIS")
      .group(kMoves)
      .in_order();
  c.add_option_function(
       "--unit",
       [&s](const std::string& name) {
         in_words_of_the_line([&] { meters_of_unit(name); });
         s.from_unit = name;
       },
       "Of the input's lengths, for --to-unit: um, mm, cm, m, km, in, ft or us-ft")
      .type_name("UNIT")
      .group(kMoves);
  c.add_option_function(
       "--to-unit",
       [&s, step](const std::string& name) {
         if (!s.to_unit.empty()) throw ValueError("is given twice");
         s.to_unit = name;
         step(UnitStep{.from = s.from_unit.empty() ? name : s.from_unit, .to = name});
       },
       "Of the output's lengths")
      .type_name("UNIT")
      .group(kMoves)
      .in_order();
  for (const bool inside : {true, false}) {
    const char* const flag = inside ? "--box" : "--outside-box";
    c.add_option_function(
         flag, [step, inside](const std::vector<double>& v) { step(CropStep{.box = box_of(v), .inside = inside}); },
         inside ? "Only what lies in this box; meshes are cut along it" : "Only what lies outside of this box")
        .numbers(6)
        .type_name("X0,Y0,Z0,X1,Y1,Z1")
        .once_called(inside ? "--crop" : "--crop-out")
        .group(kSelection)
        .in_order();
  }
  c.add_option_function(
       "--point-spacing", [step](double distance) { step(SpacingStep{distance}); },
       "Fewer points: no two closer than this, and none missing that would be farther from all (Poisson discs)")
      .type_name("LENGTH")
      .positive()
      .once_called("--spacing")
      .group(kSelection)
      .in_order();
  c.add_option_function(
       "--point-count", [step](std::size_t count) { step(CountStep{count}); },
       "Fewer points: so many, drawn by chance (always the same ones)")
      .type_name("COUNT")
      .once_called("--count")
      .within(1, 2000000000)
      .group(kSelection)
      .in_order();
  c.add_option_function(
       "--every", [step](std::size_t n) { step(EveryStep{n}); }, "Fewer points: the first of every so many")
      .type_name("COUNT")
      .within(1, 2000000000)
      .group(kSelection)
      .in_order();
  for (const bool keep : {true, false}) {
    const char* const flag = keep ? "--keep" : "--drop";
    c.add_option_function(
         flag, [step, keep](const std::string& text) { step(ChooseStep{.names = between_commas(text), .keep = keep}); },
         keep ? "Of normals, colors and attributes only these, with commas between them" : "All but these")
        .type_name("NAMES")
        .group(kSelection)
        .in_order();
  }
  c.add_option_function(
       "--weld",
       [step](double distance) {
         if (distance < 0) throw must_be("a length of at least 0", fmt::format("{}", distance));
         step(WeldStep{distance});
       },
       "Vertices (or points) no farther than this from each other become one; 0: those at the same place")
      .type_name("LENGTH")
      .group(kChanges)
      .in_order();
  struct Flip {
    const char* flag;
    bool faces, normals;
    const char* what;
  };
  for (const Flip f : {Flip{"--flip", true, true, "Turn faces over, and normals around"},
                       Flip{"--flip-faces", true, false, "Turn faces over, and leave normals"},
                       Flip{"--flip-normals", false, true, "Turn normals around, and leave faces"}})
    c.add_flag_callback(
         f.flag,
         [step, f] {
           step(FlipStep{f.faces, f.normals});
         },
         f.what)
        .group(kChanges)
        .in_order();
}

}  // namespace sansmesh::cli
