#include "sansmesh/partition/leaf_fit.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/partition/crease_fit.h"
#include "sansmesh/partition/global_sign.h"

namespace sansmesh {
namespace {

constexpr double kCreaseGain = 0.25;  ///< share of a smooth fit's mean square that a creased one must stay below

/// The pieces of a support with a crease; none if there is no crease, or none that explains the samples better than any
/// smooth function does, robust or not. `smooth`: mean square of the smooth function chosen; of the crease, if found.
std::vector<LocalFunction> fit_pieces(const BlockFitter& fitter, const ScaleChoice& choice, const LocalFunction& f,
                                      double& smooth, FitWorkspace& ws) {
  if (!fitter.options.sharp || smooth <= std::max(2.0 * choice.variance, choice.accepted * choice.accepted)) return {};
  const DegreeFits bendiest = fit_all_degrees(ws.block.samples, fitter.options.max_degree);
  const double best = bendiest.mean_square[static_cast<std::size_t>(bendiest.highest)] * f.scale * f.scale;
  ball_samples(fitter.tree, f, ws.block.ids, ws.position, ws.normal, ws.weight);
  CreaseFit crease = fit_crease(ws.position, ws.normal, ws.weight, f.center, f.scale, fitter.options.max_degree);
  if (crease.pieces.empty() || crease.mean_square >= kCreaseGain * best) return {};
  smooth = crease.mean_square;
  return std::move(crease.pieces);
}

}  // namespace

void place_patch(const LocalFunction& f, const Vec3f& lower, float edge, Support& support) {
  support.foot = f.center + f.nu * (f.coefficient[0] * f.scale);
  support.area = f.is_constant() ? 0 : plane_area_in_cube(support.foot, f.nu, lower, edge);
}

FittedLeaf fit_leaf(const BlockFitter& fitter, const ScaleChoice& choice, const Leaf& leaf, FitWorkspace& ws) {
  const SampleTree& tree = fitter.tree;
  const auto l = static_cast<std::size_t>(leaf.level);
  const Trial& t = choice.trials[l][leaf.cell];
  const Vec3f c = fitter.center(leaf.level, leaf.cell);
  const float radius = fitter.support_radius(leaf.level);
  ws.walk.go(leaf.level, leaf.cell);
  if (t.reach == 1) {
    gather(tree, leaf.level, ws.walk.own(), c, kShift * radius, ws.block.ids, t.stride);
  } else {
    gather(tree, leaf.level - 1, ws.walk.parents(), c, kShift * t.reach * radius, ws.block.ids);
  }
  FittedLeaf result;
  LocalFunction& f = result.function;
  const DegreeFits fits = fit_local(tree, c, t.reach * radius, t.degree, ws.block, f);
  f.degree = t.degree;
  f.coefficient = monomial_coefficients(fits, t.degree);
  Support& support = result.support;
  support.coverage = static_cast<float>(coverage(ws.block.samples));
  support.samples = static_cast<std::uint32_t>(ws.block.samples.size());
  double square = fits.mean_square[t.degree] * f.scale * f.scale;
  std::vector<LocalFunction> pieces = fit_pieces(fitter, choice, f, square, ws);
  if (!pieces.empty()) {
    f = pieces[0];
    support.creased = 1;
    result.more.assign(pieces.begin() + 1, pieces.end());
  }
  f.radius = radius;
  support.error = static_cast<float>(std::sqrt(square));
  support.code = tree.level(leaf.level).code[leaf.cell];
  support.level = static_cast<std::uint8_t>(leaf.level);
  const float h = fitter.block_edge(leaf.level);
  place_patch(f, c - Vec3f{h, h, h} * 0.5f, h, support);
  return result;
}

}  // namespace sansmesh
