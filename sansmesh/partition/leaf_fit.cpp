#include "sansmesh/partition/leaf_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/partition/crease_fit.h"
#include "sansmesh/partition/global_sign.h"

namespace sansmesh {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();
constexpr float kSecondSheet = 0.2f;  ///< share of the samples in a block that must lie on another sheet
constexpr float kChamfer = 0.02f;     ///< mean gap along a crease, in units of the block's edge
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

/// A triangle of edge e on a surface of curvature κ leaves κ e²/8; a plane fitted to a disc of radius R leaves an rms
/// of 0.097 κ R² under the weights (1 − t²)², and the noise. Only half of the noise is taken off: its estimate is not
/// so sure that what is left of a plane residual that is mostly noise could be trusted to be flat. h: edge of the
/// block.
float gap_of(const Trial& t, float noise, float radius, float h) {
  if (t.plane() < 0) return kInfinite;
  const float bent = std::sqrt(std::max(0.0f, t.plane() - 0.5f * noise));
  return bent / (0.097f * radius * radius) * h * h / 32;
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

LeafRef ref_of(const PartitionData& data, std::size_t support) {
  return {&data.functions[support], &data.supports[support], data.functions.data(), nullptr};
}

LeafRef ref_of(const FittedLeaf& leaf) { return {&leaf.function, &leaf.support, nullptr, &leaf.more}; }

void append_pieces(std::size_t support, std::span<const LocalFunction> pieces, std::vector<LocalFunction>& functions) {
  std::size_t tail = support;
  for (const LocalFunction& piece : pieces) {
    if (functions.size() >= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
      throw DataError("partition of unity: more local functions than can be counted");
    functions.push_back(piece);
    functions.back().next = 0;
    functions[tail].next = static_cast<std::int32_t>(functions.size());
    tail = functions.size() - 1;
  }
}

void sum_up(PartitionData& data) {
  PartitionReport& report = data.report;
  report.functions = data.supports.size();
  report.depth = 0;
  report.creased = 0;
  report.area = 0;
  report.functions_of_degree = {};
  for (std::size_t i = 0; i < data.supports.size(); ++i) {
    report.depth = std::max<int>(report.depth, data.supports[i].level);
    report.creased += data.supports[i].creased;
    ++report.functions_of_degree[static_cast<std::size_t>(data.functions[i].degree)];
    // Summed as the far field does it, in the precision of its patches.
    report.area += norm(data.functions[i].nu * data.supports[i].area);
  }
}

void assemble(std::span<const LeafRef> leaves, PartitionData& data) {
  const std::size_t n = leaves.size();
  std::vector<LocalFunction> functions(n);
  std::vector<Support> supports(n);
  parallel_for(0, n, 4096, [&](std::size_t i) {
    functions[i] = *leaves[i].function;
    functions[i].next = 0;
    supports[i] = *leaves[i].support;
  });
  std::vector<LocalFunction> pieces;
  for (std::size_t i = 0; i < n; ++i) {
    const LeafRef& leaf = leaves[i];
    pieces.clear();
    for (std::int32_t next = leaf.function->next; !leaf.more && next != 0; next = leaf.chain[next - 1].next)
      pieces.push_back(leaf.chain[next - 1]);
    append_pieces(i, leaf.more ? std::span<const LocalFunction>(*leaf.more) : pieces, functions);
  }
  data.functions = std::move(functions);
  data.supports = std::move(supports);
  data.find_slopes();
  sum_up(data);
}

float flatness_gap(const BlockFitter& fitter, const ScaleChoice& choice, int level, std::uint32_t cell) {
  const Trial& t = choice.trials[static_cast<std::size_t>(level)][cell];
  if (t.dropped > kSecondSheet) return kInfinite;
  // Samples that face away are a second sheet, or a surface that bends by more than a right angle.
  const float noise = t.noise >= 0 ? t.noise : static_cast<float>(choice.variance);
  const float radius = fitter.support_radius(level);
  return gap_of(t, noise, t.reach * radius, fitter.block_edge(level)) + 0.2f * t.dropped * radius;
}

void mark_crease(const std::vector<std::vector<std::uint64_t>>& code, std::vector<std::vector<float>>& gap, float edge,
                 int level, std::uint64_t block) {
  for (int l = 0; l < static_cast<int>(code.size()); ++l) {
    const auto& codes = code[static_cast<std::size_t>(l)];
    auto& gaps = gap[static_cast<std::size_t>(l)];
    const std::uint64_t low = l <= level ? block >> (3 * (level - l)) : block << (3 * (l - level));
    const std::uint64_t high = l <= level ? low : low + (std::uint64_t{1} << (3 * (l - level))) - 1;
    for (auto it = std::lower_bound(codes.begin(), codes.end(), low); it != codes.end() && *it <= high; ++it) {
      float& g = gaps[static_cast<std::size_t>(it - codes.begin())];
      g = std::max(g, kChamfer * edge / static_cast<float>(1u << l));
    }
  }
}

}  // namespace sansmesh
