// sansmesh align: one cloud or mesh moved onto another.
#include "sansmesh/inspect.h"

#include <fmt/core.h>

#include <array>
#include <utility>
#include <vector>

#include "cli/input/cloud_input.h"
#include "cli/input/surface_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "cli/report/mesh_words.h"
#include "sansmesh/io.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/io/transform_file.h"
#include "sansmesh/jobs/cloud_or_mesh.h"
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
  if (!a.start.empty()) before = read_transform(a.start);  // before all else: it may be no transform
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
  if (!output.empty() && points) {
    const PointSet cloud = vertices_of(std::move(made.moved));
    warn_of_losses(moving_file, moving.read, output, cloud, console);
    write_points(output, cloud, {.ascii = a.output.ascii});
    console.tell(WrittenPoints{output, cloud.size()}, "output");
  } else if (!output.empty()) {
    warn_of_losses(moving_file, moving.read, output, made.moved, console);
    write_mesh(output, made.moved, {.ascii = a.output.ascii});
    tell_mesh(output, made.moved, console);
  }
  if (!a.transform_output.empty()) write_transform(a.transform_output, made.motion);
  console.tell(moving.told, "moving");
  console.tell(fixed.told, "fixed");
  console.tell(made);
  if (!a.output.preview.empty()) console.tell(ToldFile{a.output.preview}, "preview");
  if (!a.transform_output.empty()) console.tell(ToldFile{a.transform_output}, "transform_output");

  console.say(fmt::format("{} ({}) moved onto {} ({})", moving_file, moving.surface.kind_word(), fixed.surface.name(),
                          fixed.surface.kind_word()));
  console.say(summary_of(made.report));
  if (output.empty() && a.transform_output.empty())
    for (std::size_t row = 0; row < 3; ++row) {
      const std::array<double, 4> m = made.motion.rows()[row];
      console.say(fmt::format("{:>22} {:>22} {:>22} {:>22}", m[0], m[1], m[2], m[3]));
    }
  for (const std::string& file : {output, a.transform_output, a.output.preview})
    if (!file.empty()) console.say(file + ": written");
}

}  // namespace

Command add_align(CommandLine& app) {
  CommandLine& c = app.add_subcommand("align", "Cloud or mesh → the same moved onto another surface");
  auto a = std::make_shared<AlignArguments>();
  a->moving.files.resize(1);
  c.add_option("moving", a->moving.files[0], "What moves: mesh, points, or function (.smf)")
      .reads(endings_read(kPoints | kFunction))
      .required();
  c.add_option("fixed", a->fixed.files, "What it moves onto: mesh, points, or function; several files are read as one")
      .reads(endings_read(kPoints | kFunction))
      .required();
  add_class_options(c, a->fixed, " of what it moves onto");
  c.add_option("-o,--output", a->output.file, "What has moved, with all its attributes: formats of meshes or of points")
      .writes(endings_written(kMesh | kPoints));
  c.add_option("--transform-output", a->transform_output, "The motion as 4 rows of 4 numbers (.json: as JSON)")
      .writes({".txt", ".json"});
  add_schema(c, a->options, {.group = "Alignment"});
  c.add_option("--start-transform", a->start, "First move it by this: 4 rows of 4 numbers").reads();
  add_preview_option(c, a->output.preview, "both, what has moved in orange,");
  add_ascii_flag(c, a->output.ascii);
  add_picture_options(c, a->output.picture);
  add_wireframe_options(c, a->output.picture.options);
  c.footer(
      "Distances run from samples of what moves to the surface of what is fixed; what lies beyond its borders, or\n"
      "has no counterpart, does not count. Without an output the motion is printed.\n\n"
      "Examples:\n"
      "  sansmesh align scan.ply design.stl -o aligned.ply --transform-output motion.txt\n"
      "  sansmesh align second.ply first.ply --from anywhere --json\n"
      "  sansmesh align inches.stl millimetres.ply -o same.stl --find-scale");
  c.tells({told<ReadSurface>("moving"), told<ReadSurface>("fixed"), told<AlignResult>(), told<WrittenPoints>("output"),
           told<WrittenMesh>("output"), told<ToldFile>("preview"), told<ToldFile>("transform_output")});
  return {&c, [a](Console& console) { run_align(*a, console); }};
}

}  // namespace sansmesh::cli
