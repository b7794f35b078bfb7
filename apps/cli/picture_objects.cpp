// sansmesh render of several files: each is an object of its own.
#include "picture_objects.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

#include "command_line.h"
#include "picture_curvature.h"
#include "render.h"
#include "sansmesh/core/box.h"
#include "sansmesh/core/error.h"
#include "sansmesh/data/image.h"
#include "sansmesh/data/polyline_set.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/io/io.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/mesh/tubes.h"
#include "sansmesh/model/surface_model.h"
#include "sansmesh/points/spacing.h"
#include "sansmesh/render/color_space.h"
#include "sansmesh/render/color_words.h"
#include "sansmesh/render/picture_notes.h"
#include "sansmesh/render/picture_surfaces.h"
#include "sansmesh/render/surface_caster.h"

namespace sansmesh::cli {
namespace {

constexpr const char *kAutoColor = "auto", *kOwnColor = "own";
/// Pixels that are left for the objects beside the legend, at least.
constexpr int kLeastBesideLegend = 100;
constexpr double kTubeRadius = 1.0 / 400;  // of the diagonal of the lines

/// Far from each other in hue, then in lightness as well.
Vec3f object_color(std::size_t number) {
  constexpr std::array<double, 8> kHues{255, 60, 150, 20, 310, 100, 205, 345};
  const std::size_t round = number / kHues.size();
  const double lightness = round % 3 == 0 ? 0.70 : round % 3 == 1 ? 0.50 : 0.83;
  return srgb_of_oklch(lightness, 0.13, kHues[number % kHues.size()] + 22.0 * static_cast<double>(round % 2));
}

/// An object without a mesh, and what it needs.
struct MeshlessObject {
  SurfaceModel model;
  SurfaceCaster caster;

  explicit MeshlessObject(SurfaceModel made, Progress& progress)
      : model(std::move(made)), caster(model.field(progress), model.balls(), {}) {}
};

/// Lines as tubes, as thin as those of `flow lines`.
TriangleMesh tubes_of(const PolylineSet& lines) {
  Box3 box;
  for (const Vec3f& p : lines.positions)
    if (is_finite(p)) box.extend(Vec3(p));
  const double radius = kTubeRadius * box.diagonal();
  if (!(radius > 0)) throw DataError("all points of the lines are in one place: there is nothing to draw");
  return tubes(lines, {.radius = radius, .sides = 8, .least_step = 0.5 * radius});
}

const char* object_word(ObjectKind kind) {
  switch (kind) {
    case ObjectKind::mesh:
      return "mesh";
    case ObjectKind::points:
      return "points";
    case ObjectKind::lines:
      return "lines";
    case ObjectKind::function:
      return "function";
  }
  return "";
}

PointSet tube_samples(const TriangleMesh& mesh) {
  PointSet points;
  points.origin = mesh.origin, points.positions = mesh.vertices;
  points.normals = mesh.normals, points.triangles = mesh.triangles;
  return points;
}

struct DrawnObjects {
  std::vector<PictureSurface> surfaces;
  std::vector<Vec3> places;
  std::vector<LegendEntry> legend;
  std::vector<std::unique_ptr<MeshlessObject>> meshless;
  std::vector<ObjectKind> kinds;
  std::unique_ptr<CurvatureField> curvature;  ///< of a single object, where the picture shows it
  Json json = Json::array();
};

void add_object(const RenderArguments& a, std::size_t k, DrawnObjects& drawn, Console& console) {
  CloudInput one = a.input;
  if (!a.joined()) one.files = {a.input.files[k]};
  const std::string& file = a.input.files[k];
  const ObjectLooks& looks = a.objects;
  Progress& progress = console.progress();
  progress.begin("read");
  const std::string word = k < looks.colors.size() ? looks.colors[k] : kAutoColor;
  const double opacity = k < looks.opacities.size() ? looks.opacities[k] : 1;
  SurfaceRenderOptions own = a.options;
  const auto choose_color = [&](bool has_colors) {
    own.use_colors = has_colors && (word == kAutoColor || word == kOwnColor);
    if (own.use_colors) return;
    const bool alone = a.objects_drawn() == 1;
    if (word == kAutoColor && !alone) own.surface_color = object_color(k);
    if (const auto color = color_of_word(word)) own.surface_color = *color;
  };
  ObjectKind kind = ObjectKind::mesh;
  PictureSurface surface;
  double apart = 0;
  Vec3f mean_color;
  if (!a.joined() && is_function_file(file)) {
    kind = ObjectKind::function;
    require(!a.input.classes, "--class and --without-class are for points: an input is a function");
    drawn.meshless.push_back(std::make_unique<MeshlessObject>(make_surface_model(read_function(file)), progress));
    const MeshlessObject& object = *drawn.meshless.back();
    console.warn(file, object.model.warnings());
    choose_color(object.model.colors() != nullptr);
    surface =
        surface_in_picture(object.caster, object.model.place(), own.use_colors ? object.model.colors() : nullptr, own);
    const auto& samples = object.model.points().positions;
    for (const Vec3f& p : samples.empty() ? object.model.balls().centers : samples)
      drawn.places.push_back(object.model.place().to_input(Vec3(p)));
    mean_color = own.surface_color;
  } else {
    ReadReport read;
    PointSet points = one.read(console, read);
    const PolylineSet lines = points.triangles.empty() && !a.joined() ? lines_of_file(file) : PolylineSet{};
    if (points.triangles.empty()) kind = lines.size() > 0 ? ObjectKind::lines : ObjectKind::points;
    if (kind == ObjectKind::points && a.cloud.remove_outliers) leave_out_outliers(points, one.name(), console);
    const bool curved = a.objects_drawn() == 1 && wants_curvature(a.options);
    if (curved && kind != ObjectKind::lines) drawn.curvature = curvature_of_samples(points, a.cloud, progress);
    TriangleMesh mesh = kind == ObjectKind::lines ? tubes_of(lines) : to_mesh(std::move(points));
    if (curved && kind == ObjectKind::lines)
      drawn.curvature = curvature_of_samples(tube_samples(mesh), a.cloud, progress);
    choose_color(mesh.colors.size() == mesh.vertices.size() && !mesh.colors.empty());
    mean_color = own.surface_color;
    if (own.use_colors) {
      Vec3 sum;
      for (const auto& c : mesh.colors) sum += Vec3{double(c[0]), double(c[1]), double(c[2])};
      mean_color = Vec3f(sum / (255.0 * static_cast<double>(mesh.colors.size())));
    }
    if (mesh.triangles.empty() && opacity < 1) {
      PointSet cloud;
      cloud.positions = mesh.vertices;
      apart = 4 * own.point_radius.value_or(estimate_spacing(cloud));  // the discs of one sheet
    }
    surface = surface_in_picture(mesh, own);
    for (const Vec3f& p : mesh.vertices)
      if (is_finite(p)) drawn.places.push_back(mesh.origin + Vec3(p));
  }
  drawn.surfaces.push_back(opacity < 1 ? translucent(std::move(surface), opacity, apart) : std::move(surface));
  const std::string name = k < looks.names.size() ? looks.names[k] : std::filesystem::path(file).filename().string();
  drawn.kinds.push_back(kind);
  drawn.legend.push_back({mean_color, name});
  Json json = one.json();
  json["kind"] = object_word(kind);
  json["name"] = name;
  json["color"] = own.use_colors ? kOwnColor : hex_of_color(own.surface_color);
  json["opacity"] = opacity;
  drawn.json.push_back(std::move(json));
}

}  // namespace

PolylineSet lines_of_file(const std::string& file) {
  return file.ends_with(".vtp") || file.ends_with(".vtp.gz") ? read_lines(file) : PolylineSet{};
}

bool ObjectLooks::translucent() const {
  return std::any_of(opacities.begin(), opacities.end(), [](double o) { return o < 1; });
}

void ObjectLooks::check(std::size_t objects) const {
  for (const std::string& word : colors) {
    if (word == kAutoColor || word == kOwnColor || color_of_word(word)) continue;
    throw ArgumentError(fmt::format("--color '{}' is none: {}, '#rrggbb', {} (the file's) or {}", printable(word, 40),
                                    color_words(), kOwnColor, kAutoColor));
  }
  for (const double o : opacities)
    if (!(o >= 0 && o <= 1)) throw ArgumentError(fmt::format("--opacity must lie in 0..1, not {:g}", o));
  for (const auto& [flag, count] :
       {std::pair{"--color", colors.size()}, {"--opacity", opacities.size()}, {"--name", names.size()}})
    if (count > objects)
      throw ArgumentError(fmt::format("{} is given {} times, for {}", flag, count, counted(objects, "object")));
}

void add_object_options(CommandLine& c, ObjectLooks& looks) {
  const char* const group = "Objects";
  c.add_option("--color", looks.colors,
               "Of the first file, the second time of the second one, …: '#rrggbb', red, blue, …, own (the file's) or "
               "auto [own where there are some]")
      .type_name("COLOR")
      .repeated()
      .group(group);
  c.add_option("--opacity", looks.opacities, "The same for opacities, 0..1 [1]")
      .type_name("SHARE")
      .repeated()
      .group(group);
  c.add_option("--name", looks.names, "The same for names in the legend [the files']")
      .type_name("TEXT")
      .repeated()
      .group(group);
  c.add_flag("--no-legend", looks.no_legend, "No list of the objects beside the picture").group(group);
  c.add_flag("--as-one", looks.as_one, "Several files (tiles) are one object").group(group);
}

void run_object_picture(const RenderArguments& a, Console& console) {
  RenderOptions look = a.options;
  look.validate();
  a.picture.check_frames(a.frames > 0);
  check_writable(a.output, "image");
  DrawnObjects drawn;
  for (std::size_t k = 0; k < a.objects_drawn(); ++k) try {
      add_object(a, k, drawn, console);
    } catch (const DataError& error) {
      throw FileError(a.joined() ? a.input.name() : a.input.files[k], error.what());
    }
  a.check_kinds(drawn.kinds);
  look.curvature = drawn.curvature.get();
  Progress& progress = console.progress();
  // Lines alone do not have the colours of the list.
  const bool listed = drawn.legend.size() > 1 && !a.objects.no_legend && look.lines != RenderOptions::Lines::only;
  const int beside = listed ? legend_width(look.height, drawn.legend) : 0;
  if (beside > 0 && look.width < beside + kLeastBesideLegend)
    throw ArgumentError(fmt::format("--width {} is too narrow: the legend takes {} of it; --no-legend leaves it out",
                                    look.width, beside));
  look.width -= beside;
  std::vector<std::string> files;
  Image written;
  const std::vector<ViewDirection> views = turntable(look.view, std::max(1, a.frames));
  for (std::size_t k = 0; k < views.size(); ++k) {
    look.view = views[k];
    Image image = render_surfaces(drawn.surfaces, drawn.places, a.objects.translucent(), a.frames > 0, look, progress);
    const Image paper = paper_beside(look);
    if (listed) image = beside_legend(image, drawn.legend, &paper);
    files.push_back(a.frames > 0 ? frame_name(a.output, k) : a.output);
    if (files.size() > 1) console.keep_frames();
    progress.begin("write");
    written = a.picture.write(files.back(), image, look);
  }
  progress.finish();
  console.say(fmt::format("{}: {}, {} × {} pixels", files.size() == 1 ? files[0] : a.output,
                          counted(drawn.legend.size(), "object"), written.width, written.height));
  console.say_json(
      {{"objects", drawn.json}, {"output", {{"files", files}, {"width", written.width}, {"height", written.height}}}});
  console.print_timings();
}

}  // namespace sansmesh::cli
