// Command `curvature`: principal curvatures of a scan as attributes and as a picture.
#include "sansmesh/points.h"

#include <fmt/core.h>

#include <utility>

#include "cli/input/cloud_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "cli/report/mesh_words.h"
#include "sansmesh/io.h"
#include "sansmesh/pictures.h"

namespace sansmesh::cli {
namespace {

struct CurvatureArguments {
  CloudInput input;
  std::string output, preview;
  PictureArguments picture;
  bool ascii = false;
  CurvatureMapOptions options;
};

void check_curvature(const CurvatureArguments& a) {
  a.options.validate();
  const bool only_mesh = is_written(a.output, "mesh") && !is_written(a.output, "points");
  check_writable(a.output, only_mesh ? "mesh" : "points");
  a.picture.chosen().validate();
  require(!a.preview.empty() || !a.picture.any(), "options of the picture need --preview");
  require(!a.preview.empty() || (a.options.unit.empty() && a.options.bar), "--unit and --no-bar need --preview");
  if (!a.preview.empty()) check_writable(a.preview, "image");
}

void run_curvature(const CurvatureArguments& a, Console& console) {
  check_curvature(a);
  Progress& progress = console.progress();
  const std::string name = a.input.name();
  ReadReport read;
  PointSet given = a.input.read(console, read);
  if (given.triangles.empty()) check_writable(a.output, "points");
  const CurvatureResult made = naming(name, console, [&] { return curvature(std::move(given), a.options, progress); });
  console.note(name, made.notes);
  const CurvatureReport& r = made.report;
  MapPicture preview;
  if (!a.preview.empty()) preview = draw_curvature(made, a.options, a.picture.chosen(), progress);
  progress.begin("write");
  warn_of_system(a.output, made.points.reference.get(), console);
  if (r.mesh && is_written(a.output, "mesh")) {
    const TriangleMesh mesh = to_mesh(made.points);
    warn_of_losses(name, read, a.output, mesh, console);
    write_mesh(a.output, mesh, {.ascii = a.ascii});
  } else {
    write_points(a.output, made.points, {.ascii = a.ascii});
  }
  if (!a.preview.empty()) a.picture.write(a.preview, preview.image, preview.made_with);
  console.report(a.input.report(read, made.points.size()), "input");
  console.report(r);
  console.report(FileReport{a.output}, "output");
  console.print_named(name + " (" + read.format + ")", summary_of(made));
  console.print(
      fmt::format("{}: k1 k2 mean_curvature gaussian_curvature curvedness shape_index d1 d2, colours of {} up to ±{}",
                  a.output, quantity_word(r.color_by), length(r.color_range)));
}

}  // namespace

Command add_curvature(CommandLine& app) {
  CommandLine& c = app.add_subcommand("curvature", "Points or mesh → principal curvatures and directions at them");
  auto shared = std::make_shared<CurvatureArguments>();
  CurvatureArguments& a = *shared;
  add_cloud_input(c, a.input, "Points, or a mesh or polygon soup");
  c.add_option("-o,--output", a.output,
               "Points or mesh to write with attributes: .ply .csv .pcd .vtp, .glb for meshes (others: colours only)")
      .writes({".ply", ".csv", ".pcd", ".vtp", ".glb"})
      .required();
  add_preview_option(c, a.preview, "the coloured points");
  add_ascii_flag(c, a.ascii);
  add_picture_options(c, a.picture);
  add_schema(c, a.options, {.group = "Picture", .only = {"bar", "unit"}});
  add_schema(c, a.options, {.without = {"bar", "unit"}});
  c.footer(std::string(kReadable) +
           "\n\nCurvatures are per length of the input, positive where the surface is convex. A mesh has them at its "
           "vertices."
           "\n\nExamples:\n"
           "  sansmesh curvature scan.ply -o curved.ply --preview curved.png\n"
           "  sansmesh curvature scan.ply -o table.csv --color-by gaussian");
  c.announce({report_of<ReadCloud>("input"), report_of<CurvatureReport>(), report_of<FileReport>("output")});
  return {&c, [shared](Console& console) { run_curvature(*shared, console); }};
}

}  // namespace sansmesh::cli
