// sansmesh normals: estimate and orient the normals of a cloud.
#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "cloud_input.h"
#include "commands.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"
#include "sansmesh/io/io.h"
#include "sansmesh/points/duplicates.h"
#include "sansmesh/points/noise.h"
#include "sansmesh/points/normals.h"
#include "sansmesh/points/orientation.h"
#include "sansmesh/points/spacing.h"

namespace sansmesh::cli {
namespace {

struct NormalsArguments {
  CloudInput input;
  std::string output;
  bool ascii = false;
  bool keep = false;       ///< orient the file's normals instead of estimating new ones
  bool no_orient = false;  ///< leave the signs as they come
  OrientBy orient_by = OrientBy::automatic;
  NormalOptions options;
};

void run_normals(const NormalsArguments& arguments, Console& console) {
  arguments.options.validate();
  require(!arguments.no_orient || arguments.orient_by == OrientBy::automatic,
          "--orient-by means nothing with --no-orient");
  check_writable(arguments.output, "points");

  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  PointSet points = arguments.input.read(console, read);
  if (arguments.keep && !points.has_normals())
    throw FileError(arguments.input.name(), "holds no normals to keep; leave out --keep to estimate them");
  if (count_unique(points) < 3)
    throw FileError(arguments.input.name(), "holds fewer than 3 different points: normals need neighbours");

  progress.begin("spacing and noise");
  NormalOptions options = arguments.options;
  options.spacing = estimate_spacing(points);
  const NoiseEstimate noise = measure_noise(points);
  options.noise = noise.deviation;
  const int neighbours = options.neighbours.value_or(choose_neighbours(*options.spacing, *options.noise));
  if (!arguments.keep) estimate_normals(points, options, progress);
  std::optional<OrientBy> oriented_by;
  if (!arguments.no_orient) {
    OrientationOptions orientation;
    orientation.noise = options.noise;
    orientation.by = arguments.orient_by;
    try {
      oriented_by = orient_normals(points, orientation, progress);
    } catch (const DataError& error) {
      throw FileError(arguments.input.name(), error.what());
    }
  }
  progress.begin("check normals");
  GivenNormals made = judge_normals(points, noise.deviation);
  progress.begin("write");
  write_points(arguments.output, points, {.ascii = arguments.ascii});
  progress.finish();

  const auto unknown = static_cast<std::size_t>(std::count(points.normals.begin(), points.normals.end(), Vec3f{}));
  console.say(fmt::format("{}: {}, spacing {}, noise {} ({})", arguments.input.name(), counted(points.size(), "point"),
                          length(*options.spacing), noise_words(noise, *options.spacing), read.format));
  console.say(fmt::format("{}: normals {}{}{}", arguments.output,
                          arguments.keep ? "of the file" : fmt::format("from {} neighbours", neighbours),
                          oriented_by ? fmt::format(", signs {}", orientation_words(*oriented_by))
                                      : std::string(", signs left as they are"),
                          unknown > 0 ? fmt::format(", {} unknown (zero)", grouped(unknown)) : ""));
  console.say(fmt::format("checked: {}", made.words));
  if (console.options().json) {
    Json json;
    json["input"] = arguments.input.json(read, points.size());
    json["output"] = {{"file", arguments.output}};
    json["spacing"] = *options.spacing;
    json["noise"] = *options.noise;
    json["neighbours"] = arguments.keep ? Json() : Json(neighbours);
    json["oriented"] = made.oriented;
    json["orientation"] = std::move(made.json);
    json["noise_known"] = noise.known;
    json["oriented_by"] = oriented_by ? Json(orient_by_word(*oriented_by)) : Json();
    json["unknown"] = unknown;
    console.say_json(json);
  }
  console.print_timings();
}

}  // namespace

Command add_normals(CommandLine& app) {
  CommandLine& c = app.add_subcommand("normals", "Points → points with oriented normals");
  auto shared = std::make_shared<NormalsArguments>();
  NormalsArguments& a = *shared;
  add_cloud_input(c, a.input, "Points, or a mesh or polygon soup");
  c.add_option("-o,--output", a.output, "Points to write: .ply .obj .xyz .csv .pcd .vtp .las")
      .type_name("FILE")
      .required();
  add_ascii_flag(c, a.ascii);
  c.add_option("--neighbours", a.options.neighbours, "Samples in a neighbourhood, 6..500 [from spacing and noise]")
      .type_name("COUNT");
  c.add_choice<NormalOptions::Method>(
       "--method", a.options.method,
       {{"covariance", NormalOptions::Method::covariance}, {"jet", NormalOptions::Method::jet}},
       "covariance (a plane) or jet (a quadric) [jet]")
      .type_name("CHOICE");
  c.add_option("--reweightings", a.options.reweightings,
               "Rounds, 0..10, that silence samples off the fit: sharper at creases [0]")
      .type_name("COUNT");
  c.add_flag("--keep", a.keep, "Keep the normals of the file and only orient them");
  c.add_flag("--no-orient", a.no_orient, "Leave the signs as they come");
  add_orient_by(c, a.orient_by);
  c.footer(std::string(kReadable) +
           "\n\nExamples:\n"
           "  sansmesh normals scan.xyz -o oriented.ply\n"
           "  sansmesh normals scan.xyz -o oriented.ply --neighbours 30 --orient-by up");
  return {&c, [shared](Console& console) { run_normals(*shared, console); }};
}

}  // namespace sansmesh::cli
