#include "sansmesh/jobs/compare_picture.h"
#include "sansmesh/image.h"
#include "sansmesh/inspect.h"
#include "sansmesh/measure/distance_map.h"
#include "sansmesh/partition/paper_options.h"

#include <fmt/core.h>

#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/jobs/color_bar.h"
#include "sansmesh/render/mesh_picture.h"
#include "sansmesh/render/picture_notes.h"

namespace sansmesh::inline v1 {
namespace {

constexpr const char* kDistanceTitle = "distance";
constexpr int kScaleSteps = 16;

/// The colours of a map as a scale: those of distance_color from −range, or 0, to range.
TransferFunction scale_of(double range, bool both_sides) {
  TransferFunction scale;
  for (int k = both_sides ? -kScaleSteps : 0; k <= kScaleSteps; ++k) {
    const double value = range * k / kScaleSteps;
    const auto [r, g, b] = distance_color(static_cast<float>(value), range);
    scale.colors.push_back({value, {from_byte(r), from_byte(g), from_byte(b)}});
  }
  scale.opacities = {{scale.colors.front().value, 1}, {scale.colors.back().value, 1}};
  return scale;
}

}  // namespace

void check_map_picture(const RenderOptions& look, const std::string& unit) {
  look.validate();
  const int scale = value_bar_width(look.height, scale_of(kWidestNumbers, true), with_unit(kDistanceTitle, unit));
  check_room_beside(look, scale, "scale");
}

MapPicture draw_map(const CompareResult& compared, const CompareOptions& options, const RenderOptions& look,
                    const std::string& unit, Progress& progress) {
  check_map_picture(look, unit);
  const DistanceMap& map = compared.map;
  const DistanceStatistics& s = map.statistics;
  const TransferFunction scale = scale_of(s.range, map.has_sides);
  const std::string title = with_unit(kDistanceTitle, unit);
  MapPicture made{.image = {}, .look = look};
  made.look.background = RenderOptions::Background::solid;
  made.look.background_color = {0.93f, 0.94f, 0.95f};
  made.look.shadows = made.look.ground = false;
  made.look.width -= value_bar_width(look.height, scale, title);
  std::vector<double> marks;
  if (const auto& most = options.map.tolerance) marks = {-*most, *most};
  const Image paper = paper_beside(made.look);
  made.image = beside_value_bar(render_mesh(compared.mesh, made.look, progress), scale, title, marks, &paper,
                                {map.has_sides && (s.lowest < -s.range), (s.highest > s.range)});
  return made;
}

}  // namespace sansmesh::inline v1
