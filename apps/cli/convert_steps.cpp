#include "convert_steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "command_line.h"
#include "option_groups.h"
#include "option_values.h"
#include "sansmesh/core/error.h"
#include "sansmesh/io/transform_file.h"

namespace sansmesh::cli {
namespace {

constexpr const char *kMoves = "Moves", *kSelection = "Selection", *kChanges = "Changes";

struct Unit {
  const char* name;
  double meters;
};
constexpr Unit kUnits[] = {{"um", 1e-6}, {"mm", 1e-3},   {"cm", 1e-2},   {"m", 1},
                           {"km", 1e3},  {"in", 0.0254}, {"ft", 0.3048}, {"us-ft", 1200.0 / 3937}};

double meters_of(const std::string& name) {
  std::string known;
  for (const Unit& u : kUnits) {
    if (name == u.name) return u.meters;
    known += (known.empty() ? "" : ", ") + std::string(u.name);
  }
  throw ValueError("must be one of " + known + ", not " + name);
}

/// "z,90" or "x,y,z,degrees".
AffineMap rotation_of(const std::string& text) {
  const std::size_t comma = std::min(text.find(','), text.size());
  std::string numbers = text;
  for (std::size_t k = 0; k < 3; ++k)
    if (text.substr(0, comma) == std::string(1, static_cast<char>('x' + k))) {
      const char* const unit[] = {"1,0,0", "0,1,0", "0,0,1"};
      numbers.replace(0, 1, unit[k]);
    }
  const auto v = numbers_in(numbers, 4);
  if (!v) throw must_be("an axis (x, y, z, or its three numbers) and degrees: z,90", text);
  try {
    return AffineMap::rotation({(*v)[0], (*v)[1], (*v)[2]}, (*v)[3]);
  } catch (const ArgumentError& error) {
    throw ValueError(error.what());
  }
}

/// "x,z,-y": the axes whose coordinates the new x, y and z are.
AffineMap axes_of(const std::string& text) {
  const std::vector<std::string> words = between_commas(text);
  Vec3 row[3];
  bool good = words.size() == 3;
  std::size_t seen = 0;
  for (std::size_t k = 0; good && k < 3; ++k) {
    const bool minus = words[k].starts_with('-');
    const std::string axis = words[k].substr(minus || words[k].starts_with('+') ? 1 : 0);
    good = axis == "x" || axis == "y" || axis == "z";
    if (!good) break;
    const auto at = static_cast<std::size_t>(axis[0] - 'x');
    row[k][at] = minus ? -1 : 1;
    seen |= std::size_t{1} << at;
  }
  if (!good || seen != 7)
    throw ValueError("must be x, y and z in some order, each with or without '-': x,-z,y; not " + text);
  return {{row[0].x, row[1].x, row[2].x}, {row[0].y, row[1].y, row[2].y}, {row[0].z, row[1].z, row[2].z}, {}};
}

}  // namespace

void ConvertSteps::check() const {
  require(from_unit.has_value() == to_unit.has_value(),
          "--unit and --to-unit belong together: from which unit to which");
  require(!about_waits, "--about is for --rotate and --scale after it, and none follows");
}

Json ConvertSteps::run(CloudOrMesh& data, Progress& progress, std::vector<std::string>& said) const {
  Json done = Json::array();
  for (const ConvertStep& step : steps) {
    progress.begin(step.flag.substr(2));
    const Box3 box = data.bounds();
    const std::string before = data.size_words();
    std::string remark;
    try {
      remark = step.run(data);
    } catch (const DataError& error) {
      const std::string cause = error.what();
      const bool sentence = cause.starts_with("a ") || cause.starts_with("there ");
      throw DataError(step.flag + (sentence ? ": " : " ") + cause);
    }
    if (data.size() == 0 || (data.is_mesh && data.mesh.triangles.empty()))
      throw DataError(
          fmt::format("{} leaves nothing of {} between ({:.10g}, {:.10g}, {:.10g}) and ({:.10g}, {:.10g}, {:.10g})",
                      step.flag, before, box.lower.x, box.lower.y, box.lower.z, box.upper.x, box.upper.y, box.upper.z));
    if (!remark.empty()) said.push_back(fmt::format("{}: {}", step.flag, remark));
    Json entry;
    entry["option"] = step.flag;
    entry[data.is_mesh ? "vertices" : "points"] = data.size();
    if (data.is_mesh) entry["triangles"] = data.mesh.triangles.size();
    done.push_back(std::move(entry));
  }
  return done;
}

void add_convert_steps(CommandLine& c, ConvertSteps& s) {
  const auto step = [&s](const char* flag, std::function<std::string(CloudOrMesh&)> run) {
    s.steps.push_back({flag, std::move(run)});
  };
  const auto turn = [&s, step](const char* flag, const AffineMap& map) {
    s.about_waits = false;
    step(flag, [map, about = s.about, center = s.about_center](CloudOrMesh& data) {
      if (center) return move_all(data, map.about(data.bounds().center()));
      return move_all(data, about ? map.about(*about) : map);
    });
  };
  c.add_option_function(
       "--transform",
       [step](const std::string& file) {
         step("--transform", [map = read_transform(file)](CloudOrMesh& data) { return move_all(data, map); });
       },
       "By the 4 × 4 matrix in this file: 4 rows of 4 numbers, or JSON")
      .type_name("FILE")
      .group(kMoves)
      .in_order();
  c.add_option_function(
       "--inverse-transform",
       [step](const std::string& file) {
         step("--inverse-transform",
              [map = read_transform(file).inverse()](CloudOrMesh& data) { return move_all(data, map); });
       },
       "By the inverse of such a matrix")
      .type_name("FILE")
      .group(kMoves)
      .in_order();
  c.add_option_function(
       "--translate",
       [step](const std::vector<double>& v) {
         step("--translate", [v](CloudOrMesh& data) {
           return move_all(data, AffineMap::translation({v[0], v[1], v[2]}));
         });
       },
       "By x,y,z; loses no digit, however far")
      .numbers(3)
      .type_name("X,Y,Z")
      .group(kMoves)
      .in_order();
  c.add_flag_callback(
       "--center",
       [step] {
         step("--center",
              [](CloudOrMesh& data) { return move_all(data, AffineMap::translation(-data.bounds().center())); });
       },
       "The middle of the box around everything to 0,0,0")
      .group(kMoves)
      .in_order();
  c.add_option_function(
       "--rotate", [turn](const std::string& text) { turn("--rotate", rotation_of(text)); },
       "About an axis, counter-clockwise: z,90 or x,y,z,degrees")
      .type_name("AXIS,DEGREES")
      .group(kMoves)
      .in_order();
  c.add_option_function(
       "--scale",
       [turn](const std::string& text) {
         auto v = numbers_in(text);
         if (v && v->size() == 1) v->resize(3, v->front());
         if (!v || v->size() != 3 || std::find(v->begin(), v->end(), 0.0) != v->end())
           throw must_be("a factor, or three with commas between them, none of them 0", text);
         turn("--scale", AffineMap::scaling({(*v)[0], (*v)[1], (*v)[2]}));
       },
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
       "--axes",
       [step](const std::string& text) {
         step("--axes", [map = axes_of(text)](CloudOrMesh& data) { return move_all(data, map); });
       },
       "Which axes the new x, y and z are: y,x,z swaps two (a mirror image), x,-z,y turns y up into z up")
      .type_name("AXES")
      .group(kMoves)
      .in_order();
  c.add_option_function(
       "--up",
       [step](const std::string& axis) {
         if (axis != "y" && axis != "z") throw ValueError("must be y or z, not " + axis);
         step("--up",
              [map = axes_of(axis == "z" ? "x,-z,y" : "x,z,-y")](CloudOrMesh& data) { return move_all(data, map); });
       },
       "z: what pointed up along y points up along z; y: the other way")
      .type_name("AXIS")
      .group(kMoves)
      .in_order();
  c.add_option_function(
       "--unit", [&s](const std::string& name) { s.from_unit = meters_of(name); },
       "Of the input's lengths, for --to-unit: um, mm, cm, m, km, in, ft or us-ft")
      .type_name("UNIT")
      .group(kMoves);
  c.add_option_function(
       "--to-unit",
       [&s, step](const std::string& name) {
         if (s.to_unit) throw ValueError("is given twice");
         s.to_unit = meters_of(name);
         step("--to-unit", [&s, to = *s.to_unit](CloudOrMesh& data) {
           const double factor = s.from_unit.value_or(to) / to;
           return move_all(data, AffineMap::scaling({factor, factor, factor}));
         });
       },
       "Of the output's lengths")
      .type_name("UNIT")
      .group(kMoves)
      .in_order();
  for (const bool inside : {true, false}) {
    const char* const flag = inside ? "--crop" : "--crop-out";
    c.add_option_function(
         flag,
         [step, flag, inside](const std::vector<double>& v) {
           if (!(v[0] <= v[3] && v[1] <= v[4] && v[2] <= v[5]))
             throw must_be("the least x,y,z and the largest x,y,z of a box", fmt::format("{}", fmt::join(v, ",")));
           step(flag, [box = Box3{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}}, inside](CloudOrMesh& data) {
             return crop_to_box(data, box, inside);
           });
         },
         inside ? "Only what lies in this box; meshes are cut along it" : "Only what lies outside of this box")
        .numbers(6)
        .type_name("X0,Y0,Z0,X1,Y1,Z1")
        .group(kSelection)
        .in_order();
  }
  c.add_option_function(
       "--spacing",
       [step](double distance) {
         step("--spacing", [distance](CloudOrMesh& data) { return keep_apart(data, distance); });
       },
       "Fewer points: no two closer than this, and none missing that would be farther from all (Poisson discs)")
      .type_name("LENGTH")
      .positive()
      .group(kSelection)
      .in_order();
  c.add_option_function(
       "--count",
       [step](std::size_t count) { step("--count", [count](CloudOrMesh& data) { return keep_count(data, count); }); },
       "Fewer points: so many, drawn by chance (always the same ones)")
      .type_name("COUNT")
      .within(1, 2000000000)
      .group(kSelection)
      .in_order();
  c.add_option_function(
       "--every", [step](std::size_t n) { step("--every", [n](CloudOrMesh& data) { return keep_every(data, n); }); },
       "Fewer points: the first of every so many")
      .type_name("COUNT")
      .within(1, 2000000000)
      .group(kSelection)
      .in_order();
  for (const bool keep : {true, false}) {
    const char* const flag = keep ? "--keep" : "--drop";
    c.add_option_function(
         flag,
         [step, flag, keep](const std::string& text) {
           step(flag, [names = between_commas(text), keep](CloudOrMesh& data) {
             return choose_attributes(data, names, keep);
           });
         },
         keep ? "Of normals, colors and attributes only these, with commas between them" : "All but these")
        .type_name("NAMES")
        .group(kSelection)
        .in_order();
  }
  c.add_option_function(
       "--weld",
       [step](double distance) {
         if (distance < 0) throw must_be("a length of at least 0", fmt::format("{}", distance));
         step("--weld", [distance](CloudOrMesh& data) { return weld_places(data, distance); });
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
         f.flag, [step, f] { step(f.flag, [f](CloudOrMesh& data) { return flip_sides(data, f.faces, f.normals); }); },
         f.what)
        .group(kChanges)
        .in_order();
}

}  // namespace sansmesh::cli
