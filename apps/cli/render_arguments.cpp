// sansmesh render: what its options say together. None is accepted that the picture would not heed.
#include <fmt/core.h>

#include <algorithm>
#include <initializer_list>
#include <utility>

#include "command_line.h"
#include "render.h"
#include "sansmesh/core/error.h"
#include "sansmesh/points/outliers.h"
#include "sansmesh/render/color_words.h"

namespace sansmesh::cli {
namespace {

struct GivenOption {
  const char* flag;
  bool given;
};

/// Throws ArgumentError naming the first that was given.
void refuse(std::initializer_list<GivenOption> options, const char* why) {
  for (const GivenOption& o : options)
    if (o.given) throw ArgumentError(fmt::format("{} {}", o.flag, why));
}

SurfaceRenderOptions chosen_look(const RenderArguments& a) {
  SurfaceRenderOptions o = a.options;
  static_cast<RenderOptions&>(o) = a.picture.chosen();
  set_background(o, a.background);
  return o;
}

/// Of lines alone nothing has light or colour but the lines.
void check_lines_alone(const RenderArguments& a) {
  if (a.options.lines != RenderOptions::Lines::only) return;
  refuse({{"--color", !a.objects.colors.empty()},
          {"--color-by", !a.color_by.empty()},
          {"--name", !a.objects.names.empty()},
          {"--wireframe", a.options.wireframe != RenderOptions::Wireframe::none},
          {"--reflection", a.options.reflection != 0},
          {"--transmission", a.options.transmission != 0},
          {"--exact-shadows", a.options.exact_shadows}},
         "is for surfaces that are seen, which --lines alone does not show: --lines=over");
}

void check_surface_options(const RenderArguments& a, bool function) {
  const SurfaceRenderOptions& s = a.options;
  require(!s.plain || !s.accessibility, "--plain casts no rays around places, as --accessibility does");
  if (s.plain)
    refuse({{"--antialiasing", s.samples != RenderOptions().samples && s.samples != 1},
            {"--exact-shadows", s.exact_shadows}},
           "does not go with --plain, which has one ray per pixel and no shadows");
  require(!function || !a.surface, "--surface is for samples: the surface of a function file is the function");
  require(!function || !a.cloud.remove_outliers, "--remove-outliers is for samples: the input is a function");
  require(!a.surface || !a.objects.translucent(), "--opacity is for meshes, points and functions: not with --surface");
  if (a.splats)
    refuse({{"--opacity", a.objects.translucent()},
            {"--reflection", s.reflection != 0},
            {"--transmission", s.transmission != 0},
            {"--exact-shadows", s.exact_shadows}},
           "means nothing to --splats");
  require(!a.stored_rays || (a.surface && !a.splats && surface_method(a.surface->method).projects),
          "--rays needs --surface levin, alexa or curvature, and no --splats");
  if (a.surface || a.splats || function) {
    refuse({{"--flat", !s.smooth},
            {"--point-radius", s.point_radius.has_value()},
            {"--wireframe", s.wireframe != RenderOptions::Wireframe::none}},
           "is for meshes and points, not for surfaces without a mesh");
  } else {
    refuse({{"--plain", s.plain},
            {"--exact-shadows", s.exact_shadows},
            {"--reflection", s.reflection != 0},
            {"--transmission", s.transmission != 0},
            {"--refraction-index", s.refraction_index != SurfaceRenderOptions().refraction_index}},
           "is for one surface without a mesh: it needs --surface NAME");
  }
}

void check_colors(const RenderArguments& a, bool meshless) {
  // Of meshes and points it is the name of an attribute as well.
  const bool by_confidence = a.color_by == kConfidence, by_curvature = meshless && is_curvature(a.color_by);
  require(!a.color_range || by_curvature, "--color-range is for curvatures");
  require(!a.value_range || (!a.color_by.empty() && !by_confidence && !by_curvature),
          "--value-range is for attributes: --color-by NAME");
  require(a.unit.empty() || (!a.color_by.empty() && !by_confidence && !a.no_bar),
          "--unit stands at the colour bar of --color-by");
  require(!a.value_range || (a.value_range->first < a.value_range->second), "--value-range must be LOW,HIGH");
  if (a.color_by.empty()) return;
  require(a.objects_drawn() == 1, "--color-by is for one object: --as-one makes one of several files");
  require(!a.objects.translucent(), "--color-by does not go with --opacity");
  require(!a.separate, "--color-by with --frames needs --surface NAME");
  require(a.objects.colors.empty(), "--color and --color-by exclude each other");
  if (meshless && !by_confidence && !by_curvature)
    throw ArgumentError(
        fmt::format("--color-by of a surface without a mesh must be mean, gaussian, k1, k2 or confidence, not {}",
                    printable(a.color_by, 40)));
}

/// What a picture of several objects, or of translucent ones, does not show.
void check_separate(const RenderArguments& a) {
  if (a.objects.translucent())
    refuse({{"--lines", a.options.lines != RenderOptions::Lines::none},
            {"--accessibility", a.options.accessibility.has_value()},
            {"--plain", a.options.plain},
            {"--exact-shadows", a.options.exact_shadows}},
           "is for what is opaque: it does not go with --opacity below 1");
  if (a.objects_drawn() == 1)
    refuse({{"--name", !a.objects.names.empty()}}, "is for the list of several objects: there is one");
  else  // each would have a curvature of its own
    refuse({{"--line-strength", a.options.line_strength != RenderOptions().line_strength},
            {"--bend-light", a.options.bend_light != RenderOptions().bend_light && a.options.bend_light != 0}},
           "is about curvature, which pictures of several objects do not show: draw one");
}

}  // namespace

void RenderArguments::complete() {
  options = chosen_look(*this);
  surface = of_samples.chosen();
  const bool function = input.is_function();
  objects.check(objects_drawn());
  check_surface_options(*this, function);
  check_lines_alone(*this);
  const bool meshless = surface || splats || function;
  of_lines =
      !surface && !splats && input.files.size() == 1 && color_by.empty() && lines_of_file(input.files[0]).size() > 0;
  separate =
      !surface && !splats && (objects_drawn() > 1 || objects.translucent() || (frames > 0 && !function) || of_lines);
  check_colors(*this, meshless);
  check_separate(*this);
  if (splats && options.plain) {
    options.shadows = options.ground = false;
    options.occlusion_rays = 0;
    options.samples = 1;
  }
  if (separate || objects.colors.empty()) return;
  if (const auto color = color_of_word(objects.colors[0])) options.surface_color = *color, options.use_colors = false;
}

void RenderArguments::check_kinds(const std::vector<ObjectKind>& kinds) const {
  const auto none = [&](std::initializer_list<ObjectKind> those) {
    return std::none_of(kinds.begin(), kinds.end(),
                        [&](ObjectKind k) { return std::find(those.begin(), those.end(), k) != those.end(); });
  };
  if (none({ObjectKind::mesh, ObjectKind::lines}))
    refuse({{"--flat", !options.smooth}, {"--wireframe", options.wireframe != RenderOptions::Wireframe::none}},
           "is for meshes: there are no triangles");
  if (none({ObjectKind::points}))
    refuse({{"--point-radius", options.point_radius.has_value()}, {"--remove-outliers", cloud.remove_outliers}},
           "is for points: there are none but vertices of triangles");
}

void leave_out_outliers(PointSet& points, const std::string& name, Console& console) {
  Progress& progress = console.progress();
  progress.begin("find outliers");
  const std::vector<std::uint8_t> outliers = find_outliers(points, {}, progress);
  const auto count = static_cast<std::size_t>(std::count(outliers.begin(), outliers.end(), std::uint8_t{1}));
  if (count == 0) return;
  if (count == points.size()) throw FileError(name, "--remove-outliers leaves no samples");
  remove_samples(points, outliers);
  console.warn(name, {counted(count, "sample") + " left out: belong to no surface"});
}

}  // namespace sansmesh::cli
