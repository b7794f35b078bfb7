#include "sansmesh/partition/fit/leaf_fit.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "sansmesh/partition/far/global_sign.h"
#include "sansmesh/partition/fit/crease_fit.h"

namespace sansmesh::inline v1 {
namespace {

/// Radii of wider balls for noisy samples: about two and four times the area.
constexpr float kWider[] = {1.41f, 2.0f};
/// Residual over the radius of the ball from which a support is not wider.
constexpr float kInexact = 0.02f;
/// Share of the noise that is subtracted from the additional residual of a wider fit: the estimate of the noise also
/// contains shape that no fit followed.
constexpr double kForgiven = 0.5;
constexpr float kSameWay = 0.8f;       ///< cosine between the frames of a fit and a wider one
constexpr double kSteadier = 0.98;     ///< factor of risk that a wider fit must achieve
constexpr float kAnotherSheet = 0.2f;  ///< share of the weight in a support of samples that face away
/// Largest mean square of a creased fit over that of a smooth one, and of creases below 30°, such as the edges of the
/// facets of a round part.
constexpr double kCreaseGain = 0.25, kFlatCreaseGain = 0.1;
constexpr float kFlatCreaseCosine = 0.866f;
/// Normals within 5° of one direction belong to no crease.
constexpr float kAlikeCosine = 0.9962f;

/// Residual below which a smooth function needs no pieces, and normals that need none.
bool needs_no_pieces(const BlockFitter& fitter, const ScaleChoice& choice, double square, float least_cosine) {
  return !fitter.options.sharp || least_cosine > kAlikeCosine ||
         square <= std::max(2.0 * choice.variance, choice.accepted * choice.accepted);
}

/// Pieces of a support with a crease; none if there is no crease, or if it does not explain the samples better than all
/// smooth functions, including those that fail the robustness tests. `smooth`: mean square of the chosen smooth
/// function; replaced by that of the crease, if found.
std::vector<LocalFunction> fit_pieces(const BlockFitter& fitter, const ScaleChoice& choice, const LocalFunction& f,
                                      double& smooth, FitWorkspace& ws) {
  if (needs_no_pieces(fitter, choice, smooth, ws.block.view.least_cosine)) return {};
  const DegreeFits bendiest = fit_all_degrees(ws.block.samples, fitter.options.max_degree);
  const double best = bendiest.mean_square[static_cast<std::size_t>(bendiest.highest)] * f.scale * f.scale;
  const std::size_t inner = ball_samples(fitter.tree, f, ws.block.ball.ids(), ws.position, ws.normal, ws.weight);
  CreaseFit crease = fit_crease(ws.position, ws.normal, ws.weight, inner, f.center, f.scale, fitter.options.max_degree);
  if (crease.pieces.empty()) return {};
  // Two planes also explain a bend better than one.
  const double flat_gain = fitter.options.max_degree > 1 ? kFlatCreaseGain : 0;
  const double gain = least_cosine(crease.pieces) > kFlatCreaseCosine ? flat_gain : kCreaseGain;
  if (crease.mean_square >= gain * best) return {};
  smooth = crease.mean_square;
  return std::move(crease.pieces);
}

/// Widens the ball of a fit if its residual stays within the noise, to average over more samples. The bias of the wider
/// fit is measured where the fit has weight: the increase of the weighted squares of the narrow ball's samples, in the
/// workspace, beyond that of noise by the difference of freedom. Replaces f, and returns its mean square.
double widen_fit(const BlockFitter& fitter, const Leaf& leaf, double noise, double count, double square,
                 FitWorkspace& ws, LocalFunction& f) {
  std::swap(ws.narrow, ws.block.samples);
  const LocalFunction narrow = f;
  const double own = square, freedom = kFreedom[static_cast<std::size_t>(narrow.degree)] / count;
  double risk = noise * freedom;
  for (std::size_t k = 0; k < std::size(kWider) && static_cast<int>(k) < leaf.level; ++k) {
    const float scale = kWider[k] * narrow.scale;
    const std::size_t up = k + 1;
    gather(fitter.tree, leaf.level - static_cast<int>(up), ws.walk.above(up), narrow.center, kShift * scale,
           ws.block.ball);
    LocalFunction wide;
    const DegreeFits fits = fit_local(scale, fitter.options.max_degree, ws.block, wide);
    if (dot(wide.nu, narrow.nu) < kSameWay) break;
    const int highest = highest_degree(fitter.options, fits, ws.block.view);
    bool better = false;
    for (int d = 1; d <= highest; ++d) {
      const auto degree = static_cast<std::size_t>(d);
      const double taken = kFreedom[degree] / fits.effective_count;
      if (noise * taken >= kSteadier * risk) break;  // higher degrees take more
      wide.degree = d;
      wide.coefficient = monomial_coefficients(fits, d);
      const double bias = mean_square_of(ws.narrow, narrow, wide) - own - kForgiven * noise * (freedom - taken);
      const double expected = std::max(bias, 0.0) + noise * taken;
      if (expected >= kSteadier * risk) continue;
      risk = expected, f = wide, better = true;
      square = fits.mean_square[degree] * scale * scale;
    }
    if (!better) break;
  }
  return square;
}

/// Whether the ball of a support contains another sheet, such as the back of a thin wall, whose supports would conflict
/// with it.
bool faces_another_sheet(const BlockFitter& fitter, const Leaf& leaf, const LocalFunction& f, FitWorkspace& ws) {
  if (leaf.level == 0) return false;
  gather(fitter.tree, leaf.level - 1, ws.walk.parents(), f.center, f.radius, ws.block.ball);
  const BallView view = weigh_ball(ws.block.ball, f.radius, f.nu);
  return view.away > kAnotherSheet * (view.kept + view.away);
}

/// Fits the function of a block again, with its creases. Returns its mean square.
double fit_again(const BlockFitter& fitter, const ScaleChoice& choice, const Leaf& leaf, FitWorkspace& ws,
                 FittedLeaf& result) {
  const Trial& t = choice.trials[static_cast<std::size_t>(leaf.level)][leaf.cell];
  const Vec3f c = fitter.center(leaf.level, leaf.cell);
  const float radius = fitter.fit_radius(leaf.level);
  ws.walk.go(leaf.level, leaf.cell);
  if (t.reach == 1) {
    gather(fitter.tree, leaf.level, ws.walk.own(), c, kShift * radius, ws.block.ball, t.stride);
  } else {
    gather(fitter.tree, leaf.level - 1, ws.walk.parents(), c, kShift * t.reach * radius, ws.block.ball);
  }
  LocalFunction& f = result.function;
  const DegreeFits fits = fit_local(t.reach * radius, t.degree, ws.block, f);
  f.degree = t.degree;
  f.coefficient = monomial_coefficients(fits, t.degree);
  Support& support = result.support;
  support.coverage = static_cast<float>(coverage(ws.block.view));
  support.samples = static_cast<std::uint32_t>(ws.block.samples.size());
  double square = fits.mean_square[t.degree] * f.scale * f.scale;
  std::vector<LocalFunction> pieces = fit_pieces(fitter, choice, f, square, ws);
  if (!pieces.empty()) {
    f = pieces[0];
    support.creased = 1;
    result.more.assign(pieces.begin() + 1, pieces.end());
  } else if (noisiness(choice) > 0 && t.reach == 1 && t.stride == 1) {
    const double noise = t.noise >= 0 ? t.noise : choice.variance;
    square = widen_fit(fitter, leaf, noise, fits.effective_count, square, ws, f);
  }
  return square;
}

/// Takes the function of the trial if fit_again would find the same. Returns its mean square, or -1.
double take_kept(const BlockFitter& fitter, const ScaleChoice& choice, const Leaf& leaf, FittedLeaf& result) {
  if (leaf.level != choice.kept_level || noisiness(choice) > 0) return -1;
  const Trial& t = choice.trials[static_cast<std::size_t>(leaf.level)][leaf.cell];
  const KeptFit& kept = choice.kept[leaf.cell];
  if (kept.samples == 0 || t.degree != t.highest) return -1;
  LocalFunction& f = result.function;
  f.scale = t.reach * fitter.fit_radius(leaf.level);
  const double square = kept.mean_square * f.scale * f.scale;
  if (!needs_no_pieces(fitter, choice, square, kept.least_cosine)) return -1;
  f.center = fitter.center(leaf.level, leaf.cell);
  f.degree = t.degree;
  f.coefficient = kept.coefficient;
  set_normal(f, kept.nu);
  result.support.coverage = kept.coverage;
  result.support.samples = kept.samples;
  return square;
}

}  // namespace

void set_surface_patch(const LocalFunction& f, const Vec3f& lower, float edge, Support& support) {
  support.foot = f.center + f.nu * (f.coefficient[0] * f.scale);
  support.area = f.is_constant() ? 0 : plane_area_in_cube(support.foot, f.nu, lower, edge);
}

FittedLeaf fit_leaf(const BlockFitter& fitter, const ScaleChoice& choice, const Leaf& leaf, FitWorkspace& ws) {
  FittedLeaf result;
  double square = take_kept(fitter, choice, leaf, result);
  if (square < 0) square = fit_again(fitter, choice, leaf, ws, result);
  LocalFunction& f = result.function;
  Support& support = result.support;
  const float radius = fitter.fit_radius(leaf.level);
  f.radius = fitter.support_radius(leaf.level);
  const float off = static_cast<float>(std::sqrt(square)) / radius;
  if (!fitter.options.support) f.radius *= 1 + kExactReach * std::clamp(1 - off / kInexact, 0.0f, 1.0f);
  if (noisiness(choice) > 0 && faces_another_sheet(fitter, leaf, f, ws)) f.radius = radius;
  support.error = static_cast<float>(std::sqrt(square));
  support.code = fitter.tree.level(leaf.level).code[leaf.cell];
  support.level = static_cast<std::uint8_t>(leaf.level);
  const float h = fitter.block_edge(leaf.level);
  set_surface_patch(f, fitter.center(leaf.level, leaf.cell) - Vec3f{h, h, h} * 0.5f, h, support);
  return result;
}

}  // namespace sansmesh::inline v1
