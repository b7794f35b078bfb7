#include "sansmesh/surface/lop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/check_range.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/scramble.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/points/cleaning/outliers.h"
#include "sansmesh/points/normals/normals.h"
#include "sansmesh/points/shape/principal_axes.h"
#include "sansmesh/points/statistics/noise.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kReachOfTheta = 0.65;  ///< θ(0.65 h) = 0.001: radius of the neighbourhoods over h
constexpr double kMargin =
    0.15;  ///< extra radius of the lists of neighbours over h; lists stay valid until points have moved half of it
/// Distances are rounded off below this many h. Otherwise a point next to a sample would stay there, and if there are
/// more points than samples they would gather at those.
constexpr double kRound = 0.15;
constexpr double kStepAtRest = 0.003;  ///< root mean square step, in spacings of the result, that ends the iteration
constexpr std::size_t kGrain = 512;
constexpr std::size_t kAreaNeighbours = 12;
/// A sample whose area exceeds that of its neighbours by this factor is off the surface.
constexpr float kMostArea = 2;
constexpr std::size_t kTableSize = 2048;
/// A heap has more than `kHeap` samples in a cube of this many h. Ordinary clouds have none.
constexpr double kHeapSize = 1.0 / 1024;
constexpr std::size_t kHeap = kAreaNeighbours + 1;
constexpr std::size_t kMostListed = std::size_t{1} << 26;  ///< neighbours in lists (256 MiB); beyond, they are searched

/// Uniform in (0, 1).
double uniform(std::uint64_t seed, std::uint64_t i) {
  return (static_cast<double>(scrambled(scrambled(seed) ^ i) >> 11) + 0.5) * 0x1p-53;
}

/// Neighbours of each of many points within a radius: stored in one array, or searched on demand if they exceed the
/// memory limit.
class Lists {
 public:
  Lists() = default;
  Lists(const KdTree& tree, std::span<const Vec3> x, float radius) : tree_(&tree), radius_(radius) {
    first_.assign(x.size() + 1, 0);
    parallel_for(0, x.size(), kGrain, [&](std::size_t i) { first_[i + 1] = tree.count_within(Vec3f(x[i]), radius); });
    for (std::size_t i = 0; i < x.size(); ++i) first_[i + 1] += first_[i];
    if (first_.back() > kMostListed) {
      positions_.assign(x.begin(), x.end());
      return;
    }
    index_.resize(first_.back());
    parallel_ranges(0, x.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      std::vector<Neighbour> found;
      for (std::size_t i = begin; i < end; ++i) {
        tree.within_by_slot(Vec3f(x[i]), radius, found);
        for (std::size_t k = 0; k < found.size(); ++k) index_[first_[i] + k] = found[k].index;
      }
    });
  }

  /// Calls visit(j) for each neighbour j of point i.
  template <class Visit>
  void each(std::size_t i, const Visit& visit) const {
    if (positions_.empty()) {
      for (std::size_t k = first_[i]; k < first_[i + 1]; ++k) visit(index_[k]);
      return;
    }
    std::vector<Neighbour> found;
    tree_->within_by_slot(Vec3f(positions_[i]), radius_, found);
    for (const Neighbour& n : found) visit(n.index);
  }

 private:
  const KdTree* tree_ = nullptr;
  float radius_ = 0;
  std::vector<std::size_t> first_;
  std::vector<std::uint32_t> index_;
  std::vector<Vec3> positions_;  ///< positions for the search on demand
};

/// A function of the squared distance up to a radius, interpolated between values at even steps: no roots and
/// exponentials, and the same bits on all machines.
class RadialTable {
 public:
  template <class Function>
  RadialTable(double radius, const Function& f) : end_(radius * radius), scale_(kTableSize / end_) {
    for (std::size_t i = 0; i <= kTableSize + 1; ++i) values_[i] = f(static_cast<double>(i) / scale_);
  }
  RadialTable() = default;
  double end() const { return end_; }
  /// For squared distances up to `end`.
  double operator()(double squared) const {
    const double at = squared * scale_;
    const auto i = static_cast<std::size_t>(at);
    return values_[i] + (at - static_cast<double>(i)) * (values_[i + 1] - values_[i]);
  }

 private:
  double end_ = 0, scale_ = 0;
  std::array<double, kTableSize + 2> values_{};
};

class Consolidation {
 public:
  Consolidation(const PointSet& points, const LopOptions& options, Progress& progress) : options_(options) {
    for (const Vec3f& p : points.positions)
      if (is_finite(p)) samples_.push_back(p);
    if (samples_.empty()) throw DataError("there are no finite samples to consolidate");
    samples_ = KdTree(samples_).positions();  // nearby samples become neighbours in memory
    tree_ = KdTree(samples_);
    start(points, progress);
    const auto theta_at = [&](double squared) { return std::exp(-16 * squared / (h_ * h_)); };
    const double reach = kReachOfTheta * h_, near = kRound * h_;
    theta_ = RadialTable(reach, theta_at);
    attraction_ =
        RadialTable(reach, [&](double squared) { return theta_at(squared) / std::sqrt(squared + near * near); });
    repulsion_ = RadialTable(reach, [&](double squared) {
      // −r decreases slowly and evens the points over the whole neighbourhood (huang2009); 1/(3r³) of lipman2007 acts
      // between nearest points.
      const double part = std::max(squared / (h_ * h_), 0.0025);
      return theta_at(squared) * (options_.weighted ? 1 : 1 / (part * part));
    });
  }

  void run(Progress& progress) {
    const auto iterations = static_cast<std::size_t>(options_.iterations);
    progress.begin("consolidate", iterations);
    weigh_samples();
    for (std::size_t iteration = 0; iteration < iterations; ++iteration) {
      const double moved = step();
      progress.advance();
      if (iteration > 0 && moved < kStepAtRest * spacing_) break;
    }
    progress.finish();
  }

  std::vector<Vec3f> result() const {
    std::vector<Vec3f> out;
    out.reserve(x_.size());
    for (const Vec3& x : x_) out.emplace_back(x);
    return out;
  }

 private:
  /// Computes the starting points, the spacing of the result, and h. A sample represents the area π r²/k around it.
  /// Along the order of the tree, a space-filling curve, points start at equal steps of area (of samples, if the
  /// density is to be kept), one at random in each: evenly from the start.
  void start(const PointSet& points, Progress& progress) {
    const std::size_t n = samples_.size(), wanted = options_.points.value_or(std::max<std::size_t>(1, n / 2));
    PointSet finite;
    finite.positions = samples_;
    outlier_ = find_outliers(finite, {}, progress);
    std::vector<float> raw(n), area(n);  // one per sample
    tree_.for_each_nearest(kAreaNeighbours + 1, [&](std::uint32_t slot, std::span<const Neighbour> found) {
      const auto others = static_cast<float>(std::max<std::size_t>(1, found.size() - 1));
      raw[tree_.order()[slot]] = 3.14159265f * found.back().squared_distance / others;
    });
    // Samples off the surface are far from all others, but have no area: no point starts there.
    tree_.for_each_nearest(kAreaNeighbours + 1, [&](std::uint32_t slot, std::span<const Neighbour> found) {
      const std::uint32_t own = tree_.order()[slot];
      std::array<float, kAreaNeighbours + 1> others;
      for (std::size_t k = 0; k < found.size(); ++k) others[k] = raw[tree_.order()[found[k].index]];
      const float usual = median(std::span(others).first(found.size()));
      area[own] = outlier_[own] || raw[own] > kMostArea * usual ? 0 : raw[own];
    });
    std::vector<float> inliers;
    double total = 0, steps = 0;
    std::vector<double> until(n);
    for (std::size_t i = 0; i < n; ++i) {
      const bool inlier = !outlier_[i];
      if (inlier) inliers.push_back(area[i]);
      total += static_cast<double>(area[i]);
      steps += options_.weighted ? static_cast<double>(area[i]) : inlier ? 1.0 : 0.0;
      until[i] = steps;
    }
    if (!(steps > 0)) {  // all coincident, or only outliers
      outlier_.assign(n, 0);
      for (std::size_t i = 0; i < n; ++i) until[i] = static_cast<double>(i + 1);
      steps = static_cast<double>(n);
    }
    std::size_t sample = 0, before = n;
    for (std::size_t i = 0; i < wanted; ++i) {
      const double at = (static_cast<double>(i) + uniform(options_.seed, i)) / static_cast<double>(wanted) * steps;
      while (sample + 1 < n && until[sample] <= at) ++sample;
      Vec3 x(samples_[sample]);
      if (sample == before) {  // the sample already has a point: start beside it
        const Vec3 d{uniform(options_.seed + 1, i) - 0.5, uniform(options_.seed + 2, i) - 0.5,
                     uniform(options_.seed + 3, i) - 0.5};
        x += d * std::sqrt(static_cast<double>(area[sample]));
      }
      before = sample;
      x_.push_back(x);
    }
    spacing_ = std::sqrt(total / static_cast<double>(wanted));
    h_ = options_.radius ? *options_.radius : default_radius(points, std::move(inliers));
    merge_heaps(raw);
  }

  /// `areas`: areas of the samples on the surface.
  double default_radius(const PointSet& points, std::vector<float> areas) const {
    const double sparse = std::sqrt(static_cast<double>(quantile(areas, 0.9)));
    // Wide enough for a few points of the result and a few samples even where they are sparse, and to average noise
    // over more than its own size.
    const double noise = estimate_noise(points);
    const double h = 4 * std::max({1.2 * spacing_, (noise > 0.1 * sparse ? 1.8 : 1.2) * sparse, 2.5 * noise});
    return h > 0 ? h : 1;
  }

  /// Merges the samples of a heap into one of the same total weight, because each of them would be a neighbour of all
  /// others. `raw`: area of each sample.
  void merge_heaps(std::span<const float> raw) {
    const std::size_t n = samples_.size();
    count_.assign(n, 1);
    const double edge = kHeapSize * h_, most = 3.2 * 3 * edge * edge / kAreaNeighbours;
    using Cube = std::array<double, 3>;
    std::vector<std::pair<Cube, std::uint32_t>> close;
    for (std::uint32_t i = 0; i < n; ++i) {
      if (static_cast<double>(raw[i]) > most) continue;
      const Vec3 at = Vec3(samples_[i]) / edge;
      close.push_back({{std::floor(at.x), std::floor(at.y), std::floor(at.z)}, i});
    }
    if (close.size() <= kHeap) return;
    std::sort(close.begin(), close.end());
    bool any = false;
    for (std::size_t begin = 0, end = 0; begin < close.size(); begin = end) {
      while (end < close.size() && close[end].first == close[begin].first) ++end;
      if (end - begin <= kHeap) continue;
      any = true;
      Vec3 sum;
      std::uint8_t outliers = 1;  // only if all are outliers
      for (std::size_t k = begin; k < end; ++k) {
        const std::uint32_t i = close[k].second;
        sum += Vec3(samples_[i]);
        count_[i] = 0;
        outliers &= outlier_[i];
      }
      const std::uint32_t kept = close[begin].second;
      count_[kept] = static_cast<double>(end - begin);
      samples_[kept] = Vec3f(sum / count_[kept]);
      outlier_[kept] = outliers;
    }
    if (!any) return;
    std::size_t left = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (!(count_[i] > 0)) continue;
      samples_[left] = samples_[i], outlier_[left] = outlier_[i], count_[left] = count_[i];
      ++left;
    }
    samples_.resize(left), outlier_.resize(left), count_.resize(left);
    tree_ = KdTree(samples_);
  }

  /// 1 / v_j: reduces the weight of close samples, to compensate for the density along the surface. A sample off the
  /// surface has few others around and must not gain weight by that, so v is at least its mean over the samples around.
  /// Outliers have no weight.
  void weigh_samples() {
    const std::size_t n = samples_.size();
    weights_.resize(n);
    for (std::size_t i = 0; i < n; ++i) weights_[i] = outlier_[i] ? 0 : count_[i];
    if (!options_.weighted) return;
    std::vector<double> density(n);
    const auto over_neighbours = [&](const auto& visit) {
      parallel_ranges(0, n, kGrain, [&](std::size_t first, std::size_t last) {
        std::vector<Neighbour> found;
        for (std::size_t i = first; i < last; ++i) {
          tree_.within_by_slot(samples_[i], static_cast<float>(kReachOfTheta * h_), found);
          visit(i, std::span<const Neighbour>(found));
        }
      });
    };
    const auto theta = [&](const Neighbour& j) {
      return theta_(std::min(static_cast<double>(j.squared_distance), theta_.end()));
    };
    over_neighbours([&](std::size_t i, std::span<const Neighbour> found) {
      for (const Neighbour& j : found) density[i] += count_[j.index] * theta(j);  // the sample itself is the 1 in 1 + Σ
    });
    over_neighbours([&](std::size_t i, std::span<const Neighbour> found) {
      double sum = 0;
      for (const Neighbour& j : found) sum += count_[j.index] * theta(j) * density[j.index];
      weights_[i] /= std::max(density[i], sum / density[i]);
    });
  }

  /// One step; returns the root mean square of the moves.
  double step() {
    if (listed_.empty() || drift_ > 0.5 * kMargin * h_) {
      const auto reach = static_cast<float>((kReachOfTheta + kMargin) * h_);
      near_samples_ = Lists(tree_, x_, reach);
      points_tree_ = KdTree(result());
      near_points_ = Lists(points_tree_, x_, reach);
      drift_ = 0;
      listed_ = x_;
    }
    const std::size_t n = x_.size();
    crowd_.assign(n, 1);
    if (options_.weighted)
      parallel_for(0, n, kGrain, [&](std::size_t i) {
        double crowd = 1;
        near_points_.each(i, [&](std::uint32_t j) {
          if (const double squared = squared_norm(x_[i] - x_[j]); j != i && squared <= theta_.end())
            crowd += theta_(squared);
        });
        crowd_[i] = crowd;
      });
    next_.resize(n);
    parallel_for(0, n, kGrain, [&](std::size_t i) {
      Vec3 attraction;
      Symmetric3 spread;
      double total = 0;
      near_samples_.each(i, [&](std::uint32_t j) {
        const Vec3 d = Vec3(samples_[j]) - x_[i];
        const double squared = squared_norm(d);
        if (squared > attraction_.end()) return;
        const double w = attraction_(squared) * weights_[j];
        attraction += d * w;
        spread.add(d, w);
        total += w;
      });
      next_[i] = x_[i];
      if (!(total > 0)) return;
      next_[i] += attraction / total;
      Vec3 repulsion;
      double pushed = 0;
      near_points_.each(i, [&](std::uint32_t j) {
        if (j == i) return;
        Vec3 d = x_[i] - x_[j];
        if (squared_norm(d) < 1e-12 * h_ * h_) d = apart(i, j) * (1e-6 * h_);
        const double squared = squared_norm(d);
        if (squared > repulsion_.end()) return;
        const double w = crowd_[j] * repulsion_(squared) / std::sqrt(squared);
        repulsion += d * w;
        pushed += w;
      });
      if (!(pushed > 0)) return;
      repulsion = repulsion * (options_.repulsion / pushed);
      // Repel along the surface only: across it, repulsion amplifies the remaining noise by 1 / (1 − μ).
      const Vec3 mean = attraction / total;
      spread.add(mean, -total);
      const Vec3 normal = smallest_axis(spread);
      next_[i] += repulsion - normal * dot(normal, repulsion);
    });
    struct Moved {
      double sum = 0, far = 0;
    };
    const Moved moved = parallel_reduce(
        n, 4096, Moved{},
        [&](std::size_t begin, std::size_t end) {
          Moved m;
          for (std::size_t i = begin; i < end; ++i) {
            m.sum += squared_norm(next_[i] - x_[i]);
            m.far = std::max(m.far, norm(next_[i] - listed_[i]));
          }
          return m;
        },
        [](const Moved& a, const Moved& b) {
          return Moved{a.sum + b.sum, std::max(a.far, b.far)};
        });
    drift_ = moved.far;
    x_.swap(next_);
    return std::sqrt(moved.sum / static_cast<double>(n));
  }

  /// A direction for two coincident points, opposite for each.
  Vec3 apart(std::size_t i, std::size_t j) const {
    const std::uint64_t pair = std::min(i, j) * 0x100000001b3u ^ std::max(i, j);
    const Vec3 d{uniform(1, pair) - 0.5, uniform(2, pair) - 0.5, uniform(3, pair) - 0.5};
    return normalized(d) * (i < j ? 1.0 : -1.0);
  }

  LopOptions options_;
  std::vector<Vec3f> samples_;
  std::vector<double> count_;  ///< number of input samples merged into each
  KdTree tree_, points_tree_;
  std::vector<std::uint8_t> outlier_;
  RadialTable theta_, attraction_, repulsion_;
  std::vector<double> weights_, crowd_;
  std::vector<Vec3> x_, next_, listed_;
  Lists near_samples_, near_points_;
  double spacing_ = 0, h_ = 1, drift_ = 0;
};

/// Normals of the new points with the signs of those of the samples around.
void give_normals(PointSet& result, const PointSet& cloud, Progress& progress) {
  estimate_normals(result, {}, progress);
  const KdTree tree(cloud.positions);
  parallel_ranges(0, result.size(), kGrain, [&](std::size_t first, std::size_t last) {
    std::array<Neighbour, 6> found;
    for (std::size_t i = first; i < last; ++i) {
      const std::size_t n = tree.nearest(result.positions[i], found);
      float side = 0;
      for (std::size_t k = 0; k < n; ++k) {
        const float s = dot(cloud.normals[found[k].index], result.normals[i]);
        if (std::isfinite(s)) side += s;
      }
      if (side < 0) result.normals[i] = -result.normals[i];
    }
  });
}

}  // namespace

const OptionSchema& LopOptions::schema() {
  using O = LopOptions;
  static constexpr OptionRow rows[] = {
      option<&O::radius>({.text = "lop: radius of the neighbourhoods",
                          .unit = "length",
                          .from_data = "from spacing and noise",
                          .range = positive()}),
      option<&O::repulsion>({.text = "lop: strength of the repulsion between points",
                             .unit = "share",
                             .range = {.least = 0, .most = 0.5, .below = true}}),
      option<&O::iterations>(
          {.text = "lop: steps at most, fewer where points come to rest", .range = {1, 1000}, .name = "lop_steps"}),
      option<&O::weighted>({.text = "lop: keep the density of the samples", .negative = "unweighted"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void LopOptions::validate() const {
  validate_options(*this);
  if (points && *points == 0) throw ArgumentError("`points` is 0; it must be at least 1");
  check_range("iterations", iterations, 1, 1000);
}

PointSet consolidate(const PointSet& points, const LopOptions& options, Progress& progress) {
  options.validate();
  const Box3f box = finite_bounds(points.positions);
  const Vec3f size = box.empty() ? Vec3f{} : box.size();
  LocalFrame frame = frame_for(points.origin, static_cast<double>(std::max({size.x, size.y, size.z})));
  frame.reference = points.reference;
  PointSet scaled = points;
  move_from_input(scaled, frame);
  LopOptions inner = options;
  // Neighbourhoods wider than the cloud hold no additional samples.
  if (inner.radius) inner.radius = std::min(frame.from_input(*inner.radius), 2.0);
  Consolidation consolidation(scaled, inner, progress);
  consolidation.run(progress);
  PointSet result;
  result.positions = consolidation.result();
  if (options.normals && points.normals.size() == points.size()) give_normals(result, scaled, progress);
  move_to_input(result, frame);
  return result;
}

}  // namespace sansmesh::inline v1
