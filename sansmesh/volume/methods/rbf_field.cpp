// Blended radial basis functions of compact support around every sample (wendland1995, babuska1997; tejada2008, 3.1).
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "sansmesh/approximation/generating_functions.h"
#include "sansmesh/core/check_range.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/methods/pointwise_field.h"
#include "sansmesh/volume/reconstruction_input.h"
#include "sansmesh/volume/samples/sample_supports.h"
#include "sansmesh/volume/volume_method.h"

namespace sansmesh::inline v1 {
namespace detail {
namespace {

constexpr double kBlendReach = 1.05;     ///< just over the reach that covers the cells around a sample
constexpr double kFunctionReach = 3;     ///< scale of the functions over the distance of the farthest sample
constexpr std::size_t kMostNodes = 120;  ///< per system
constexpr double kLeastRidge = 1e-13;
/// Least squared pivot: below, nodes of overlapping blocks nearly coincide in the metric, and a larger ridge makes the
/// functions nearly interpolate, up to the largest one.
constexpr double kLeastPivot = 1e-11, kMostRidge = 1e-9;
/// Values stay within the range of the nodes, widened by this share of it on both sides.
constexpr double kBeyondNodes = 1.5;
constexpr double kGapWeight = 1e-8;
constexpr Eigen::Index kTail = 4;  ///< coefficients of the linear function

/// Matrix from values at nodes, at their positions in the coordinates of a support, to coefficients: kTail + nodes rows
/// for the functions at the nodes, then 1, u.x, u.y, u.z. Linear functions that the nodes do not determine are dropped.
Eigen::MatrixXd rbf_coefficients(const RadialKernel& kernel, const std::vector<Vec3>& u, const Eigen::MatrixXd& right) {
  const auto n = static_cast<Eigen::Index>(u.size());
  Eigen::MatrixXd matrix(n, n), tail(n, kTail);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3& a = u[static_cast<std::size_t>(i)];
    tail.row(i) << 1, a.x, a.y, a.z;
    for (Eigen::Index j = 0; j <= i; ++j)
      matrix(i, j) = matrix(j, i) = kernel(squared_norm(a - u[static_cast<std::size_t>(j)]));
  }
  Eigen::LLT<Eigen::MatrixXd> cholesky;
  for (double ridge = kLeastRidge; ridge < 1; ridge *= 100) {
    matrix.diagonal().setConstant(1 + ridge);
    cholesky.compute(matrix);
    if (cholesky.info() != Eigen::Success) continue;
    const double pivot = cholesky.matrixLLT().diagonal().minCoeff();
    if (pivot * pivot >= kLeastPivot || ridge >= kMostRidge) break;
  }
  // With K = L Lᵀ the tail is the least-squares solution of L⁻¹P a = L⁻¹f.
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> least;
  least.setThreshold(1e-6);
  least.compute(cholesky.matrixL().solve(tail));
  Eigen::MatrixXd found(n + kTail, right.cols());
  found.bottomRows(kTail) = least.solve(cholesky.matrixL().solve(right));
  found.topRows(n) = cholesky.solve(right - tail * found.bottomRows(kTail));
  return found;
}

/// Systems at samples: their nodes and coefficients.
class RbfSystems {
 public:
  RbfSystems(const SampledVolume& volume, const VolumeValues& values, double reach, Progress& progress)
      : volume_(volume),
        values_(values),
        supports_(volume, reach),
        kernel_(RadialFunction::kWendlandC4, kFunctionReach * reach) {
    if (volume.lattice && volume.lattice->uniform)
      make_stencils(progress);
    else
      make_systems(progress);
  }

  const SampleSupports& supports() const { return supports_; }
  /// End of the weight of a sample's system: all nearer samples belong to the system.
  double blend_reach(std::uint32_t sample) const { return reach_.empty() ? kBlendReach : double{reach_[sample]}; }

  /// s_i at x and its gradients, for all components.
  void evaluate(std::uint32_t sample, const Vec3& x, double* values, Vec3* gradients) const {
    static thread_local std::vector<double> coefficients;
    static thread_local std::vector<std::uint32_t> nodes;
    const std::size_t m = values_.components;
    std::span<const std::uint32_t> near;
    const double* c = nullptr;  // node by node, with adjacent components
    if (!stencils_.empty()) {
      const Stencil& stencil = stencils_[stencil_of(sample)];
      nodes.clear();
      for (const std::ptrdiff_t step : stencil.steps)
        nodes.push_back(static_cast<std::uint32_t>(static_cast<std::ptrdiff_t>(sample) + step));
      near = nodes;
      const std::size_t n = nodes.size(), rows = n + kTail;
      coefficients.assign(rows * m, 0);
      for (std::size_t j = 0; j < n; ++j) {
        const double* const column = stencil.matrix.data() + j * rows;
        for (std::size_t k = 0; k < m; ++k) {
          const double f = values_.values[nodes[j] * m + k];
          if (m == 1)
            for (std::size_t r = 0; r < rows; ++r) coefficients[r] += column[r] * f;
          else
            for (std::size_t r = 0; r < rows; ++r) coefficients[r * m + k] += column[r] * f;
        }
      }
      c = coefficients.data();
    } else {
      near = nodes_[sample];
      c = coefficients_.data() + (nodes_.first[sample] + static_cast<std::size_t>(kTail) * sample) * m;
    }
    const Vec3 origin = volume_.position(sample), u = supports_.local(sample, x - origin);
    std::fill_n(values, m, 0);
    std::fill_n(gradients, m, Vec3{});
    for (const std::uint32_t node : near) {
      const Vec3 d = u - supports_.local(sample, volume_.position(node) - origin);
      const RadialValue phi = kernel_.with_slope(squared_norm(d));
      for (std::size_t k = 0; k < m; ++k) {
        values[k] += c[k] * phi.value;
        gradients[k] += d * (c[k] * phi.slope);
      }
      c += m;
    }
    for (std::size_t k = 0; k < m; ++k) {
      const Vec3 slope{c[m + k], c[2 * m + k], c[3 * m + k]};
      values[k] += c[k] + dot(slope, u);
      gradients[k] = supports_.transposed(sample, gradients[k] + slope);
      double least = values_.values[sample * m + k], most = least;
      for (const std::uint32_t node : near)
        least = std::min(least, values_.values[node * m + k]), most = std::max(most, values_.values[node * m + k]);
      const double beyond = kBeyondNodes * (most - least);
      const double held = std::clamp(values[k], least - beyond, most + beyond);
      if (held != values[k]) values[k] = held, gradients[k] = {};
    }
  }

 private:
  /// Shared by samples of a uniform lattice with the same position relative to its borders.
  struct Stencil {
    std::vector<std::ptrdiff_t> steps;  ///< from the sample's index to those of its nodes
    std::vector<double> matrix;         ///< coefficients from values, by columns
  };

  /// Largest extent of a stencil along an axis, in steps.
  std::size_t widest() const { return static_cast<std::size_t>(std::ceil(supports_.reach() * std::numbers::sqrt3)); }

  std::size_t stencil_of(std::size_t sample) const {
    const auto at = volume_.lattice->indices(sample);
    std::size_t number = 0;
    for (std::size_t k = 3; k-- > 0;) number = number * kinds_[k] + kind(k, at[k]);
    return number;
  }
  /// Class of a position along an axis: counted from the first end, in the middle, from the last end.
  std::size_t kind(std::size_t k, std::size_t i) const {
    const std::size_t n = volume_.lattice->axes[k].size();
    if (kinds_[k] == n) return i;
    const std::size_t r = widest();
    return i < r ? i : i + r < n ? r : i + 2 * r + 1 - n;
  }

  void make_stencils(Progress& progress) {
    const Lattice& lattice = *volume_.lattice;
    for (std::size_t k = 0; k < 3; ++k) kinds_[k] = std::min(lattice.axes[k].size(), 2 * widest() + 1);
    const std::size_t count = kinds_[0] * kinds_[1] * kinds_[2];
    std::vector<std::uint32_t> example(count);  // one sample of each kind
    const auto axis_index = [&](std::size_t k, std::size_t kind) {
      const std::size_t n = lattice.axes[k].size();
      return kinds_[k] == n || kind <= widest() ? kind : kind + n - (2 * widest() + 1);
    };
    const std::size_t nx = lattice.axes[0].size(), ny = lattice.axes[1].size();
    for (std::size_t s = 0; s < count; ++s)
      example[s] = static_cast<std::uint32_t>(
          axis_index(0, s % kinds_[0]) +
          nx * (axis_index(1, s / kinds_[0] % kinds_[1]) + ny * axis_index(2, s / (kinds_[0] * kinds_[1]))));
    stencils_.resize(count);
    progress.begin("fitting radial basis functions", count);
    parallel_for(0, count, 1, [&](std::size_t s) {
      std::vector<SampleSupports::Cover> covers;
      supports_.covering(lattice.position(example[s]), covers);
      std::vector<std::uint32_t> nodes;
      nodes.reserve(covers.size());
      for (const auto& cover : covers) nodes.push_back(cover.sample);
      Stencil& stencil = stencils_[s];
      for (const std::uint32_t node : nodes)
        stencil.steps.push_back(static_cast<std::ptrdiff_t>(node) - static_cast<std::ptrdiff_t>(example[s]));
      const auto n = static_cast<Eigen::Index>(nodes.size());
      const Eigen::MatrixXd matrix =
          rbf_coefficients(kernel_, local_nodes(example[s], nodes), Eigen::MatrixXd::Identity(n, n));
      stencil.matrix.assign(matrix.data(), matrix.data() + matrix.size());
      progress.advance();
    });
    progress.finish();
  }

  void make_systems(Progress& progress) {
    const std::size_t n = volume_.size(), m = values_.components;
    // Node j belongs to the systems of all supports that contain it, so that the blend interpolates.
    std::vector<std::vector<std::uint32_t>> covered(n);
    parallel_ranges(0, n, 256, [&](std::size_t first, std::size_t last) {
      std::vector<SampleSupports::Cover> covers;
      for (std::size_t j = first; j < last; ++j) {
        supports_.covering(volume_.position(j), covers);
        for (const auto& cover : covers) covered[j].push_back(cover.sample);
      }
    });
    std::vector<std::vector<std::uint32_t>> near(n);
    for (std::size_t j = 0; j < n; ++j) {
      for (const std::uint32_t i : covered[j]) near[i].push_back(static_cast<std::uint32_t>(j));
      covered[j] = {};
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (near[i].size() > kMostNodes) {
        const auto sample = static_cast<std::uint32_t>(i);
        std::vector<std::pair<double, std::uint32_t>> by_distance;
        for (const std::uint32_t s : near[i])
          by_distance.emplace_back(
              squared_norm(supports_.local(sample, volume_.position(s) - volume_.position(sample))), s);
        std::sort(by_distance.begin(), by_distance.end());
        near[i].resize(kMostNodes);
        for (std::size_t r = 0; r < kMostNodes; ++r) near[i][r] = by_distance[r].second;
        reach_.resize(n, static_cast<float>(kBlendReach));
        // Slightly less than the distance of the first sample outside the system.
        reach_[i] = std::min(reach_[i], static_cast<float>(std::sqrt(by_distance[kMostNodes].first) * (1 - 1e-6)));
      }
      nodes_.entries.insert(nodes_.entries.end(), near[i].begin(), near[i].end());
      nodes_.first.push_back(nodes_.entries.size());
      near[i] = {};
    }
    coefficients_.resize((nodes_.entries.size() + static_cast<std::size_t>(kTail) * n) * m);
    progress.begin("fitting radial basis functions", n);
    parallel_ranges(0, n, 64, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const auto nodes = nodes_[i];
        Eigen::MatrixXd right(static_cast<Eigen::Index>(nodes.size()), static_cast<Eigen::Index>(m));
        for (std::size_t r = 0; r < nodes.size(); ++r)
          for (std::size_t k = 0; k < m; ++k)
            right(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(k)) = values_.values[nodes[r] * m + k];
        const Eigen::MatrixXd found =
            rbf_coefficients(kernel_, local_nodes(static_cast<std::uint32_t>(i), nodes), right);
        double* out = coefficients_.data() + (nodes_.first[i] + static_cast<std::size_t>(kTail) * i) * m;
        for (Eigen::Index r = 0; r < found.rows(); ++r)
          for (Eigen::Index k = 0; k < found.cols(); ++k) *out++ = found(r, k);
      }
      progress.advance(last - first);
    });
    progress.finish();
  }

  std::vector<Vec3> local_nodes(std::uint32_t sample, std::span<const std::uint32_t> nodes) const {
    std::vector<Vec3> u;
    for (const std::uint32_t node : nodes)
      u.push_back(supports_.local(sample, volume_.position(node) - volume_.position(sample)));
    return u;
  }

  const SampledVolume& volume_;
  const VolumeValues& values_;
  SampleSupports supports_;
  RadialKernel kernel_;
  std::array<std::size_t, 3> kinds_{};
  std::vector<Stencil> stencils_;     // for uniform lattices
  Adjacency nodes_;                   // for all others
  std::vector<float> reach_;          // end of the weights; empty if it is kBlendReach for all
  std::vector<double> coefficients_;  // a system's nodes, then its tail, with adjacent components
};

/// f(x) = Σ W_i(x) s_i(x) / Σ W_i(x) (docs/methods/volume-baselines.md): s_i interpolates the samples with t_i < R/√3
/// around sample i (SampleSupports), at most the nearest 120. W_i = (1 − t)⁴₊ (4t + 1), t = t_i / 1.05, with a smaller
/// reach where the next sample is nearer. Memory: almost none on uniform lattices; otherwise about 12 bytes for each of
/// the 25 to 40 samples around each sample, and 8 more for each further component. `radius` R in spacings, 1..3; values
/// below 1.05 √3 count as that.
class RbfField final : public PointwiseField {
 public:
  RbfField(std::shared_ptr<const SampledVolume> sampled, VolumeValues values, double reach, Progress& progress)
      : PointwiseField(std::move(sampled), std::move(values)), systems_(volume(), samples(), reach, progress) {}

 protected:
  void evaluate_at(const Vec3& x, const CellLocation& location, double* values, Vec3* gradients) const override {
    static thread_local std::vector<SampleSupports::Cover> covers;
    static thread_local std::vector<double> value;
    static thread_local std::vector<Vec3> gradient, sums;
    const std::size_t m = components();
    value.resize(m), gradient.resize(m), sums.assign(m, {});
    std::fill_n(values, m, 0);
    systems_.supports().covering(x, covers);
    double sum = 0;
    Vec3 slope;
    const auto add = [&](double weight, const Vec3& fall) {
      for (std::size_t k = 0; k < m; ++k) {
        values[k] += weight * value[k];
        sums[k] += gradient[k] * weight + fall * value[k];
      }
      sum += weight;
      slope += fall;
    };
    for (const auto& cover : covers) {
      const double reach = systems_.blend_reach(cover.sample);
      if (!(cover.squared < reach * reach)) continue;
      const RadialValue w = weight(WeightFunction::kWendland, cover.squared, reach);
      systems_.evaluate(cover.sample, x, value.data(), gradient.data());
      add(w.value, cover.slope * w.slope);
    }
    if (!volume().lattice && volume().cell_sample.empty()) {
      std::array<Vec3, 8> falls{};
      if (gradients) shape_gradients(volume(), location, x, falls);
      for (std::size_t c = 0; c < location.corner_count; ++c) {
        for (std::size_t k = 0; k < m; ++k) value[k] = samples().values[location.corners[c] * m + k], gradient[k] = {};
        add(kGapWeight * location.weights[c], falls[c] * kGapWeight);
      }
    }
    if (!(sum > 0)) {  // cell data are covered by their own supports, up to rounding
      const std::size_t s = volume().cell_sample.empty() ? 0 : volume().cell_sample[location.cell];
      for (std::size_t k = 0; k < m; ++k) value[k] = samples().values[s * m + k], gradient[k] = {};
      add(1, {});
    }
    for (std::size_t k = 0; k < m; ++k) {
      values[k] /= sum;
      if (gradients) gradients[k] = (sums[k] - slope * values[k]) / sum;
    }
  }

 private:
  RbfSystems systems_;
};

}  // namespace

}  // namespace detail

static std::unique_ptr<VolumeField> make_rbf_field(ReconstructionInput input) {
  constexpr double kRadius = 2;
  const double radius = input.report.options.radius.emplace(input.options.radius.value_or(kRadius));
  check_range("radius", radius, 1, 3);
  return std::make_unique<detail::RbfField>(std::move(input.volume), std::move(input.values),
                                            detail::reach_of_radius(radius), input.progress);
}

namespace {

constexpr std::string_view kRbfUses[] = {"radius"};
constexpr VolumeMethod kRbfMethods[] = {{.name = "rbf",
                                         .summary = "radial basis functions of compact support, blended",
                                         .grids = "all",
                                         .make = make_rbf_field,
                                         .uses = kRbfUses}};

}  // namespace

std::span<const VolumeMethod> rbf_field_methods() { return kRbfMethods; }

}  // namespace sansmesh::inline v1
