#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/partition/crease_fit.h"
#include "sansmesh/partition/local_fit.h"
#include "sansmesh/partition/partition_state.h"
#include "sansmesh/partition/sample_tree.h"

namespace sansmesh {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();
/// tr(G⁻¹ Σ w² m mᵀ) · Σ w / Σ w²: the degrees of freedom that a fit of each degree takes from Σ w r², in units of the
/// weights' effective count; for w = (1 − t²)² over a disc. Less than the number of basis functions, since those that
/// live near the rim, where the weights vanish, hardly take part.
constexpr std::array<float, kMaxDegree + 1> kFreedom{1.0f, 7.0f / 3, 4.0f, 6.0f, 25.0f / 3};

constexpr float kSecondSheet = 0.2f;         ///< share of the samples in a block that must lie on another sheet
constexpr float kChamfer = 0.02f;            ///< mean gap along a crease, in units of the block's edge
constexpr float kHalfDiagonal = 0.8660254f;  // of a unit cube

/// What a trial fit of one block says about every degree; the winners are fitted again at the end.
struct Trial {
  std::array<float, kMaxDegree + 1> mean_square{};  ///< weighted mean squared residual (length²)
  float effective_count = 0;
  float dropped = 0;         ///< share of the weight on samples that face away: a second sheet
  float reach = 1;           ///< radius of the fit / radius of the support
  std::uint32_t stride = 1;  ///< every how manieth sample was used
  std::int8_t highest = -1;
  std::uint8_t degree = 0;  ///< chosen
  bool leaf = false;
  float risk = kInfinite;  ///< expected squared error of the best degree
  float best = kInfinite;  ///< of the best cut below this block
  float noise = 0;         ///< local noise variance
  float gap = kInfinite;   ///< between the surface and linear triangles of half the block's edge (length)
};

/// A triangle of edge e on a surface of curvature κ leaves a mean gap of κ e²/8; a plane fitted to a disc of radius R
/// leaves an rms of 0.097 κ R² under the weights (1 − t²)². Hence the gap of e = h/2, from the plane's residual.
float gap_of_plane(double plane_mean_square, double radius, double block_edge) {
  return static_cast<float>(std::sqrt(plane_mean_square) / (0.097 * radius * radius) * block_edge * block_edge / 32);
}

struct Fitter {
  const SampleTree& tree;
  const PartitionOptions& options;
  int deepest;  ///< level that is fitted however many samples a block has

  float block_edge(int level) const { return tree.edge() / static_cast<float>(1u << level); }

  Vec3f center(int level, std::uint32_t cell) const {
    const auto c = morton_cell(tree.level(level).code[cell]);
    const float h = block_edge(level);
    return tree.lower() + Vec3f{(static_cast<float>(c[0]) + 0.5f) * h, (static_cast<float>(c[1]) + 0.5f) * h,
                                (static_cast<float>(c[2]) + 0.5f) * h};
  }

  float support_radius(int level) const {
    return static_cast<float>(options.support) * kHalfDiagonal * block_edge(level);
  }
};

struct Workspace {
  std::vector<std::uint32_t> ids;
  LocalSamples samples;
};

/// Indices of the samples in a ball (of every stride-th), from the given cells of a level.
void gather(const SampleTree& tree, int level, const SampleTree::Neighbours& cells, const Vec3f& c, float radius,
            std::vector<std::uint32_t>& ids, std::size_t stride = 1) {
  ids.clear();
  const auto positions = tree.positions();
  const auto& begin = tree.level(level).begin;
  const float limit = radius * radius;
  for (const std::int32_t cell : cells) {
    if (cell < 0) continue;
    for (std::uint32_t i = begin[static_cast<std::size_t>(cell)]; i < begin[static_cast<std::size_t>(cell) + 1];
         i += static_cast<std::uint32_t>(stride))
      if (squared_norm(positions[i] - c) < limit) ids.push_back(i);
  }
}

float smooth_weight(float t) { return (1 - t) * (1 - t); }

/// The samples of the ball around `middle` that face the same way as f.nu, in f's frame. Returns the share of the
/// weight that faces away.
float project(const SampleTree& tree, const Vec3f& middle, Workspace& ws, const LocalFunction& f) {
  const auto positions = tree.positions();
  const auto normals = tree.normals();
  const float inverse = 1 / f.scale;
  ws.samples.clear();
  float kept = 0, away = 0;
  for (const std::uint32_t i : ws.ids) {
    const float t = squared_norm(positions[i] - middle) * inverse * inverse;
    if (t >= 1) continue;
    const float weight = smooth_weight(t);
    if (dot(normals[i], f.nu) < 0) {
      away += weight;
      continue;
    }
    kept += weight;
    const Vec3f d = (positions[i] - f.center) * inverse;
    ws.samples.add(dot(d, f.xi), dot(d, f.eta), dot(d, f.nu), weight);
  }
  return kept + away > 0 ? away / (kept + away) : 0;
}

/// All samples of the ball around a fitted function's foot point, whichever way they face.
void ball_samples(const SampleTree& tree, const LocalFunction& f, std::span<const std::uint32_t> ids,
                  std::vector<Vec3f>& position, std::vector<Vec3f>& normal, std::vector<float>& weight) {
  position.clear(), normal.clear(), weight.clear();
  const float inverse = 1 / (f.scale * f.scale);
  for (const std::uint32_t i : ids) {
    const float t = squared_norm(tree.positions()[i] - f.center) * inverse;
    if (t >= 1) continue;
    position.push_back(tree.positions()[i]);
    normal.push_back(tree.normals()[i]);
    weight.push_back(smooth_weight(t));
  }
}

void set_normal(LocalFunction& f, const Vec3f& nu) {
  f.nu = nu;
  tangent_frame(f.nu, f.xi, f.eta);
}

/// Fits all degrees around c to the samples in ws.ids. The frame's normal is the mean of the samples' normals,
/// corrected where a first plane says that it is tilted (noisy normals). The ball is shifted along the normal until the
/// surface passes through its middle: an off-centre ball cuts more noisy samples off on one side than on the other, a
/// bias.
DegreeFits fit_local(const SampleTree& tree, const Vec3f& c, float scale, int max_degree, Workspace& ws,
                     LocalFunction& f, float* dropped = nullptr) {
  const auto positions = tree.positions();
  const auto normals = tree.normals();
  const float inverse = 1 / (scale * scale);
  Vec3f normal, mean;
  float weight = 0;
  for (const std::uint32_t i : ws.ids) {
    const Vec3f d = positions[i] - c;
    const float t = squared_norm(d) * inverse;
    if (t >= 1) continue;
    const float w = smooth_weight(t);
    normal += normals[i] * w;
    mean += d * w;
    weight += w;
  }
  normal = normalized(normal);
  if (normal == Vec3f{}) normal = {0, 0, 1};
  set_normal(f, normal);
  f.center = c;
  f.scale = scale;
  Vec3f middle = weight > 0 ? c + normal * (dot(mean, normal) / weight) : c;
  float away = project(tree, middle, ws, f);
  DegreeFits fits = fit_all_degrees(ws.samples, max_degree);
  if (fits.highest >= 1) {
    const auto plane = monomial_coefficients(fits, 1);
    const float slope = std::hypot(plane[1], plane[2]);
    if (slope > 0.1f && slope < 2.0f) {
      set_normal(f, normalized(f.nu - f.xi * plane[1] - f.eta * plane[2]));
      middle = c + f.nu * (plane[0] * scale / std::sqrt(1 + slope * slope));
      away = project(tree, middle, ws, f);
      fits = fit_all_degrees(ws.samples, max_degree);
    }
  }
  if (dropped) *dropped = away;
  return fits;
}

/// Coverage k (METHODS §3.1): area of the box of the projected samples / area of the projected ball.
double coverage(const LocalSamples& s) {
  float lo[2] = {1, 1}, hi[2] = {-1, -1};
  for (std::size_t i = 0; i < s.size(); ++i) {
    lo[0] = std::min(lo[0], s.u()[i]), hi[0] = std::max(hi[0], s.u()[i]);
    lo[1] = std::min(lo[1], s.v()[i]), hi[1] = std::max(hi[1], s.v()[i]);
  }
  return std::max(0.0f, hi[0] - lo[0]) * std::max(0.0f, hi[1] - lo[1]) / 3.14159265;
}

/// A ball shifted along the normal reaches farther from the block's centre than its radius.
constexpr float kShift = 1.3f;

/// Gathers with the support's own radius or, where too few samples are in it, with up to twice that (the parent's
/// ball). Returns the factor, or 0 if even that ball holds too few.
float gather_enough(const Fitter& fitter, int level, std::uint32_t cell, const SampleTree::Neighbours& own,
                    const SampleTree::Neighbours& parents, std::vector<std::uint32_t>& ids) {
  const Vec3f c = fitter.center(level, cell);
  const float radius = fitter.support_radius(level);
  const auto enough = [&](float r) {
    const auto in = std::count_if(
        ids.begin(), ids.end(), [&](std::uint32_t i) { return squared_norm(fitter.tree.positions()[i] - c) < r * r; });
    return in >= fitter.options.min_samples;
  };
  gather(fitter.tree, level, own, c, kShift * radius, ids);
  if (enough(radius) || level == 0) return 1;
  for (const float reach : {1.41f, 2.0f}) {
    gather(fitter.tree, level - 1, parents, c, kShift * reach * radius, ids);
    if (enough(reach * radius)) return reach;
  }
  return 0;
}

/// Distance of the samples' centre of gravity from the middle of the disc, relative to its radius: 0 in the interior of
/// a surface, 0.28 at a straight border (under the weights (1 − t²)²).
double eccentricity(const LocalSamples& s) {
  double u = 0, v = 0, n = 0;
  for (std::size_t i = 0; i < s.size(); ++i)
    u += s.weight()[i] * s.u()[i], v += s.weight()[i] * s.v()[i], n += s.weight()[i];
  return n > 0 ? std::hypot(u, v) / n : 0;
}

/// Robustness (METHODS §3.1): curved polynomials only where the samples cover the support, and surround its middle.
int highest_degree(const PartitionOptions& options, const DegreeFits& fits, const LocalSamples& samples) {
  int d = fits.highest;
  if (d > 1 && eccentricity(samples) > options.max_eccentricity) return 1;
  const double k = coverage(samples);
  while (d > 1 && k < options.coverage[static_cast<std::size_t>(d)]) --d;
  return d;
}

/// Every how manieth sample around a block is enough for its fit.
std::size_t thinning(const Fitter& fitter, int level, const SampleTree::Neighbours& own) {
  std::size_t near = 0;
  const auto& begin = fitter.tree.level(level).begin;
  for (const std::int32_t n : own)
    if (n >= 0) near += begin[static_cast<std::size_t>(n) + 1] - begin[static_cast<std::size_t>(n)];
  const auto limit = static_cast<std::size_t>(fitter.options.max_samples);
  return near > 4 * limit ? near / limit : 1;
}

/// A ball of radius 1 leaves out the samples that noise takes far off the surface: over all of the disc, offsets z have
/// the weight (1 − z²)³ ≈ exp(−3z²), so that noise of variance σ² shows as σ² / (1 + 6σ²). Undone here.
float uncut(float mean_square) { return mean_square / std::max(0.3f, 1 - 6 * mean_square); }

/// Case (iii) of METHODS §3.1 says: too many samples, subdivide. But where planes on half the scale leave no more than
/// noise, only more samples make the fit better.
bool only_noise(std::span<const Trial> children) {
  double plane = 0, best = 0;
  for (const Trial& t : children) {
    if (t.highest < 1) continue;
    plane += t.mean_square[1];
    best += t.mean_square[static_cast<std::size_t>(t.highest)];
  }
  return best > 0 && plane < 2 * best;
}

Trial try_block(const Fitter& fitter, int level, std::uint32_t cell, const SampleTree::Neighbours& own,
                const SampleTree::Neighbours& parents, std::span<const Trial> children, Workspace& ws) {
  Trial trial;
  const auto limit = static_cast<std::size_t>(fitter.options.max_samples);
  const bool any_number = only_noise(children);
  const std::size_t stride = any_number ? 1 : thinning(fitter, level, own);
  const Vec3f c = fitter.center(level, cell);
  LocalFunction f;
  if (stride > 1 && level < fitter.deepest) {
    // Case (iii): subdivided without a fit. A thinned sample still tells the polygoniser how flat it is here.
    gather(fitter.tree, level, own, c, kShift * fitter.support_radius(level), ws.ids, stride);
    const float scale = fitter.support_radius(level);
    const DegreeFits fits = fit_local(fitter.tree, c, scale, 1, ws, f, &trial.dropped);
    if (fits.highest >= 1) trial.gap = gap_of_plane(fits.mean_square[1], 1, fitter.block_edge(level) / scale) * scale;
    return trial;
  }
  trial.stride = static_cast<std::uint32_t>(stride);
  if (stride > 1) {
    gather(fitter.tree, level, own, c, kShift * fitter.support_radius(level), ws.ids, stride);
  } else {
    trial.reach = gather_enough(fitter, level, cell, own, parents, ws.ids);
  }
  if (trial.reach == 0) return trial;
  const float scale = trial.reach * fitter.support_radius(level);
  const DegreeFits fits = fit_local(fitter.tree, c, scale, fitter.options.max_degree, ws, f, &trial.dropped);
  if (fits.highest >= 1) trial.gap = gap_of_plane(fits.mean_square[1], 1, fitter.block_edge(level) / scale) * scale;
  if (ws.samples.size() > limit && level < fitter.deepest && !any_number) return trial;
  trial.highest = static_cast<std::int8_t>(highest_degree(fitter.options, fits, ws.samples));
  trial.effective_count = static_cast<float>(fits.effective_count);
  for (int d = 0; d <= trial.highest; ++d) {
    const auto k = static_cast<std::size_t>(d);
    trial.mean_square[k] = uncut(static_cast<float>(fits.mean_square[k])) * scale * scale;
  }
  return trial;
}

/// Residual variance of the samples about the surface, from the fits of a block and its neighbours; -1: not known.
float pooled_noise(const std::vector<Trial>& trials, const SampleTree::Neighbours& around) {
  double sum = 0, n = 0;
  for (const std::int32_t k : around) {
    if (k < 0) continue;
    const Trial& o = trials[static_cast<std::size_t>(k)];
    // The highest degree with freedom left: what it does not follow is noise, not shape.
    int d = o.highest;
    while (d > 1 && o.effective_count < 1.5f * kFreedom[static_cast<std::size_t>(d)]) --d;
    if (d < 1 || o.reach != 1) continue;
    const double freedom = o.effective_count - kFreedom[static_cast<std::size_t>(d)];
    if (freedom < 1) continue;
    sum += o.mean_square[static_cast<std::size_t>(d)] * o.effective_count;
    n += freedom;
  }
  return n > 0 ? static_cast<float>(sum / n) : -1;
}

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

}  // namespace

void PartitionOptions::validate() const {
  const auto check = [](bool ok, const char* what) {
    if (!ok) throw ArgumentError(std::string("partition of unity: ") + what);
  };
  check(!max_depth || (*max_depth >= 2 && *max_depth <= 14), "max_depth must lie in 2..14");
  check(!error || *error > 0, "error must be positive");
  check(support >= 1.1 && support <= 3, "support must lie in 1.1..3");
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

  // The finest level tried is the last on which a sample typically still has company enough for a quadratic fit.
  int finest = 2;
  for (int l = 2; l <= sort_depth; ++l) {
    const auto& begin = tree.level(l).begin;
    double mean = 0;
    for (std::size_t c = 0; c + 1 < begin.size(); ++c)
      mean += std::pow(static_cast<double>(begin[c + 1] - begin[c]), 2);
    if (mean / static_cast<double>(points.size()) < 4.0 && l > 2 && !options.max_depth) break;
    finest = l;
  }
  const Fitter fitter{tree, options, finest};
  const auto levels = static_cast<std::size_t>(finest) + 1;
  std::vector<std::vector<Trial>> trials(levels);
  std::vector<std::vector<SampleTree::Neighbours>> neighbours(levels);
  std::size_t work = 0;
  for (std::size_t l = 0; l < levels; ++l) work += tree.level(static_cast<int>(l)).size();
  progress.begin("fit", work);
  std::vector<std::vector<std::uint32_t>> parent(levels);
  neighbours[0] = {tree.root_neighbours()};
  parent[0] = {0};
  for (int l = 1; l <= finest; ++l) {
    const auto at = static_cast<std::size_t>(l);
    neighbours[at].resize(tree.level(l).size());
    parent[at].resize(tree.level(l).size());
    const auto& child = tree.level(l - 1).child;
    parallel_for(0, tree.level(l - 1).size(), 256, [&](std::size_t p) {
      for (std::uint32_t c = child[p]; c < child[p + 1]; ++c) {
        parent[at][c] = static_cast<std::uint32_t>(p);
        neighbours[at][c] = tree.child_neighbours(l - 1, neighbours[at - 1][p], c);
      }
    });
  }
  for (int l = finest; l >= 0; --l) {
    const auto at = static_cast<std::size_t>(l);
    trials[at].resize(tree.level(l).size());
    parallel_ranges(0, trials[at].size(), 128, [&](std::size_t first, std::size_t last) {
      Workspace ws;
      for (std::size_t c = first; c < last; ++c) {
        std::span<const Trial> children;
        if (l < finest) {
          const auto& child = tree.level(l).child;
          children = std::span(trials[at + 1]).subspan(child[c], child[c + 1] - child[c]);
        }
        trials[at][c] = try_block(fitter, l, static_cast<std::uint32_t>(c), neighbours[at][c],
                                  neighbours[l > 0 ? at - 1 : 0][parent[at][c]], children, ws);
      }
      progress.advance(last - first);
    });
  }

  // Noise: what the highest affordable degree leaves over on the finest level whose balls are wide against it (a ball
  // that is not cuts the noise off, and its fits are meaningless). Pooled over each block's neighbourhood.
  progress.begin("choose scale");
  double variance = 0;
  for (;; --finest) {
    const auto at = static_cast<std::size_t>(finest);
    parallel_for(0, trials[at].size(), 1024,
                 [&](std::size_t c) { trials[at][c].noise = pooled_noise(trials[at], neighbours[at][c]); });
    std::vector<float> noises;
    for (const Trial& t : trials[at])
      if (t.noise >= 0) noises.push_back(t.noise);
    if (!noises.empty()) {
      const auto middle = noises.begin() + static_cast<std::ptrdiff_t>(noises.size() / 2);
      std::nth_element(noises.begin(), middle, noises.end());
      variance = *middle;
      if (std::sqrt(variance) < 0.2 * fitter.support_radius(finest)) break;
    }
    if (finest <= 2) break;
  }
  for (int l = finest - 1; l >= 0; --l) {
    const auto at = static_cast<std::size_t>(l);
    const auto& child = tree.level(l).child;
    const auto& begin = tree.level(l + 1).begin;
    parallel_for(0, trials[at].size(), 1024, [&](std::size_t c) {
      double sum = 0, n = 0;
      for (std::uint32_t k = child[c]; k < child[c + 1]; ++k) {
        const double m = begin[k + 1] - begin[k];
        if (trials[at + 1][k].noise >= 0) sum += m * trials[at + 1][k].noise, n += m;
      }
      trials[at][c].noise = n > 0 ? static_cast<float>(sum / n) : -1;
    });
  }
  state->report.noise = std::sqrt(variance);
  const double diagonal = box.diagonal();
  const double accepted = options.error.value_or(std::max(0.1 * state->report.noise, 2e-6 * diagonal));
  state->report.error = accepted;

  // Risk of every block and degree: Mallows' estimate of the expected squared error, averaged over the neighbourhood
  // (a single block's residual is itself too noisy to choose by), never below the variance that the fit must have.
  for (int l = finest; l >= 0; --l) {
    const auto at = static_cast<std::size_t>(l);
    std::vector<std::array<float, kMaxDegree + 1>> raw(trials[at].size());
    parallel_for(0, raw.size(), 1024, [&](std::size_t c) {
      const Trial& t = trials[at][c];
      const float noise = t.noise >= 0 ? t.noise : static_cast<float>(variance);
      const float radius = fitter.support_radius(l);
      for (int d = 0; d <= kMaxDegree; ++d) {
        const auto k = static_cast<std::size_t>(d);
        raw[c][k] = kInfinite;
        if (d < 1 || d > t.highest) continue;
        const float p = kFreedom[k], n = t.effective_count;
        raw[c][k] = t.mean_square[k] - noise * (1 - 2 * p / n) + t.dropped * 0.1f * radius * radius;
      }
    });
    parallel_for(0, raw.size(), 1024, [&](std::size_t c) {
      Trial& t = trials[at][c];
      const float noise = t.noise >= 0 ? t.noise : static_cast<float>(variance);
      for (int d = 1; d <= t.highest; ++d) {
        const auto k = static_cast<std::size_t>(d);
        float sum = 0, n = 0;
        for (const std::int32_t o : neighbours[at][c]) {
          if (o < 0 || raw[static_cast<std::size_t>(o)][k] == kInfinite) continue;
          sum += raw[static_cast<std::size_t>(o)][k], n += 1;
        }
        const float p = kFreedom[k];
        const float risk = std::max(sum / n, noise * p / t.effective_count);
        if (risk < t.risk * (d > 1 ? 0.98f : 1.0f)) t.risk = risk, t.degree = static_cast<std::uint8_t>(d);
      }
      t.best = t.risk;
      t.leaf = true;
      if (l == finest) return;
      const auto& child = tree.level(l).child;
      const auto& begin = tree.level(l + 1).begin;
      // A child without company enough for a fit counts as badly served as here; its neighbours' supports cover it.
      double sum = 0, n = 0;
      for (std::uint32_t k = child[c]; k < child[c + 1]; ++k) {
        const double m = begin[k + 1] - begin[k];
        const float best = std::min(trials[at + 1][k].best, t.risk);
        if (best < kInfinite) sum += m * best, n += m;
      }
      const float below = n > 0 ? static_cast<float>(sum / n) : kInfinite;
      const bool wanted = t.risk > accepted * accepted && below < 0.9f * t.risk;
      if (wanted || (t.risk == kInfinite && below < kInfinite)) t.leaf = false, t.best = below;
    });
  }

  // Leaves from the top; blocks that no fit could serve inherit nothing: their neighbours' supports or the far field
  // do.
  struct Leaf {
    std::uint64_t order;
    std::uint32_t cell;
    int level;
  };
  std::vector<Leaf> leaves;
  std::vector<std::pair<int, std::uint32_t>> stack{{0, 0}};
  while (!stack.empty()) {
    const auto [l, c] = stack.back();
    stack.pop_back();
    const Trial& t = trials[static_cast<std::size_t>(l)][c];
    if (t.leaf || l == finest) {
      if (t.risk < kInfinite) leaves.push_back({tree.level(l).code[c], c, l});
      continue;
    }
    const auto& child = tree.level(l).child;
    for (std::uint32_t k = child[c + 1]; k-- > child[c];) stack.emplace_back(l + 1, k);
  }
  if (leaves.empty()) throw DataError("partition of unity: too few samples for any local fit");

  progress.begin("final fits", leaves.size());
  state->functions.resize(leaves.size());
  state->heads.resize(leaves.size());
  state->level.resize(leaves.size());
  state->cell.resize(leaves.size());
  std::vector<std::vector<LocalFunction>> pieces(leaves.size());
  parallel_ranges(0, leaves.size(), 128, [&](std::size_t first, std::size_t last) {
    Workspace ws;
    std::vector<Vec3f> position, normal;
    std::vector<float> weight;
    for (std::size_t i = first; i < last; ++i) {
      const Leaf& leaf = leaves[i];
      const auto at = static_cast<std::size_t>(leaf.level);
      const Trial& t = trials[at][leaf.cell];
      const Vec3f c = fitter.center(leaf.level, leaf.cell);
      const float radius = fitter.support_radius(leaf.level);
      if (t.reach == 1) {
        const SampleTree::Neighbours& own = neighbours[at][leaf.cell];
        gather(tree, leaf.level, own, c, kShift * radius, ws.ids, t.stride);
      } else {
        const std::uint32_t above = parent[at][leaf.cell];
        gather(tree, leaf.level - 1, neighbours[at - 1][above], c, kShift * t.reach * radius, ws.ids);
      }
      LocalFunction& f = state->functions[i];
      const DegreeFits fits = fit_local(tree, c, t.reach * radius, t.degree, ws, f);
      f.radius = radius;
      f.degree = t.degree;
      f.coefficient = monomial_coefficients(fits, t.degree);
      if (options.sharp) {
        double smooth = fits.mean_square[t.degree] * f.scale * f.scale;
        if (smooth > std::max(2.0 * variance, accepted * accepted)) {
          // A crease must explain the samples better than any smooth function, robust or not.
          const DegreeFits bendiest = fit_all_degrees(ws.samples, options.max_degree);
          smooth = bendiest.mean_square[static_cast<std::size_t>(bendiest.highest)] * f.scale * f.scale;
          ball_samples(tree, f, ws.ids, position, normal, weight);
          CreaseFit crease = fit_crease(position, normal, weight, f.center, f.scale, options.max_degree);
          if (!crease.pieces.empty() && crease.mean_square < 0.25 * smooth) pieces[i] = std::move(crease.pieces);
        }
      }
      state->heads[i] = static_cast<std::uint32_t>(i);
      state->level[i] = static_cast<std::uint8_t>(leaf.level);
      state->cell[i] = leaf.order;
    }
    progress.advance(last - first);
  });
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    if (pieces[i].empty()) continue;
    ++state->report.creased;
    const float radius = state->functions[i].radius;
    state->functions[i] = pieces[i][0];
    state->functions[i].radius = radius;
    std::size_t tail = i;
    for (std::size_t k = 1; k < pieces[i].size(); ++k) {
      state->functions.push_back(pieces[i][k]);
      state->functions[tail].next = static_cast<std::int32_t>(state->functions.size());
      tail = state->functions.size() - 1;
    }
  }
  // Each support's surface patch within its own block: together they tile the surface, and decide inside and outside
  // where no support reaches.
  std::vector<OrientedPatch> patches(leaves.size());
  state->foot.resize(leaves.size());
  parallel_for(0, leaves.size(), 512, [&](std::size_t i) {
    const LocalFunction& f = state->functions[i];
    const float h = fitter.block_edge(leaves[i].level);
    const Vec3f foot = f.center + f.nu * (f.coefficient[0] * f.scale);
    state->foot[i] = foot;
    patches[i] = {foot,
                  f.nu * plane_area_in_cube(foot, f.nu,
                                            fitter.center(leaves[i].level, leaves[i].cell) - Vec3f{h, h, h} * 0.5f, h)};
  });
  state->sign = GlobalSign(patches);
  for (const OrientedPatch& p : patches) state->report.area += norm(p.area);
  state->report.spacing = std::sqrt(state->report.area / static_cast<double>(points.size()));

  // What the polygoniser will ask: how flat is the surface at the scale of each block?
  double accuracy = 0;
  for (const Leaf& leaf : leaves)
    accuracy += std::min<double>(trials[static_cast<std::size_t>(leaf.level)][leaf.cell].risk, diagonal * diagonal);
  state->report.accuracy = std::sqrt(accuracy / static_cast<double>(leaves.size()));
  state->flatness.resize(static_cast<std::size_t>(finest) + 1);
  for (int l = 0; l <= finest; ++l) {
    const auto at = static_cast<std::size_t>(l);
    PartitionOfUnity::State::Flatness& level = state->flatness[at];
    level.code = tree.level(l).code;
    if (l < finest) level.child = tree.level(l).child;
    level.gap.resize(trials[at].size());
    for (std::size_t c = 0; c < trials[at].size(); ++c) {
      const Trial& t = trials[at][c];
      // Samples that face away are a second sheet, or a surface that bends by more than a right angle.
      level.gap[c] = t.dropped > kSecondSheet ? kInfinite : t.gap + 0.2f * t.dropped * fitter.support_radius(l);
    }
  }
  for (std::size_t i = 0; i < leaves.size(); ++i)
    if (!pieces[i].empty()) mark_crease(*state, leaves[i].level, leaves[i].order);
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    state->report.depth = std::max(state->report.depth, leaves[i].level);
    ++state->report.functions_of_degree[static_cast<std::size_t>(state->functions[i].degree)];
  }
  state->report.functions = leaves.size();
  state->tree.build(state->functions, state->heads);
  progress.finish();
  return PartitionOfUnity(std::move(state));
}

}  // namespace sansmesh
