// sansmesh simulate: tetrahedra that move by forces.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "motion.h"
#include "option_groups.h"
#include "option_values.h"
#include "sansmesh/core/error.h"
#include "sansmesh/dataset/tet_dataset.h"
#include "sansmesh/dynamics/scene_script.h"
#include "sansmesh/dynamics/soft_body.h"
#include "sansmesh/dynamics/suited_options.h"
#include "sansmesh/io/io.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/write_tets.h"
#include "simulate_frames.h"
#include "simulate_scene.h"

namespace sansmesh::cli {
namespace {

constexpr double kUsualTime = 2, kUsualRate = 25;
constexpr double kMostFrames = 100000, kMostSteps = 1e8;
constexpr double kManyUnsettled = 0.1;                ///< of the steps
constexpr double kMostBytes = 8e9;                    ///< of frames in memory
constexpr double kLeastSize = 1e-6, kMostSize = 1e9;  ///< of bodies, m

void check_arguments(const SimulateArguments& a) {
  require(!a.outputs.empty() || !a.animation.empty() || !a.energies.empty(),
          "nothing would be written: --output, --animation or --energies is wanted");
  for (const std::string& o : a.outputs) {
    const std::string first = motion_frame_name(o, 0);
    if (io::ending(o) == "vtu") {
      check_tets_writable(first);
    } else if (io::ending(o) == "png") {
      check_writable(first, "image");
    } else {
      try {
        check_writable(first, "mesh");
      } catch (const FileError&) {
        // Of a file that cannot be written for another reason that stands.
        const std::string e = io::ending(o);
        if (std::string(" ply obj stl off glb vtp ").find(" " + e + " ") != std::string::npos) throw;
        throw FileError(o,
                        fmt::format("no writer for frames with the ending '.{}'; known: .vtu, .ply .obj .stl .off .glb "
                                    ".vtp (the surface), .png (pictures)",
                                    e));
      }
    }
  }
  if (!a.animation.empty()) check_writable(a.animation, "image");
  if (!a.energies.empty()) check_writable(a.energies, "text");
  require(!a.frames || *a.frames >= 2, "--frames must be at least 2: the first one is the body at rest");
  require(!(a.frames && a.flags.frames_per_second && a.flags.duration),
          "of --frames, --fps and --time only two can be given");
  require(!a.flags.poisson || (*a.flags.poisson >= 0 && *a.flags.poisson <= 0.49), "--poisson must lie in 0..0.49");
  require(!a.flags.damping || *a.flags.damping >= 0, "--damping must not be negative");
  require(a.volume_file.empty() || a.draws(), "--volume needs pictures: --output NAME.png or --animation");
  require(!a.volume_file.empty() || (a.volume.colors.usual() && a.volume.input.array.empty()),
          "--array, --preset, --transfer, --opacity and --iso belong to --volume");
  a.picture.chosen().validate();
  a.picture.check_frames(true);
}

/// Moments of the frames.
struct FrameTimes {
  std::size_t frames;
  double step;
};
FrameTimes frame_times(const SimulateArguments& a, const SceneScript& s) {
  double rate = s.frames_per_second.value_or(kUsualRate);
  double time = s.duration.value_or(kUsualTime);
  if (a.frames) {
    const double steps = *a.frames - 1;
    if (a.flags.frames_per_second || !s.duration)
      time = steps / rate;
    else
      rate = steps / time;
  }
  // Whole frames at the rate that is asked for; where their number is given, both are kept.
  const double frames = a.frames ? *a.frames - 1 : std::floor(time * rate * (1 + 1e-9));
  if (!(frames >= 1))
    throw ArgumentError(fmt::format("a `duration` of {:g} s is shorter than a frame ({:g} a second)", time, rate));
  if (frames > kMostFrames)
    throw ArgumentError(
        fmt::format("{:g} s with {:g} frames a second are more than {:g} frames", time, rate, kMostFrames));
  return {static_cast<std::size_t>(frames) + 1, 1 / rate};
}

/// Steps in a frame.
std::size_t steps_a_frame(const FrameTimes& times, double step) {
  const double steps = std::max(1.0, std::ceil(times.step / step - 1e-9));
  if (!(steps * static_cast<double>(times.frames - 1) <= kMostSteps))
    throw ArgumentError(fmt::format("a `step` of {:.3g} s makes more than {:g} steps", step, kMostSteps));
  return static_cast<std::size_t>(steps);
}

/// What the steps took, all together.
struct SimulationTotals {
  std::size_t steps = 0, halvings = 0, unsettled = 0;
  std::uint64_t iterations = 0;
  double seconds = 0, shortest = std::numeric_limits<double>::infinity();
  int most_contacts = 0;
  BodyEnergies first, last;
  std::string table = "time,kinetic,elastic,gravity,total,iterations,step,contacts\n";

  void row(const BodyEnergies& e, const StepReport& r) {
    table += fmt::format("{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{},{:.6g},{}\n", r.time, e.kinetic, e.elastic, e.gravity,
                         e.total(), r.iterations, r.shortest, r.contacts);
  }
};

SimulationTotals simulate(SoftBody& body, const FrameTimes& times, std::size_t steps, double unit, bool energies,
                          Motion& motion, Progress& progress) {
  SimulationTotals t;
  t.first = body.energies();
  t.row(t.first, {});
  motion.add(0, body.positions(), body.velocities(), unit);
  const double h = times.step / static_cast<double>(steps);
  progress.begin("simulating", (times.frames - 1) * steps);
  const auto begin = std::chrono::steady_clock::now();
  for (std::size_t frame = 1; frame < times.frames; ++frame) {
    for (std::size_t k = 0; k < steps; ++k) {
      const StepReport r = body.advance(h);
      ++t.steps;
      t.halvings += static_cast<std::size_t>(r.halvings);
      t.unsettled += r.unsettled > 0;
      t.iterations += static_cast<std::uint64_t>(r.iterations);
      t.shortest = std::min(t.shortest, r.shortest);
      t.most_contacts = std::max(t.most_contacts, r.contacts);
      if (energies) t.row(body.energies(), r);
      progress.advance();
    }
    motion.add(static_cast<double>(frame) * times.step, body.positions(), body.velocities(), unit);
  }
  t.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  t.last = body.energies();
  progress.finish();
  return t;
}

/// Inputs are not to be lost: frames get names that nobody typed.
void check_overwriting(const SimulateArguments& a, std::size_t frames) {
  const auto place = [](const std::string& file) {
    std::error_code ignored;
    return std::filesystem::weakly_canonical(file, ignored);
  };
  std::set<std::filesystem::path> inputs;
  for (const std::string& file : {a.tets, a.forces, a.fixed, a.surface, a.volume_file, a.volume.colors.transfer})
    if (!file.empty()) inputs.insert(place(file));
  const auto check = [&](const std::string& file) {
    if (inputs.contains(place(file))) throw FileError(file, "is an input, which a result would overwrite");
  };
  for (const std::string& o : a.outputs)
    for (std::size_t k = 0; k < frames; ++k) check(motion_frame_name(o, k));
  if (!a.animation.empty()) check(a.animation);
  if (!a.energies.empty()) check(a.energies);
}

Json energies_json(const BodyEnergies& e) {
  return {{"kinetic", e.kinetic}, {"elastic", e.elastic}, {"gravity", e.gravity}, {"total", e.total()}};
}

std::string material_words(const SoftBodyOptions& o) {
  return o.model == SoftBodyModel::springs
             ? fmt::format("springs of {:.4g} N/m, damping {:.4g} N s/m", o.stiffness, o.damping)
             : fmt::format("Young's modulus {:.4g} Pa, Poisson's ratio {:.4g}, damping {:.4g} s", o.youngs_modulus,
                           o.poissons_ratio, o.stiffness_damping);
}

/// Values of options as they are given.
std::string in_words(std::string message) {
  for (const DynamicsIntegrator i : {DynamicsIntegrator::implicit_euler, DynamicsIntegrator::velocity_verlet}) {
    std::string field = word_of(i);
    std::replace(field.begin(), field.end(), '-', '_');
    for (std::size_t at = message.find(field); at != std::string::npos; at = message.find(field, at))
      message.replace(at, field.size(), word_of(i));
  }
  return message;
}

void run_simulate(SimulateArguments& a, Console& console) {
  check_arguments(a);
  if (!a.volume_file.empty()) a.volume.input.files = {a.volume_file};
  RenderOptions look = a.picture.chosen();
  set_background(look, a.background);
  const TetDataset body = read_tets(a.tets);
  console.warn(a.tets, body.notes);
  std::vector<std::string> notes;
  SceneScript script = read_scene(a, body, notes);
  const double unit = suited_unit(script, body.mesh);
  const double size = bounds(body.mesh).diagonal();
  if (!script.unit && unit != 1)
    notes.push_back(fmt::format("{:.4g} long in a unit that nobody says: taken as {}, {:.3g} m; --unit says another",
                                size, unit == 0.01 ? "centimetres" : "millimetres", size * unit));
  script.unit = unit;
  if (!(size * unit >= kLeastSize && size * unit <= kMostSize))
    throw FileError(a.tets, fmt::format("is {:.3g} m large, which cannot be simulated: --unit tells of what its "
                                        "lengths are",
                                        size * unit));
  console.warn(a.tets, notes);
  if (script.z_up.value_or(false)) look.up = UpAxis::z;
  std::optional<CarriedSurface> surface;
  try {
    if (a.surface.empty())
      surface.emplace(body.mesh);
    else
      surface.emplace(body.mesh, read_mesh(a.surface));
  } catch (const DataError& error) {
    throw FileError(a.surface.empty() ? a.tets : a.surface, error.what());
  }
  if (surface->outside() > 0)
    console.warn(a.surface, {fmt::format("{} of {} vertices lie in no tetrahedron: they go on with the nearest",
                                         grouped(surface->outside()), grouped(surface->vertices()))});

  TetMesh metres = body.mesh;
  metres.attributes = {}, metres.tet_attributes = {};
  for (Vec3& p : metres.vertices) p *= unit;
  // Errors of what the scene says are those of its file.
  const auto told = [&](auto&& work, bool by_flags = false) {
    try {
      return work();
    } catch (const ArgumentError& error) {
      if (a.forces.empty() || by_flags) throw;
      throw FileError(a.forces, in_words(console.in_flags(error.what())));
    } catch (const DataError& error) {
      throw FileError(a.tets, in_words(console.in_flags(error.what())));
    }
  };
  const FrameTimes times =
      told([&] { return frame_times(a, script); }, a.frames || a.flags.duration || a.flags.frames_per_second);
  const SoftBodyOptions options = told([&] {
    const SoftBodyOptions suited = suited_options(script, metres);
    suited.validate();
    return suited;
  });
  const std::size_t steps = told([&] { return steps_a_frame(times, options.step); }, a.flags.step.has_value());
  add_floor_below(script, body.mesh, options);
  check_overwriting(a, times.frames);
  Motion motion(body.mesh, a.draws() || !a.outputs.empty(), a.writes_tets());
  if (motion.bytes(times.frames) > kMostBytes)
    throw ArgumentError(fmt::format("{} frames of {} vertices are {:.1f} GB: fewer --frames", grouped(times.frames),
                                    grouped(body.mesh.vertices.size()), 1e-9 * motion.bytes(times.frames)));
  // A volume is seen alone, unless a surface is asked for beside it.
  const bool with_surface = !a.volume.wanted() || !a.surface.empty();
  PicturesToDraw draw;
  if (a.draws()) draw.pictures.emplace(motion, with_surface ? &*surface : nullptr, a.volume, look, console);
  if (!a.animation.empty()) draw.animation.emplace(1 / times.step);

  const SimulationTotals totals = told([&] {
    const DynamicsScene scene = scaled(script.scene, unit);
    SoftBody moving(std::move(metres), options, scene);
    const double stable = script.step ? moving.stable_step() : options.step;
    if (const std::size_t within = moving.within_obstacles().size(); within > 0)
      console.warn({fmt::format("{} within an obstacle: what is pushed out at once may be thrown",
                                within == 1 ? "1 vertex begins" : grouped(within) + " vertices begin")});
    SimulationTotals done = simulate(moving, times, steps, unit, !a.energies.empty(), motion, console.progress());
    // What explodes says so itself.
    if (options.step > stable)
      console.warn({fmt::format("steps of {:.3g} s are longer than is stable for {} ({:.2g} s)", options.step,
                                word_of(options.integrator), stable)});
    return done;
  });
  if (totals.halvings > 0)
    console.warn(
        {fmt::format("the step was halved {} times, down to {:.4g} s: conjugate gradients did not converge; a "
                     "smaller --step, or less stiffness, is quicker",
                     grouped(totals.halvings), totals.shortest)});
  if (static_cast<double>(totals.unsettled) > kManyUnsettled * static_cast<double>(totals.steps))
    console.warn(
        {fmt::format("contacts were still changing at the end of {} of {} steps: a smaller --step lets them settle",
                     grouped(totals.unsettled), grouped(totals.steps))});
  std::vector<std::string> files = write_outputs(a, motion, *surface, script.scene, draw, console);
  if (!a.energies.empty()) {
    write_text(a.energies, totals.table);
    files.push_back(a.energies);
  }
  console.progress().finish();

  const double a_step = static_cast<double>(totals.steps);
  console.say(fmt::format("{}: {} vertices, {} tetrahedra, {} fixed", a.tets, grouped(body.mesh.vertices.size()),
                          grouped(body.mesh.tets.size()), grouped(script.scene.fixed.size())));
  console.say(fmt::format("{} ({}), {}", word_of(options.model), material_words(options), word_of(options.integrator)));
  console.say(
      fmt::format("{} of at most {:.4g} s in {:.3g} s ({:.1f} a second){}", counted(totals.steps, "step"), options.step,
                  totals.seconds, a_step / std::max(totals.seconds, 1e-9),
                  options.integrator == DynamicsIntegrator::implicit_euler
                      ? fmt::format(", {:.1f} iterations a step", static_cast<double>(totals.iterations) / a_step)
                      : ""));
  console.say(fmt::format(
      "energy {:.6g} J at first, {:.6g} J in the end (kinetic {:.4g}, elastic {:.4g}, gravity {:.4g})",
      totals.first.total(), totals.last.total(), totals.last.kinetic, totals.last.elastic, totals.last.gravity));
  console.say(fmt::format(
      "{} of {:.4g} s: {}", counted(motion.frames(), "frame"), times.step,
      files.size() == 1 ? files[0] : fmt::format("{} files, {} to {}", files.size(), files.front(), files.back())));
  console.say_json({{"input",
                     {{"file", a.tets},
                      {"vertices", body.mesh.vertices.size()},
                      {"tetrahedra", body.mesh.tets.size()},
                      {"notes", body.notes}}},
                    {"scene",
                     {{"fixed", script.scene.fixed.size()},
                      {"forces", script.scene.forces.size()},
                      {"handles", script.scene.handles.size()},
                      {"floors", script.scene.floors.size()},
                      {"spheres", script.scene.spheres.size()},
                      {"unit", unit},
                      {"gravity", std::array{options.gravity.x, options.gravity.y, options.gravity.z}}}},
                    {"model", word_of(options.model)},
                    {"integrator", word_of(options.integrator)},
                    {"stiffness", options.stiffness},
                    {"damping", options.damping},
                    {"young", options.youngs_modulus},
                    {"poisson", options.poissons_ratio},
                    {"stiffness_damping", options.stiffness_damping},
                    {"density", options.density},
                    {"step", options.step},
                    {"steps", totals.steps},
                    {"iterations", totals.iterations},
                    {"halvings", totals.halvings},
                    {"unsettled", totals.unsettled},
                    {"shortest_step", totals.shortest},
                    {"most_contacts", totals.most_contacts},
                    {"seconds", totals.seconds},
                    {"energies", {{"first", energies_json(totals.first)}, {"last", energies_json(totals.last)}}},
                    {"output", {{"frames", motion.frames()}, {"frame_time", times.step}, {"files", files}}}});
  console.print_timings();
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
  c.add_option("--surface", a.surface, "Mesh that moves with the tetrahedra, in place of their boundary")
      .type_name("FILE");
  const char* const body = "Body";
  c.add_option("--fixed", a.fixed, "List of vertices that stay where they are (.bou), numbered as in TETS")
      .type_name("FILE")
      .group(body);
  using M = SoftBodyModel;
  c.add_choice<M>("--model", a.flags.model,
                  {{word_of(M::springs), M::springs}, {word_of(M::corotational), M::corotational}},
                  "springs, or corotational (elasticity in pascals) [springs, but with --young]")
      .type_name("NAME")
      .group(body);
  c.add_option("--stiffness", a.flags.stiffness, "Of springs, N/m [from data]").positive().type_name("N/M").group(body);
  c.add_option("--young", a.flags.young, "Young's modulus, Pa [the file's, else from data]")
      .positive()
      .type_name("PA")
      .group(body);
  c.add_option("--poisson", a.flags.poisson, "Poisson's ratio, 0..0.49 [the file's, else 0.3]")
      .type_name("RATIO")
      .group(body);
  c.add_option("--damping", a.flags.damping, "Of springs, N s/m; of elasticity, s [0.004 s of the stiffness]")
      .type_name("VALUE")
      .group(body);
  c.add_option("--density", a.flags.density, "kg/m³ [the file's, else 1000]").positive().type_name("VALUE").group(body);
  c.add_option_function(
       "--unit",
       [&a](const std::string& text) {
         a.flags.unit = metres_of(text);
         if (a.flags.unit) return;
         const auto metres = number_in(text);
         if (!metres || !(*metres >= kLeastUnit && *metres <= kMostUnit))
           throw must_be("mm, cm, dm, m, km, inch, foot, or its length in metres, 1e-9..1e9", text);
         a.flags.unit = metres;
       },
       "Of lengths in TETS and the scene: mm, cm, dm, m, km, inch, foot or metres [m; where nobody says "
       "more, cm or mm of bodies above 20]")
      .type_name("UNIT")
      .group(body);
  const char* const time = "Time";
  c.add_option("--time", a.flags.duration, "Seconds [2]").positive().type_name("SECONDS").group(time);
  c.add_option("--fps", a.flags.frames_per_second, "Frames a second [25]").positive().type_name("COUNT").group(time);
  c.add_option("--frames", a.frames, "So many frames, the body at rest among them").type_name("COUNT").group(time);
  using I = DynamicsIntegrator;
  c.add_choice<I>("--integrator", a.flags.integrator,
                  {{word_of(I::implicit_euler), I::implicit_euler},
                   {word_of(I::explicit_euler), I::explicit_euler},
                   {word_of(I::verlet), I::verlet},
                   {word_of(I::velocity_verlet), I::velocity_verlet}},
                  "implicit-euler, explicit-euler, verlet or velocity-verlet [implicit-euler]")
      .type_name("NAME")
      .group(time);
  c.add_option("--step", a.flags.step, "Longest step, s [0.01; of explicit ones half of what is stable]")
      .positive()
      .type_name("SECONDS")
      .group(time);
  const char* const seen = "Volume";
  c.add_option("--volume", a.volume_file, "Volume that moves with the tetrahedra, for pictures")
      .type_name("FILE")
      .group(seen);
  c.add_option("--array", a.volume.input.array, "Of the volume [the first that varies]").type_name("NAME").group(seen);
  a.volume.colors.add_options(c, seen);
  add_ascii_flag(c, a.ascii);
  add_background_option(c, a.background);
  add_picture_options(c, a.picture);
  add_wireframe_options(c, a.picture.options);
  c.footer(
      "TETS: Gmsh, Medit, TetGen, Vega meshes, and all other volumes with cells. Down is where y is small (with "
      "--z-up: "
      "z).\nScenes: docs/formats/scene.md. Without one the body falls onto a floor; with --fixed it hangs.\n\n"
      "Examples:\n"
      "  sansmesh simulate turtle.veg --fixed turtle.bou --surface turtle.obj -o turtle.ply\n"
      "  sansmesh simulate dolphin.msh --unit cm --animation dolphin.png --width 480 --height 360\n"
      "  sansmesh simulate bar.msh --forces twist.json -o twist.vtu --energies twist.csv      # open twist.pvd\n"
      "  sansmesh simulate head.msh --forces pull.json --volume head.vti --preset ct-bone -o head.png\n"
      "  twist.json: {\"fixed\": {\"side\": \"-x\"},\n"
      "               \"handles\": {\"on\": {\"side\": \"+x\"}, \"turn\": {\"axis\": [1, 0, 0], \"degrees\": 180}}}");
  return {&c, [shared](Console& console) { run_simulate(*shared, console); }};
}

}  // namespace sansmesh::cli
