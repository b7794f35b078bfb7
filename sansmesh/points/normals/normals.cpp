#include "sansmesh/points/normals/normals.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/points/shape/principal_axes.h"
#include "sansmesh/points/statistics/noise.h"
#include "sansmesh/points/statistics/spacing.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kCleanNeighbours = 10;
constexpr int kMostNeighbours = 240;

/// Fits one neighbourhood at a time, without allocation in the loop.
class NormalFitter {
 public:
  NormalFitter(const KdTree& tree, NormalOptions::Method method, int reweightings, double noise)
      : tree_(tree), method_(method), reweightings_(reweightings), noise_(noise) {}

  /// Unit normal at `slot`; zero if the neighbours coincide.
  Vec3f fit(std::uint32_t slot, std::span<const Neighbour> neighbours) {
    const Vec3f center = tree_.position(slot);
    offsets_.clear();
    for (const Neighbour& n : neighbours) offsets_.push_back(tree_.position(n.index) - center);
    if (neighbours.empty() || neighbours.back().squared_distance == 0) return {};
    // Normalised to unit size, so that products of very small and very large clouds do not overflow.
    const float scale = 1 / std::sqrt(neighbours.back().squared_distance);
    for (Vec3f& o : offsets_) o *= scale;
    Vec3 normal = plain_normal();
    if (reweightings_ > 0) normal = reweighted_normal(normal, noise_ * static_cast<double>(scale));
    if (method_ == NormalOptions::Method::jet) normal = jet_normal(normal);
    return Vec3f(normal);
  }

 private:
  // Single precision suffices: the offsets are of similar, moderate size.
  Vec3 plain_normal() const {
    Vec3f sum;
    Symmetric3T<float> products;
    for (const Vec3f& o : offsets_) sum += o, products.add(o);
    const double w = 1 / static_cast<double>(offsets_.size());
    const Vec3 mean = Vec3(sum) * w;
    return smallest_axis({products.xx * w - mean.x * mean.x, products.xy * w - mean.x * mean.y,
                          products.xz * w - mean.x * mean.z, products.yy * w - mean.y * mean.y,
                          products.yz * w - mean.y * mean.z, products.zz * w - mean.z * mean.z});
  }

  // Reduces the weight of samples far off the plane relative to the typical deviation and the noise (Geman–McClure
  // weights).
  Vec3 reweighted_normal(Vec3 normal, double noise) {
    const std::size_t n = offsets_.size();
    heights_.resize(n);
    weights_.assign(n, 1);
    Vec3 mean = weighted_mean();
    for (int round = 0; round < reweightings_; ++round) {
      for (std::size_t i = 0; i < n; ++i) heights_[i] = std::abs(dot(Vec3(offsets_[i]) - mean, normal));
      sorted_ = heights_;
      const double scale = std::max(2 * kDeviationOverMedian * median(sorted_), 1.5 * noise) + 1e-9;
      for (std::size_t i = 0; i < n; ++i) {
        const double t = heights_[i] / scale;
        weights_[i] = 1 / ((1 + t * t) * (1 + t * t));
      }
      mean = weighted_mean();
      Symmetric3 covariance;
      for (std::size_t i = 0; i < n; ++i) covariance.add(Vec3(offsets_[i]) - mean, weights_[i]);
      normal = smallest_axis(covariance);
    }
    return normal;
  }

  Vec3 weighted_mean() const {
    Vec3 sum;
    double total = 0;
    for (std::size_t i = 0; i < offsets_.size(); ++i) sum += Vec3(offsets_[i]) * weights_[i], total += weights_[i];
    return sum / total;
  }

  // Fits a quadratic height function over the plane with the sample as origin; its slope there tilts the normal.
  Vec3 jet_normal(const Vec3& normal) const {
    if (offsets_.size() < 8) return normal;
    Vec3 t, b;
    tangent_frame(normal, t, b);
    using Matrix = Eigen::Matrix<double, 6, 6>;
    using Column = Eigen::Matrix<double, 6, 1>;
    Matrix a = Matrix::Zero();
    Column right = Column::Zero();
    for (std::size_t i = 0; i < offsets_.size(); ++i) {
      const Vec3 o(offsets_[i]);
      const double u = dot(o, t), v = dot(o, b), h = dot(o, normal);
      const double w = reweightings_ > 0 ? weights_[i] : 1.05 - std::min(squared_norm(o), 1.0);
      Column row;
      row << 1, u, v, u * u, u * v, v * v;
      a.selfadjointView<Eigen::Lower>().rankUpdate(row, w);
      right += (w * h) * row;
    }
    a.diagonal().array() += 1e-7 * a(0, 0);
    const Column c = a.selfadjointView<Eigen::Lower>().ldlt().solve(right);
    const Vec3 tilted = normal - t * c[1] - b * c[2];
    // A slope of more than 60 degrees over the best plane indicates a failed fit.
    return std::isfinite(squared_norm(tilted)) && squared_norm(tilted) < 4 ? normalized(tilted) : normal;
  }

  const KdTree& tree_;
  NormalOptions::Method method_;
  int reweightings_;
  double noise_;
  std::vector<Vec3f> offsets_;
  std::vector<double> weights_, heights_, sorted_;
};

}  // namespace

const OptionSchema& NormalOptions::schema() {
  using O = NormalOptions;
  static constexpr std::string_view methods[] = {"covariance", "jet"};
  static constexpr OptionRow rows[] = {
      option<&O::neighbours>(
          {.text = "Samples in a neighbourhood", .from_data = "from spacing and noise", .range = {6, 500}}),
      option<&O::method>({.text = "A plane (covariance) or a quadric (jet)", .unit = "choice", .choices = methods}),
      option<&O::reweightings>(
          {.text = "Reweighting rounds that reject samples off the fit: sharper at creases", .range = {0, 10}})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void NormalOptions::validate() const {
  validate_options(*this);
  if (spacing && !(*spacing >= 0)) throw ArgumentError("`spacing` must not be negative");
  if (noise && !(*noise >= 0)) throw ArgumentError("`noise` must not be negative");
}

int choose_neighbours(double spacing, double noise) {
  // A plane through k samples with spacing s and noise σ is tilted by about 2σ√π/(s k). Three degrees would require k =
  // 70 σ/s if the nearest samples were not those with the nearest heights. Measured: the error is least at 100–150.
  const double ratio = spacing > 0 ? noise / spacing : 0;
  return index_in<int>(110 * ratio, kCleanNeighbours, kMostNeighbours);
}

void estimate_normals(PointSet& points, const NormalOptions& options, Progress& progress) {
  estimate_normals(points, KdTree(points.positions), options, progress);
}

void estimate_normals(PointSet& points, const KdTree& tree, const NormalOptions& options, Progress& progress) {
  options.validate();
  double spacing = 0, noise = 0;
  if (!options.neighbours) {
    spacing = options.spacing ? *options.spacing : estimate_spacing(points);
    noise = options.noise ? *options.noise : estimate_noise(points);
  }
  const int neighbours = options.neighbours.value_or(choose_neighbours(spacing, noise));

  progress.begin("normals", points.size());
  points.normals.assign(points.size(), {});
  constexpr std::size_t kSlots = 2048;
  parallel_ranges(0, tree.size(), kSlots, [&](std::size_t first, std::size_t last) {
    NormalFitter fitter(tree, options.method, options.reweightings, noise);
    tree.for_each_nearest(static_cast<std::size_t>(neighbours), first, last,
                          [&](std::uint32_t slot, std::span<const Neighbour> found) {
                            points.normals[tree.order()[slot]] = fitter.fit(slot, found);
                          });
    progress.advance(last - first);
  });
  progress.finish();
}

}  // namespace sansmesh::inline v1
