#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/partition/block_fit.h"
#include "sansmesh/partition/crease_fit.h"
#include "sansmesh/partition/partition_state.h"
#include "sansmesh/partition/scale_choice.h"

namespace sansmesh {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();
constexpr float kSecondSheet = 0.2f;  ///< share of the samples in a block that must lie on another sheet
constexpr float kChamfer = 0.02f;     ///< mean gap along a crease, in units of the block's edge
constexpr double kCreaseGain = 0.25;  ///< share of a smooth fit's mean square that a creased one must stay below

/// A block with a crease, and all above and below it, are as flat as a chamfer of its lattice would be.
void mark_crease(PartitionOfUnity::State& state, int level, std::uint64_t code) {
  for (int l = 0; l < static_cast<int>(state.flatness.size()); ++l) {
    auto& f = state.flatness[static_cast<std::size_t>(l)];
    const std::uint64_t low = l <= level ? code >> (3 * (level - l)) : code << (3 * (l - level));
    const std::uint64_t high = l <= level ? low : low + (std::uint64_t{1} << (3 * (l - level))) - 1;
    for (auto it = std::lower_bound(f.code.begin(), f.code.end(), low); it != f.code.end() && *it <= high; ++it) {
      float& gap = f.gap[static_cast<std::size_t>(it - f.code.begin())];
      gap = std::max(gap, kChamfer * state.edge / static_cast<float>(1u << l));
    }
  }
}

using State = PartitionOfUnity::State;

/// Mean gap between the surface and linear triangles of half a block's edge h. A triangle of edge e on a surface of
/// curvature κ leaves κ e²/8; a plane fitted to a disc of radius R leaves an rms of 0.097 κ R² under the weights
/// (1 − t²)², and the noise. Only half of the noise is taken off: its estimate is not so sure that what is left of a
/// plane residual that is mostly noise could be trusted to be flat.
float gap_of(const Trial& t, float noise, float radius, float h) {
  if (t.plane < 0) return kInfinite;
  const float bent = std::sqrt(std::max(0.0f, t.plane - 0.5f * noise));
  return bent / (0.097f * radius * radius) * h * h / 32;
}

struct FitWorkspace {
  Workspace block;
  std::vector<Vec3f> position, normal;
  std::vector<float> weight;
};

/// The function of a leaf; of a creased one, its pieces (else none).
std::vector<LocalFunction> fit_leaf(const BlockFitter& fitter, const ScaleChoice& choice, const Leaf& leaf,
                                    LocalFunction& f, FitWorkspace& ws) {
  const SampleTree& tree = fitter.tree;
  const auto l = static_cast<std::size_t>(leaf.level);
  const Trial& t = choice.trials[l][leaf.cell];
  const Vec3f c = fitter.center(leaf.level, leaf.cell);
  const float radius = fitter.support_radius(leaf.level);
  if (t.reach == 1) {
    gather(tree, leaf.level, choice.neighbours[l][leaf.cell], c, kShift * radius, ws.block.ids, t.stride);
  } else {
    const SampleTree::Neighbours& parents = choice.neighbours[l - 1][choice.parent[l][leaf.cell]];
    gather(tree, leaf.level - 1, parents, c, kShift * t.reach * radius, ws.block.ids);
  }
  const DegreeFits fits = fit_local(tree, c, t.reach * radius, t.degree, ws.block, f);
  f.radius = radius;
  f.degree = t.degree;
  f.coefficient = monomial_coefficients(fits, t.degree);
  if (!fitter.options.sharp) return {};

  double smooth = fits.mean_square[t.degree] * f.scale * f.scale;
  if (smooth <= std::max(2.0 * choice.variance, choice.accepted * choice.accepted)) return {};
  // A crease must explain the samples better than any smooth function, robust or not.
  const DegreeFits bendiest = fit_all_degrees(ws.block.samples, fitter.options.max_degree);
  smooth = bendiest.mean_square[static_cast<std::size_t>(bendiest.highest)] * f.scale * f.scale;
  ball_samples(tree, f, ws.block.ids, ws.position, ws.normal, ws.weight);
  CreaseFit crease = fit_crease(ws.position, ws.normal, ws.weight, f.center, f.scale, fitter.options.max_degree);
  if (crease.pieces.empty() || crease.mean_square >= kCreaseGain * smooth) return {};
  return std::move(crease.pieces);
}

/// Fits all leaves; returns which are creased. Their first piece takes the leaf's place, the others follow behind.
std::vector<std::uint8_t> fit_leaves(const BlockFitter& fitter, const ScaleChoice& choice, State& state,
                                     Progress& progress) {
  const std::size_t n = choice.leaves.size();
  progress.begin("final fits", n);
  state.functions.resize(n);
  std::vector<std::vector<LocalFunction>> pieces(n);
  parallel_ranges(0, n, 128, [&](std::size_t first, std::size_t last) {
    FitWorkspace ws;
    for (std::size_t i = first; i < last; ++i)
      pieces[i] = fit_leaf(fitter, choice, choice.leaves[i], state.functions[i], ws);
    progress.advance(last - first);
  });
  std::vector<std::uint8_t> creased(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    if (pieces[i].empty()) continue;
    creased[i] = 1;
    const float radius = state.functions[i].radius;
    state.functions[i] = pieces[i][0];
    state.functions[i].radius = radius;
    std::size_t tail = i;
    for (std::size_t k = 1; k < pieces[i].size(); ++k) {
      state.functions.push_back(pieces[i][k]);
      state.functions[tail].next = static_cast<std::int32_t>(state.functions.size());
      tail = state.functions.size() - 1;
    }
  }
  state.heads.resize(n);
  for (std::size_t i = 0; i < n; ++i) state.heads[i] = static_cast<std::uint32_t>(i);
  state.tree.build(state.functions, state.heads);
  return creased;
}

/// Each support's surface patch within its own block: together they tile the surface, and decide inside and outside
/// where no support reaches.
void find_patches(const BlockFitter& fitter, const std::vector<Leaf>& leaves, State& state) {
  std::vector<OrientedPatch> patches(leaves.size());
  state.foot.resize(leaves.size());
  parallel_for(0, leaves.size(), 512, [&](std::size_t i) {
    const LocalFunction& f = state.functions[i];
    const float h = fitter.block_edge(leaves[i].level);
    const Vec3f foot = f.center + f.nu * (f.coefficient[0] * f.scale);
    const Vec3f corner = fitter.center(leaves[i].level, leaves[i].cell) - Vec3f{h, h, h} * 0.5f;
    state.foot[i] = foot;
    patches[i] = {foot, f.nu * plane_area_in_cube(foot, f.nu, corner, h)};
  });
  state.sign = GlobalSign(patches, state.edge);
  for (const OrientedPatch& p : patches) state.report.area += norm(p.area);
}

/// What the polygoniser will ask: how flat is the surface at the scale of each block?
void record_flatness(const BlockFitter& fitter, const ScaleChoice& choice, const std::vector<std::uint8_t>& creased,
                     State& state) {
  state.flatness.resize(static_cast<std::size_t>(choice.finest) + 1);
  for (std::size_t l = 0; l < state.flatness.size(); ++l) {
    const int level = static_cast<int>(l);
    State::Flatness& flatness = state.flatness[l];
    flatness.code = fitter.tree.level(level).code;
    if (level < choice.finest) flatness.child = fitter.tree.level(level).child;
    flatness.gap.resize(choice.trials[l].size());
    const float h = fitter.block_edge(level);
    for (std::size_t c = 0; c < flatness.gap.size(); ++c) {
      const Trial& t = choice.trials[l][c];
      // Samples that face away are a second sheet, or a surface that bends by more than a right angle.
      const float noise = t.noise >= 0 ? t.noise : static_cast<float>(choice.variance);
      const float radius = fitter.support_radius(level), gap = gap_of(t, noise, t.reach * radius, h);
      flatness.gap[c] = t.dropped > kSecondSheet ? kInfinite : gap + 0.2f * t.dropped * radius;
    }
  }
  for (std::size_t i = 0; i < choice.leaves.size(); ++i)
    if (creased[i]) mark_crease(state, choice.leaves[i].level, choice.leaves[i].order);
}

void fill_report(const PointSet& points, const ScaleChoice& choice, const std::vector<std::uint8_t>& creased,
                 double diagonal, State& state) {
  PartitionReport& report = state.report;
  const std::size_t n = choice.leaves.size();
  report.noise = std::sqrt(choice.variance);
  report.error = choice.accepted;
  report.spacing = std::sqrt(report.area / static_cast<double>(points.size()));
  report.functions = n;
  double squares = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Leaf& leaf = choice.leaves[i];
    const Trial& t = choice.trials[static_cast<std::size_t>(leaf.level)][leaf.cell];
    squares += std::min<double>(t.risk, diagonal * diagonal);
    report.depth = std::max(report.depth, leaf.level);
    report.creased += creased[i];
    ++report.functions_of_degree[static_cast<std::size_t>(state.functions[i].degree)];
  }
  report.accuracy = std::sqrt(squares / static_cast<double>(n));
}

}  // namespace

void PartitionOptions::validate() const {
  const auto check = [](bool ok, const char* what) {
    if (!ok) throw ArgumentError(std::string("partition of unity: ") + what);
  };
  check(!max_depth || (*max_depth >= 2 && *max_depth <= 14), "max_depth must lie in 2..14");
  check(!error || *error > 0, "error must be positive");
  check(!support || (*support >= 1.1 && *support <= 2), "support must lie in 1.1..2");
  check(max_degree >= 1 && max_degree <= kMaxDegree, "max_degree must lie in 1..4");
  check(min_samples >= 3 && min_samples <= 1000, "min_samples must lie in 3..1000");
  check(max_samples >= 50, "max_samples must be at least 50");
}

PartitionOfUnity fit_partition_of_unity(const PointSet& points, const PartitionOptions& options, Progress& progress) {
  options.validate();
  if (points.size() < 4) throw DataError("partition of unity: at least 4 points are needed");
  if (points.normals.size() != points.size()) throw DataError("partition of unity: points need oriented normals");
  const Box3f box = bounds(points);
  const float extent = std::max({box.size().x, box.size().y, box.size().z});
  if (!(extent > 0)) throw DataError("partition of unity: all points coincide");

  auto state = std::make_unique<PartitionOfUnity::State>();
  state->origin = points.origin;
  state->edge = 1.1f * extent;
  state->lower = box.center() - Vec3f{1, 1, 1} * (0.5f * state->edge);

  progress.begin("sort samples");
  // Deep enough that the finest occupied cells hold about one sample even where the cloud is densest.
  const int sort_depth = std::clamp(options.max_depth.value_or(static_cast<int>(
                                        std::ceil(0.5 * std::log2(static_cast<double>(points.size())) + 1.5))),
                                    options.max_depth ? 2 : 3, 14);
  const SampleTree tree(points.positions, points.normals, state->lower, state->edge, sort_depth);

  const ScaleChoice choice = choose_scales(tree, options, box.diagonal(), progress);
  const BlockFitter fitter{tree, options, choice.support, choice.finest};
  const std::vector<std::uint8_t> creased = fit_leaves(fitter, choice, *state, progress);
  find_patches(fitter, choice.leaves, *state);
  record_flatness(fitter, choice, creased, *state);
  fill_report(points, choice, creased, box.diagonal(), *state);
  progress.finish();
  return PartitionOfUnity(std::move(state));
}

}  // namespace sansmesh
