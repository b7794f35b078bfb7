// sansmesh render: a picture of a mesh, a cloud or a function.
#include "render.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "commands.h"
#include "sansmesh/core/error.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/io/io.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/points/sample_confidence.h"

namespace sansmesh::cli {
namespace {

RenderOptions picture_options(const RenderArguments& a) {
  RenderOptions o = a.picture.chosen();
  o.smooth = !a.flat;
  o.shadows = !a.no_shadows;
  set_background(o, a.background);
  return o;
}

/// Completes the arguments. Throws ArgumentError for options that would not be heeded.
void complete(RenderArguments& a) {
  static_cast<RenderOptions&>(a.options) = picture_options(a);
  a.surface = a.of_samples.chosen();
  const SurfaceRenderOptions& s = a.options;
  const bool function = a.input.is_function();
  require(!function || !a.surface, "--surface is for samples: the surface of a function file is the function");
  const bool by_confidence = a.color_by == kConfidence;
  require(!by_confidence || !a.color_range, "--color-range is for curvatures: confidence lies in 0..1");
  if (!a.surface && !function) {
    require(a.color_by.empty() || by_confidence, "--color-by of curvatures needs --surface NAME");
    require(a.frames == 0 && !a.color_range && !s.plain && !s.exact_shadows && s.reflection == 0 &&
                s.transmission == 0 && s.refraction_index == SurfaceRenderOptions().refraction_index &&
                !a.cloud.remove_outliers,
            "--frames, --color-range, --plain, --exact-shadows, --reflection, --transmission, "
            "--refraction-index and --remove-outliers need --surface NAME");
  } else {
    require(!a.flat && !s.point_radius,
            "--flat and --point-radius are for meshes and points, not for surfaces without a mesh");
  }
}

/// The colours of the attribute that reconstruct and mesh write.
void color_by_confidence(TriangleMesh& mesh, const std::string& name) {
  const Attribute* const confidence = mesh.attributes.find(kConfidence);
  if (!confidence || confidence->components != 1)
    throw FileError(name, "has no attribute confidence: reconstruct and mesh write it with --confidence");
  mesh.colors.resize(mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.colors.size(); ++v) {
    const double known = confidence->number(v);
    const Vec3f color = confidence_color(std::isfinite(known) ? static_cast<float>(std::clamp(known, 0.0, 1.0)) : 0.0f);
    for (std::size_t k = 0; k < 3; ++k) mesh.colors[v][k] = static_cast<std::uint8_t>(std::lround(255 * color[k]));
  }
}

void run_render(RenderArguments& a, Console& console) {
  complete(a);
  if (a.surface || a.input.is_function()) return run_surface_picture(a, console);
  const RenderOptions& options = a.options;
  options.validate();
  check_writable(a.output, "image");

  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  TriangleMesh mesh = to_mesh(a.input.read(console, read));
  if (a.color_by == kConfidence) color_by_confidence(mesh, a.input.name());
  Image image;
  try {
    image = render_mesh(mesh, options, progress);
  } catch (const DataError& error) {
    throw FileError(a.input.name(), error.what());
  }
  progress.begin("write");
  write_image(a.output, image);
  progress.finish();
  console.say(fmt::format("{}: {} × {} pixels", a.output, image.width, image.height));
  const Json json = {{"output", {{"file", a.output}, {"width", image.width}, {"height", image.height}}}};
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_render(CommandLine& app) {
  CommandLine& c = app.add_subcommand("render", "Mesh, points or function → picture");
  auto shared = std::make_shared<RenderArguments>();
  RenderArguments& a = *shared;
  RenderOptions& o = a.picture.options;
  add_cloud_input(c, a.input, "Mesh, points or function (.smf)");
  c.add_option("-o,--output", a.output, "Picture to write: .png").type_name("FILE").required();
  add_picture_options(c, a.picture);
  add_background_option(c, a.background);
  c.add_flag("--flat", a.flat, "Show the flat triangles: normals are not interpolated").group("Picture");
  c.add_option("--point-radius", o.point_radius, "Radius of points [from their spacing]")
      .type_name("LENGTH")
      .group("Picture");
  c.add_option("--antialiasing", o.samples, "Rays per pixel in each direction, 1..8 [3]")
      .type_name("COUNT")
      .group("Picture");
  c.add_flag("--no-shadows", a.no_shadows, "No shadows").group("Picture");
  add_surface(c, a.of_samples, a.cloud, "Cast rays at this surface of the samples, without a mesh");
  c.add_option(
       "--color-by", a.color_by,
       "mean, gaussian, k1 or k2 curvature (red convex, blue concave), or confidence (red where no samples are)")
      .type_name("QUANTITY")
      .one_of({"mean", "gaussian", "k1", "k2", kConfidence})
      .group("Surface");
  add_color_range(c, a.color_range, "Surface");
  SurfaceRenderOptions& s = a.options;
  c.add_option("--reflection", s.reflection, "Share of the light that a mirror would send, 0..1 [0]")
      .type_name("SHARE")
      .group("Surface");
  c.add_option("--transmission", s.transmission, "Share of the light that comes through the body, 0..1 [0]")
      .type_name("SHARE")
      .group("Surface");
  c.add_option("--refraction-index", s.refraction_index, "Refraction index of the body: 1.33 water, 1.5 glass [1.5]")
      .type_name("RATIO")
      .group("Surface");
  c.add_flag("--exact-shadows", s.exact_shadows, "Shadows by rays against the surface itself: slow").group("Surface");
  c.add_flag("--plain", s.plain, "Quick: one ray per pixel, no shadows, no ground").group("Surface");
  c.add_option("--frames", a.frames, "So many pictures from all around, as NAME_000.png, NAME_001.png, …")
      .type_name("COUNT")
      .within(1, 100000)
      .group("Surface");
  c.footer(kReadable + surface_list() +
           "\n\nExamples:\n"
           "  sansmesh render surface.ply -o surface.png --view front\n"
           "  sansmesh render scan.ply -o scan.png --surface apss\n"
           "  sansmesh render part.xyz -o part.png --surface amls --sharp --color-by mean\n"
           "  sansmesh render scan.ply -o turn.png --surface curvature --frames 72");
  return {&c, [shared](Console& console) { run_render(*shared, console); }};
}

}  // namespace sansmesh::cli
