// sansmesh project: points onto the surface of samples; resampling, denoising, consolidation.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "cloud_input.h"
#include "commands.h"
#include "option_groups.h"
#include "option_values.h"
#include "sansmesh/core/error.h"
#include "sansmesh/io/io.h"
#include "sansmesh/model/sample_surface.h"
#include "sansmesh/surface/lop.h"
#include "surface_options.h"

namespace sansmesh::cli {
namespace {

struct ProjectArguments {
  CloudInput input, onto;
  std::string output;
  std::string method = "auto";  ///< a projection, an implicit surface, lop, or what suits the samples
  bool ascii = false;
  CloudUse cloud;
  SurfaceOptions surface;
  LopOptions lop;
  int steps = 10;
  double tolerance = 1e-3;            ///< over the spacing
  std::optional<std::size_t> points;  ///< resample to about so many
};

/// Options of surfaces that not all of them heed: with them, and without a method, it is `curvature`, as they are its.
bool of_curvature(const SurfaceOptions& s) { return !options_set(s).empty(); }

/// Throws ArgumentError for options that the method would not heed.
void check_options_fit(const ProjectArguments& a) {
  const ProjectArguments none;
  const bool chosen = a.method == "auto";
  const auto check = [&](bool ok, const char* option, const char* what) {
    if (!ok)
      throw ArgumentError(fmt::format("{} means nothing {}: {}", option,
                                      chosen ? std::string("here") : "to --method " + a.method, what));
  };
  if (a.method == "lop") {
    const char* const what = "it has no surface, and moves to the input";
    check(a.onto.files.empty(), "--onto", what);
    for (const std::string_view option : options_set(a.surface))
      check(false, fmt::format("`{}`", option).c_str(), what);
    check(!a.cloud.remove_outliers, "--remove-outliers", "outliers hardly draw its points");
    check(a.steps == none.steps, "--steps", what);
    check(a.tolerance == none.tolerance, "--tolerance", what);
  } else {
    check(!a.lop.radius, "--radius", "it belongs to lop");
    check(a.lop.repulsion == none.lop.repulsion, "--repulsion", "it belongs to lop");
  }
}

void run_project(const ProjectArguments& arguments, Console& console) {
  check_options_fit(arguments);
  check_writable(arguments.output, "points");
  const ProjectToSurface how{arguments.steps, arguments.tolerance};
  how.validate();
  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  CloudInput input = arguments.input, samples_of = arguments.onto;
  const bool itself = samples_of.files.empty();
  if (!itself) samples_of.classes = std::exchange(input.classes, {});  // they choose among the samples
  PointSet points = input.read(console, read);
  const std::size_t given = points.size();

  PointSet result;
  SurfaceProjection report;
  std::string method = arguments.method;
  if (arguments.method == "lop") {
    LopOptions options = arguments.lop;
    options.points = arguments.points;
    options.validate();
    try {
      result = consolidate(points, options, progress);
    } catch (const DataError& error) {
      throw FileError(arguments.input.name(), error.what());
    }
    report.projected = result.size();
  } else {
    SurfaceOptions surface = arguments.surface;
    const bool suited = arguments.method == "auto" && !of_curvature(surface);
    if (arguments.method != "auto" || !suited)
      surface.method = arguments.method == "auto" ? "curvature" : arguments.method;
    surface.validate();
    const std::string onto = itself ? arguments.input.name() : arguments.onto.name();
    ReadReport read_onto;
    PointSet samples = itself ? points : samples_of.read(console, read_onto);
    try {
      PreparedCloud prepared = prepare_cloud(std::move(samples), arguments.cloud, progress);
      const SurfaceModel model = suited ? make_suited_surface(std::move(prepared), progress)
                                        : make_surface_model(std::move(prepared), surface, progress);
      method = model.report().method;
      console.warn(onto, model.warnings());
      result = arguments.points ? resample_surface(model, *arguments.points, how, progress, &report)
                                : project_points(points, model, how, progress, &report);
    } catch (const DataError& error) {
      throw FileError(onto, error.what());
    }
    if (result.size() == 0)
      throw FileError(arguments.input.name(), "no point lies near enough to the surface of " + onto);
  }
  progress.begin("write");
  write_points(arguments.output, result, {.ascii = arguments.ascii});
  progress.finish();

  console.say(fmt::format("{}: {} ({})", arguments.input.name(), counted(given, "point"), read.format));
  if (arguments.method != "lop" && !arguments.points)
    console.say(fmt::format("moved by {} on average (root mean square {}, at most {}); {} too far from the samples",
                            length(report.mean_move), length(report.rms_move), length(report.largest_move),
                            grouped(report.left_out)));
  console.say(fmt::format("{}: {} by {}{}", arguments.output, counted(result.size(), "point"), method,
                          result.has_normals() ? ", with normals" : ""));
  const Json json = {
      {"input", arguments.input.json(read, given)},
      {"method", method},
      {"moved", {{"mean", report.mean_move}, {"rms", report.rms_move}, {"largest", report.largest_move}}},
      {"left_out", report.left_out},
      {"output", {{"file", arguments.output}, {"points", result.size()}}}};
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_project(CommandLine& app) {
  CommandLine& c = app.add_subcommand("project", "Points → points on the surface of samples: denoise, resample");
  auto shared = std::make_shared<ProjectArguments>();
  ProjectArguments& a = *shared;
  add_cloud_input(c, a.input, "Points to move");  // --class: among the samples of --onto, if given
  c.add_option("-o,--output", a.output, "Points to write: .ply .obj .xyz .csv .pcd .vtp .las")
      .type_name("FILE")
      .required();
  c.add_option("--onto", a.onto.files,
               "Samples of the surface; may be repeated (tiles) [the input itself: this denoises]")
      .type_name("FILE")
      .repeated();
  add_ascii_flag(c, a.ascii);
  c.add_option("--method", a.method,
               "auto, lop (consolidation of the input) or a surface: " + SurfaceMethod::registry().names() +
                   " [auto: what suits the samples]")
      .one_of(listed_words("auto, lop, " + SurfaceMethod::registry().names()))
      .type_name("NAME");
  c.add_option("--points", a.points, "Spread about this many new points over the surface instead of moving those given")
      .type_name("COUNT")
      .within(1, 2000000000);
  c.add_option("--steps", a.steps, "Steps of a point at most, 1..1000 [10]").type_name("COUNT");
  c.add_option("--tolerance", a.tolerance, "A point stops after a step shorter than this ratio to the spacing [0.001]")
      .type_name("RATIO");
  c.add_option("--radius", a.lop.radius, "lop: radius of the neighbourhoods [from spacing and noise]")
      .type_name("LENGTH");
  c.add_option("--repulsion", a.lop.repulsion, "lop: how strongly points keep apart, 0..0.5 [0.45]").type_name("SHARE");
  add_surface_details(c, a.surface, a.cloud);
  c.footer(kReadable + surface_list() +
           "\n\nExamples:\n"
           "  sansmesh project noisy.ply -o smooth.ply\n"
           "  sansmesh project probes.xyz --onto scan.ply -o feet.ply --method levin\n"
           "  sansmesh project scan.ply -o dense.ply --points 1000000\n"
           "  sansmesh project outliers.ply -o even.ply --method lop --points 20000");
  return {&c, [shared](Console& console) { run_project(*shared, console); }};
}

}  // namespace sansmesh::cli
