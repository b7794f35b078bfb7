#include "sansmesh/image.h"
#include "sansmesh/inspect.h"
#include "sansmesh/measure/distance_map.h"
#include "sansmesh/pictures.h"

#include <algorithm>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/jobs/pictures/color_bar.h"
#include "sansmesh/points/statistics/spacing.h"
#include "sansmesh/render/annotate/picture_notes.h"
#include "sansmesh/render_options.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kScaleSteps = 16;
/// Radius of the medians of a cloud, in spacings of its closest points: 12 points of a random sampling. Noise hides
/// deviations that are narrower than itself.
constexpr double kMedianOverSpacing = 2, kMedianOverNoise = 2;

/// Scale of a map: distance_color from −range, or 0, to range.
ColorBar scale_of(double range, bool both_sides, const std::string& unit) {
  ColorBar bar{.colors = {}, .title = with_unit("distance", unit)};
  TransferFunction& scale = bar.colors;
  for (int k = both_sides ? -kScaleSteps : 0; k <= kScaleSteps; ++k) {
    const double value = range * k / kScaleSteps;
    const auto [r, g, b] = distance_color(static_cast<float>(value), range);
    scale.colors.push_back({value, {from_byte(r), from_byte(g), from_byte(b)}});
  }
  scale.opacities = {{scale.colors.front().value, 1}, {scale.colors.back().value, 1}};
  return bar;
}

double noise_of_mapped(const CompareReport& report) {
  const auto& points = report.on == MapSide::part ? report.part_points : report.reference_points;
  return points ? points->noise.deviation : 0;
}

/// The points with colours of local medians.
TriangleMesh with_medians(const TriangleMesh& points, const DistanceMap& map, double noise) {
  PointSet feet;
  feet.positions = map.feet;
  const double radius = std::max(kMedianOverSpacing * estimate_spacing(feet), kMedianOverNoise * noise);
  const std::vector<float> shown = local_medians(points, map, radius);
  TriangleMesh drawn = points;
  for (std::size_t i = 0; i < shown.size(); ++i) drawn.colors[i] = distance_color(shown[i], map.statistics.range);
  return drawn;
}

}  // namespace

void check_map_picture(const RenderOptions& picture, const std::string& unit) {
  picture.validate();
  check_room_beside(picture, scale_of(kWidestNumbers, true, unit), "scale");
}

MapPicture draw_map(const CompareResult& compared, const CompareOptions& options, const RenderOptions& picture,
                    const std::string& unit, Progress& progress) {
  check_map_picture(picture, unit);
  const DistanceMap& map = compared.map;
  const DistanceStatistics& s = map.statistics;
  ColorBar scale = scale_of(s.range, map.has_sides, unit);
  scale.ends = {map.has_sides && s.lowest<-s.range, s.highest> s.range};
  if (const auto& most = options.map.within) scale.marks = {-*most, *most};
  MapPicture made{.image = {}, .made_with = picture};
  made.made_with.look.background = Background::solid({0.93f, 0.94f, 0.95f});
  made.made_with.look.shadows = made.made_with.look.ground = false;
  reserve_width(made.made_with, scale);
  const bool cloud = compared.mesh.triangles.empty() && !map.feet.empty();
  const Image image =
      cloud ? render_mesh(with_medians(compared.mesh, map, noise_of_mapped(compared.report)), made.made_with, progress)
            : render_mesh(compared.mesh, made.made_with, progress);
  made.image = beside_bar(image, scale, made.made_with);
  return made;
}

}  // namespace sansmesh::inline v1
