#include "convert_steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <utility>

#include "command_line.h"
#include "option_groups.h"
#include "option_values.h"
#include "sansmesh/core/error.h"
#include "sansmesh/data/affine_map.h"
#include "sansmesh/io/transform_file.h"
#include "sansmesh/mesh/clip_mesh.h"
#include "sansmesh/mesh/weld.h"
#include "sansmesh/points/close_points.h"
#include "sansmesh/points/duplicates.h"
#include "sansmesh/points/poisson_discs.h"
#include "sansmesh/points/subsample.h"

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

/// `typed`: what errors show in place of `text`.
std::vector<double> numbers_in(const std::string& text, const char* form, const std::string& typed = "") {
  std::vector<double> numbers;
  for (const std::string& part : between_commas(text)) {
    double value = 0;
    const char* const begin = part.data() + (part.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, part.data() + part.size(), value);
    if (error != std::errc() || end != part.data() + part.size() || !std::isfinite(value))
      throw ValueError(fmt::format("must be {}, not {}", form, typed.empty() ? text : typed));
    numbers.push_back(value);
  }
  return numbers;
}

double one_number(const std::string& text, const char* form, double least, bool or_equal) {
  const std::vector<double> numbers = numbers_in(text, form);
  if (numbers.size() != 1 || numbers[0] < least || (numbers[0] == least && !or_equal))
    throw ValueError(fmt::format("must be {}, not {}", form, text));
  return numbers[0];
}

std::size_t whole_number(const std::string& text, const char* form) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 1)
    throw ValueError(fmt::format("must be {}, not {}", form, text));
  return value;
}

/// "z,90" or "x,y,z,degrees".
AffineMap rotation_of(const std::string& text) {
  constexpr const char* kForm = "an axis (x, y, z, or its three numbers) and degrees: z,90";
  const std::string axis = text.substr(0, text.find(','));
  std::string numbers = text;
  std::erase(numbers, ' ');
  for (std::size_t k = 0; k < 3; ++k)
    if (axis == std::string(1, static_cast<char>('x' + k))) {
      const char* const unit[] = {"1,0,0", "0,1,0", "0,0,1"};
      numbers.replace(0, 1, unit[k]);
    }
  const std::vector<double> v = numbers_in(numbers, kForm, text);
  if (v.size() != 4) throw ValueError(fmt::format("must be {}, not {}", kForm, text));
  try {
    return AffineMap::rotation({v[0], v[1], v[2]}, v[3]);
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

/// Moves all; says what stays that might be thought to be moved along.
std::string move(CloudOrMesh& data, const AffineMap& map) {
  try {
    if (data.is_mesh)
      transform(data.mesh, map);
    else
      transform(data.points, map);
  } catch (const ArgumentError& error) {
    throw DataError(error.what());
  }
  if (map.only_shifts()) return "";
  const AttributeTable& of_triangles = data.mesh.triangle_attributes;
  for (const AttributeTable* const table : {&data.attributes(), &of_triangles})
    for (const Attribute& a : *table)
      if (a.components == 3 && is_real(a.type()) &&
          std::find(data.unturned.begin(), data.unturned.end(), a.name) == data.unturned.end())
        data.unturned.push_back(a.name);
  return "";
}

/// Of a cloud the samples of which there are rows.
void take(CloudOrMesh& data, const std::vector<std::uint32_t>& rows) {
  if (rows.size() < data.points.size()) data.points = take_samples(data.points, rows);
}

void need_points(const CloudOrMesh& data, const char* instead) {
  if (data.is_mesh) throw DataError(fmt::format("is for points, and the input is a mesh; {}", instead));
}

std::string left_of(std::size_t before, const CloudOrMesh& data) {
  return fmt::format("{} of {} {}", grouped(data.size()), grouped(before), data.is_mesh ? "vertices" : "points");
}

std::string crop(CloudOrMesh& data, const Box3& box, bool inside) {
  const std::size_t before = data.size();
  if (data.is_mesh) {
    const Box3f own{Vec3f(box.lower - data.mesh.origin), Vec3f(box.upper - data.mesh.origin)};
    if (inside)
      clip_mesh(data.mesh, own);
    else
      cut_out_box(data.mesh, own);
    return data.size_words();
  }
  std::vector<std::uint8_t> gone(before);
  for (std::size_t i = 0; i < before; ++i) {
    const Vec3 p = data.points.origin + Vec3(data.points.positions[i]);
    bool in = true;
    for (std::size_t k = 0; k < 3; ++k) in = in && p[k] >= box.lower[k] && p[k] <= box.upper[k];
    gone[i] = in != inside;
  }
  remove_samples(data.points, gone);
  return left_of(before, data);
}

std::string weld(CloudOrMesh& data, double distance) {
  const std::size_t before = data.size();
  if (data.is_mesh) {
    const WeldReport report = weld_vertices(data.mesh, distance);
    return fmt::format(
        "{} became one with others{}", counted(report.vertices, report.vertices == 1 ? "vertex" : "vertice"),
        report.triangles > 0 ? fmt::format(", {} without area gone", counted(report.triangles, "triangle"))
                             : std::string());
  }
  if (distance == 0) {
    remove_samples(data.points, find_duplicates(data.points));
  } else {
    const std::vector<std::uint32_t> of = close_representatives(data.points.positions, distance);
    std::vector<std::uint8_t> gone(of.size());
    for (std::size_t i = 0; i < of.size(); ++i) gone[i] = of[i] != i;
    remove_samples(data.points, gone);
  }
  return left_of(before, data);
}

std::string keep_apart(CloudOrMesh& data, double distance) {
  need_points(data, "--points takes its vertices, `sansmesh simplify` makes fewer triangles");
  const std::size_t before = data.size();
  const std::vector<Vec3> positions(data.points.positions.begin(), data.points.positions.end());
  take(data, poisson_discs(positions, distance));
  return left_of(before, data);
}

std::string flip(CloudOrMesh& data, bool faces, bool normals) {
  std::vector<Vec3f>& directions = data.is_mesh ? data.mesh.normals : data.points.normals;
  if (!data.is_mesh && !normals) throw DataError("is for meshes, and the input has no faces");
  if (!data.is_mesh && directions.empty())
    throw DataError("finds no normals, and points have no faces; `sansmesh normals` estimates some");
  if (data.is_mesh && !faces && directions.empty()) throw DataError("finds no normals");
  if (faces)
    for (Triangle& t : data.mesh.triangles) std::swap(t[1], t[2]);
  if (normals)
    for (Vec3f& n : directions) n = Vec3f{} - n;  // without -0
  return "";
}

/// Keeps or drops what the list names.
std::string select(CloudOrMesh& data, const std::vector<std::string>& names, bool keep) {
  AttributeTable& own = data.is_mesh ? data.mesh.attributes : data.points.attributes;
  AttributeTable none;
  AttributeTable& of_triangles = data.is_mesh ? data.mesh.triangle_attributes : none;
  auto& normals = data.is_mesh ? data.mesh.normals : data.points.normals;
  auto& colors = data.is_mesh ? data.mesh.colors : data.points.colors;
  std::vector<std::string> known;
  if (!normals.empty()) known.emplace_back("normals");
  if (!colors.empty()) known.emplace_back("colors");
  for (const AttributeTable* const table : {&own, &of_triangles})
    for (const Attribute& a : *table)
      if (std::find(known.begin(), known.end(), a.name) == known.end()) known.push_back(a.name);
  for (const std::string& name : names)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw DataError(
          fmt::format("there is no '{}'; there {}{}", printable(name, 80), known.size() == 1 ? "is " : "are ",
                      known.empty() ? "no attributes" : printable(fmt::format("{}", fmt::join(known, ", ")))));
  const auto goes = [&](const std::string& name) {
    return (std::find(names.begin(), names.end(), name) != names.end()) != keep;
  };
  if (goes("normals")) normals.clear();
  if (goes("colors")) colors.clear();
  for (AttributeTable* const table : {&own, &of_triangles})
    for (const std::string& name : known)
      if (goes(name)) table->erase(name);
  return "";
}

}  // namespace

CloudOrMesh::CloudOrMesh(PointSet read) : is_mesh(!read.triangles.empty()) {
  const bool several = std::any_of(read.scan_of_point.begin(), read.scan_of_point.end(),
                                   [&](std::uint16_t scan) { return scan != read.scan_of_point.front(); });
  if (several) {
    std::string name = "source";
    for (int k = 2; read.attributes.find(name) || read.triangle_attributes.find(name); ++k)
      name = fmt::format("source_{}", k);
    if (is_mesh) {
      std::vector<std::uint16_t> of_triangle;
      of_triangle.reserve(read.triangles.size());
      for (const auto& t : read.triangles) of_triangle.push_back(read.scan_of_point[t[0]]);
      read.triangle_attributes.set(name, std::move(of_triangle));
    }
    read.attributes.set(name, std::move(read.scan_of_point));
  }
  if (is_mesh)
    mesh = to_mesh(std::move(read));
  else
    points = std::move(read);
}

std::string CloudOrMesh::size_words() const {
  if (!is_mesh) return counted(points.size(), "point");
  return fmt::format("{} {}, {}", grouped(mesh.vertices.size()), mesh.vertices.size() == 1 ? "vertex" : "vertices",
                     counted(mesh.triangles.size(), "triangle"));
}

Box3 CloudOrMesh::bounds() const {
  const Box3f own = is_mesh ? sansmesh::bounds(mesh) : sansmesh::bounds(points);
  return own.empty() ? Box3{} : Box3{origin() + Vec3(own.lower), origin() + Vec3(own.upper)};
}

void CloudOrMesh::make_points() {
  if (!is_mesh) return;
  points.origin = mesh.origin;
  points.positions = std::move(mesh.vertices);
  points.normals = std::move(mesh.normals);
  points.colors = std::move(mesh.colors);
  points.attributes = std::move(mesh.attributes);
  mesh = {};
  is_mesh = false;
}

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
      if (center) return move(data, map.about(data.bounds().center()));
      return move(data, about ? map.about(*about) : map);
    });
  };
  c.add_option_function(
       "--transform",
       [step](const std::string& file) {
         step("--transform", [map = read_transform(file)](CloudOrMesh& data) { return move(data, map); });
       },
       "By the 4 × 4 matrix in this file: 4 rows of 4 numbers, or JSON")
      .type_name("FILE")
      .group(kMoves)
      .in_order();
  c.add_option_function(
       "--inverse-transform",
       [step](const std::string& file) {
         step("--inverse-transform",
              [map = read_transform(file).inverse()](CloudOrMesh& data) { return move(data, map); });
       },
       "By the inverse of such a matrix")
      .type_name("FILE")
      .group(kMoves)
      .in_order();
  c.add_option_function(
       "--translate",
       [step](const std::string& text) {
         constexpr const char* kForm = "three numbers with commas between them";
         const std::vector<double> v = numbers_in(text, kForm);
         if (v.size() != 3) throw ValueError(fmt::format("must be {}, not {}", kForm, text));
         step("--translate", [v](CloudOrMesh& data) { return move(data, AffineMap::translation({v[0], v[1], v[2]})); });
       },
       "By x,y,z; loses no digit, however far")
      .type_name("X,Y,Z")
      .group(kMoves)
      .in_order();
  c.add_flag_callback(
       "--center",
       [step] {
         step("--center",
              [](CloudOrMesh& data) { return move(data, AffineMap::translation(-data.bounds().center())); });
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
         constexpr const char* kForm = "a factor, or three with commas between them, none of them 0";
         std::vector<double> v = numbers_in(text, kForm);
         if (v.size() == 1) v.resize(3, v[0]);
         if (v.size() != 3 || v[0] == 0 || v[1] == 0 || v[2] == 0)
           throw ValueError(fmt::format("must be {}, not {}", kForm, text));
         turn("--scale", AffineMap::scaling({v[0], v[1], v[2]}));
       },
       "By a factor, or by one for each axis (negative ones mirror, and turn faces over)")
      .type_name("FACTOR")
      .group(kMoves)
      .in_order();
  c.add_option_function(
       "--about",
       [&s](const std::string& text) {
         constexpr const char* kForm = "x,y,z or center";
         s.about_waits = true;
         s.about_center = text == "center";
         s.about.reset();
         if (s.about_center) return;
         const std::vector<double> v = numbers_in(text, kForm);
         if (v.size() != 3) throw ValueError(fmt::format("must be {}, not {}", kForm, text));
         s.about = Vec3{v[0], v[1], v[2]};
       },
       "What stays where it is by --rotate and --scale after this: x,y,z or center, the middle of the box as it then "
       "is [0,0,0]")
      .type_name("PLACE")
      .group(kMoves)
      .in_order();
  c.add_option_function(
       "--axes",
       [step](const std::string& text) {
         step("--axes", [map = axes_of(text)](CloudOrMesh& data) { return move(data, map); });
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
              [map = axes_of(axis == "z" ? "x,-z,y" : "x,z,-y")](CloudOrMesh& data) { return move(data, map); });
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
           return move(data, AffineMap::scaling({factor, factor, factor}));
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
         [step, flag, inside](const std::string& text) {
           constexpr const char* kForm = "the least x,y,z and the largest x,y,z of a box";
           const std::vector<double> v = numbers_in(text, kForm);
           if (v.size() != 6 || !(v[0] <= v[3] && v[1] <= v[4] && v[2] <= v[5]))
             throw ValueError(fmt::format("must be {}, not {}", kForm, text));
           step(flag, [box = Box3{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}}, inside](CloudOrMesh& data) {
             return crop(data, box, inside);
           });
         },
         inside ? "Only what lies in this box; meshes are cut along it" : "Only what lies outside of this box")
        .type_name("X0,Y0,Z0,X1,Y1,Z1")
        .group(kSelection)
        .in_order();
  }
  c.add_option_function(
       "--spacing",
       [step](const std::string& text) {
         const double distance = one_number(text, "a length above 0", 0, false);
         step("--spacing", [distance](CloudOrMesh& data) { return keep_apart(data, distance); });
       },
       "Fewer points: no two closer than this, and none missing that would be farther from all (Poisson discs)")
      .type_name("LENGTH")
      .group(kSelection)
      .in_order();
  c.add_option_function(
       "--count",
       [step](const std::string& text) {
         const std::size_t count = whole_number(text, "a whole number of at least 1");
         step("--count", [count](CloudOrMesh& data) {
           need_points(data, "--points takes its vertices");
           const std::size_t before = data.size();
           take(data, scattered_choice(before, count));
           return left_of(before, data);
         });
       },
       "Fewer points: so many, drawn by chance (always the same ones)")
      .type_name("COUNT")
      .group(kSelection)
      .in_order();
  c.add_option_function(
       "--every",
       [step](const std::string& text) {
         const std::size_t n = whole_number(text, "a whole number of at least 1");
         step("--every", [n](CloudOrMesh& data) {
           need_points(data, "--points takes its vertices");
           const std::size_t before = data.size();
           take(data, every_nth(before, n));
           return left_of(before, data);
         });
       },
       "Fewer points: the first of every so many")
      .type_name("COUNT")
      .group(kSelection)
      .in_order();
  for (const bool keep : {true, false}) {
    const char* const flag = keep ? "--keep" : "--drop";
    c.add_option_function(
         flag,
         [step, flag, keep](const std::string& text) {
           step(flag, [names = between_commas(text), keep](CloudOrMesh& data) { return select(data, names, keep); });
         },
         keep ? "Of normals, colors and attributes only these, with commas between them" : "All but these")
        .type_name("NAMES")
        .group(kSelection)
        .in_order();
  }
  c.add_option_function(
       "--weld",
       [step](const std::string& text) {
         const double distance = one_number(text, "a length of at least 0", 0, true);
         step("--weld", [distance](CloudOrMesh& data) { return weld(data, distance); });
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
         f.flag, [step, f] { step(f.flag, [f](CloudOrMesh& data) { return flip(data, f.faces, f.normals); }); }, f.what)
        .group(kChanges)
        .in_order();
}

}  // namespace sansmesh::cli
