// sansmesh eval: value, gradient and curvature of a function at points.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "cloud_input.h"
#include "commands.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"
#include "sansmesh/field/level_set_curvature.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/function/surface_function.h"
#include "sansmesh/io/io.h"

namespace sansmesh::cli {
namespace {

/// So many points are printed as well.
constexpr std::size_t kPrintedPoints = 20;
/// Step of the second derivatives over the spacing of the samples.
constexpr double kStep = 0.25;

struct EvalArguments {
  std::string input, output;
  CloudInput points;  ///< without files: none
  std::vector<double> at;
  bool ascii = false;
};

PointSet points_of(const EvalArguments& a, Console& console) {
  if (a.points.files.empty() == a.at.empty()) throw ArgumentError("where? Give either --points FILE or --at x,y,z");
  if (!a.points.files.empty()) {
    ReadReport read;
    return a.points.read(console, read);
  }
  if (a.points.classes) throw ArgumentError("--class and --without-class choose among --points");
  PointSet points;
  points.origin = {a.at[0], a.at[1], a.at[2]};
  for (const Vec3& place : places_at(a.at)) points.positions.push_back(Vec3f(place - points.origin));
  return points;
}

/// Where the function is evaluated: those of --at as they were given, which single precision would change.
std::vector<Vec3> places_of(const EvalArguments& a, const PointSet& points) {
  if (!a.at.empty()) return places_at(a.at);
  std::vector<Vec3> places(points.size());
  for (std::size_t i = 0; i < places.size(); ++i) places[i] = points.origin + Vec3(points.positions[i]);
  return places;
}

void run_eval(const EvalArguments& a, Console& console) {
  if (!a.output.empty()) check_writable(a.output, "points");
  Progress& progress = console.progress();
  progress.begin("read");
  const SurfaceFunction function = read_function(a.input);
  PointSet points = points_of(a, console);
  points.triangles.clear();
  points.triangle_attributes.clear();

  progress.begin("evaluate");
  const std::size_t n = points.size();
  const std::vector<Vec3> places = places_of(a, points);
  std::vector<Vec3> x(n);
  for (std::size_t i = 0; i < n; ++i) x[i] = function.place.from_input(places[i]);
  std::vector<LevelSetPoint> found(n);
  level_set_points(function.field, x, kStep * function.field.report().spacing, found);
  const double unit = function.place.unit;
  for (LevelSetPoint& p : found) p.value *= unit, p.k1 /= unit, p.k2 /= unit;

  if (!a.output.empty()) {
    progress.begin("write");
    const auto add = [&](const char* name, auto&& get) {
      std::vector<float> values(n);
      for (std::size_t i = 0; i < n; ++i) values[i] = static_cast<float>(get(found[i]));
      points.attributes.set(name, std::move(values));
    };
    add("value", [](const LevelSetPoint& p) { return p.value; });
    add("gradient_x", [](const LevelSetPoint& p) { return p.gradient.x; });
    add("gradient_y", [](const LevelSetPoint& p) { return p.gradient.y; });
    add("gradient_z", [](const LevelSetPoint& p) { return p.gradient.z; });
    add("k1", [](const LevelSetPoint& p) { return p.k1; });
    add("k2", [](const LevelSetPoint& p) { return p.k2; });
    write_points(a.output, points, {.ascii = a.ascii});
  }
  progress.finish();

  std::vector<double> size(n);
  std::size_t inside = 0;
  double steepest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    size[i] = std::abs(found[i].value);
    inside += found[i].value < 0;
    steepest = std::max(steepest, norm(found[i].gradient));
  }
  std::sort(size.begin(), size.end());
  double mean = 0;
  for (const double s : size) mean += s / static_cast<double>(n);
  console.say(fmt::format("{}: {} evaluated, {} inside", a.input, counted(n, "point"), grouped(inside)));
  if (n <= kPrintedPoints) {
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3& p = places[i];
      const LevelSetPoint& f = found[i];
      console.say(
          fmt::format("({:.8g}, {:.8g}, {:.8g})  value {:.6g}  gradient ({:.6g}, {:.6g}, {:.6g})  "
                      "curvatures {:.4g}, {:.4g}",
                      p.x, p.y, p.z, f.value, f.gradient.x, f.gradient.y, f.gradient.z, f.k1, f.k2));
    }
  } else {
    console.say(fmt::format("|value|: mean {}, median {}, largest {}; largest gradient {:.3f}", length(mean),
                            length(size[n / 2]), length(size[n - 1]), steepest));
  }
  Json json = {{"input", {{"file", a.input}}},
               {"points", n},
               {"inside", inside},
               {"absolute_value", {{"mean", mean}, {"median", size[n / 2]}, {"max", size[n - 1]}}},
               {"largest_gradient", steepest}};
  if (n <= kPrintedPoints) {
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3& p = places[i];
      const LevelSetPoint& f = found[i];
      json["values"].push_back({{"at", {p.x, p.y, p.z}},
                                {"value", f.value},
                                {"gradient", {f.gradient.x, f.gradient.y, f.gradient.z}},
                                {"k1", f.k1},
                                {"k2", f.k2}});
    }
  }
  if (!a.output.empty()) json["output"] = {{"file", a.output}};
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_eval(CommandLine& app) {
  CommandLine& c = app.add_subcommand("eval", "Function file → its value, gradient and curvature at points");
  auto a = std::make_shared<EvalArguments>();
  c.add_option("input", a->input, "Function, .smf").type_name("FILE").required();
  c.add_option("--points", a->points.files, "Where: the points of this file; may be repeated (tiles)")
      .type_name("FILE")
      .repeated();
  add_class_options(c, a->points);
  c.add_option("--at", a->at, "Where: at this place, x,y,z; may be repeated").numbers(3).repeated().type_name("POINT");
  c.add_option("-o,--output", a->output, "Points to write with attributes: .ply .csv .pcd .vtp").type_name("FILE");
  add_ascii_flag(c, a->ascii);
  c.footer(
      "The value is about the distance to the surface, negative inside, in the unit of the input. k1 and k2 are the\n"
      "principal curvatures of the level set through the point, per length, positive where it is convex.\n\n"
      "Examples:\n"
      "  sansmesh eval scan.smf --at 0.1,0.2,0.3\n"
      "  sansmesh eval scan.smf --at 0,0,0 --at 0,0,1 --json\n"
      "  sansmesh eval scan.smf --points probes.xyz -o values.csv");
  return {&c, [a](Console& console) { run_eval(*a, console); }};
}

}  // namespace sansmesh::cli
