#include "sansmesh/surface/layer_projection.h"

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/median.h"
#include "sansmesh/error.h"
#include "sansmesh/surface/candidates.h"
#include "sansmesh/surface/feet_of_groups.h"
#include "sansmesh/surface/layer_kernels.h"

namespace sansmesh::inline v1 {

struct LayerProjection::State {
  detail::LayerKernel kernel;
  detail::Candidates candidates;
  BallUnion balls;
  Box3 bounds;
};

void LayerOptions::validate() const {
  check_range("smoothing", smoothing, 0.5, 20);
  if (!predictor && !corrector) throw ArgumentError("`predictor` or `corrector` is needed");
}

LayerProjection::LayerProjection(const LayerSamples& samples, const LayerOptions& options) {
  options.validate();
  const auto state = std::make_shared<State>();
  SurfaceSamples s;
  s.positions = samples.positions, s.normals = samples.normals, s.spacing = samples.spacing;
  std::vector<float> sorted = samples.spacing;
  s.median_spacing = static_cast<double>(median(sorted));
  Box3f box;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const float r = samples.reach[i];
    if (!(r > 0)) continue;
    state->balls.centers.push_back(samples.positions[i]);
    state->balls.radii.push_back(r);
    box.extend(samples.positions[i] - Vec3f{r, r, r});
    box.extend(samples.positions[i] + Vec3f{r, r, r});
  }
  if (state->balls.centers.empty()) throw DataError("no sample is near the surface");
  state->bounds = {Vec3(box.lower), Vec3(box.upper)};
  const std::vector<float> widths = detail::weight_widths(s, options.smoothing, {});
  state->candidates = detail::Candidates(s, widths, SurfaceWeights::compact, 1);
  for (std::size_t i = 0; i < s.size(); ++i) {
    detail::Candidate& c = state->candidates.all()[i];
    const float r = samples.reach[i];
    c.weight = samples.weights[i];
    c.inverse_reach = r > 0 ? 1 / (r * r) : 1e30f;
  }
  state->kernel = {options.predictor, options.corrector, options.alternating, options.line_search,
                   options.separate_sheets};
  state_ = state;
}

Box3 LayerProjection::bounds() const { return state_->bounds; }
BallUnion LayerProjection::balls() const { return state_->balls; }

void LayerProjection::project(std::span<const Vec3> x, std::span<FootPoint> feet) const {
  detail::project_groups(state_->candidates, x, feet,
                         [&](const detail::PointGroup& group, std::span<const detail::Candidate> chosen, bool mixed,
                             detail::GroupFeet& out) {
                           detail::LayerKernel how = state_->kernel;
                           how.sheets = how.sheets && mixed;
                           detail::project_onto_layer(how, chosen, group, out);
                         });
}

}  // namespace sansmesh::inline v1
