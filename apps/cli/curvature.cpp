// sansmesh curvature: principal curvatures of a scan as attributes and as a picture.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "cloud_input.h"
#include "color_bar.h"
#include "commands.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"
#include "sansmesh/data/image.h"
#include "sansmesh/io/io.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/points/spacing.h"
#include "sansmesh/surface/curvature.h"
#include "sansmesh/surface/curvature_colors.h"

namespace sansmesh::cli {
namespace {

struct CurvatureArguments {
  CloudInput input;
  std::string output, preview;
  std::optional<CurvatureQuantity> color_by;
  std::optional<double> color_range;
  PictureArguments picture;
  std::string unit;
  bool ascii = false, no_bar = false;
  CurvatureOptions options;
};

float chosen_quantity(const PrincipalCurvatures& c, CurvatureQuantity quantity) {
  switch (quantity) {
    case CurvatureQuantity::gaussian:
      return gaussian_curvature(c);
    case CurvatureQuantity::k1:
      return c.k1;
    case CurvatureQuantity::k2:
      return c.k2;
    case CurvatureQuantity::mean:
      break;
  }
  return mean_curvature(c);
}

double quantile(std::vector<float> values, double q) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return static_cast<double>(*at);
}

void run_curvature(const CurvatureArguments& arguments, Console& console) {
  arguments.options.validate();
  check_writable(arguments.output, "points");
  RenderOptions look = arguments.picture.chosen();
  look.validate();
  require(!arguments.preview.empty() || !arguments.picture.any(), "options of the picture need --preview");
  require(!arguments.preview.empty() || (arguments.unit.empty() && !arguments.no_bar),
          "--unit and --no-bar need --preview");
  if (!arguments.preview.empty()) check_writable(arguments.preview, "image");

  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  PointSet given = arguments.input.read(console, read);
  PointSet points;
  double noise = 0;
  std::vector<PrincipalCurvatures> curvatures;
  try {
    PreparedCloud cloud = prepare_cloud(std::move(given), {}, progress);
    console.warn(arguments.input.name(), cloud.warnings);
    CurvatureOptions options = arguments.options;
    options.noise = cloud.noise;  // known unless normals are taken as given
    noise = cloud.place.to_input(*cloud.noise);
    if (options.radius) options.radius = cloud.place.from_input(*options.radius);
    progress.begin("curvature");
    curvatures = estimate_curvatures(cloud.points, options, progress);
    points = std::move(cloud.points);
    move_to_input(points, cloud.place);
    const auto unit = static_cast<float>(cloud.place.unit);
    for (PrincipalCurvatures& c : curvatures) c.k1 /= unit, c.k2 /= unit, c.offset *= unit;
  } catch (const DataError& error) {
    throw FileError(arguments.input.name(), error.what());
  }

  const std::size_t n = points.size();
  const auto add = [&](const char* name, auto value) {
    std::vector<float> values(n);
    for (std::size_t i = 0; i < n; ++i) values[i] = value(curvatures[i]);
    points.attributes.set(name, std::move(values));
  };
  add("k1", [](const PrincipalCurvatures& c) { return c.k1; });
  add("k2", [](const PrincipalCurvatures& c) { return c.k2; });
  add("mean_curvature", mean_curvature);
  add("gaussian_curvature", gaussian_curvature);
  add("curvedness", curvedness);
  add("shape_index", shape_index);
  const char* const axis = "xyz";
  for (std::size_t k = 0; k < 3; ++k)
    add(fmt::format("d1{}", axis[k]).c_str(), [k](const PrincipalCurvatures& c) { return c.direction1[k]; });
  for (std::size_t k = 0; k < 3; ++k)
    add(fmt::format("d2{}", axis[k]).c_str(), [k](const PrincipalCurvatures& c) { return c.direction2[k]; });

  const CurvatureQuantity quantity = arguments.color_by.value_or(CurvatureQuantity::mean);
  const char* const word = quantity_word(quantity);
  std::vector<float> values, sizes;
  std::size_t undefined = 0;
  for (const PrincipalCurvatures& c : curvatures) {
    undefined += !c.defined;
    if (!c.defined) continue;
    values.push_back(chosen_quantity(c, quantity));
    sizes.push_back(std::abs(values.back()));
  }
  const double range = arguments.color_range.value_or(quantile(sizes, 0.95));
  points.colors.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    Vec3f color{0.5f, 0.5f, 0.5f};
    if (curvatures[i].defined)
      color = diverging_color(range > 0 ? chosen_quantity(curvatures[i], quantity) / static_cast<float>(range) : 0);
    points.colors[i] = {to_byte(color.x), to_byte(color.y), to_byte(color.z)};
  }
  Image preview;
  if (!arguments.preview.empty()) {
    std::optional<ColorBar> bar;
    const bool beyond = std::any_of(sizes.begin(), sizes.end(), [&](float s) { return s > range; });
    if (!arguments.no_bar) bar = curvature_bar(quantity, range, arguments.unit, beyond);
    leave_room(look, bar);
    preview = beside_bar(render_mesh(to_mesh(points), look, progress), bar, look);
  }
  progress.begin("write");
  write_points(arguments.output, points, {.ascii = arguments.ascii});
  if (!arguments.preview.empty()) arguments.picture.write(arguments.preview, preview, look);
  progress.finish();

  const double low = quantile(values, 0.05), middle = quantile(values, 0.5), high = quantile(values, 0.95);
  console.say(
      fmt::format("{}: {}, noise {} ({})", arguments.input.name(), counted(n, "sample"), length(noise), read.format));
  console.say(fmt::format("{} curvature: 5 % below {}, half below {}, 95 % below {} ({})", word, length(low),
                          length(middle), length(high),
                          quantity == CurvatureQuantity::gaussian ? "1/length²" : "1/length, positive where convex"));
  if (undefined > 0) console.say(fmt::format("{} without enough neighbours: zero", counted(undefined, "sample")));
  console.say(
      fmt::format("{}: k1 k2 mean_curvature gaussian_curvature curvedness shape_index d1 d2, colours of {} "
                  "up to ±{}",
                  arguments.output, word, length(range)));
  const Json json = {{"input", arguments.input.json(read, n)},
                     {"noise", noise},
                     {"undefined", undefined},
                     {word, {{"q05", low}, {"median", middle}, {"q95", high}}},
                     {"color_range", range},
                     {"output", {{"file", arguments.output}}}};
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_curvature(CommandLine& app) {
  CommandLine& c = app.add_subcommand("curvature", "Points → principal curvatures and directions at them");
  auto shared = std::make_shared<CurvatureArguments>();
  CurvatureArguments& a = *shared;
  add_cloud_input(c, a.input, "Points, or a mesh or polygon soup");
  c.add_option("-o,--output", a.output, "Points to write with attributes: .ply .csv .pcd .vtp (others: colours only)")
      .type_name("FILE")
      .required();
  add_preview_option(c, a.preview, "the coloured points");
  add_ascii_flag(c, a.ascii);
  add_picture_options(c, a.picture);
  add_bar_options(c, a.no_bar, a.unit, "lengths");
  add_curvature_colors(c, a.color_by, a.color_range, "mean, gaussian, k1 or k2 [mean]");
  c.add_option("--neighbours", a.options.neighbours, "Samples in a neighbourhood, 8..2000 [from noise and shape]")
      .type_name("COUNT");
  c.add_option("--radius", a.options.radius, "Width of the weights as one length, in place of --neighbours")
      .type_name("LENGTH");
  c.add_option("--tau", a.options.tau, "Exponent of the M-like weights, 1..4 [2]").type_name("EXPONENT");
  c.add_choice<CurvatureOptions::Weights>("--weights", a.options.weights,
                                          {{"m-like", CurvatureOptions::Weights::m_like},
                                           {"gaussian", CurvatureOptions::Weights::gaussian},
                                           {"uniform", CurvatureOptions::Weights::uniform}},
                                          "m-like, gaussian or uniform [m-like]")
      .type_name("CHOICE");
  c.footer(std::string(kReadable) +
           "\n\nCurvatures are per length of the input, positive where the surface is convex."
           "\n\nExamples:\n"
           "  sansmesh curvature scan.ply -o curved.ply --preview curved.png\n"
           "  sansmesh curvature scan.ply -o table.csv --color-by gaussian");
  return {&c, [shared](Console& console) { run_curvature(*shared, console); }};
}

}  // namespace sansmesh::cli
