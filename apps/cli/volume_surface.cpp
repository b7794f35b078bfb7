// sansmesh volume surface: isosurfaces and surfaces of high gradient straight from the samples of a volume.
#include "sansmesh/isosurfaces.h"
#include "sansmesh/volumes.h"

#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "mesh_words.h"
#include "option_groups.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/jobs/color_bar.h"
#include "sansmesh/volume_pictures.h"
#include "schema_options.h"
#include "volume_input.h"

namespace sansmesh::cli {
namespace {

struct VolumeSurfaceArguments {
  VolumeInput input;
  SurfaceInVolumeOptions options;
  MeshInVolumeOptions meshing;
  SurfaceInVolumeLook look;
  std::string output, points, unit;
  std::optional<double> distance;
  PictureArguments picture;
  bool ascii = false, quick = false, no_bar = false;
  int frames = 0;

  bool to_picture() const { return output.size() > 4 && output.ends_with(".png"); }
  /// Throws what keeps the outputs from being written, and ArgumentError for what does not go together.
  void check() const;
};

void VolumeSurfaceArguments::check() const {
  require(!output.empty() || !points.empty(), "--output or --points-output is needed");
  require(frames == 0 || frames >= 2, "--frames must be at least 2");
  require(to_picture() || (options_set(look).empty() && frames == 0),
          "--color-by, --sharp and --frames need a picture");
  require(to_picture() || !picture.any(), "options of the picture need one: -o FILE.png");
  require(!look.color_by.empty() || (unit.empty() && !no_bar), "--unit and --no-bar are of the bar of --color-by");
  require(!distance || !points.empty(), "--point-spacing needs --points-output");
  require(!distance || *distance > 0, "--point-spacing must be positive");
  require(output != points, "--output and --points-output are the same file");
  if (!output.empty()) check_writable(output, to_picture() ? "image" : "mesh");
  if (!points.empty()) check_writable(points, "points");
  options.validate();
  meshing.validate();
  look.validate();
  if (to_picture()) picture.chosen().validate();
  picture.check_frames(frames > 0);
}

/// The colour bar beside the pictures.
std::optional<ColorBar> bar_of(const VolumeSurfaceArguments& a, const std::optional<ShownColors>& shown) {
  if (!shown || a.no_bar) return std::nullopt;
  if (shown->curvature) return curvature_bar(*shown->curvature, shown->range, a.unit, true);
  return ColorBar{shown->colors, with_unit(a.look.color_by, a.unit), shown->ends};
}

void draw_surface(const VolumeSurfaceArguments& a, const SurfaceInVolume& surface, const VolumeModel& volume,
                  Console& console) {
  SurfaceRenderOptions look;
  look.picture = a.picture.chosen();
  look.plain = a.quick, look.picture.view.steady = a.frames > 0;
  look.validate();
  std::vector<Note> notes;
  const SurfaceInVolumePictures pictures(surface, volume, a.look, console.progress(), notes);
  console.note(volume.name(), notes);
  if (const auto& shown = pictures.colors(); shown && !shown->curvature) console.tell(*shown, "colors");
  const std::optional<ColorBar> bar = bar_of(a, pictures.colors());
  leave_room(look.picture, bar);
  PictureFiles files(a.picture, a.output, a.frames > 0, console);
  for (const ViewDirection& view : turntable(look.picture.view.direction, std::max(1, a.frames))) {
    look.picture.view.direction = view;
    files.write(beside_bar(pictures.render(look, console.progress()), bar, look.picture), look.picture);
  }
  const WrittenPictures& written = files.written();
  console.tell(pictures.counts(), "rays");
  console.tell(written, "output");
  console.say(fmt::format("{}: {} × {} pixels", written.words(), written.width, written.height));
}

void write_surface(const VolumeSurfaceArguments& a, const SurfaceInVolume& surface, const VolumeModel& volume,
                   Console& console) {
  const MeshInVolume made = mesh_of_surface(surface, a.meshing, console.progress());
  const MeshInVolumeReport& r = made.report;
  console.note(volume.name(), made.notes);
  console.progress().begin("write");
  write_mesh(a.output, made.mesh, {.ascii = a.ascii});
  tell_mesh(a.output, made.mesh, console);
  console.tell(r);
  say_mesh(a.output, made.mesh, static_cast<std::size_t>(r.mesh.components), r.volume.has_value(), console);
  console.say(area_words(r.area, r.volume));
}

void say_surface(const VolumeSurfaceArguments& a, const SurfaceInVolume& s, const VolumeModel& volume,
                 Console& console) {
  const VolumeSurfaceReport& r = s.report;
  const auto samples = volume.samples(console.progress());
  const bool steep = a.options.surface.kind == VolumeSurfaceOptions::Kind::high_gradient;
  console.say(
      fmt::format("{}: {}, {} of {} ({})", volume.name(),
                  steep ? fmt::format("steepest {}, from {:.4g} per length", volume.array_name(), r.least_gradient)
                        : fmt::format("{} = {:.6g}{}", volume.array_name(), s.value,
                                      a.options.value ? "" : " (the middle of its range)"),
                  counted(r.samples, "sample"), grouped(samples->size()), samples->facts.grid));
  console.say(fmt::format(
      "spacing {}, weights {:.2f} spacings wide{}", length(r.spacing), r.smoothing,
      r.noise_distance > 0 ? fmt::format(", noise moves the surface by {}", length(r.noise_distance)) : std::string()));
  console.note(volume.name(), s.notes);
}

void run_volume_surface(const VolumeSurfaceArguments& a, Console& console) {
  a.check();
  VolumeModel volume = a.input.open(console);
  Progress& progress = console.progress();
  if (!a.look.color_by.empty() && !a.look.curvature()) volume.scalar_choice(a.look.color_by, "color_by");
  const auto made = std::make_shared<const SurfaceInVolume>(surface_in_volume(volume, a.options, progress));
  const SurfaceInVolume& surface = *made;
  console.tell(a.input.told(volume, progress), "input");
  console.tell(surface);
  say_surface(a, surface, volume, console);
  std::optional<PointSet> points;
  if (!a.points.empty()) points = points_of_surface(surface, a.distance, progress);
  if (a.to_picture())
    draw_surface(a, surface, volume, console);
  else if (!a.output.empty())
    write_surface(a, surface, volume, console);
  if (!points) return;
  write_points(a.points, *points, {});
  console.say(fmt::format("{}: {}", a.points, counted(points->size(), "point")));
  console.tell(WrittenPoints{a.points, points->size()}, "points");
}

}  // namespace

Command add_volume_surface(CommandLine& volume) {
  CommandLine& c = volume.add_subcommand("surface", "Volume on any grid → smooth surface by moving least squares");
  auto shared = std::make_shared<VolumeSurfaceArguments>();
  VolumeSurfaceArguments& a = *shared;
  add_volume_input(c, a.input);
  c.add_option("-o,--output", a.output, "Picture (.png) or mesh (.ply, .obj, .stl, …) to write")
      .writes({".png", ".ply", ".obj", ".stl", ".off", ".glb", ".vtp"});
  c.add_option("--points-output", a.points, "Also or only: points spread evenly over the surface, with normals")
      .writes(endings_written(kPoints))
      .once_called("--points");
  c.add_option("--point-spacing", a.distance, "Distance of these points [the spacing of the samples]")
      .type_name("LENGTH")
      .once_called("--distance");
  add_schema(c, a.options, {.only = {"value", "high_gradient"}});
  add_schema(c, a.options.surface, {.group = "Weights", .without = {"high_gradient"}});
  add_schema(c, a.look, {.group = "Picture"});
  c.add_flag("--quick", a.quick, "One ray a pixel, no shadows").group("Picture");
  add_background_option(c, a.picture);
  c.add_option("--frames", a.frames, "Turntable: so many pictures around the up axis, NAME_000.png, …")
      .type_name("COUNT")
      .group("Picture");
  add_picture_options(c, a.picture);
  add_bar_options(c, a.no_bar, a.unit, "the array, or of lengths in curvatures");
  add_schema(c, a.meshing, {.group = "Mesh"});
  c.add_flag("--ascii", a.ascii, "Write text, not binary").group("Mesh");
  c.footer(std::string(kReadableVolumes) +
           "\n\nExamples:\n"
           "  sansmesh volume surface head.mhd --value 1150 -o skull.png\n"
           "  sansmesh volume surface engine.nrrd --high-gradient -o engine.ply\n"
           "  sansmesh volume surface fire.vtu --array t --value 1000 --color-by mfrac -o hot.png");
  c.tells({told<ReadVolume>("input"), told<SurfaceInVolume>(), told<ShownColors>("colors"), told<CastCounts>("rays"),
           told<WrittenPictures>("output"), told<WrittenMesh>("output"), told<MeshInVolumeReport>(),
           told<WrittenPoints>("points")});
  return {&c, [shared](Console& console) { run_volume_surface(*shared, console); }};
}

}  // namespace sansmesh::cli
