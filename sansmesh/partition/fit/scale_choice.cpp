#include "sansmesh/partition/fit/scale_choice.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/partition/fit/child_density.h"
#include "sansmesh/partition/fit/level_noise.h"
#include "sansmesh/partition/fit/neighbour_walk.h"

namespace sansmesh::inline v1 {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();
/// Radii of supports in units of the blocks' circumscribed radius, for noise small and large against the spacing (in
/// spacings), and of the initial balls of samples of fits. Many overlapping supports average the noise; wide balls also
/// blur shape. docs/methods/partition-of-unity.md has the gain of each.
constexpr double kSupport = 1.5, kNoisySupport = 2.5, kNoisyFit = 1.8;
constexpr double kLittleNoise = 0.15, kMuchNoise = 0.6;
/// Noise is about the same everywhere; unresolved shape is not. The ratio of the standard deviation at the lowest tenth
/// of the cells to the median is 0.8 to 0.95 for noise, and 0 to 0.5 for terrain, depth frames and scans that are too
/// coarse for their shape.
constexpr double kShapeEvenness = 0.5, kNoiseEvenness = 0.8;
/// The cube is made for kLeastCompany on the finest level; counted again, the number differs a little.
constexpr double kCountedCompany = 0.75;
/// If so many cells of that level, in the mean of the samples, still hold a second sheet (walls as thin as the
/// spacing), another level is tried, as long as cells hold this mean number of samples: a cell with both sides of a
/// wall can follow only one.
constexpr double kThinCells = 0.25, kThinCompany = 2.5;
constexpr float kHoldsTwoSheets = 0.15f;
constexpr double kNoiseHeight = 5;  ///< half length of balls stretched along the normal, in standard deviations
/// The residual of planes is noise if the best degree leaves at least this part of it.
constexpr double kNoiseShare = 0.5;
/// A second sheet with all of the weight has the risk of a surface √0.1 = 0.3 radii off; with much noise, 0.1 radii
/// off, because small blocks along thin walls would follow the noise.
constexpr float kSecondSheetRisk = 0.1f, kNoisySecondSheetRisk = 0.01f;
/// A higher degree must have a slightly lower risk than a lower one, which oscillates less and is cheaper to evaluate;
/// a cut 10 % less, for about four times the functions (25 % changes next to nothing: benchmarks/README.md). With much
/// noise more: small balls cut it off, which underestimates their risk.
constexpr float kBetterDegree = 0.98f, kBetterCut = 0.9f, kBetterNoisyCut = 0.75f;
/// Accepted error by default: this part of the noise, which is the expected error of a quadratic fit to 400 samples;
/// and of the diagonal, a few dozen roundings of a float coordinate.
constexpr double kAcceptedNoise = 0.1, kAcceptedSize = 2e-6;

/// Number of samples around a block, over `max_samples`, above which its fit uses a part of them. A ball holds about
/// 0.6 of the samples of the 27 cells (1.3 edges in radius, a disc of 5.3 squares out of 9). Up to here a fit has at
/// most 2.4 times `max_samples`, which is still affordable, and no sample is wasted; beyond, between 0.6 and 0.75 times
/// as many.
constexpr std::size_t kThinFrom = 4;

/// Stride through the samples around a block that leaves enough for its fit: 1 takes all, 4 every fourth one …
std::size_t thinning(const BlockFitter& fitter, int level, const SampleTree::Neighbours& own) {
  std::size_t near = 0;
  const auto& begin = fitter.tree.level(level).begin;
  for (const std::int32_t n : own)
    if (n >= 0) near += begin[static_cast<std::size_t>(n) + 1] - begin[static_cast<std::size_t>(n)];
  const auto limit = static_cast<std::size_t>(fitter.options.max_samples);
  return near > kThinFrom * limit ? near / limit : 1;
}

/// A ball of radius 1 excludes samples that noise moves far off the surface: over all of the disc, offsets z have the
/// weight (1 − z²)³ ≈ exp(−3z²), so that noise of variance σ² appears as σ² / (1 + 6σ²). This inverts that, with a
/// divisor of at least 0.3: in a ball full of noise the residual is not informative. `stretch`: factor of the ball
/// along the normal.
float uncut(float mean_square, float stretch) {
  return mean_square / std::max(0.3f, 1 - 6 * mean_square / (stretch * stretch));
}

/// Records the residuals of fits of radius `scale`, up to a degree; `height` as in fit_local.
void record(const DegreeFits& fits, int most, float scale, float height, Trial& trial) {
  const float stretch = std::max(1.0f, height / scale);
  for (int d = 1; d <= std::min(most, fits.highest); ++d) {
    const auto k = static_cast<std::size_t>(d);
    trial.mean_square[k - 1] = uncut(static_cast<float>(fits.mean_square[k]), stretch) * scale * scale;
  }
}

/// Case (iii) of tejada2008, 4.4.3, subdivides blocks with too many samples. But if planes at half the scale leave no
/// more than noise, only more samples improve the fit.
bool only_noise(std::span<const Trial> children) {
  double plane = 0, best = 0;
  for (const Trial& t : children) {
    if (t.highest < 1) continue;
    plane += t.plane();
    best += t.residual(t.highest);
  }
  return best > 0 && kNoiseShare * plane < best;
}

Trial try_block(const BlockFitter& fitter, int level, std::uint32_t cell, NeighbourWalk& walk,
                std::span<const Trial> children, Workspace& ws, KeptFit* kept = nullptr) {
  Trial trial;
  walk.go(level, cell);
  const SampleTree::Neighbours& own = walk.own();
  const auto limit = static_cast<std::size_t>(fitter.options.max_samples);
  const bool any_number = only_noise(children);
  const std::size_t stride = any_number ? 1 : thinning(fitter, level, own);
  const Vec3f c = fitter.center(level, cell);
  LocalFunction f;
  if (stride > 1 && level < fitter.deepest) {
    // Case (iii): subdivided without a fit. A subset of the samples gives the flatness for the polygoniser.
    gather(fitter.tree, level, own, c, kShift * fitter.fit_radius(level), ws.ball, stride);
    const float scale = fitter.fit_radius(level);
    const DegreeFits fits = fit_local(scale, 1, ws, f, &trial.dropped, fitter.height);
    record(fits, 1, scale, fitter.height, trial);
    return trial;
  }
  trial.stride = static_cast<std::uint32_t>(stride);
  if (stride > 1) {
    gather(fitter.tree, level, own, c, kShift * fitter.fit_radius(level), ws.ball, stride);
  } else {
    trial.reach = gather_enough(fitter, level, cell, own, walk.parents(), ws.ball);
  }
  if (trial.reach == 0) return trial;
  const float scale = trial.reach * fitter.fit_radius(level);
  const DegreeFits fits = fit_local(scale, fitter.options.max_degree, ws, f, &trial.dropped, fitter.height);
  record(fits, 1, scale, fitter.height, trial);
  if (ws.samples.size() > limit && level < fitter.deepest && !any_number) return trial;
  trial.highest = static_cast<std::int8_t>(highest_degree(fitter.options, fits, ws.view));
  trial.effective_count = static_cast<float>(fits.effective_count);
  record(fits, trial.highest, scale, fitter.height, trial);
  if (kept && trial.highest > 0)
    *kept = {f.nu,
             monomial_coefficients(fits, trial.highest),
             fits.mean_square[static_cast<std::size_t>(trial.highest)],
             static_cast<float>(coverage(ws.view)),
             ws.view.least_cosine,
             static_cast<std::uint32_t>(ws.samples.size())};
  return trial;
}

/// Finest level to try: the last on which a sample typically has enough others around it for a quadratic fit.
int finest_level(const SampleTree& tree, const PartitionOptions& options) {
  const std::vector<double> company = tree.company();
  const int deepest = static_cast<int>(company.size()) - 1;
  if (options.max_depth) return deepest;
  int finest = 2;
  while (finest < deepest && company[static_cast<std::size_t>(finest) + 1] >= kCountedCompany * kLeastCompany) ++finest;
  return finest;
}

/// Whether the mean number of samples in a sample's cell of a level is at least this.
bool has_company(const SampleTree& tree, int level, double least) {
  const std::vector<double> company = tree.company();
  return static_cast<std::size_t>(level) < company.size() && company[static_cast<std::size_t>(level)] >= least;
}

/// 1 for the cells of each level that are tried.
using Wanted = std::vector<std::vector<std::uint8_t>>;

/// Those that must be tried to refit below some blocks: those blocks, the blocks around them on their level, whose
/// risks they average over, all blocks below these, and around them the finest cells that noise is pooled over.
Wanted wanted_below(const SampleTree& tree, std::span<const BlockKey> roots, int finest) {
  const auto levels = static_cast<std::size_t>(tree.depth()) + 1;
  Wanted wanted(levels);
  for (std::size_t l = 0; l < levels; ++l) wanted[l].resize(tree.level(static_cast<int>(l)).size());
  NeighbourWalk walk(tree);
  for (const BlockKey& root : roots) {
    if (root.level > tree.depth()) continue;
    const std::int64_t cell = tree.find(root.level, root.code);
    if (cell < 0) continue;
    walk.go(root.level, static_cast<std::uint32_t>(cell));
    for (const std::int32_t n : walk.own())
      if (n >= 0) wanted[static_cast<std::size_t>(root.level)][static_cast<std::size_t>(n)] = 1;
  }
  for (std::size_t l = 0; l < levels; ++l) {
    for (std::size_t p = 0; l > 0 && p < wanted[l - 1].size(); ++p) {
      const auto& child = tree.level(static_cast<int>(l) - 1).child;
      for (std::uint32_t c = child[p]; c < child[p + 1]; ++c) wanted[l][c] |= wanted[l - 1][p];
    }
    if (l != static_cast<std::size_t>(finest)) continue;
    const std::vector<std::uint8_t> inner = wanted[l];
    for (std::size_t c = 0; c < inner.size(); ++c) {
      if (!inner[c]) continue;
      walk.go(finest, static_cast<std::uint32_t>(c));
      for (const std::int32_t n : walk.own())
        if (n >= 0) wanted[l][static_cast<std::size_t>(n)] = 1;
    }
  }
  return wanted;
}

/// Blocks that represent the cloud in the choice of the widths of supports: a pilot costs a small part of trials of all
/// blocks, which are then made once, with these widths.
struct Pilot {
  Wanted cells;        ///< empty: all
  double samples = 0;  ///< number of samples in its cells of the finest level
  const Wanted* wanted() const { return cells.empty() ? nullptr : &cells; }
};
/// Cells of the finest level in a pilot; clouds with less than four times as many are tried whole. Its blocks are this
/// many levels coarser; if the noise needs fits more than kPilotGivesUp levels above the finest, all blocks are tried.
constexpr std::size_t kPilotCells = 8000;
constexpr int kPilotBlock = 4, kPilotGivesUp = 1;

Pilot whole_cloud(const SampleTree& tree) { return {{}, static_cast<double>(tree.positions().size())}; }

Pilot choose_pilot(const SampleTree& tree, int finest) {
  const int level = finest - kPilotBlock;
  const std::size_t cells = tree.level(finest).size(), every = cells / kPilotCells;
  if (level < 0 || every < 4) return whole_cloud(tree);
  Pilot pilot;
  pilot.cells.resize(static_cast<std::size_t>(finest) + 1);
  for (std::size_t l = 0; l < pilot.cells.size(); ++l) pilot.cells[l].resize(tree.level(static_cast<int>(l)).size());
  // Chosen by its place, so that samples elsewhere do not change the choice.
  const auto& code = tree.level(level).code;
  for (std::size_t c = 0; c < code.size(); ++c)
    pilot.cells[static_cast<std::size_t>(level)][c] = (code[c] * 0x9e3779b97f4a7c15u >> 32) % every == 0;
  for (int l = level; l < finest; ++l) {
    const auto& child = tree.level(l).child;
    for (std::size_t p = 0; p < tree.level(l).size(); ++p)
      for (std::uint32_t c = child[p]; c < child[p + 1]; ++c)
        pilot.cells[static_cast<std::size_t>(l) + 1][c] = pilot.cells[static_cast<std::size_t>(l)][p];
  }
  const auto& begin = tree.level(finest).begin;
  const std::vector<std::uint8_t>& wanted = pilot.cells[static_cast<std::size_t>(finest)];
  for (std::size_t c = 0; c < wanted.size(); ++c)
    if (wanted[c]) pilot.samples += begin[c + 1] - begin[c];
  return pilot.samples > 0 ? pilot : whole_cloud(tree);
}

/// Tries blocks from the finest level up, because each block uses its children's results.
void try_blocks(const BlockFitter& fitter, ScaleChoice& choice, Progress& progress, const Wanted* wanted = nullptr) {
  const auto levels = static_cast<std::size_t>(choice.finest) + 1;
  std::size_t work = 0;
  for (int l = 0; l <= choice.finest; ++l) work += fitter.tree.level(l).size();
  progress.begin("fit", work);
  choice.trials.assign(levels, {});
  // A pilot's blocks are tried again, and noisy ones are fitted again.
  choice.kept_level = wanted || fitter.height > 0 ? -1 : choice.finest;
  choice.kept.assign(choice.kept_level < 0 ? 0 : fitter.tree.level(choice.finest).size(), {});
  for (std::size_t l = levels; l-- > 0;) {
    const int level = static_cast<int>(l);
    choice.trials[l].resize(fitter.tree.level(level).size());
    parallel_ranges(0, choice.trials[l].size(), 128, [&](std::size_t first, std::size_t last) {
      NeighbourWalk walk(fitter.tree);
      Workspace ws;
      for (std::size_t c = first; c < last; ++c) {
        if (wanted && !(*wanted)[l][c]) continue;
        std::span<const Trial> children;
        if (level < choice.finest) {
          const auto& child = fitter.tree.level(level).child;
          children = std::span(choice.trials[l + 1]).subspan(child[c], child[c + 1] - child[c]);
        }
        KeptFit* const kept = level == choice.kept_level ? &choice.kept[c] : nullptr;
        choice.trials[l][c] = try_block(fitter, level, static_cast<std::uint32_t>(c), walk, children, ws, kept);
      }
      progress.advance(last - first);
    });
  }
}

/// Fits the blocks of the finest level with any number of samples, after finer levels were given up.
void refit_finest(BlockFitter& fitter, ScaleChoice& choice, const Wanted* wanted = nullptr) {
  if (choice.finest == fitter.deepest) return;
  fitter.deepest = choice.finest;
  const auto l = static_cast<std::size_t>(choice.finest);
  parallel_ranges(0, choice.trials[l].size(), 128, [&](std::size_t first, std::size_t last) {
    NeighbourWalk walk(fitter.tree);
    Workspace ws;
    for (std::size_t c = first; c < last; ++c) {
      Trial& t = choice.trials[l][c];
      if (t.highest >= 0 || t.reach == 0 || (wanted && !(*wanted)[l][c])) continue;
      const float noise = t.noise;
      t = try_block(fitter, choice.finest, static_cast<std::uint32_t>(c), walk, {}, ws);
      t.noise = noise;
    }
  });
}

/// Share of these samples in cells of the finest level with a second sheet.
double share_of_two_sheets(const BlockFitter& fitter, const ScaleChoice& choice, double samples) {
  const std::vector<Trial>& trials = choice.trials[static_cast<std::size_t>(choice.finest)];
  const auto& begin = fitter.tree.level(choice.finest).begin;
  double two = 0;
  for (std::size_t c = 0; c < trials.size(); ++c)
    if (trials[c].dropped > kHoldsTwoSheets) two += begin[c + 1] - begin[c];
  return two / samples;
}

/// Risks of degrees 1 .. kMaxDegree.
using Risks = std::array<float, kMaxDegree>;

/// Mallows' estimate of the expected squared error of each degree; infinite where undefined (mallows1973).
Risks raw_risks(const Trial& t, float noise, float radius, float second) {
  Risks risks;
  risks.fill(kInfinite);
  for (int d = 1; d <= t.highest; ++d) {
    const auto k = static_cast<std::size_t>(d);
    risks[k - 1] =
        t.residual(d) - noise * (1 - 2 * kFreedom[k] / t.effective_count) + t.dropped * second * radius * radius;
  }
  return risks;
}

/// Chooses the degree with the least risk, averaged over the neighbourhood (a single block's residual is too noisy for
/// a choice), at least the variance of the fit.
void choose_degree(Trial& t, float noise, const SampleTree::Neighbours& around, const std::vector<Risks>& raw) {
  for (int d = 1; d <= t.highest; ++d) {
    const auto k = static_cast<std::size_t>(d);
    float sum = 0, n = 0;
    for (const std::int32_t o : around) {
      if (o < 0 || raw[static_cast<std::size_t>(o)][k - 1] == kInfinite) continue;
      sum += raw[static_cast<std::size_t>(o)][k - 1], n += 1;
    }
    const float risk = std::max(sum / n, noise * kFreedom[k] / t.effective_count);
    if (risk < t.risk * (d > 1 ? kBetterDegree : 1.0f)) t.risk = risk, t.degree = static_cast<std::uint8_t>(d);
  }
}

/// Share of the blocks that contain a second sheet; blocks with a small part of one count in part.
float two_sheets_around(const std::vector<Trial>& trials, const SampleTree::Neighbours& around) {
  float sum = 0, n = 0;
  for (const std::int32_t o : around)
    if (o >= 0) sum += std::min(1.0f, 0.5f * trials[static_cast<std::size_t>(o)].dropped / kHoldsTwoSheets), n += 1;
  return n > 0 ? sum / n : 0;
}

/// Decides bottom-up whether a block is better left whole.
void choose_cuts(const BlockFitter& fitter, ScaleChoice& choice) {
  const auto needed = static_cast<float>(choice.accepted * choice.accepted);
  const float second = kSecondSheetRisk + noisiness(choice) * (kNoisySecondSheetRisk - kSecondSheetRisk);
  const float better = kBetterCut + noisiness(choice) * (kBetterNoisyCut - kBetterCut);
  for (int level = choice.finest; level >= 0; --level) {
    const auto l = static_cast<std::size_t>(level);
    std::vector<Trial>& trials = choice.trials[l];
    const float radius = fitter.fit_radius(level);
    const auto noise_of = [&](const Trial& t) { return t.noise >= 0 ? t.noise : static_cast<float>(choice.variance); };
    std::optional<ChildDensity> below;
    if (level < choice.finest) below.emplace(fitter.tree, level);
    std::vector<Risks> raw(trials.size());
    parallel_for(0, raw.size(), 1024,
                 [&](std::size_t c) { raw[c] = raw_risks(trials[c], noise_of(trials[c]), radius, second); });
    const auto choose = [&](Trial& t, std::size_t c, const SampleTree::Neighbours& around) {
      choose_degree(t, noise_of(t), around, raw);
      t.best = t.risk;
      t.leaf = true;
      if (level == choice.finest) return;
      const auto& child = fitter.tree.level(level).child;
      const auto& begin = fitter.tree.level(level + 1).begin;
      // A child without enough samples for a fit has the risk of this block; its neighbours' supports cover it.
      double sum = 0, n = 0;
      for (std::uint32_t k = child[c]; k < child[c + 1]; ++k) {
        const double m = begin[k + 1] - begin[k];
        const float best = std::min(choice.trials[l + 1][k].best, t.risk);
        if (best < kInfinite) sum += m * best, n += m;
      }
      const float divided = n > 0 ? static_cast<float>(sum / n) : kInfinite;
      const bool wanted =
          t.risk > needed && divided < better * t.risk && below->suffices(around, two_sheets_around(trials, around));
      if (wanted || (t.risk == kInfinite && divided < kInfinite)) t.leaf = false, t.best = divided;
    };
    parallel_ranges(0, raw.size(), 1024, [&](std::size_t first, std::size_t last) {
      NeighbourWalk walk(fitter.tree);
      for (std::size_t c = first; c < last; ++c) {
        walk.go(level, static_cast<std::uint32_t>(c));
        choose(trials[c], c, walk.own());
      }
    });
  }
}

/// Collects leaves from the top; blocks that cannot be fitted have none and are left to their neighbours' supports or
/// the far field.
void collect_leaves(const SampleTree& tree, ScaleChoice& choice, int root_level = 0, std::uint32_t root = 0) {
  std::vector<std::pair<int, std::uint32_t>> stack{{root_level, root}};
  while (!stack.empty()) {
    const auto [l, c] = stack.back();
    stack.pop_back();
    const Trial& t = choice.trials[static_cast<std::size_t>(l)][c];
    if (t.leaf || l == choice.finest) {
      if (t.risk < kInfinite) choice.leaves.push_back({tree.level(l).code[c], c, l});
      continue;
    }
    const auto& child = tree.level(l).child;
    for (std::uint32_t k = child[c + 1]; k-- > child[c];) stack.emplace_back(l + 1, k);
  }
}

/// Spacing of the samples, from the number of samples in the finest level's balls.
double spacing_of(const BlockFitter& fitter, const ScaleChoice& choice) {
  std::vector<float> counts;
  for (const Trial& t : choice.trials[static_cast<std::size_t>(choice.finest)])
    if (t.highest >= 1 && t.reach == 1) counts.push_back(t.effective_count);
  if (counts.empty()) return 0;
  // (Σ w)² / Σ w² of the weights (1 − t²)² over a disc is 5/9 of the samples in it.
  return fitter.fit_radius(choice.finest) * std::sqrt(5 * std::numbers::pi / (9 * median(counts)));
}

}  // namespace

float noisiness(const ScaleBasis& basis) {
  return std::max(0.0f, static_cast<float>(basis.support) - static_cast<float>(basis.fit)) /
         static_cast<float>(kNoisySupport - kNoisyFit);
}

ScaleChoice choose_scales(SampleTree& tree, const PartitionOptions& options, double diagonal, Progress& progress) {
  ScaleChoice choice;
  choice.tried = choice.finest = finest_level(tree, options);
  tree.build_levels(choice.finest);
  BlockFitter fitter{tree, options, static_cast<float>(options.support.value_or(kSupport)), choice.finest};
  Pilot pilot = choose_pilot(tree, choice.finest);
  try_blocks(fitter, choice, progress, pilot.wanted());
  while (!options.max_depth && share_of_two_sheets(fitter, choice, pilot.samples) > kThinCells &&
         has_company(tree, choice.finest + 1, kThinCompany)) {
    choice.tried = choice.finest = fitter.deepest = choice.finest + 1;
    tree.build_levels(choice.finest);
    pilot = choose_pilot(tree, choice.finest);
    try_blocks(fitter, choice, progress, pilot.wanted());
  }
  double evenness = find_noise(fitter, pilot.samples, choice);
  const auto try_all = [&] {
    choice.finest = choice.tried;
    try_blocks(fitter, choice, progress);
    pilot = whole_cloud(tree);
    evenness = find_noise(fitter, pilot.samples, choice);
  };
  if (pilot.wanted() && choice.finest < choice.tried - kPilotGivesUp) try_all();
  bool tried = !pilot.wanted();
  if (!options.support) {
    // If noise is as large as the spacing, wider supports make a more stable surface; if it is small, they blur.
    const double ratio = std::sqrt(choice.variance) / spacing_of(fitter, choice);
    const double noisy = std::clamp((ratio - kLittleNoise) / (kMuchNoise - kLittleNoise), 0.0, 1.0) *
                         std::clamp((evenness - kShapeEvenness) / (kNoiseEvenness - kShapeEvenness), 0.0, 1.0);
    if (noisy > 0) {
      fitter.support = static_cast<float>(kSupport + noisy * (kNoisySupport - kSupport));
      fitter.fit = static_cast<float>(kSupport + noisy * (kNoisyFit - kSupport));
      fitter.height = static_cast<float>(kNoiseHeight * std::sqrt(choice.variance));
      tried = false;
    }
  }
  if (!tried) try_all();
  choice.support = fitter.support, choice.fit = fitter.fit, choice.height = fitter.height;
  refit_finest(fitter, choice);
  progress.begin("choose scale");
  choice.trials.resize(static_cast<std::size_t>(choice.finest) + 1);
  choice.accepted =
      options.error.value_or(std::max(kAcceptedNoise * std::sqrt(choice.variance), kAcceptedSize * diagonal));
  choose_cuts(fitter, choice);
  collect_leaves(tree, choice);
  if (choice.leaves.empty()) throw DataError("partition of unity: too few samples for any local fit");
  return choice;
}

ScaleChoice choose_scales_below(const SampleTree& tree, const PartitionOptions& options, const ScaleBasis& basis,
                                std::span<const BlockKey> roots, Progress& progress) {
  ScaleChoice choice;
  static_cast<ScaleBasis&>(choice) = basis;
  choice.finest = basis.tried;
  BlockFitter fitter = fitter_of(tree, options, choice);
  fitter.height = static_cast<float>(basis.height);
  int deepest = 0;
  for (const BlockKey& root : roots) deepest = std::max(deepest, root.level);
  const Wanted wanted = wanted_below(tree, roots, basis.finest);
  try_blocks(fitter, choice, progress, &wanted);
  choice.finest = basis.finest;
  pool_noise(fitter, choice);
  spread_noise(fitter, choice);
  if (options.max_depth) choice.finest = std::clamp(*options.max_depth, deepest, choice.finest);
  refit_finest(fitter, choice, &wanted);
  choose_cuts(fitter, choice);
  for (const BlockKey& root : roots) {
    const std::int64_t cell = tree.find(root.level, root.code);
    if (cell >= 0) collect_leaves(tree, choice, root.level, static_cast<std::uint32_t>(cell));
  }
  return choice;
}

}  // namespace sansmesh::inline v1
