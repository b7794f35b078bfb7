// sansmesh curvature: principal curvatures of a scan as attributes and as a picture.
#include "sansmesh/jobs/color_bar.h"
#include "sansmesh/points.h"

#include <fmt/core.h>

#include <utility>

#include "cloud_input.h"
#include "commands.h"
#include "mesh_words.h"
#include "option_groups.h"
#include "sansmesh/io.h"
#include "schema_options.h"

namespace sansmesh::cli {
namespace {

struct CurvatureArguments {
  CloudInput input;
  std::string output, preview;
  PictureArguments picture;
  std::string unit;
  bool ascii = false, no_bar = false;
  CurvatureMapOptions options;
};

void report_curvature(const CurvatureArguments& arguments, const CurvatureResult& made, const ReadReport& read,
                      Console& console) {
  const CurvatureReport& r = made.report;
  const std::size_t n = made.points.size();
  const CurvatureQuantity quantity = arguments.options.color_by;
  const char* const word = quantity_word(quantity);
  const auto words = [&](std::size_t count) {
    if (!r.mesh) return counted(count, "sample");
    return count == 1 ? std::string("1 vertex") : grouped(count) + " vertices";
  };
  console.say(fmt::format("{}: {}, noise {} ({})", arguments.input.name(), words(n), length(r.noise), read.format));
  console.say(fmt::format("{} curvature: 5 % below {}, half below {}, 95 % below {} ({})", word, length(r.q05),
                          length(r.median), length(r.q95),
                          quantity == CurvatureQuantity::gaussian ? "1/length²" : "1/length, positive where convex"));
  if (r.undefined > 0) console.say(fmt::format("{} without enough neighbours: zero", words(r.undefined)));
  console.say(
      fmt::format("{}: k1 k2 mean_curvature gaussian_curvature curvedness shape_index d1 d2, colours of {} "
                  "up to ±{}",
                  arguments.output, word, length(r.color_range)));
  console.tell(arguments.input.told(read, n), "input");
  console.tell(r);
  console.tell(ToldFile{arguments.output}, "output");
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
  ReadReport read;
  PointSet given = arguments.input.read(console, read);
  if (given.triangles.empty()) check_writable(arguments.output, "points");
  const CurvatureResult made =
      naming(arguments.input.name(), console, [&] { return curvature(std::move(given), arguments.options, progress); });
  console.note(arguments.input.name(), made.notes);
  const PointSet& points = made.points;
  const CurvatureReport& r = made.report;
  Image preview;
  if (!arguments.preview.empty()) {
    std::optional<ColorBar> bar;
    if (!arguments.no_bar)
      bar = curvature_bar(arguments.options.color_by, r.color_range, arguments.unit, r.beyond_range);
    leave_room(look, bar);
    preview = beside_bar(render_mesh(to_mesh(points), look, progress), bar, look);
  }
  progress.begin("write");
  if (r.mesh && is_written(arguments.output, "mesh")) {
    const TriangleMesh mesh = to_mesh(points);
    warn_of_losses(arguments.input.name(), read, arguments.output, mesh, console);
    write_mesh(arguments.output, mesh, {.ascii = arguments.ascii});
  } else {
    write_points(arguments.output, points, {.ascii = arguments.ascii});
  }
  if (!arguments.preview.empty()) arguments.picture.write(arguments.preview, preview, look);
  report_curvature(arguments, made, read, console);
}

}  // namespace

Command add_curvature(CommandLine& app) {
  CommandLine& c = app.add_subcommand("curvature", "Points or mesh → principal curvatures and directions at them");
  auto shared = std::make_shared<CurvatureArguments>();
  CurvatureArguments& a = *shared;
  add_cloud_input(c, a.input, "Points, or a mesh or polygon soup");
  c.add_option("-o,--output", a.output,
               "Points or mesh to write with attributes: .ply .csv .pcd .vtp, of meshes .glb (others: colours only)")
      .writes({".ply", ".csv", ".pcd", ".vtp", ".glb"})
      .required();
  add_preview_option(c, a.preview, "the coloured points");
  add_ascii_flag(c, a.ascii);
  add_picture_options(c, a.picture);
  add_bar_options(c, a.no_bar, a.unit, "lengths");
  add_schema(c, a.options);
  c.footer(
      std::string(kReadable) +
      "\n\nCurvatures are per length of the input, positive where the surface is convex. Those of a mesh are at its "
      "vertices."
      "\n\nExamples:\n"
      "  sansmesh curvature scan.ply -o curved.ply --preview curved.png\n"
      "  sansmesh curvature scan.ply -o table.csv --color-by gaussian");
  c.tells({told<ReadCloud>("input"), told<CurvatureReport>(), told<ToldFile>("output")});
  return {&c, [shared](Console& console) { run_curvature(*shared, console); }};
}

}  // namespace sansmesh::cli
