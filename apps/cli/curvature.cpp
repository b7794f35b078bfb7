// sansmesh curvature: principal curvatures of a scan as attributes and as a picture.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "cloud_input.h"
#include "color_bar.h"
#include "commands.h"
#include "mesh_words.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"
#include "sansmesh/data/image.h"
#include "sansmesh/io/io.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/points/spacing.h"
#include "sansmesh/surface/curvature.h"
#include "sansmesh/surface/curvature_colors.h"
#include "sansmesh/surface/vertex_curvature.h"

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

/// What was read, with the normals that were used, and the curvatures at each of its samples or vertices.
struct CurvedInput {
  PointSet points;
  std::vector<PrincipalCurvatures> curvatures;
  double noise = 0;

  bool is_mesh() const { return !points.triangles.empty(); }
};

/// Those of a mesh are at its vertices, all of them and in their order, be they as few as they are.
CurvedInput curvatures_of(PointSet given, const CurvatureArguments& arguments, Console& console) {
  Progress& progress = console.progress();
  const bool is_mesh = !given.triangles.empty();
  const char* const kRow = "row of the file";
  CloudUse use;
  PointSet mesh;
  if (is_mesh) {
    use.faces = FaceUse::vertices;
    mesh = given;
    std::vector<std::uint32_t> rows(given.size());
    std::iota(rows.begin(), rows.end(), 0u);
    given.attributes.set(kRow, std::move(rows));
  }
  PreparedCloud cloud = prepare_cloud(std::move(given), use, progress);
  console.warn(arguments.input.name(), cloud.warnings);
  CurvatureOptions options = arguments.options;
  // Known unless normals are taken as given.
  options.noise = is_mesh ? known_noise(cloud.points) : *cloud.noise;
  if (options.radius) options.radius = cloud.place.from_input(*options.radius);
  progress.begin("curvature");
  CurvedInput made;
  made.noise = cloud.place.to_input(*options.noise);
  made.curvatures = is_mesh ? estimate_vertex_curvatures(cloud.points, options, progress)
                            : estimate_curvatures(cloud.points, options, progress);
  const auto unit = static_cast<float>(cloud.place.unit);
  for (PrincipalCurvatures& c : made.curvatures) c.k1 /= unit, c.k2 /= unit, c.offset *= unit;
  if (!is_mesh) {
    made.points = std::move(cloud.points);
    move_to_input(made.points, cloud.place);
    return made;
  }
  const std::vector<PrincipalCurvatures> found = std::exchange(made.curvatures, {});
  made.curvatures.resize(mesh.size());
  mesh.normals.resize(mesh.size());
  const std::vector<std::uint32_t>& rows = *cloud.points.attributes.find<std::uint32_t>(kRow);
  for (std::size_t i = 0; i < found.size(); ++i) {
    made.curvatures[rows[i]] = found[i];
    mesh.normals[rows[i]] = cloud.points.normals[i];
  }
  made.points = std::move(mesh);
  return made;
}

void add_attributes(CurvedInput& to) {
  const auto add = [&](const char* name, auto value) {
    std::vector<float> values(to.curvatures.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = value(to.curvatures[i]);
    to.points.attributes.set(name, std::move(values));
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
}

/// The quantity that is shown, over what has one.
struct ShownCurvature {
  CurvatureQuantity quantity = CurvatureQuantity::mean;
  std::vector<float> values, sizes;
  double range = 0;  ///< of full colour
  std::size_t undefined = 0;
};

/// Colours the samples by it.
ShownCurvature show_curvature(CurvedInput& made, const CurvatureArguments& arguments) {
  ShownCurvature shown;
  shown.quantity = arguments.color_by.value_or(CurvatureQuantity::mean);
  for (const PrincipalCurvatures& c : made.curvatures) {
    shown.undefined += !c.defined;
    if (!c.defined) continue;
    shown.values.push_back(chosen_quantity(c, shown.quantity));
    shown.sizes.push_back(std::abs(shown.values.back()));
  }
  shown.range = arguments.color_range.value_or(quantile(shown.sizes, 0.95));
  const auto scale = static_cast<float>(shown.range);
  made.points.colors.resize(made.points.size());
  for (std::size_t i = 0; i < made.points.size(); ++i) {
    Vec3f color{0.5f, 0.5f, 0.5f};
    if (made.curvatures[i].defined)
      color = diverging_color(scale > 0 ? chosen_quantity(made.curvatures[i], shown.quantity) / scale : 0);
    made.points.colors[i] = {to_byte(color.x), to_byte(color.y), to_byte(color.z)};
  }
  return shown;
}

void report_curvature(const CurvatureArguments& arguments, const CurvedInput& made, const ShownCurvature& shown,
                      const ReadReport& read, Console& console) {
  const std::size_t n = made.points.size();
  const char* const word = quantity_word(shown.quantity);
  const auto words = [&](std::size_t count) {
    if (!made.is_mesh()) return counted(count, "sample");
    return count == 1 ? std::string("1 vertex") : grouped(count) + " vertices";
  };
  const double low = quantile(shown.values, 0.05), middle = quantile(shown.values, 0.5),
               high = quantile(shown.values, 0.95);
  console.say(fmt::format("{}: {}, noise {} ({})", arguments.input.name(), words(n), length(made.noise), read.format));
  console.say(fmt::format(
      "{} curvature: 5 % below {}, half below {}, 95 % below {} ({})", word, length(low), length(middle), length(high),
      shown.quantity == CurvatureQuantity::gaussian ? "1/length²" : "1/length, positive where convex"));
  if (shown.undefined > 0) console.say(fmt::format("{} without enough neighbours: zero", words(shown.undefined)));
  console.say(
      fmt::format("{}: k1 k2 mean_curvature gaussian_curvature curvedness shape_index d1 d2, colours of {} "
                  "up to ±{}",
                  arguments.output, word, length(shown.range)));
  const Json json = {{"input", arguments.input.json(read, n)},
                     {"noise", made.noise},
                     {"undefined", shown.undefined},
                     {word, {{"q05", low}, {"median", middle}, {"q95", high}}},
                     {"color_range", shown.range},
                     {"output", {{"file", arguments.output}}}};
  console.say_json(json);
  console.print_timings();
}

void run_curvature(const CurvatureArguments& arguments, Console& console) {
  arguments.options.validate();
  const bool only_mesh = is_written(arguments.output, "mesh") && !is_written(arguments.output, "points");
  check_writable(arguments.output, only_mesh ? "mesh" : "points");
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
  if (given.triangles.empty()) check_writable(arguments.output, "points");
  CurvedInput made;
  try {
    made = curvatures_of(std::move(given), arguments, console);
  } catch (const DataError& error) {
    throw FileError(arguments.input.name(), error.what());
  }
  add_attributes(made);
  const PointSet& points = made.points;
  const ShownCurvature shown = show_curvature(made, arguments);
  Image preview;
  if (!arguments.preview.empty()) {
    std::optional<ColorBar> bar;
    const bool beyond = std::any_of(shown.sizes.begin(), shown.sizes.end(),
                                    [&](float s) { return static_cast<double>(s) > shown.range; });
    if (!arguments.no_bar) bar = curvature_bar(shown.quantity, shown.range, arguments.unit, beyond);
    leave_room(look, bar);
    preview = beside_bar(render_mesh(to_mesh(points), look, progress), bar, look);
  }
  progress.begin("write");
  if (made.is_mesh() && is_written(arguments.output, "mesh")) {
    const TriangleMesh mesh = to_mesh(points);
    console.warn(arguments.input.name(), loss_words(read, arguments.output, mesh));
    write_mesh(arguments.output, mesh, {.ascii = arguments.ascii});
  } else {
    write_points(arguments.output, points, {.ascii = arguments.ascii});
  }
  if (!arguments.preview.empty()) arguments.picture.write(arguments.preview, preview, look);
  progress.finish();

  report_curvature(arguments, made, shown, read, console);
}

}  // namespace

Command add_curvature(CommandLine& app) {
  CommandLine& c = app.add_subcommand("curvature", "Points or mesh → principal curvatures and directions at them");
  auto shared = std::make_shared<CurvatureArguments>();
  CurvatureArguments& a = *shared;
  add_cloud_input(c, a.input, "Points, or a mesh or polygon soup");
  c.add_option("-o,--output", a.output,
               "Points or mesh to write with attributes: .ply .csv .pcd .vtp, of meshes .glb (others: colours only)")
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
  c.footer(
      std::string(kReadable) +
      "\n\nCurvatures are per length of the input, positive where the surface is convex. Those of a mesh are at its "
      "vertices."
      "\n\nExamples:\n"
      "  sansmesh curvature scan.ply -o curved.ply --preview curved.png\n"
      "  sansmesh curvature scan.ply -o table.csv --color-by gaussian");
  return {&c, [shared](Console& console) { run_curvature(*shared, console); }};
}

}  // namespace sansmesh::cli
