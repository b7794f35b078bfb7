// Command `volume surface`: isosurfaces and surfaces of high gradient directly from the samples of a volume.
#include "sansmesh/isosurfaces.h"
#include "sansmesh/volumes.h"

#include <fmt/core.h>

#include <memory>
#include <optional>
#include <string>

#include "cli/input/volume_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "cli/report/mesh_words.h"
#include "sansmesh/io.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/volume_pictures.h"

namespace sansmesh::cli {
namespace {

struct VolumeSurfaceArguments {
  VolumeInput input;
  SurfaceInVolumeOptions options;
  MeshInVolumeOptions meshing;
  SurfaceInVolumeLook look;
  std::string output, points;
  std::optional<double> distance;
  PictureArguments picture;
  bool ascii = false;

  bool to_picture() const { return output.size() > 4 && output.ends_with(".png"); }
  /// Throws FileError if an output cannot be written, ArgumentError for options that exclude each other.
  void check() const;
};

void VolumeSurfaceArguments::check() const {
  require(!output.empty() || !points.empty(), "--output or --points-output is required");
  require(to_picture() || options_set(look).empty(), "--color-by, --sharp and --frames need a picture");
  require(to_picture() || !picture.any(), "options of the picture need one: -o FILE.png");
  require(!distance || !points.empty(), "--point-spacing needs --points-output");
  require(!distance || *distance > 0, "--point-spacing must be positive");
  require(output != points, "--output and --points-output are the same file");
  if (!output.empty()) check_writable(output, to_picture() ? "image" : "mesh");
  if (!points.empty()) check_writable(points, "points");
  options.validate();
  meshing.validate();
  look.validate();
  if (to_picture()) picture.chosen().validate();
  picture.check_frames(look.frames.has_value());
}

void draw_surface(const VolumeSurfaceArguments& a, const SurfaceInVolume& surface, const VolumeModel& volume,
                  Console& console) {
  PictureFiles files(a.picture, a.output, a.look.frames.has_value(), console);
  const DrawnSurfaceInVolume drawn =
      draw_surface_in_volume(surface, volume, a.look, a.picture.chosen(), files.writer(), console.progress());
  console.note(volume.name(), drawn.notes);
  if (drawn.colors && !drawn.colors->curvature) console.report(*drawn.colors, "colors");
  console.report(drawn.rays, "rays");
  console.report(files.written(), "output");
  console.print(files.written().size_line());
}

void write_surface(const VolumeSurfaceArguments& a, const SurfaceInVolume& surface, const VolumeModel& volume,
                   Console& console) {
  const MeshInVolume made = mesh_of_surface(surface, a.meshing, console.progress());
  const MeshInVolumeReport& r = made.report;
  console.note(volume.name(), made.notes);
  console.progress().begin("write");
  write_mesh(a.output, made.mesh, {.ascii = a.ascii});
  report_mesh(a.output, made.mesh, console);
  console.report(r);
  print_mesh(a.output, made.mesh, static_cast<std::size_t>(r.mesh.components), r.volume.has_value(), console);
  console.print(area_words(r.area, r.volume));
}

void run_volume_surface(const VolumeSurfaceArguments& a, Console& console) {
  a.check();
  VolumeModel volume = a.input.open(console);
  Progress& progress = console.progress();
  if (!a.look.color_by.empty() && !a.look.curvature()) volume.scalar_choice(a.look.color_by, "color_by");
  const auto made = std::make_shared<const SurfaceInVolume>(surface_in_volume(volume, a.options, progress));
  const SurfaceInVolume& surface = *made;
  console.report(a.input.report(volume, progress), "input");
  console.report(surface);
  console.print(summary_of(surface, volume, progress));
  console.note(volume.name(), surface.notes);
  std::optional<PointSet> points;
  if (!a.points.empty()) points = points_of_surface(surface, a.distance, progress);
  if (a.to_picture())
    draw_surface(a, surface, volume, console);
  else if (!a.output.empty())
    write_surface(a, surface, volume, console);
  if (!points) return;
  write_points(a.points, *points, {});
  console.print(fmt::format("{}: {}", a.points, counted(points->size(), "point")));
  console.report(WrittenPoints{a.points, points->size()}, "points");
}

}  // namespace

Command add_volume_surface(CommandLine& volume) {
  CommandLine& c = volume.add_subcommand("surface", "Volume on any grid → smooth surface by moving least squares");
  auto shared = std::make_shared<VolumeSurfaceArguments>();
  VolumeSurfaceArguments& a = *shared;
  add_volume_input(c, a.input, {"smoothing"});  // the name is that of the surface's own
  c.add_option("-o,--output", a.output, "Picture (.png) or mesh (.ply, .obj, .stl, …) to write")
      .writes({".png", ".ply", ".obj", ".stl", ".off", ".glb", ".vtp"});
  c.add_option("--points-output", a.points, "Write evenly spread points of the surface with normals")
      .writes(endings_written(kPoints))
      .former_name("--points");
  c.add_option("--point-spacing", a.distance, "Distance between these points [the spacing of the samples]")
      .type_name("LENGTH")
      .former_name("--distance");
  add_schema(c, a.options, {.only = {"value", "high_gradient"}});
  add_schema(c, a.options.surface, {.group = "Weights", .without = {"high_gradient"}});
  add_schema(c, a.look, {.group = "Picture"});
  add_background_option(c, a.picture);
  add_picture_options(c, a.picture);
  add_schema(c, a.meshing, {.group = "Mesh"});
  add_ascii_flag(c, a.ascii, "Mesh");
  c.footer(std::string(kReadableVolumes) +
           "\n\nExamples:\n"
           "  sansmesh volume surface head.mhd --value 1150 -o skull.png\n"
           "  sansmesh volume surface engine.nrrd --high-gradient -o engine.ply\n"
           "  sansmesh volume surface fire.vtu --array t --value 1000 --color-by mfrac -o hot.png");
  c.announce({report_of<ReadVolume>("input"), report_of<SurfaceInVolume>(), report_of<ShownColors>("colors"),
              report_of<CastCounts>("rays"), report_of<WrittenPictures>("output"), report_of<WrittenMesh>("output"),
              report_of<MeshInVolumeReport>(), report_of<WrittenPoints>("points")});
  return {&c, [shared](Console& console) { run_volume_surface(*shared, console); }};
}

}  // namespace sansmesh::cli
