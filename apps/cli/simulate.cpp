// sansmesh simulate: tetrahedra that move by forces.
#include "sansmesh/simulate.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "schema_options.h"
#include "simulate_frames.h"

namespace sansmesh::cli {
namespace {

/// Errors of what the scene says are those of its file, others of the body's.
template <class Work>
auto with_files(const SimulateArguments& a, const Console& console, const Work& work) {
  try {
    return work();
  } catch (const SceneError& error) {
    if (a.forces.empty()) throw;
    throw FileError(a.forces, console.in_flags(error.what()));
  } catch (const DataError& error) {
    throw FileError(a.tets, console.in_flags(error.what()));
  }
}

std::shared_ptr<const CarriedSurface> open_surface(const SimulateArguments& a, const TetMesh& rest, Console& console) {
  try {
    if (a.surface.empty()) return std::make_shared<const CarriedSurface>(rest);
    auto surface = std::make_shared<const CarriedSurface>(rest, read_mesh(a.surface));
    console.note(a.surface, surface->notes());
    return surface;
  } catch (const DataError& error) {
    throw FileError(a.surface.empty() ? a.tets : a.surface, error.what());
  }
}

std::optional<CarriedVolume> open_carried_volume(SimulateArguments& a, Console& console) {
  if (a.volume_file.empty()) return std::nullopt;
  a.volume.files = {a.volume_file};
  VolumeModel open = a.volume.open(console);
  std::vector<Note> notes;
  CarriedVolume volume;
  volume.field = open.field(open.as_scalar(open.choice()), console.progress(), notes);
  console.note(a.volume_file, notes);
  volume.image = open.samples(console.progress())->lattice.has_value();
  a.colors.put_into(volume.look);
  return volume;
}

/// A volume is seen alone, unless a surface is asked for beside it.
PicturesToDraw open_pictures(SimulateArguments& a, const SimulationPlan& plan,
                             std::shared_ptr<const CarriedSurface> surface, Console& console) {
  PicturesToDraw draw;
  if (a.draws()) {
    RenderOptions look = a.picture.chosen();
    set_background(look, a.background);
    if (plan.z_up) look.view.up = UpAxis::z;
    auto volume = open_carried_volume(a, console);
    if (volume && a.surface.empty()) surface.reset();
    draw.pictures.emplace(plan.rest, std::move(surface), std::move(volume), look);
    console.note(a.volume_file, draw.pictures->notes());
  }
  if (!a.animation.empty()) draw.animation.emplace(1 / plan.frame_time);
  return draw;
}

std::string energy_table(const SimulateReport& report) {
  std::string table = "time,kinetic,elastic,gravity,total,iterations,step,contacts\n";
  for (const auto& [e, step] : report.moments)
    table += fmt::format("{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{},{:.6g},{}\n", step.time, e.kinetic, e.elastic,
                         e.gravity, e.total(), step.iterations, step.shortest, step.contacts);
  return table;
}

Json energies_json(const BodyEnergies& e) {
  return {{"kinetic", e.kinetic}, {"elastic", e.elastic}, {"gravity", e.gravity}, {"total", e.total()}};
}

std::string material_words(const SoftBodyOptions& o) {
  return o.model == SoftBodyModel::springs
             ? fmt::format("springs of {:.4g} N/m, damping {:.4g} N s/m", o.stiffness, o.damping)
             : fmt::format("Young's modulus {:.4g} Pa, Poisson's ratio {:.4g}, damping {:.4g} s", o.young, o.poisson,
                           o.stiffness_damping);
}

void report_simulation(const SimulateArguments& a, const SimulationBody& body, const SimulationPlan& plan,
                       const SimulateReport& r, const std::vector<std::string>& files, Console& console) {
  const SoftBodyOptions& options = plan.options;
  const DynamicsScene& scene = plan.scene;
  const double steps = static_cast<double>(r.steps);
  console.say(fmt::format("{}: {} vertices, {} tetrahedra, {} fixed", a.tets, grouped(plan.rest->vertices.size()),
                          grouped(plan.rest->tets.size()), grouped(scene.fixed.size())));
  console.say(fmt::format("{} ({}), {}", word_of(options.model), material_words(options), word_of(options.integrator)));
  console.say(fmt::format("{} of at most {:.4g} s in {:.3g} s ({:.1f} a second){}", counted(r.steps, "step"),
                          options.step, r.seconds, steps / std::max(r.seconds, 1e-9),
                          options.integrator == DynamicsIntegrator::implicit_euler
                              ? fmt::format(", {:.1f} iterations a step", static_cast<double>(r.iterations) / steps)
                              : ""));
  console.say(
      fmt::format("energy {:.6g} J at first, {:.6g} J in the end (kinetic {:.4g}, elastic {:.4g}, gravity {:.4g})",
                  r.first.total(), r.last.total(), r.last.kinetic, r.last.elastic, r.last.gravity));
  console.say(fmt::format(
      "{} of {:.4g} s: {}", counted(plan.frames, "frame"), plan.frame_time,
      files.size() == 1 ? files[0] : fmt::format("{} files, {} to {}", files.size(), files.front(), files.back())));
  console.say_json({{"input",
                     {{"file", a.tets},
                      {"vertices", plan.rest->vertices.size()},
                      {"tetrahedra", plan.rest->tets.size()},
                      {"notes", body.notes()}}},
                    {"scene",
                     {{"fixed", scene.fixed.size()},
                      {"forces", scene.forces.size()},
                      {"handles", scene.handles.size()},
                      {"floors", scene.floors.size()},
                      {"spheres", scene.spheres.size()},
                      {"unit", plan.unit},
                      {"gravity", std::array{options.gravity.x, options.gravity.y, options.gravity.z}}}},
                    {"model", word_of(options.model)},
                    {"integrator", word_of(options.integrator)},
                    {"stiffness", options.stiffness},
                    {"damping", options.damping},
                    {"young", options.young},
                    {"poisson", options.poisson},
                    {"stiffness_damping", options.stiffness_damping},
                    {"density", options.density},
                    {"step", options.step},
                    {"steps", r.steps},
                    {"iterations", r.iterations},
                    {"halvings", r.halvings},
                    {"unsettled", r.unsettled},
                    {"shortest_step", r.shortest_step},
                    {"most_contacts", r.most_contacts},
                    {"seconds", r.seconds},
                    {"energies", {{"first", energies_json(r.first)}, {"last", energies_json(r.last)}}},
                    {"output", {{"frames", plan.frames}, {"frame_time", plan.frame_time}, {"files", files}}}});
  console.print_timings();
}

void run_simulate(SimulateArguments& a, Console& console) {
  a.check();
  const SimulationBody body = read_body(a.tets);
  console.warn(a.tets, body.notes());
  SceneScript scene = read_scene(a.forces, a.fixed, body, a.picture.place.z_up);
  a.options.z_up = a.picture.place.z_up;
  const SimulationPlan plan =
      with_files(a, console, [&] { return plan_simulation(body.mesh(), std::move(scene), a.options); });
  console.note(a.tets, plan.notes);
  const auto surface = open_surface(a, *plan.rest, console);
  a.check_overwriting(plan.frames);
  PicturesToDraw draw = open_pictures(a, plan, surface, console);
  const KeptMotion kept{a.draws() || !a.outputs.empty(), a.writes_tets()};
  const SimulateResult made =
      with_files(a, console, [&] { return simulate(plan, kept, !a.energies.empty(), console.progress()); });
  console.note(a.tets, made.notes);
  if (draw.pictures) draw.pictures->show(made.motion, plan.scene);
  std::vector<std::string> files = write_outputs(a, made.motion, *surface, draw, console);
  if (!a.energies.empty()) {
    write_text(a.energies, energy_table(made.report));
    files.push_back(a.energies);
  }
  console.progress().finish();
  report_simulation(a, body, plan, made.report, files, console);
}

}  // namespace

Command add_simulate(CommandLine& app) {
  CommandLine& c = app.add_subcommand("simulate", "Tetrahedra that move by forces → frames, pictures, an animation");
  auto shared = std::make_shared<SimulateArguments>();
  SimulateArguments& a = *shared;
  c.add_option("tets", a.tets, "Tetrahedra: .msh .mesh .node/.ele .veg .vtu, …").type_name("TETS").required();
  c.add_option("--forces", a.forces, "Scene: what holds, pulls and stops the body, material, time (JSON)")
      .type_name("FILE");
  c.add_option("-o,--output", a.outputs,
               "Frames to write, NAME_0000.vtu, … (and NAME.pvd), .ply .obj .stl .off .glb .vtp (surface) or .png "
               "(pictures); may be repeated")
      .type_name("FILE")
      .repeated();
  c.add_option("--animation", a.animation, "Pictures of all frames in one file, an animated PNG that browsers play")
      .type_name("FILE");
  c.add_option("--energies", a.energies, "Energies, iterations and contacts of every step: .csv").type_name("FILE");
  c.add_option("--embedded-mesh", a.surface, "Mesh that moves with the tetrahedra, in place of their boundary")
      .type_name("FILE")
      .once_called("--surface");
  const char* const body = "Body";
  c.add_option("--fixed", a.fixed, "List of vertices that stay where they are (.bou), numbered as in TETS")
      .type_name("FILE")
      .group(body);
  add_schema(c, a.options,
             {.group = body, .only = {"model", "stiffness", "young", "poisson", "damping", "density", "unit"}});
  add_schema(c, a.options, {.group = "Time", .only = {"duration", "fps", "frames", "integrator", "longest_step"}});
  const char* const seen = "Volume";
  c.add_option("--embedded-volume", a.volume_file, "Volume that moves with the tetrahedra, for pictures")
      .type_name("FILE")
      .once_called("--volume")
      .group(seen);
  c.add_option("--array", a.volume.array, "Of the volume [the first that varies]").type_name("NAME").group(seen);
  a.colors.add_options(c, seen);
  add_ascii_flag(c, a.ascii);
  add_background_option(c, a.background);
  add_picture_options(c, a.picture);
  add_wireframe_options(c, a.picture.options);
  c.footer(
      "TETS: Gmsh, Medit, TetGen, Vega meshes, and all other volumes with cells. Down is where y is small (with "
      "--z-up: "
      "z).\nScenes: docs/formats/scene.md. Without one the body falls onto a floor; with --fixed it hangs.\n\n"
      "Examples:\n"
      "  sansmesh simulate turtle.veg --fixed turtle.bou --embedded-mesh turtle.obj -o turtle.ply\n"
      "  sansmesh simulate dolphin.msh --unit cm --animation dolphin.png --width 480 --height 360\n"
      "  sansmesh simulate bar.msh --forces twist.json -o twist.vtu --energies twist.csv      # open twist.pvd\n"
      "  sansmesh simulate head.msh --forces pull.json --embedded-volume head.vti --preset ct-bone -o head.png\n"
      "  twist.json: {\"fixed\": {\"side\": \"-x\"},\n"
      "               \"handles\": {\"on\": {\"side\": \"+x\"}, \"turn\": {\"axis\": [1, 0, 0], \"degrees\": 180}}}");
  return {&c, [shared](Console& console) { run_simulate(*shared, console); }};
}

}  // namespace sansmesh::cli
