// Command `align`: moves a cloud or mesh onto another one.
#include "sansmesh/inspect.h"

#include <fmt/core.h>

#include <array>
#include <utility>

#include "cli/input/cloud_input.h"
#include "cli/input/surface_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "cli/report/mesh_words.h"
#include "sansmesh/io.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/io/transform_file.h"
#include "sansmesh/pictures.h"

namespace sansmesh::cli {
namespace {

struct AlignArguments {
  CloudInput moving, fixed;
  MeshOutput output;  // or points
  std::string transform_output, start;
  SurfaceAlignmentOptions options;
};

void run_align(const AlignArguments& a, Console& console) {
  AffineMap before;
  if (!a.start.empty()) before = read_transform(a.start);  // first, since the file may not contain a transform
  a.options.validate();
  a.output.check_preview();
  Progress& progress = console.progress();
  const SurfaceInput moving = open_surface(a.moving, console), fixed = open_surface(a.fixed, console);
  const bool points = moving.surface.kind() == AnySurface::Kind::points;
  const std::string& output = a.output.file;
  if (!output.empty()) check_writable(output, points ? "points" : "mesh");
  if (!a.transform_output.empty()) check_writable(a.transform_output, "text");
  AlignResult made = align(moving.surface, fixed.surface, a.options, progress, before);
  const std::string& moving_file = moving.surface.name();
  console.note(moving_file, made.notes);
  if (!a.output.preview.empty()) {
    const RenderOptions look = a.output.picture.chosen();
    a.output.picture.write(a.output.preview, draw_alignment(made, look, progress), look);
  }
  progress.begin("write");
  if (!output.empty()) warn_of_system(output, made.moved.reference.get(), console);
  if (!output.empty() && points) {
    const PointSet cloud = vertices_of(std::move(made.moved));
    warn_of_losses(moving_file, moving.read, output, cloud, console);
    write_points(output, cloud, {.ascii = a.output.ascii});
    console.report(WrittenPoints{output, cloud.size()}, "output");
  } else if (!output.empty()) {
    warn_of_losses(moving_file, moving.read, output, made.moved, console);
    write_mesh(output, made.moved, {.ascii = a.output.ascii});
    report_mesh(output, made.moved, console);
  }
  if (!a.transform_output.empty()) write_transform(a.transform_output, made.motion);
  console.report(moving.report, "moving");
  console.report(fixed.report, "fixed");
  console.report(made);
  if (!a.output.preview.empty()) console.report(FileReport{a.output.preview}, "preview");
  if (!a.transform_output.empty()) console.report(FileReport{a.transform_output}, "transform_output");

  console.print(fmt::format("{} ({}) moved onto {} ({})", moving_file, moving.surface.kind_word(), fixed.surface.name(),
                            fixed.surface.kind_word()));
  console.print(summary_of(made.report));
  if (output.empty() && a.transform_output.empty())
    for (std::size_t row = 0; row < 3; ++row) {
      const std::array<double, 4> m = made.motion.rows()[row];
      console.print(fmt::format("{:>22} {:>22} {:>22} {:>22}", m[0], m[1], m[2], m[3]));
    }
  for (const std::string& file : {output, a.transform_output, a.output.preview})
    if (!file.empty()) console.print(file + ": written");
}

}  // namespace

Command add_align(CommandLine& app) {
  CommandLine& c = app.add_subcommand("align", "Cloud or mesh → the same, moved onto another surface");
  auto a = std::make_shared<AlignArguments>();
  a->moving.files.resize(1);
  add_surface_input(c, "moving", a->moving.files[0], "Surface to move: mesh, points, or function (.smf)");
  add_surface_input(c, "fixed", a->fixed.files,
                    "Fixed surface: mesh, points, or function; several files are read as one");
  add_selection_options(c, a->fixed, " of the fixed surface");
  c.add_option("-o,--output", a->output.file, "Moved surface with all attributes: formats of meshes or of points")
      .writes(endings_written(kMesh | kPoints));
  c.add_option("--transform-output", a->transform_output, "Motion as 4 rows of 4 numbers (.json: as JSON)")
      .writes({".txt", ".json"});
  add_schema(c, a->options, {.group = "Alignment"});
  c.add_option("--start-transform", a->start, "Apply this transform first: 4 rows of 4 numbers").reads();
  add_preview_option(c, a->output.preview, "both surfaces, the moved one in orange,");
  add_ascii_flag(c, a->output.ascii);
  add_picture_options(c, a->output.picture);
  add_wireframe_options(c, a->output.picture.options);
  c.footer(
      "Distances are measured from samples of the moving surface to the fixed one; parts beyond its borders, or\n"
      "without a counterpart, are ignored. Without an output the motion is printed.\n\n"
      "Examples:\n"
      "  sansmesh align scan.ply design.stl -o aligned.ply --transform-output motion.txt\n"
      "  sansmesh align second.ply first.ply --from anywhere --json\n"
      "  sansmesh align inches.stl millimetres.ply -o same.stl --find-scale");
  c.announce({report_of<ReadSurface>("moving"), report_of<ReadSurface>("fixed"), report_of<AlignResult>(),
              report_of<WrittenPoints>("output"), report_of<WrittenMesh>("output"), report_of<FileReport>("preview"),
              report_of<FileReport>("transform_output")});
  return {&c, [a](Console& console) { run_align(*a, console); }};
}

}  // namespace sansmesh::cli
