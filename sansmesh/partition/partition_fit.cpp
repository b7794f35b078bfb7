#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/partition/local_fit.h"
#include "sansmesh/partition/partition_state.h"
#include "sansmesh/partition/sample_tree.h"

namespace sansmesh {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();
constexpr float kHalfDiagonal = 0.8660254f;  // of a unit cube

/// What a trial fit of one block says about every degree; the winners are fitted again at the end.
struct Trial {
  std::array<float, kMaxDegree + 1> mean_square{};  ///< weighted mean squared residual (length²)
  float effective_count = 0;
  float dropped = 0;      ///< share of the weight on samples that face away: a second sheet
  float reach = 1;        ///< radius of the fit / radius of the support
  std::int8_t highest = -1;
  std::uint8_t degree = 0;  ///< chosen
  bool leaf = false;
  float risk = kInfinite;      ///< expected squared error of the best degree
  float best = kInfinite;      ///< of the best cut below this block
  float noise = 0;             ///< local noise variance
};

struct Fitter {
  const SampleTree& tree;
  const PartitionOptions& options;

  float block_edge(int level) const { return tree.edge() / static_cast<float>(1u << level); }

  Vec3f center(int level, std::uint32_t cell) const {
    const auto c = morton_cell(tree.level(level).code[cell]);
    const float h = block_edge(level);
    return tree.lower() + Vec3f{(static_cast<float>(c[0]) + 0.5f) * h, (static_cast<float>(c[1]) + 0.5f) * h,
                                (static_cast<float>(c[2]) + 0.5f) * h};
  }

  float support_radius(int level) const { return static_cast<float>(options.support) * kHalfDiagonal * block_edge(level); }
};

struct Workspace {
  std::vector<std::uint32_t> ids;
  std::vector<float> weight;
  LocalSamples samples;
};

/// Indices and weights (1 − t²)² of the samples in a ball, from the given cells of a level.
void gather(const SampleTree& tree, int level, const SampleTree::Neighbours& cells, const Vec3f& c, float radius, Workspace& ws) {
  ws.ids.clear();
  ws.weight.clear();
  const auto positions = tree.positions();
  const auto& begin = tree.level(level).begin;
  const float inverse = 1 / (radius * radius);
  for (const std::int32_t cell : cells) {
    if (cell < 0) continue;
    for (std::uint32_t i = begin[static_cast<std::size_t>(cell)]; i < begin[static_cast<std::size_t>(cell) + 1]; ++i) {
      const float t = squared_norm(positions[i] - c) * inverse;
      if (t < 1) {
        ws.ids.push_back(i);
        ws.weight.push_back((1 - t) * (1 - t));
      }
    }
  }
}

/// Local frame from the samples' normals, and the samples that face the same way in it. Returns the share of the weight
/// that faces away.
float make_local(const SampleTree& tree, const Vec3f& c, float scale, Workspace& ws, LocalFunction& f) {
  const auto positions = tree.positions();
  const auto normals = tree.normals();
  Vec3f sum;
  for (std::size_t k = 0; k < ws.ids.size(); ++k) sum += normals[ws.ids[k]] * ws.weight[k];
  f.nu = normalized(sum);
  if (f.nu == Vec3f{}) f.nu = {0, 0, 1};
  tangent_frame(f.nu, f.xi, f.eta);
  f.center = c;
  f.scale = scale;
  const float inverse = 1 / scale;
  ws.samples.clear();
  float kept = 0, away = 0;
  for (std::size_t k = 0; k < ws.ids.size(); ++k) {
    const std::uint32_t i = ws.ids[k];
    if (dot(normals[i], f.nu) < 0) {
      away += ws.weight[k];
      continue;
    }
    kept += ws.weight[k];
    const Vec3f d = (positions[i] - c) * inverse;
    ws.samples.u.push_back(dot(d, f.xi));
    ws.samples.v.push_back(dot(d, f.eta));
    ws.samples.w.push_back(dot(d, f.nu));
    ws.samples.weight.push_back(ws.weight[k]);
  }
  return kept + away > 0 ? away / (kept + away) : 0;
}

/// Coverage k (METHODS §3.1): area of the box of the projected samples / area of the projected ball.
double coverage(const LocalSamples& s) {
  float lo[2] = {1, 1}, hi[2] = {-1, -1};
  for (std::size_t i = 0; i < s.size(); ++i) {
    lo[0] = std::min(lo[0], s.u[i]), hi[0] = std::max(hi[0], s.u[i]);
    lo[1] = std::min(lo[1], s.v[i]), hi[1] = std::max(hi[1], s.v[i]);
  }
  return std::max(0.0f, hi[0] - lo[0]) * std::max(0.0f, hi[1] - lo[1]) / 3.14159265;
}

/// Gathers with the support's own radius or, where too few samples are in it, with up to twice that (the parent's ball).
float gather_enough(const Fitter& fitter, int level, std::uint32_t cell, const SampleTree::Neighbours& own,
                    const SampleTree::Neighbours& parents, Workspace& ws) {
  const Vec3f c = fitter.center(level, cell);
  const float radius = fitter.support_radius(level);
  const auto enough = static_cast<std::size_t>(fitter.options.min_samples);
  gather(fitter.tree, level, own, c, radius, ws);
  if (ws.ids.size() >= enough || level == 0) return 1;
  for (const float reach : {1.41f, 2.0f}) {
    gather(fitter.tree, level - 1, parents, c, reach * radius, ws);
    if (ws.ids.size() >= enough) return reach;
  }
  return 0;
}

int highest_degree(const PartitionOptions& options, const DegreeFits& fits, const LocalSamples& samples) {
  const double k = coverage(samples);
  int d = fits.highest;
  while (d > 1 && k < options.coverage[static_cast<std::size_t>(d)]) --d;
  return d;
}

Trial try_block(const Fitter& fitter, int level, std::uint32_t cell, const SampleTree::Neighbours& own,
                const SampleTree::Neighbours& parents, Workspace& ws) {
  Trial trial;
  std::size_t near = 0;
  const auto& begin = fitter.tree.level(level).begin;
  for (const std::int32_t n : own)
    if (n >= 0) near += begin[static_cast<std::size_t>(n) + 1] - begin[static_cast<std::size_t>(n)];
  if (near > 2 * static_cast<std::size_t>(fitter.options.max_samples)) return trial;  // case (iii)
  trial.reach = gather_enough(fitter, level, cell, own, parents, ws);
  if (trial.reach == 0 || ws.ids.size() > static_cast<std::size_t>(fitter.options.max_samples)) return trial;
  LocalFunction f;
  const float scale = trial.reach * fitter.support_radius(level);
  trial.dropped = make_local(fitter.tree, fitter.center(level, cell), scale, ws, f);
  const DegreeFits fits = fit_all_degrees(ws.samples, fitter.options.max_degree);
  trial.highest = static_cast<std::int8_t>(highest_degree(fitter.options, fits, ws.samples));
  trial.effective_count = static_cast<float>(fits.effective_count);
  for (int d = 0; d <= trial.highest; ++d) {
    const auto k = static_cast<std::size_t>(d);
    trial.mean_square[k] = static_cast<float>(fits.mean_square[k]) * scale * scale;
  }
  return trial;
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

PartitionOfUnity fit_partition_of_unity(const PointSet& points, const PartitionOptions& options, FarField far_field,
                                        Progress& progress) {
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
  state->far_field = std::move(far_field);

  progress.begin("sort samples");
  // Deep enough that the finest occupied cells hold about one sample even where the cloud is densest.
  const int sort_depth = std::clamp(options.max_depth.value_or(static_cast<int>(std::ceil(0.5 * std::log2(static_cast<double>(points.size())) + 1.5))), 3, 14);
  const SampleTree tree(points.positions, points.normals, state->lower, state->edge, sort_depth);

  // The finest level tried is the last on which a sample typically still has company enough for a quadratic fit.
  int finest = 2;
  for (int l = 2; l <= sort_depth; ++l) {
    const auto& begin = tree.level(l).begin;
    double mean = 0;
    for (std::size_t c = 0; c + 1 < begin.size(); ++c) mean += std::pow(static_cast<double>(begin[c + 1] - begin[c]), 2);
    if (mean / static_cast<double>(points.size()) < 4.0 && l > 2 && !options.max_depth) break;
    finest = l;
  }
  const Fitter fitter{tree, options};
  const auto levels = static_cast<std::size_t>(finest) + 1;
  std::vector<std::vector<Trial>> trials(levels);
  std::vector<std::vector<SampleTree::Neighbours>> neighbours(levels);
  std::size_t work = 0;
  for (std::size_t l = 0; l < levels; ++l) work += tree.level(static_cast<int>(l)).size();
  progress.begin("fit", work);
  neighbours[0] = {tree.root_neighbours()};
  for (int l = 0; l <= finest; ++l) {
    const auto at = static_cast<std::size_t>(l);
    const std::size_t count = tree.level(l).size();
    trials[at].resize(count);
    std::vector<std::uint32_t> parent(count, 0);
    if (l > 0) {
      neighbours[at].resize(count);
      const auto& child = tree.level(l - 1).child;
      parallel_for(0, tree.level(l - 1).size(), 256, [&](std::size_t p) {
        for (std::uint32_t c = child[p]; c < child[p + 1]; ++c) {
          parent[c] = static_cast<std::uint32_t>(p);
          neighbours[at][c] = tree.child_neighbours(l - 1, neighbours[at - 1][p], c);
        }
      });
    }
    parallel_ranges(0, count, 128, [&](std::size_t first, std::size_t last) {
      Workspace ws;
      for (std::size_t c = first; c < last; ++c)
        trials[at][c] = try_block(fitter, l, static_cast<std::uint32_t>(c), neighbours[at][c],
                                  l > 0 ? neighbours[at - 1][parent[c]] : neighbours[at][c], ws);
      progress.advance(last - first);
    });
  }

  // Noise. On the finest level a quadratic follows the surface, so what is left over is noise (or facets, creases).
  progress.begin("choose scale");
  for (int l = finest; l >= 0; --l) {
    const auto at = static_cast<std::size_t>(l);
    parallel_for(0, trials[at].size(), 1024, [&](std::size_t c) {
      Trial& t = trials[at][c];
      if (l < finest) {
        const auto& child = tree.level(l).child;
        const auto& begin = tree.level(l + 1).begin;
        double sum = 0, n = 0;
        for (std::uint32_t k = child[c]; k < child[c + 1]; ++k) {
          const double m = begin[k + 1] - begin[k];
          if (trials[at + 1][k].noise >= 0) sum += m * trials[at + 1][k].noise, n += m;
        }
        t.noise = n > 0 ? static_cast<float>(sum / n) : -1;
        return;
      }
      double sum = 0, n = 0;
      for (const std::int32_t k : neighbours[at][c]) {
        if (k < 0) continue;
        const Trial& o = trials[at][static_cast<std::size_t>(k)];
        const int d = std::min<int>(o.highest, 2);
        if (d < 1 || o.reach != 1) continue;
        const double p = kBasisSize[static_cast<std::size_t>(d)];
        const double dof = o.effective_count - p;
        if (dof < 1) continue;
        sum += o.mean_square[static_cast<std::size_t>(d)] * o.effective_count;
        n += dof;
      }
      t.noise = n > 0 ? static_cast<float>(sum / n) : -1;
    });
  }
  std::vector<float> noises;
  for (const Trial& t : trials[static_cast<std::size_t>(finest)])
    if (t.noise >= 0) noises.push_back(t.noise);
  double variance = 0;
  if (!noises.empty()) {
    std::nth_element(noises.begin(), noises.begin() + static_cast<std::ptrdiff_t>(noises.size() / 2), noises.end());
    variance = noises[noises.size() / 2];
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
        const float p = static_cast<float>(kBasisSize[k]), n = t.effective_count;
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
        const float p = static_cast<float>(kBasisSize[k]);
        const float risk = std::max(sum / n, noise * p / t.effective_count);
        if (risk < t.risk * (d > 1 ? 0.98f : 1.0f)) t.risk = risk, t.degree = static_cast<std::uint8_t>(d);
      }
      t.best = t.risk;
      t.leaf = true;
      if (l == finest) return;
      const auto& child = tree.level(l).child;
      const auto& begin = tree.level(l + 1).begin;
      double sum = 0, n = 0;
      bool viable = true;
      for (std::uint32_t k = child[c]; k < child[c + 1]; ++k) {
        const double m = begin[k + 1] - begin[k];
        viable = viable && trials[at + 1][k].best < kInfinite;
        sum += m * trials[at + 1][k].best, n += m;
      }
      const auto below = static_cast<float>(sum / n);
      const bool wanted = t.risk > accepted * accepted && below < 0.9f * t.risk;
      if (viable && (wanted || t.risk == kInfinite)) t.leaf = false, t.best = below;
    });
  }

  // Leaves from the top; blocks that no fit could serve inherit nothing: their neighbours' supports or the far field do.
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
  parallel_ranges(0, leaves.size(), 128, [&](std::size_t first, std::size_t last) {
    Workspace ws;
    for (std::size_t i = first; i < last; ++i) {
      const Leaf& leaf = leaves[i];
      const auto at = static_cast<std::size_t>(leaf.level);
      const Trial& t = trials[at][leaf.cell];
      const Vec3f c = fitter.center(leaf.level, leaf.cell);
      const float radius = fitter.support_radius(leaf.level);
      if (t.reach == 1) {
        gather(tree, leaf.level, neighbours[at][leaf.cell], c, radius, ws);
      } else {
        const std::int64_t parent = tree.find(leaf.level - 1, leaf.order >> 3);
        gather(tree, leaf.level - 1, neighbours[at - 1][static_cast<std::size_t>(parent)], c, t.reach * radius, ws);
      }
      LocalFunction& f = state->functions[i];
      make_local(tree, c, t.reach * radius, ws, f);
      f.radius = radius;
      f.degree = t.degree;
      f.coefficient = monomial_coefficients(fit_all_degrees(ws.samples, t.degree), t.degree);
      state->heads[i] = static_cast<std::uint32_t>(i);
      state->level[i] = static_cast<std::uint8_t>(leaf.level);
      state->cell[i] = leaf.order;
    }
    progress.advance(last - first);
  });
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
