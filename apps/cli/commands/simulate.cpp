// Command `simulate`: dynamics of tetrahedral bodies.
#include "sansmesh/simulate.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/input/volume_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "sansmesh/io.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/jobs/motion/motion_files.h"

namespace sansmesh::cli {
namespace {

struct SimulateArguments {
  std::string tets, forces, fixed, surface;
  MotionFiles files;
  SimulateOptions options;
  std::string volume_file;
  VolumeInput volume;
  VolumeColors colors;
  PictureArguments picture;
};

/// Throws FileError if an output cannot be written, ArgumentError for options that exclude each other.
void check_simulate(const SimulateArguments& a) {
  a.files.check();
  require(a.volume_file.empty() || a.files.draws(),
          "--embedded-volume needs pictures: --output NAME.png or --animation");
  require(!a.volume_file.empty() || (a.colors.is_default() && a.volume.array.empty()),
          "--array, --preset, --transfer, --opacity-factor and --iso belong to --embedded-volume");
  a.options.validate();
  a.picture.chosen().validate();
  a.picture.check_frames(true);
}

/// Opens pictures before the simulation. A volume hides the surface unless an embedded mesh is given.
std::optional<MotionPictures> open_pictures(SimulateArguments& a, const SimulationPlan& plan,
                                            std::optional<CarriedSurface> surface, Console& console) {
  if (!a.files.draws()) return std::nullopt;
  std::optional<CarriedVolume> carried;
  if (!a.volume_file.empty()) {
    a.volume.files = {a.volume_file};
    std::vector<Note> notes;
    carried = carried_volume(a.volume.open(console), console.progress(), notes);
    console.note(a.volume_file, notes);
    a.colors.apply_to(carried->look);
    if (a.surface.empty()) surface.reset();
  }
  MotionPictures pictures(plan, std::move(surface), std::move(carried), a.picture.chosen());
  console.note(a.volume_file, pictures.notes());
  return pictures;
}

void run_simulate(SimulateArguments& a, Console& console) {
  check_simulate(a);
  const SimulationBody body = read_body(a.tets);
  console.warn(a.tets, body.notes());
  a.options.z_up = a.picture.view.z_up;
  const SimulationPlan plan = plan_simulation(body, read_scene(a.forces, a.fixed, body, a.options.z_up), a.options);
  console.note(a.tets, plan.notes);
  const CarriedSurface surface = read_carried(a.surface, plan);
  console.note(a.surface, surface.notes());
  a.files.check(plan, {a.tets, a.forces, a.fixed, a.surface, a.volume_file, a.colors.transfer});
  std::optional<MotionPictures> pictures = open_pictures(a, plan, surface, console);
  const SimulateResult made = simulate(plan, a.files.kept(), !a.files.energies.empty(), console.progress());
  console.note(a.tets, made.notes);
  if (pictures) pictures->show(made.motion);
  MotionUse use{.frame_time = plan.frame_time, .pictures = pictures ? &*pictures : nullptr};
  use.part = [&](const Image& image) { return a.picture.part(image, a.picture.chosen()); };
  use.before_more = [&] { console.keep_frames(); };
  const std::vector<std::string> files = write_motion(a.files, made, surface, use, console.progress());
  console.report(FileReport{a.tets}, "input");
  console.report_value("input.notes", body.notes());
  console.report(plan);
  console.report(made.report);
  console.report_value("output.files", files);
  console.print(summary_of(plan, made.report));
  console.print(WrittenPictures{files}.words() + ": written");
}

}  // namespace

Command add_simulate(CommandLine& app) {
  CommandLine& c = app.add_subcommand("simulate", "Tetrahedra and forces → motion as frames, pictures or an animation");
  auto shared = std::make_shared<SimulateArguments>();
  SimulateArguments& a = *shared;
  c.add_option("tets", a.tets, "Tetrahedra: .msh .mesh .node/.ele .veg .vtu, …")
      .type_name("TETS")
      .reads(endings_read(kTetrahedra))
      .required();
  c.add_option("--forces", a.forces, "Scene: constraints, forces, obstacles, material, time (JSON)").reads({".json"});
  c.add_option("-o,--output", a.files.outputs,
               "Frames to write, NAME_0000.vtu, … (and NAME.pvd), .ply .obj .stl .off .glb .vtp (surface) or .png "
               "(pictures); may be repeated")
      .writes({".vtu", ".ply", ".obj", ".stl", ".off", ".glb", ".vtp", ".png"})
      .repeated();
  c.add_option("--animation", a.files.animation, "Animated PNG of all frames").writes({".png"});
  c.add_option("--energies", a.files.energies, "Energies, iterations and contacts of every step: .csv")
      .writes({".csv"});
  c.add_option("--embedded-mesh", a.surface, "Mesh that moves with the tetrahedra, instead of their boundary")
      .reads(endings_read(kPoints))
      .former_name("--surface");
  const char* const body = "Body";
  c.add_option("--fixed", a.fixed, "List of fixed vertices (.bou), numbered as in TETS").reads({".bou"}).group(body);
  add_schema(c, a.options,
             {.group = body, .only = {"model", "stiffness", "young", "poisson", "damping", "density", "unit"}});
  add_schema(c, a.options, {.group = "Time", .only = {"duration", "fps", "frames", "integrator", "longest_step"}});
  const char* const seen = "Volume";
  c.add_option("--embedded-volume", a.volume_file, "Volume that moves with the tetrahedra, for pictures")
      .reads()
      .former_name("--volume")
      .group(seen);
  c.add_option("--array", a.volume.array, "Array of the volume [the first that varies]").type_name("NAME").group(seen);
  a.colors.add_options(c, seen);
  add_ascii_flag(c, a.files.ascii);
  add_background_option(c, a.picture);
  add_picture_options(c, a.picture);
  add_wireframe_options(c, a.picture.options);
  c.footer(
      "TETS: Gmsh, Medit, TetGen, Vega meshes, and all other volumes with cells. Gravity pulls along -y (with "
      "--z-up along "
      "-z).\nScenes: docs/formats/scene.md. Without one the body falls onto a floor; with --fixed it is suspended.\n\n"
      "Examples:\n"
      "  sansmesh simulate turtle.veg --fixed turtle.bou --embedded-mesh turtle.obj -o turtle.ply\n"
      "  sansmesh simulate dolphin.msh --unit cm --animation dolphin.png --width 480 --height 360\n"
      "  sansmesh simulate bar.msh --forces twist.json -o twist.vtu --energies twist.csv      # open twist.pvd\n"
      "  sansmesh simulate head.msh --forces pull.json --embedded-volume head.vti --preset ct-bone -o head.png\n"
      "  twist.json: {\"fixed\": {\"side\": \"-x\"},\n"
      "               \"handles\": {\"on\": {\"side\": \"+x\"}, \"turn\": {\"axis\": [1, 0, 0], \"degrees\": 180}}}");
  c.announce({report_of<FileReport>("input"),
              value_of<std::vector<std::string>>("input.notes", "Notes on reading the file"),
              report_of<SimulationPlan>(), report_of<SimulateReport>(),
              value_of<std::vector<std::string>>("output.files", "Written files")});
  return {&c, [shared](Console& console) { run_simulate(*shared, console); }};
}

}  // namespace sansmesh::cli
