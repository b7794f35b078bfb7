#include "sansmesh/points/cleaning/outliers.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/points/normals/normals.h"
#include "sansmesh/points/shape/principal_axes.h"
#include "sansmesh/points/statistics/noise.h"
#include "sansmesh/points/statistics/spacing.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kNeighbours = 10;
/// Samples closer than this many local spacings are connected.
constexpr float kReachOfStrays = 4;
/// Ratio of the deviations across and along the best plane above which neighbours do not look like a surface; samples
/// distributed evenly in space have about 0.6.
constexpr double kScattered = 0.4;
/// Dimension of a group of samples from which it fills space; sparsely sampled surfaces have 1.5 to 2.5, clutter 3 and
/// more.
constexpr double kFillsSpace = 2.75;
/// Margin of the inverse dimension of one sample, which varies: 1.5 standard deviations.
constexpr double kDimensionMargin = 0.18;
/// Separate clusters of at most this share of the cloud are outliers if they look scattered.
constexpr double kSmallPart = 0.05;
/// Least number of samples for the reference surface of a sample.
constexpr int kFewestAround = 32;
/// Ratio of distances to the neighbours and between them from which a sample may be off the surface.
constexpr float kSparser = 1.3f;
/// Below this noise (over the spacing), a sample whose neighbours do not look like a surface may be off it, too.
constexpr double kThickNoise = 0.35;
/// Least height of a sample off the surface, in local spacings: smaller deviations are poorly sampled details.
constexpr float kOffByAtLeast = 1.5f;
/// Share of a sample's height above which other samples are beside it: a spike, a rib, another sheet.
constexpr double kBesidePlane = 0.6;
constexpr int kPlaneRounds = 3;
/// In quantised coordinates, samples within this many steps are adjacent.
constexpr double kStepsBeside = 2;

bool looks_scattered(std::span<const Vec3f> offsets) {
  const Vec3 variance = principal_axes(moments(offsets).covariance).values;
  return variance.x > kScattered * kScattered * variance.y;
}

bool looks_scattered(const KdTree& tree, std::span<const std::uint32_t> neighbours) {
  std::vector<Vec3f> offsets;
  for (const std::uint32_t other : neighbours) offsets.push_back(tree.position(other) - tree.position(neighbours[0]));
  return looks_scattered(offsets);
}

/// Robust plane: samples far from it have no influence.
struct RobustPlane {
  Vec3 normal, through;
  double deviation = 0;  ///< deviation of the heights, from their median

  double height(const Vec3f& at) const { return dot(Vec3(at) - through, normal); }

  explicit RobustPlane(std::span<const Vec3f> points) {
    std::vector<double> weights(points.size(), 1), heights;
    for (int round = 0; round < kPlaneRounds; ++round) {
      double total = 0;
      through = {};
      for (std::size_t i = 0; i < points.size(); ++i) through += Vec3(points[i]) * weights[i], total += weights[i];
      if (!(total > 0)) return;
      through = through / total;
      Symmetric3 spread;
      for (std::size_t i = 0; i < points.size(); ++i) spread.add(Vec3(points[i]) - through, weights[i]);
      normal = smallest_axis(spread);
      heights.clear();
      for (const Vec3f& p : points) heights.push_back(std::abs(height(p)));
      std::vector<double> sorted = heights;
      deviation = kDeviationOverMedian * median(sorted);
      for (std::size_t i = 0; i < points.size(); ++i) {  // Geman–McClure
        const double t = heights[i] / (3 * deviation + 1e-30), w = 1 / (1 + t * t);
        weights[i] = w * w;
      }
    }
  }
};

/// Search for outliers; samples are numbered by their slots in the tree.
class OutlierSearch {
 public:
  OutlierSearch(const PointSet& points, const KdTree& tree, const OutlierOptions& options)
      : points_(points),
        tree_(tree),
        options_(options),
        n_(tree.size()),
        small_(static_cast<std::uint32_t>(kSmallPart * static_cast<double>(n_))) {}

  /// Local spacing: mean distance to the neighbours that are not duplicates.
  void measure_spacing() {
    neighbours_.resize(n_ * kFound);
    spacing_.resize(n_);
    tree_.for_each_nearest(kFound, [&](std::uint32_t s, std::span<const Neighbour> found) {
      float sum = 0;
      int count = 0;
      for (std::size_t k = 0; k < kFound; ++k) {
        neighbours_[s * kFound + k] = found[k].index;
        if (found[k].squared_distance > 0) sum += std::sqrt(found[k].squared_distance), ++count;
      }
      spacing_[s] = count > 0 ? sum / static_cast<float>(count) : 0;
    });
    measured_ = measure_noise(points_);
    beside_steps_ = static_cast<float>(kStepsBeside * measured_.step);
  }

  /// Isolated samples: much farther from their neighbours than these are from theirs; or in a region that is sparse
  /// relative to the cloud and not a surface, as in a thin cloud of stray samples that are neighbours of each other.
  void find_isolated() {
    std::vector<float> sorted = spacing_;
    const float isolation = static_cast<float>(options_.isolation), sparse = isolation * median(sorted);
    isolated_.resize(n_);
    around_.resize(n_);
    parallel_ranges(0, n_, 8192, [&](std::size_t first, std::size_t last) {
      std::vector<float> others;
      for (std::size_t s = first; s < last; ++s) {
        others.clear();
        for (const std::uint32_t other : nearest(s))
          if (other != s) others.push_back(spacing_[other]);
        around_[s] = median(others);
        if (spacing_[s] < beside_steps_) continue;
        isolated_[s] = around_[s] > 0 && spacing_[s] > isolation * around_[s];
        if (!isolated_[s] && spacing_[s] > sparse) isolated_[s] = looks_scattered(tree_, nearest(s));
      }
    });
    keep_sparse_surfaces();
  }

  /// Connects samples that are close together, without isolated ones, so that clusters with few samples show.
  void find_clusters() {
    UnionFind clusters(n_);
    for (std::uint32_t s = 0; s < n_; ++s) {
      if (isolated_[s]) continue;
      for (const std::uint32_t other : nearest(s)) {
        if (isolated_[other]) continue;
        const float reach = std::max(kReachOfStrays * std::min(around_[s], around_[other]), beside_steps_);
        if (squared_distance(tree_.position(s), tree_.position(other)) > reach * reach) continue;
        clusters.join(s, other);
      }
    }
    cluster_.resize(n_);
    members_.resize(n_);
    for (std::uint32_t s = 0; s < n_; ++s) ++members_[cluster_[s] = clusters.find(s)];
  }

  /// Samples off the surface, and those of small clusters that do not look like a surface; both in neighbourhoods wide
  /// enough to show the surface despite the noise.
  void find_strays() {
    const double noise = measured_.deviation, typical = estimate_spacing(points_);
    const bool thick = noise > kThickNoise * typical;
    const std::size_t wide = static_cast<std::size_t>(std::max(choose_neighbours(typical, noise), kFewestAround)) + 1;
    scattered_.resize(n_);
    off_.resize(n_);
    parallel_ranges(0, n_, 1024, [&](std::size_t first, std::size_t last) {
      std::vector<Neighbour> found(wide);
      std::vector<Vec3f> offsets;
      for (std::size_t s = first; s < last; ++s) {
        if (isolated_[s]) continue;
        const bool part = members_[cluster_[s]] <= small_;
        const bool sparser = spacing_[s] > kSparser * around_[s] && around_[s] > 0;
        const bool rough = !thick && !sparser && looks_scattered(tree_, nearest(s));
        if (!part && !sparser && !rough) continue;
        const Vec3f center = tree_.position(s);
        const std::size_t count = tree_.nearest(center, found);
        offsets.clear();
        for (const Neighbour& other : std::span(found).first(count))
          if (other.squared_distance > 0) offsets.push_back(points_.positions[other.index] - center);
        if (offsets.size() < kNeighbours) continue;
        // A rod is not flat for many neighbours, a noisy sheet not for few; neither is scattered.
        const bool shown = norm(offsets.back()) > 2 * beside_steps_;
        if (part && shown) scattered_[s] = looks_scattered(tree_, nearest(s)) && looks_scattered(offsets);
        if (sparser || rough) off_[s] = is_off_surface(offsets, around_[s]);
      }
    });
  }

  /// 1 for the outliers among the finite samples.
  void mark(std::vector<std::uint8_t>& mask) const {
    std::vector<std::uint32_t> strays(n_);  // scattered samples per cluster
    for (std::uint32_t s = 0; s < n_; ++s) strays[cluster_[s]] += scattered_[s];
    const auto no_surface = [&](std::uint32_t c) {
      return members_[c] < options_.min_cluster || (members_[c] <= small_ && 2 * strays[c] > members_[c]);
    };
    for (std::uint32_t s = 0; s < n_; ++s)
      if (isolated_[s] || off_[s] || no_surface(cluster_[s])) mask[tree_.order()[s]] = 1;
  }

 private:
  static constexpr std::size_t kFound = kNeighbours + 1;

  std::span<const std::uint32_t> nearest(std::size_t s) const {
    return std::span(neighbours_).subspan(s * kFound, kFound);
  }

  /// Inverse of the dimension in which a sample's neighbours are distributed: ½ on average on a surface, ⅓ in space
  /// (levina2005).
  double inverse_dimension(std::size_t s) const {
    const std::span<const std::uint32_t> found = nearest(s);
    const Vec3f center = tree_.position(s);
    const double farthest = squared_distance(center, tree_.position(found.back()));
    double sum = 0;
    int count = 0;
    for (const std::uint32_t other : found.first(kNeighbours)) {
      const double square = squared_distance(center, tree_.position(other));
      if (square > 0) sum += 0.5 * std::log(farthest / square), ++count;
    }
    return count > 0 ? sum / count : 0;
  }

  /// Sparse parts of a surface, where the density of the samples varies, are also farther apart than most samples, and
  /// may look scattered. Unlike clutter, connected groups of them do not fill space.
  void keep_sparse_surfaces() {
    UnionFind groups(n_);
    for (std::uint32_t s = 0; s < n_; ++s)
      if (isolated_[s])
        for (const std::uint32_t other : nearest(s))
          if (isolated_[other]) groups.join(s, other);
    std::vector<double> spread(n_);
    std::vector<std::uint32_t> size(n_);
    for (std::uint32_t s = 0; s < n_; ++s) {
      if (!isolated_[s]) continue;
      const std::uint32_t group = groups.find(s);
      spread[group] += inverse_dimension(s), ++size[group];
    }
    for (std::uint32_t s = 0; s < n_; ++s) {
      const std::uint32_t group = groups.find(s);
      const double least = size[group] / kFillsSpace + kDimensionMargin * std::sqrt(size[group]);
      if (isolated_[s] && spread[group] >= least) isolated_[s] = 0;
    }
  }

  bool is_off_surface(std::span<const Vec3f> offsets, float around) const {
    const RobustPlane plane(offsets);
    const double height = plane.height({});
    if (std::abs(height) < options_.height * plane.deviation) return false;
    if (std::abs(height) < static_cast<double>(std::max(kOffByAtLeast * around, beside_steps_))) return false;
    const auto beside = std::count_if(offsets.begin(), offsets.end(), [&](const Vec3f& o) {
      return plane.height(o) * height > kBesidePlane * height * height &&
             static_cast<double>(norm(o)) < std::abs(height);
    });
    return static_cast<std::size_t>(beside) + 1 < options_.min_cluster;
  }

  const PointSet& points_;
  const KdTree& tree_;
  const OutlierOptions& options_;
  std::size_t n_;
  std::uint32_t small_;  ///< most members of a small cluster
  NoiseEstimate measured_;
  float beside_steps_ = 0;                 ///< distance of samples that quantised coordinates do not separate
  std::vector<std::uint32_t> neighbours_;  ///< kFound per sample
  std::vector<float> spacing_, around_;    ///< own value of each sample, and the typical one of its neighbours
  std::vector<std::uint32_t> cluster_, members_;
  std::vector<std::uint8_t> isolated_, scattered_, off_;
};

}  // namespace

void OutlierOptions::validate() const {
  if (!(isolation > 1)) throw ArgumentError("`isolation` is " + std::to_string(isolation) + "; it must exceed 1");
  if (!(height > 1)) throw ArgumentError("`height` is " + std::to_string(height) + "; it must exceed 1");
}

std::vector<std::uint8_t> find_outliers(const PointSet& points, const OutlierOptions& options, Progress& progress) {
  options.validate();
  std::vector<std::uint8_t> mask(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) mask[i] = !is_finite(points.positions[i]);
  const std::vector<std::uint8_t> non_finite = mask;
  progress.begin("outliers", 2 * points.size());
  const KdTree tree(points.positions);
  if (tree.size() >= std::max<std::size_t>(options.min_cluster, kNeighbours + 2)) {
    OutlierSearch search(points, tree, options);
    search.measure_spacing();
    progress.advance(points.size());
    search.find_isolated();
    search.find_clusters();
    search.find_strays();
    search.mark(mask);
    // A cloud that consists of tiny clusters only is sparse.
    if (2 * static_cast<std::size_t>(std::count(mask.begin(), mask.end(), 1)) > points.size()) mask = non_finite;
  }
  progress.finish();
  return mask;
}

}  // namespace sansmesh::inline v1
