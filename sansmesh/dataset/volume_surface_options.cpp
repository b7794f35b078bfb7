#include <cmath>

#include "sansmesh/core/check_range.h"
#include "sansmesh/error.h"
#include "sansmesh/surface/layer_projection.h"
#include "sansmesh/volume_options.h"

namespace sansmesh::inline v1 {
namespace {

/// The kind as a flag.
struct HighGradient {
  using Kind = VolumeSurfaceOptions::Kind;
  static constexpr auto kind = OptionKind::flag;
  static OptionValue get(Kind v) { return v == Kind::high_gradient; }
  static Kind from(const OptionValue& v) { return std::get<bool>(v) ? Kind::high_gradient : Kind::isovalue; }
};

}  // namespace

const OptionSchema& VolumeSurfaceOptions::schema() {
  using O = VolumeSurfaceOptions;
  static constexpr OptionRow rows[] = {
      option<&O::kind, HighGradient>(
          {.text = "Borders of materials, where the gradient is largest, at any value", .name = "high_gradient"}),
      option<&O::beta>({.text = "Width of the weights: of values in their unit, of gradients as a share, 0.01 to 1",
                        .from_data = "by the slope at each sample; 0.35"}),
      option<&O::smoothing>({.text = "h of the weights by distance, in spacings",
                             .from_data = "2, more with noise",
                             .range = {.least = 0.5, .most = 20}}),
      option<&O::least_gradient>({.text = "Of a border, with `high_gradient`",
                                  .from_data = "from the noise",
                                  .range = positive(),
                                  .needs = "high_gradient"}),
      option<&O::local_maximum>(
          {.text = "With `high_gradient`: gradients relative to the largest of the volume, not of the neighbourhood",
           .negative = "global_maximum"}),
      option<&O::corrector>({.text = "Fast: omit the corrector's weights by distance", .negative = "predictor_only"}),
      option<&O::predictor>({.text = "Omit the predictor", .negative = "corrector_only"}),
      option<&O::alternating>({.text = "Predictor: optimise direction and offset in turn, as in the source"}),
      option<&O::line_search>({.text = "Corrector: offset by minimisation along the normal"}),
      option<&O::separate_sheets>({.text = "Use samples of all orientations", .negative = "all_sheets"}),
      option<&O::exact_projection>(
          {.text = "Pictures and meshes project at every point instead of using paraboloids at the feet of samples",
           .old_name = "exact"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void VolumeSurfaceOptions::validate() const {
  validate_options(*this);
  check_argument(predictor || corrector, "`predictor = false` and `corrector = false` exclude each other");
  check_argument(kind == Kind::high_gradient || local_maximum, "`local_maximum = false` needs `high_gradient`");
  if (kind == Kind::isovalue) {
    if (!std::isfinite(value)) throw ArgumentError("`value` must be finite");
    if (beta && !(std::isfinite(*beta) && *beta > 0)) throw ArgumentError("`beta` must be positive");
  } else {
    if (beta) check_range("beta", *beta, 0.01, 1);
  }
  LayerOptions layer;
  layer.smoothing = smoothing.value_or(layer.smoothing), layer.predictor = predictor, layer.corrector = corrector;
  layer.validate();
}

namespace {

constexpr ReportRow kVolumeSurfaceReportRows[] = {
    reported<&VolumeSurfaceReport::samples>({.text = "Samples with a weight"}),
    reported<&VolumeSurfaceReport::spacing>({.text = "Median spacing of these samples", .unit = "length"}),
    reported<&VolumeSurfaceReport::smoothing>({.text = "Width of the weights", .unit = "spacings"}),
    reported<&VolumeSurfaceReport::slope>(
        {.text = "Median slope of the quantity at the surface", .unit = "per length"}),
    reported<&VolumeSurfaceReport::noise>({.text = "Noise of the values", .unit = "unit of the array"}),
    reported<&VolumeSurfaceReport::smoothed>(
        {.text =
             "Share of values without this noise (volume smooth) in those of the surface; 0: the samples as they are"}),
    reported<&VolumeSurfaceReport::beta>({.text = "β of the weights, if it is the same everywhere"}),
    reported<&VolumeSurfaceReport::least_gradient>(
        {.text = "Smallest gradient of a border, for high gradients", .unit = "per length"})};

}  // namespace

const ReportSchema& VolumeSurfaceReport::schema() {
  static constexpr ReportSchema schema{kVolumeSurfaceReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
