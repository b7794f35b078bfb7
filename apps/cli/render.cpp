// sansmesh render: a picture of a mesh, a cloud or a function.
#include "render.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "color_bar.h"
#include "commands.h"
#include "option_values.h"
#include "picture_curvature.h"
#include "sansmesh/core/error.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/io/io.h"
#include "sansmesh/points/sample_confidence.h"
#include "schema_options.h"

namespace sansmesh::cli {
namespace {

/// The colours of the attribute that reconstruct and mesh write; where it is not known, those of none.
void color_by_confidence(TriangleMesh& mesh, const std::string& name) {
  const Attribute* const confidence = mesh.attributes.find(kConfidence);
  if (!confidence || confidence->components != 1)
    throw FileError(name, "has no attribute confidence: reconstruct and mesh write it with --confidence");
  mesh.colors.resize(mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.colors.size(); ++v) {
    const double known = confidence->number(v);
    const Vec3f color = confidence_color(std::isfinite(known) ? static_cast<float>(std::clamp(known, 0.0, 1.0)) : 0.0f);
    for (std::size_t k = 0; k < 3; ++k) mesh.colors[v][k] = index_in<std::uint8_t>(std::round(255 * color[k]), 0, 255);
  }
}

/// Fewer samples are drawn as they are: their surface may be nowhere.
constexpr std::size_t kFewestOfSurface = 30;

/// Discs around samples have rims, which lines would show: lines of a cloud are those of a surface.
bool lines_may_need_surface(const RenderArguments& a) {
  return a.options.lines != RenderOptions::Lines::none && a.objects_drawn() == 1 && !a.of_lines &&
         !a.objects.translucent() && a.color_by.empty() && !a.options.point_radius &&
         a.options.wireframe == RenderOptions::Wireframe::none;
}

/// False for points that make no surface: their discs have silhouettes all the same.
bool draw_lines_of_surface(const RenderArguments& a, ReadCloud cloud, Console& console) {
  RenderArguments by_rays = a;
  by_rays.surface = SurfaceOptions{};
  try {
    run_surface_picture(by_rays, console, std::move(cloud));
    return true;
  } catch (const FileError&) {
    return false;
  }
}

void run_render(RenderArguments& a, Console& console) {
  a.complete();
  const bool of_surface = lines_may_need_surface(a);
  if (a.separate && !of_surface) return run_object_picture(a, console);
  if (a.surface || a.splats || a.input.is_function()) return run_surface_picture(a, console);
  RenderOptions options = a.options;
  options.validate();
  check_writable(a.output, "image");

  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  PointSet points = a.input.read(console, read);
  if (of_surface && points.triangles.empty() && a.options.smooth && points.size() >= kFewestOfSurface &&
      draw_lines_of_surface(a, {points, read}, console))
    return;
  if (a.separate) return run_object_picture(a, console);
  a.check_kinds({points.triangles.empty() ? ObjectKind::points : ObjectKind::mesh});
  if (a.cloud.remove_outliers) leave_out_outliers(points, a.input.name(), console);
  std::unique_ptr<CurvatureField> curvature;
  if (wants_curvature(options)) curvature = curvature_of_samples(points, a.cloud, progress);
  options.curvature = curvature.get();
  TriangleMesh mesh = to_mesh(std::move(points));
  Image image;
  try {
    std::optional<ColorBar> bar;
    if (a.color_by == kConfidence) {
      color_by_confidence(mesh, a.input.name());
      bar = confidence_bar();
    } else if (!a.color_by.empty()) {
      require(!is_curvature(a.color_by) || mesh.attributes.find(a.color_by),
              "--color-by of curvatures needs --surface NAME, or a file with them as attributes (sansmesh curvature)");
      bar = color_by_attribute(mesh, a.color_by, a.value_range, a.unit);
      options.shadows = options.ground = false;  // colours are to be read
    }
    if (a.no_bar) bar.reset();
    leave_room(options, bar);
    image = beside_bar(render_mesh(mesh, options, progress), bar, options);
  } catch (const DataError& error) {
    throw FileError(a.input.name(), error.what());
  }
  progress.begin("write");
  image = a.picture.write(a.output, image, options);
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
  c.add_option("input", a.input.files,
               "Meshes, points or functions (.smf): several are objects of one picture, but with --as-one or --surface")
      .type_name("FILE")
      .required();
  add_class_options(c, a.input);
  c.add_option("-o,--output", a.output, "Picture to write: .png").type_name("FILE").required();
  add_picture_options(c, a.picture);
  add_background_option(c, a.background);
  add_schema(c, a.picture.options, {.group = "Picture", .only = {"smooth", "point_radius", "antialiasing", "shadows"}});
  add_surface(c, a.of_samples, a.cloud, "Cast rays at this surface of the samples, without a mesh");
  add_wireframe_options(c, a.picture.options);
  add_line_options(c, a.picture);
  add_accessibility_options(c, a.picture);
  add_object_options(c, a.objects);
  c.add_option(
       "--color-by", a.color_by,
       "An attribute of the vertices or points, as a vector its length; with --surface mean, gaussian, k1 or k2 "
       "curvature (red convex, blue concave); confidence (red where no samples are)")
      .type_name("QUANTITY")
      .group("Colours");
  c.add_option_function(
       "--value-range",
       [&a](const std::vector<double>& v) {
         a.value_range = {v[0], v[1]};
       },
       "Of an attribute: values with the colours at the ends of the bar [from data]")
      .numbers(2)
      .type_name("LOW,HIGH")
      .group("Colours");
  add_bar_options(c, a.no_bar, a.unit, "the attribute, or of lengths in curvatures");
  add_color_range(c, a.color_range, "Colours");
  add_schema(c, a.options, {.group = "Surface", .only = {"reflection", "transmission", "refraction_index"}});
  c.add_choice<bool>("--rays", a.stored_rays, {{"march", false}, {"stored", true}},
                     "levin, alexa, curvature: march through the balls around the samples, or start from polynomials "
                     "stored with them [march]")
      .type_name("CHOICE")
      .group("Surface");
  add_schema(c, a.options, {.group = "Surface", .only = {"exact_shadows", "plain"}});
  c.add_option_function(
       "--splats",
       [&a](const std::string& word) { a.splats = static_cast<std::size_t>(parse_whole(word, 0, 100000000)); },
       "Points of the surface, evenly spread, as splats that blend, not rays: of --surface, or of what suits the "
       "samples "
       "[no value: as many as there are samples]")
      .type_name("COUNT")
      .without_value("0")
      .group("Surface");
  c.add_option("--frames", a.frames, "So many pictures from all around, as NAME_000.png, NAME_001.png, …")
      .type_name("COUNT")
      .within(1, 100000)
      .group("Surface");
  c.footer(kReadable + surface_list() +
           "\n\nExamples:\n"
           "  sansmesh render surface.ply -o surface.png --view front\n"
           "  sansmesh render part.stl -o part.png --orthographic --scale-bar=mm --wireframe\n"
           "  sansmesh render a.ply b.ply scan.smf -o all.png --color red --color '#4080ff' --opacity 1 --opacity 0.4\n"
           "  sansmesh render curved.ply -o k1.png --color-by k1 --look-at 1,0,2 --look-radius 0.5\n"
           "  sansmesh render scan.ply -o scan.png --surface apss\n"
           "  sansmesh render scan.ply -o splats.png --splats\n"
           "  sansmesh render mesh.ply -o drawing.png --lines\n"
           "  sansmesh render mesh.ply -o open.png --accessibility\n"
           "  sansmesh render part.xyz -o part.png --surface amls --sharp --color-by mean\n"
           "  sansmesh render scan.ply -o turn.png --surface curvature --frames 72");
  return {&c, [shared](Console& console) { run_render(*shared, console); }};
}

}  // namespace sansmesh::cli
