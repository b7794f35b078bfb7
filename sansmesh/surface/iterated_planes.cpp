#include "sansmesh/surface/iterated_planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/search/ball_tree.h"
#include "sansmesh/surface/sample_group.h"

namespace sansmesh::inline v1::detail {
namespace {

double laguerre(int order, double r) {
  if (order == 2) return 1;
  if (order == 4) return 2.5 - r;
  return 4.375 + r * (0.5 * r - 3.5);
}
double laguerre_mean(int order) { return order == 2 ? 1 : order == 4 ? 1.5 : 1.875; }

/// Rows of A: the generating functions at a sample, divided by the sum of the Gaussians there.
class Rows {
 public:
  struct Entry {
    std::uint32_t column;
    float value;
  };

  Rows(const SurfaceSamples& samples, const std::vector<float>& widths, const IterationOptions& options)
      : samples_(samples), widths_(widths), options_(options) {
    std::vector<float> radii = widths;
    for (float& r : radii) r *= static_cast<float>(std::sqrt(double{kGaussianEnd}));
    tree_ = BallTree(samples.positions, radii);
  }

  /// Generating functions at a sample.
  void row(std::uint32_t i, std::vector<Entry>& out) const { row(samples_.positions[i], samples_.normals[i], out); }
  /// The same at any point x of the surface with normal n.
  void row(const Vec3f& x, const Vec3f& n, std::vector<Entry>& out) const {
    thread_local std::vector<std::uint32_t> near;
    Box3f box;
    box.extend(x);
    tree_.touching(box, near);
    out.clear();
    double sum = 0;
    for (const std::uint32_t j : near) {
      const Vec3f d = x - samples_.positions[j];
      const double width = static_cast<double>(widths_[j]);
      const double r = static_cast<double>(squared_norm(d)) / (width * width);
      if (r >= double{kGaussianEnd}) continue;
      // Area of the sample and selection of its sheet, as in the kernels.
      const double s = options_.alike ? 1 : static_cast<double>(samples_.spacing[j]);
      double weight = std::exp(-r) * s * s;
      if (options_.separate_sheets)
        weight *= std::clamp(1 + 2 * static_cast<double>(dot(n, samples_.normals[j])), 0.0, 1.0);
      if (!(weight > 0)) continue;
      sum += weight;
      out.push_back({j, static_cast<float>(weight * laguerre(options_.order, r))});
    }
    const auto scale = static_cast<float>(1 / (sum * laguerre_mean(options_.order)));
    for (Entry& e : out) e.value *= scale;
  }

 private:
  const SurfaceSamples& samples_;
  const std::vector<float>& widths_;
  const IterationOptions& options_;
  BallTree tree_;
};

constexpr std::size_t kLeftOut = 100;  // number of samples left out in turn
constexpr double kMostEntries = 5e8;   // largest number of entries of the matrix: 4 GB
constexpr int kMostIterations = 10;
constexpr float kForget = 2e-4f;   // smaller entries of the powers' rows are dropped
constexpr double kWorthIt = 0.99;  // more iterations must reduce the error to below this share

/// If noise is large against the width, the neighbours of a sample off the surface are off it in the same direction:
/// the surface seems to follow the noise. Therefore the others are evaluated at the sample's foot on a mean plane.
constexpr double kFootWidth = 2.5;   // width of the weights of the mean, over the spacing
constexpr double kFootNoise = 0.05;  // over the spacing: with less noise the sample itself is used

Vec3f foot_of(const SurfaceSamples& s, std::uint32_t i) {
  const Vec3f x = s.positions[i];
  if (s.noise < kFootNoise * s.median_spacing) return x;
  const float width = static_cast<float>(kFootWidth) * s.spacing[i];
  std::vector<Neighbour> near;
  s.tree.within(x, 2 * width, near);
  Vec3f mean, normal;
  float sum = 0;
  for (const Neighbour& j : near) {
    const float w =
        std::max(0.0f, dot(s.normals[i], s.normals[j.index])) * std::exp(-j.squared_distance / (width * width));
    mean += w * (s.positions[j.index] - x), normal += w * s.normals[j.index];
    sum += w;
  }
  normal = normalized(normal);
  return sum > 0 ? x + normal * dot(mean / sum, normal) : x;
}

/// Leave-one-out errors at one sample for n = 0, 1, … iterations.
class LeaveOneOut {
 public:
  LeaveOneOut(const SurfaceSamples& samples, const Rows& rows) : samples_(samples), rows_(rows) {}

  std::array<double, kMostIterations + 1> errors(std::uint32_t left_out, int most) {
    std::array<double, kMostIterations + 1> result{};
    rows_of_.clear();
    // v: the generating functions at the foot, times (I − A)^n; their sums are the weights of the samples' planes.
    std::vector<Rows::Entry> start;
    rows_.row(foot_of(samples_, left_out), samples_.normals[left_out], start);
    std::unordered_map<std::uint32_t, double> v, next, total;
    for (const Rows::Entry& e : start) v[e.column] = static_cast<double>(e.value);
    for (int n = 0; n <= most; ++n) {
      double sum = 0, weights = 0;
      for (const auto& [j, value] : v) total[j] += value;
      for (const auto& [j, value] : total) {
        if (j == left_out) continue;  // left out: the others replace its weight
        weights += value;
        sum += value * dot(Vec3(samples_.positions[left_out] - samples_.positions[j]), Vec3(samples_.normals[j]));
      }
      // Undefined where the others do not reach.
      result[static_cast<std::size_t>(n)] = weights > 0.05 ? sum / weights : std::numeric_limits<double>::quiet_NaN();
      next = v;
      for (const auto& [l, value] : v)
        for (const Rows::Entry& e : row(l)) next[e.column] -= value * static_cast<double>(e.value);
      std::erase_if(next, [](const auto& item) { return std::abs(item.second) < static_cast<double>(kForget); });
      v.swap(next);
    }
    return result;
  }

 private:
  const std::vector<Rows::Entry>& row(std::uint32_t i) {
    auto [at, fresh] = rows_of_.try_emplace(i);
    if (fresh) rows_.row(i, at->second);
    return at->second;
  }

  const SurfaceSamples& samples_;
  const Rows& rows_;
  std::unordered_map<std::uint32_t, std::vector<Rows::Entry>> rows_of_;
};

/// Root mean square without the largest tenth.
double robust_error(std::vector<double> squares) {
  std::erase_if(squares, [](double v) { return !std::isfinite(v); });
  if (squares.empty()) return std::numeric_limits<double>::infinity();
  std::sort(squares.begin(), squares.end());
  const std::size_t kept = squares.size() - squares.size() / 10;
  double sum = 0;
  for (std::size_t i = 0; i < kept; ++i) sum += squares[i];
  return std::sqrt(sum / static_cast<double>(kept));
}

}  // namespace

IteratedPlanes iterate_planes(const SurfaceSamples& samples, const std::vector<float>& widths,
                              const IterationOptions& options, Progress& progress) {
  const std::size_t n = samples.size();
  IteratedPlanes result{samples.normals, std::vector<float>(n, 0)};
  if (options.iterations == 0) return result;
  progress.begin("iterate", static_cast<std::size_t>(options.iterations) + 1);
  const Rows rows(samples, widths, options);
  constexpr std::size_t kProbes = 64;
  std::vector<Rows::Entry> probe;
  double entries = 0;
  for (std::size_t k = 0; k < std::min(kProbes, n); ++k) {
    rows.row(static_cast<std::uint32_t>(k * n / std::min(kProbes, n)), probe);
    entries += static_cast<double>(probe.size());
  }
  entries *= static_cast<double>(n) / static_cast<double>(std::min(kProbes, n));
  if (entries > kMostEntries)
    throw DataError("the weights are so wide that the matrix of the iteration would need " +
                    std::to_string(static_cast<int>(entries * sizeof(Rows::Entry) / 1e9)) +
                    " GB: choose a smaller width or no iterations");
  // The matrix in blocks of rows, which are built in parallel and keep their memory.
  constexpr std::size_t kBlock = 1024;
  struct Block {
    std::vector<std::uint32_t> first;
    std::vector<Rows::Entry> entries;
  };
  std::vector<Block> blocks((n + kBlock - 1) / kBlock);
  parallel_for(0, blocks.size(), 1, [&](std::size_t b) {
    std::vector<Rows::Entry> row;
    Block& block = blocks[b];
    block.first.push_back(0);
    for (std::size_t i = b * kBlock; i < std::min(n, (b + 1) * kBlock); ++i) {
      rows.row(static_cast<std::uint32_t>(i), row);
      block.entries.insert(block.entries.end(), row.begin(), row.end());
      block.first.push_back(static_cast<std::uint32_t>(block.entries.size()));
    }
  });
  progress.advance();
  // g ← g + f − A g, starting with g = f, gives Σ_k (I − A)^k f. Four right-hand sides at once.
  using Four = std::array<double, 4>;
  std::vector<Four> f(n), g, next(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 x(samples.positions[i]), normal(samples.normals[i]);
    f[i] = {normal.x, normal.y, normal.z, dot(x, normal)};
  }
  g = f;
  for (int k = 0; k < options.iterations; ++k) {
    parallel_for(0, blocks.size(), 1, [&](std::size_t b) {
      for (std::size_t r = 0; r + 1 < blocks[b].first.size(); ++r) {
        const std::size_t i = b * kBlock + r;
        Four sum{};
        for (std::uint32_t e = blocks[b].first[r]; e < blocks[b].first[r + 1]; ++e) {
          const auto [column, value] = blocks[b].entries[e];
          for (std::size_t c = 0; c < 4; ++c) sum[c] += static_cast<double>(value) * g[column][c];
        }
        for (std::size_t c = 0; c < 4; ++c) next[i][c] = g[i][c] + f[i][c] - sum[c];
      }
    });
    g.swap(next);
    progress.advance();
  }
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 m{g[i][0], g[i][1], g[i][2]};
    result.m[i] = Vec3f(m);
    result.offset[i] = static_cast<float>(g[i][3] - dot(Vec3(samples.positions[i]), Vec3(result.m[i])));
  }
  progress.finish();
  return result;
}

IterationChoice choose_iterations(const SurfaceSamples& samples, const IterationOptions& options, double smoothing,
                                  int iterations) {
  const bool clean = samples.noise < kFootNoise * samples.median_spacing;
  std::vector<double> candidates{1.25, 1.6, 2, 2.5, 3.2};
  // Leaving single samples out does not reveal errors in the gaps between random samples.
  if (clean)
    candidates = unevenness(samples) < 0.5 ? std::vector<double>{0.8, 1, 1.25, 1.6} : std::vector<double>{1.25, 1.6, 2};
  if (smoothing > 0) candidates = {smoothing};
  const int most = iterations >= 0 ? std::min(iterations, kMostIterations) : kMostIterations;
  const std::size_t count = std::min(kLeftOut, samples.size());
  IterationChoice best;
  best.error = std::numeric_limits<double>::infinity();
  for (const double factor : candidates) {
    std::vector<float> widths = samples.spacing;
    if (options.alike) std::fill(widths.begin(), widths.end(), static_cast<float>(samples.median_spacing));
    for (float& w : widths) w *= static_cast<float>(factor);
    const Rows rows(samples, widths, options);
    std::vector<std::array<double, kMostIterations + 1>> errors(count);
    parallel_for(0, count, 4, [&](std::size_t p) {
      LeaveOneOut leave(samples, rows);
      errors[p] = leave.errors(static_cast<std::uint32_t>(p * samples.size() / count), most);
      const auto spacing = static_cast<double>(samples.spacing[p * samples.size() / count]);
      for (double& e : errors[p]) e = e * e / (spacing * spacing);
    });
    for (int n = iterations >= 0 ? most : 0; n <= most; ++n) {
      std::vector<double> squares;
      squares.reserve(errors.size());
      for (const auto& e : errors) squares.push_back(e[static_cast<std::size_t>(n)]);
      const double error = robust_error(std::move(squares));
      if (error < kWorthIt * best.error) best = {options.order, factor, iterations >= 0 ? iterations : n, error};
    }
  }
  best.error *= samples.median_spacing;
  return best;
}

}  // namespace sansmesh::inline v1::detail
