// The command line: what can be asked, what it means, and which exit code says what went wrong.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <new>
#include <utility>
#include <vector>

#include "commands.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"
#include "sansmesh/core/names.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::cli {
namespace {

constexpr int kFailed = 1;         // a file or its data
constexpr int kUsage = 2;          // the command line
constexpr int kInterrupted = 130;  // Ctrl-C, as shells have it

constexpr const char* kExamples = R"(
Examples:
  sansmesh reconstruct scan.ply -o surface.ply
  sansmesh reconstruct scan.ply -o surface.glb --preview surface.png
  sansmesh evaluate surface.ply reference.ply
  sansmesh COMMAND --help

Lengths are in the unit of the input. What is not given is chosen from the data.
Exit codes: 0 done, 1 a file or its data is at fault, 2 the command line is, 130 interrupted.)";

struct CommandLine {
  ConsoleOptions console;
  int threads = 0;
  ReconstructArguments reconstruct;
  SurfaceOptions surface;
  std::string surface_name;
  bool no_sheets = false;
  NormalsArguments normals;
  bool no_orient = false;
  EvaluateArguments evaluate;
  InfoArguments info;
  RenderArguments render;
  ProjectArguments project;
  CurvatureArguments curvature;
  AdviseArguments advise;
  std::string view, background = "gradient";
  bool flat = false, z_up = false, no_shadows = false;
};

void add_common(CLI::App& command, CommandLine& line) {
  command.add_flag("--json", line.console.json, "Print the results as one JSON object")->group("Output");
  command.add_flag("--verbose", line.console.verbose, "Print the time that each stage took")->group("Output");
  command.add_flag("--quiet", line.console.quiet, "Print errors and nothing else")->group("Output");
  command.add_option("--threads", line.threads, "Number of threads; results do not depend on it [all cores]")
      ->check(CLI::Range(1, 1024).description(""))
      ->type_name("COUNT")
      ->group("Output");
}

CLI::App& add_command(CLI::App& app, const char* name, const std::string& what, CommandLine& line) {
  CLI::App& command = *app.add_subcommand(name, what);
  command.footer(kReadable);
  add_common(command, line);
  return command;
}

/// How a meshless surface is made. The options of one command are those of all: only one runs.
void add_surface_details(CLI::App& c, CommandLine& line) {
  SurfaceOptions& o = line.surface;
  c.add_flag("--sharp", o.sharp, "Edges and corners: normals that turn sharply (bilateral)")->group("Surface");
  c.add_option("--smoothing", o.smoothing, "Width of the weights over the spacing of the samples, 0.5..20 [from data]")
      ->type_name("RATIO")
      ->group("Surface");
  c.add_option("--bandwidth", o.width, "Width of the weights as one length, in place of --smoothing")
      ->type_name("LENGTH")
      ->group("Surface");
  c.add_option("--order", o.order, "amls: order of the approximation, 2, 4 or 6 [from data]")
      ->type_name("ORDER")
      ->group("Surface");
  c.add_option("--iterations", o.iterations, "amls: 0 smooths most, many interpolate [from data]")
      ->type_name("COUNT")
      ->group("Surface");
  c.add_option("--diffusion", o.diffusion, "curvature: samples far off count less: none, soft or hard [none]")
      ->type_name("CHOICE")
      ->group("Surface");
  c.add_flag("--no-sheets", line.no_sheets, "Let samples of the other side of a thin part count too")->group("Surface");
  c.add_flag("--remove-outliers", o.remove_outliers, "Leave out samples that belong to no surface, such as strays")
      ->group("Surface");
}

void add_surface(CLI::App& c, CommandLine& line, const std::string& what) {
  c.add_option("--surface", line.surface_name, what + ": " + listed(surface_names()))
      ->type_name("NAME")
      ->group("Surface");
  add_surface_details(c, line);
}

/// What was said about the surface; nothing if it was not named.
std::optional<SurfaceOptions> chosen_surface(CommandLine& line) {
  const SurfaceOptions none;
  SurfaceOptions& o = line.surface;
  o.separate_sheets = !line.no_sheets;
  if (!line.surface_name.empty()) {
    o.method = line.surface_name;
    if (o.method == "partition" && o.sharp)
      throw ArgumentError("--sharp is for other surfaces than partition, which finds creases by itself");
    o.validate();
    return o;
  }
  if (o.smoothing || o.width || o.order || o.iterations || o.diffusion != none.diffusion || line.no_sheets || o.sharp)
    throw ArgumentError(
        "--sharp, --smoothing, --bandwidth, --order, --iterations, --diffusion and --no-sheets need --surface NAME");
  return std::nullopt;
}

CLI::App& add_reconstruct(CLI::App& app, CommandLine& line) {
  CLI::App& c = add_command(app, "reconstruct", "Points → triangle mesh, closed unless asked otherwise", line);
  ReconstructArguments& a = line.reconstruct;
  c.add_option("input", a.input, "Points, or a mesh or polygon soup")->type_name("FILE")->required();
  c.add_option("-o,--output", a.output, "Mesh to write: .ply .obj .stl .off .glb")->type_name("FILE")->required();
  c.add_option("--preview", a.preview, "Also draw the mesh into this PNG")->type_name("FILE");
  c.add_flag("--ascii", a.ascii, "Write text where the format also has a binary form");
  add_mesh_options(c, a.options);
  add_cloud_options(c, a.options);
  add_fit_options(c, a.options);
  add_surface(c, line, "Cut another surface out, as it stands [partition]");
  c.footer(std::string(kReadable) +
           "\n\nExamples:\n"
           "  sansmesh reconstruct scan.ply -o surface.ply --preview surface.png\n"
           "  sansmesh reconstruct terrain.las -o terrain.ply --trim\n"
           "  sansmesh reconstruct part.ply -o part.stl --surface apss --sharp\n"
           "  sansmesh reconstruct part.xyz -o part.stl --mesh-error 0.05 --components largest");
  return c;
}

CLI::App& add_normals(CLI::App& app, CommandLine& line) {
  CLI::App& c = add_command(app, "normals", "Points → points with oriented normals", line);
  NormalsArguments& a = line.normals;
  c.add_option("input", a.input, "Points, or a mesh or polygon soup")->type_name("FILE")->required();
  c.add_option("-o,--output", a.output, "Points to write: .ply .obj .xyz .csv .pcd")->type_name("FILE")->required();
  c.add_flag("--ascii", a.ascii, "Write text where the format also has a binary form");
  c.add_option("--neighbours", a.options.neighbours, "Samples in a neighbourhood, 6..500 [from spacing and noise]")
      ->type_name("COUNT");
  c.add_option("--method", a.options.method, "covariance (a plane) or jet (a quadric) [jet]")
      ->transform(choices<NormalOptions::Method>(
          {{"covariance", NormalOptions::Method::covariance}, {"jet", NormalOptions::Method::jet}}))
      ->type_name("CHOICE");
  c.add_option("--reweightings", a.options.reweightings,
               "Rounds, 0..10, that silence samples off the fit: sharper at creases [0]")
      ->type_name("COUNT");
  c.add_flag("--keep", a.keep, "Keep the normals of the file and only orient them");
  c.add_flag("--no-orient", line.no_orient, "Leave the signs as they come");
  return c;
}

CLI::App& add_evaluate(CLI::App& app, CommandLine& line) {
  CLI::App& c = add_command(app, "evaluate", "Mesh → distances to a reference, topology, shape of triangles", line);
  EvaluateArguments& a = line.evaluate;
  c.add_option("mesh", a.surface, "Mesh or points")->type_name("FILE")->required();
  c.add_option("reference", a.reference, "Mesh or points to compare with");
  c.add_option("--samples", a.samples, "Samples on each mesh [300000]")
      ->type_name("COUNT")
      ->check(CLI::Range(1u, 2000000000u).description(""));
  c.footer(
      "To the reference: accuracy. From the reference: completeness. Normal angles are between planes, 0..90°.\n"
      "Where a side is a set of points, distances do not fall below half their spacing.");
  return c;
}

CLI::App& add_info(CLI::App& app, CommandLine& line) {
  CLI::App& c = add_command(app, "info", "File → what is in it: points, box, spacing, noise, normals, faces", line);
  c.add_option("input", line.info.input, "Points, mesh or function (.smf)")->type_name("FILE")->required();
  return c;
}

CLI::App& add_render(CLI::App& app, CommandLine& line) {
  CLI::App& c = add_command(app, "render", "Mesh, points or function → picture", line);
  RenderArguments& a = line.render;
  RenderOptions& o = a.options;
  c.add_option("input", a.input, "Mesh, points or function (.smf)")->type_name("FILE")->required();
  c.add_option("-o,--output", a.output, "Picture to write: .png")->type_name("FILE")->required();
  c.add_option("--width", o.width, "Pixels, 1..16384 [1280]")->type_name("PIXELS");
  c.add_option("--height", o.height, "Pixels, 1..16384 [960]")->type_name("PIXELS");
  c.add_option("--view", line.view, "front, back, left, right, top, bottom or iso")->type_name("NAME");
  c.add_option("--azimuth", o.view.azimuth, "Degrees around the up axis; 0: the front [35]")->type_name("DEGREES");
  c.add_option("--elevation", o.view.elevation, "Degrees above the horizon [20]")->type_name("DEGREES");
  c.add_flag("--z-up", line.z_up, "The z axis points up, not y");
  c.add_option("--background", line.background, "gradient, white, black or transparent [gradient]")
      ->type_name("CHOICE")
      ->check(CLI::IsMember({"gradient", "white", "black", "transparent"}).description(""));
  c.add_flag("--flat", line.flat, "Show the triangles: no interpolated normals");
  c.add_option("--point-radius", o.point_radius, "Radius of points [from their spacing]")->type_name("LENGTH");
  c.add_option("--antialiasing", o.samples, "Rays a pixel in each direction, 1..8 [3]")->type_name("COUNT");
  c.add_flag("--no-shadows", line.no_shadows, "No shadows");
  add_surface(c, line, "Cast rays at this surface of the samples, without a mesh");
  SurfaceRenderOptions& s = a.surface_options;
  c.add_option("--color-by", a.color_by, "Curvature as colour: mean, gaussian, k1 or k2; red convex, blue concave")
      ->type_name("QUANTITY")
      ->check(CLI::IsMember({"mean", "gaussian", "k1", "k2"}).description(""))
      ->group("Surface");
  c.add_option("--color-range", a.color_range,
               "Curvature that has the full colour, 1/length or, for gaussian, 1/length² [from data]")
      ->type_name("VALUE")
      ->check(CLI::PositiveNumber.description(""))
      ->group("Surface");
  c.add_option("--reflection", s.reflection, "Share of the light that a mirror would send, 0..1 [0]")
      ->type_name("SHARE")
      ->group("Surface");
  c.add_option("--transmission", s.transmission, "Share of the light that comes through the body, 0..1 [0]")
      ->type_name("SHARE")
      ->group("Surface");
  c.add_option("--refraction-index", s.refraction_index, "Of the body: 1.33 water, 1.5 glass [1.5]")
      ->type_name("RATIO")
      ->group("Surface");
  c.add_flag("--exact-shadows", s.exact_shadows, "Shadows by rays against the surface itself: slow")->group("Surface");
  c.add_flag("--plain", s.plain, "Quick: one ray a pixel, no shadows, no ground")->group("Surface");
  c.add_option("--frames", a.frames, "Pictures all around, as NAME_000.png, NAME_001.png, …")
      ->type_name("COUNT")
      ->check(CLI::Range(1, 100000).description(""))
      ->group("Surface");
  c.footer(std::string(kReadable) +
           "\n\nExamples:\n"
           "  sansmesh render surface.ply -o surface.png --view front\n"
           "  sansmesh render scan.ply -o scan.png --surface apss\n"
           "  sansmesh render part.xyz -o part.png --surface amls --sharp --color-by mean\n"
           "  sansmesh render scan.ply -o turn.png --surface curvature --frames 72");
  return c;
}

CLI::App& add_project(CLI::App& app, CommandLine& line) {
  CLI::App& c = add_command(app, "project", "Points → points on the surface of samples: denoise, resample", line);
  ProjectArguments& a = line.project;
  c.add_option("input", a.input, "Points to move")->type_name("FILE")->required();
  c.add_option("-o,--output", a.output, "Points to write: .ply .obj .xyz .csv .pcd")->type_name("FILE")->required();
  c.add_option("--onto", a.onto, "Samples of the surface [the input itself: this denoises]")->type_name("FILE");
  c.add_flag("--ascii", a.ascii, "Write text where the format also has a binary form");
  c.add_option("--method", a.method,
               "lop (consolidation of the input) or a surface: " + listed(surface_names()) + " [curvature]")
      ->type_name("NAME");
  c.add_option("--points", a.points, "Spread about so many new points over the surface instead of moving those given")
      ->type_name("COUNT")
      ->check(CLI::Range(1u, 2000000000u).description(""));
  c.add_option("--steps", a.steps, "Most steps of a point, 1..1000 [10]")->type_name("COUNT");
  c.add_option("--tolerance", a.tolerance, "A step shorter than this, over the spacing, is the last [0.001]")
      ->type_name("RATIO");
  c.add_option("--radius", a.lop.radius, "lop: radius of the neighbourhoods [from spacing and noise]")
      ->type_name("LENGTH");
  c.add_option("--repulsion", a.lop.repulsion, "lop: points keep apart, 0..0.5 [0.45]")->type_name("SHARE");
  add_surface_details(c, line);
  c.footer(std::string(kReadable) +
           "\n\nExamples:\n"
           "  sansmesh project noisy.ply -o smooth.ply\n"
           "  sansmesh project probes.xyz --onto scan.ply -o feet.ply --method levin\n"
           "  sansmesh project scan.ply -o dense.ply --points 1000000\n"
           "  sansmesh project outliers.ply -o even.ply --method lop --points 20000");
  return c;
}

CLI::App& add_curvature(CLI::App& app, CommandLine& line) {
  CLI::App& c = add_command(app, "curvature", "Points → principal curvatures and directions at them", line);
  CurvatureArguments& a = line.curvature;
  c.add_option("input", a.input, "Points, or a mesh or polygon soup")->type_name("FILE")->required();
  c.add_option("-o,--output", a.output, "Points to write with attributes: .ply .csv (others: colours only)")
      ->type_name("FILE")
      ->required();
  c.add_option("--preview", a.preview, "Also draw the coloured points into this PNG")->type_name("FILE");
  c.add_flag("--ascii", a.ascii, "Write text where the format also has a binary form");
  c.add_option("--color-by", a.color_by, "mean, gaussian, k1 or k2 [mean]")
      ->type_name("QUANTITY")
      ->check(CLI::IsMember({"mean", "gaussian", "k1", "k2"}).description(""));
  c.add_option("--color-range", a.color_range,
               "Curvature that has the full colour, 1/length or, for gaussian, 1/length² [from data]")
      ->type_name("VALUE")
      ->check(CLI::PositiveNumber.description(""));
  c.add_option("--neighbours", a.options.neighbours, "Samples in a neighbourhood, 8..2000 [from noise and shape]")
      ->type_name("COUNT");
  c.add_option("--radius", a.options.radius, "Width of the weights as one length, in place of --neighbours")
      ->type_name("LENGTH");
  c.add_option("--tau", a.options.tau, "Exponent of the M-like weights, 1..4 [2]")->type_name("EXPONENT");
  c.add_option("--weights", a.options.weights, "m-like, gaussian or uniform [m-like]")
      ->transform(choices<CurvatureOptions::Weights>({{"m-like", CurvatureOptions::Weights::m_like},
                                                      {"gaussian", CurvatureOptions::Weights::gaussian},
                                                      {"uniform", CurvatureOptions::Weights::uniform}}))
      ->type_name("CHOICE");
  c.footer(std::string(kReadable) +
           "\n\nCurvatures are per length of the input, positive where the surface is convex."
           "\n\nExamples:\n"
           "  sansmesh curvature scan.ply -o curved.ply --preview curved.png\n"
           "  sansmesh curvature scan.ply -o table.csv --color-by gaussian");
  return c;
}

CLI::App& add_advise(CLI::App& app, CommandLine& line) {
  CLI::App& c = add_command(app, "advise", "Points → which method suits them, why, and the commands to run", line);
  c.add_option("input", line.advise.input, "Points, or a mesh or polygon soup")->type_name("FILE")->required();
  c.footer(std::string(kReadable) +
           "\n\nLooks at noise, density, sharp edges, borders, stray samples and normals. Writes nothing."
           "\n\nExamples:\n"
           "  sansmesh advise scan.ply\n"
           "  sansmesh advise scan.ply --json");
  return c;
}

void run(const CLI::App& app, const std::vector<Command>& commands, CommandLine& line) {
  if (line.threads > 0) set_thread_count(line.threads);
  Console console(line.console);
  for (const Command& command : commands)
    if (app.got_subcommand(command.app)) return command.run(console);
  if (app.got_subcommand("reconstruct")) {
    ReconstructOptions& o = line.reconstruct.options;
    o.remove_outliers = line.surface.remove_outliers;
    if (const auto surface = chosen_surface(line); surface && surface->method != "partition") {
      require(!o.max_depth && !o.error && !o.support && o.max_degree == ReconstructOptions().max_degree && o.sharp,
              "--depth, --error, --support, --degree and --smooth belong to the partition, not to other surfaces");
      require(!o.trim || *o.trim > 0,
              "--trim needs a LENGTH with --surface: such surfaces end at their borders anyway");
      o.surface = surface;
    }
    run_reconstruct(line.reconstruct, console);
  } else if (app.got_subcommand("normals")) {
    line.normals.orient = !line.no_orient;
    run_normals(line.normals, console);
  } else if (app.got_subcommand("evaluate")) {
    run_evaluate(line.evaluate, console);
  } else if (app.got_subcommand("project")) {
    ProjectArguments& p = line.project;
    p.surface = line.surface;
    p.surface.separate_sheets = !line.no_sheets;
    run_project(line.project, console);
  } else if (app.got_subcommand("curvature")) {
    run_curvature(line.curvature, console);
  } else if (app.got_subcommand("advise")) {
    run_advise(line.advise, console);
  } else if (app.got_subcommand("info")) {
    run_info(line.info, console);
  } else {
    RenderOptions& o = line.render.options;
    if (!line.view.empty()) o.view = named_view(line.view);
    if (line.z_up) o.up = UpAxis::z;
    o.smooth = !line.flat;
    o.shadows = !line.no_shadows;
    line.render.surface = chosen_surface(line);
    const SurfaceRenderOptions& s = line.render.surface_options;
    const bool function = is_function_file(line.render.input);
    require(!function || !line.render.surface,
            "--surface is for samples: the surface of a function file is the function");
    if (!line.render.surface && !function) {
      require(line.render.frames == 0 && line.render.color_by.empty() && !line.render.color_range && !s.plain &&
                  !s.exact_shadows && s.reflection == 0 && s.transmission == 0 &&
                  s.refraction_index == SurfaceRenderOptions().refraction_index && !line.surface.remove_outliers,
              "--frames, --color-by, --color-range, --plain, --exact-shadows, --reflection, --transmission, "
              "--refraction-index and --remove-outliers need --surface NAME");
    } else {
      require(!line.flat && !o.point_radius,
              "--flat and --point-radius are for meshes and points, not for surfaces without a mesh");
    }
    using Background = RenderOptions::Background;
    if (line.background == "transparent") o.background = Background::transparent;
    if (line.background == "white" || line.background == "black") {
      o.background = Background::solid;
      o.background_color = line.background == "white" ? Vec3f{1, 1, 1} : Vec3f{0, 0, 0};
    }
    run_render(line.render, console);
  }
}

int main(int argc, char** argv) {
  CommandLine line;
  CLI::App app{"Surfaces straight from samples.", "sansmesh"};
  app.footer(kExamples);
  app.set_version_flag("--version", std::string("sansmesh ") + SANSMESH_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->column_width(28);
  add_reconstruct(app, line);
  add_normals(app, line);
  add_evaluate(app, line);
  add_info(app, line);
  add_render(app, line);
  add_project(app, line);
  add_curvature(app, line);
  add_advise(app, line);
  const std::vector<Command> commands = {add_fit(app),     add_mesh(app),     add_eval(app),
                                         add_edit(app),    add_diagnose(app), add_section(app),
                                         add_compare(app), add_measure(app),  add_csg(app)};
  for (const Command& command : commands) add_common(*command.app, line);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help_or_version) {
    return app.exit(help_or_version);
  } catch (const CLI::ParseError& error) {
    const auto chosen = app.get_subcommands();
    if (argc < 2) {
      fmt::print("{}", app.help());
    } else if (chosen.empty() && argv[1][0] != '-') {
      print_error(fmt::format("unknown command '{}' (see sansmesh --help)", argv[1]));
    } else {
      print_error(fmt::format("{} (see sansmesh {}--help)", error.what(),
                              chosen.empty() ? "" : chosen.front()->get_name() + " "));
    }
    return kUsage;
  }
  try {
    run(app, commands, line);
    return 0;
  } catch (const Cancelled&) {
    print_error("interrupted, nothing was written");
    return kInterrupted;
  } catch (const ArgumentError& error) {
    print_error(error.what());
    return kUsage;
  } catch (const std::bad_alloc&) {
    print_error("not enough memory");
  } catch (const std::exception& error) {
    print_error(error.what());
  }
  return kFailed;
}

}  // namespace
}  // namespace sansmesh::cli

int main(int argc, char** argv) { return sansmesh::cli::main(argc, argv); }
