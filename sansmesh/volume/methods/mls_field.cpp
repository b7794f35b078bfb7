// mls: moving least squares at each query point (tejada2008, 3.2).
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "sansmesh/approximation/polynomial_order.h"
#include "sansmesh/core/check_range.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/cells/cell_geometry.h"
#include "sansmesh/volume/cells/cell_numbers.h"
#include "sansmesh/volume/cells/higher_order_functions.h"
#include "sansmesh/volume/kernels/mls_kernels.h"
#include "sansmesh/volume/methods/cell_interpolant.h"
#include "sansmesh/volume/methods/grouped_field.h"
#include "sansmesh/volume/methods/support_blend.h"
#include "sansmesh/volume/reconstruction_input.h"
#include "sansmesh/volume/samples/lattice_polynomials.h"
#include "sansmesh/volume/samples/sample_gradients.h"
#include "sansmesh/volume/samples/sample_stencil.h"
#include "sansmesh/volume/samples/star_metric.h"
#include "sansmesh/volume/samples/support_index.h"
#include "sansmesh/volume/volume_method.h"

namespace sansmesh::inline v1 {
namespace {

using detail::MlsSample;
using detail::MlsTile;

constexpr double kSamplesPerTerm = 4, kWidest = 4;
// Variance of a value in units of that of a weighted mean. Inside the samples it is kAllAround, by degree, for weights
// (1 − r²)⁴. At boundaries, linear interpolation takes over from kDoubtful times that on, and replaces it entirely from
// kUseless on.
constexpr double kAllAround[] = {3.3, 3.3, 3.3, 3.3, 7.3};  // (planes have 1: they are doubted later)
constexpr double kDoubtful = 1.5, kUseless = 6;

// Radii of the samples' weights in the local metrics: the cells of a sample are well inside, and each radius reaches as
// many samples as a fit needs.
std::vector<float> mls_radii(const SampledVolume& volume, std::span<const StarMetric> metrics, int degree,
                             const LocalPolynomials& covered, std::optional<double> asked) {
  std::vector<float> radii = support_radii(volume, covered, 1);
  const double enough = kSamplesPerTerm * monomial_count(3, degree);
  if (asked) {
    for (float& r : radii) r = std::max(r, static_cast<float>(*asked));
    return radii;
  }
  if (volume.lattice) {
    // Steps are 1 in the local metric: the ball of this radius contains `enough` samples.
    const double radius = std::cbrt(enough / (4.0 / 3 * 3.14159265358979));
    parallel_for(0, radii.size(), 8192, [&](std::size_t i) {
      // Half the ball is empty at each boundary.
      const auto at = volume.lattice->indices(i);
      double r = radius;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t last = volume.lattice->axes[k].size() - 1;
        if (static_cast<double>(std::min(at[k], last - at[k])) < 1) r *= std::cbrt(2.0);
      }
      radii[i] = std::max(radii[i], static_cast<float>(std::min(r, kWidest)));
    });
    return radii;
  }
  const auto count = static_cast<std::size_t>(std::ceil(enough));
  parallel_ranges(0, radii.size(), 512, [&](std::size_t first, std::size_t last) {
    SampleStencil stencil(volume);
    std::vector<double> lengths;
    for (std::size_t i = first; i < last; ++i) {
      stencil.gather(static_cast<std::uint32_t>(i), metrics[i], 2 * count, 8 * count, SupportIndex::kRings);
      lengths.clear();
      for (const Vec3& u : stencil.local()) lengths.push_back(norm(u));
      const std::size_t at = std::min(count, lengths.size() - 1);
      std::nth_element(lengths.begin(), lengths.begin() + static_cast<std::ptrdiff_t>(at), lengths.end());
      radii[i] = std::max(radii[i], static_cast<float>(std::min(lengths[at] * 1.05, kWidest)));
    }
  });
  return radii;
}

class MlsField final : public GroupedField {
 public:
  MlsField(std::shared_ptr<const SampledVolume> volume_of, std::shared_ptr<const VolumeLocator> locator,
           VolumeValues values, std::vector<StarMetric> metrics, std::vector<float> radii, int degree)
      : GroupedField(std::move(volume_of), std::move(locator), values.components),
        values_(std::move(values)),
        metrics_(std::move(metrics)),
        radii_(std::move(radii)),
        index_(volume(), metrics_, radii_),
        degree_(degree),
        higher_(volume()) {}

  /// Computes the residuals f_i − M f(x_i), which linear interpolation adds where samples are cell corners, and the
  /// share of the correction of linear interpolation by M f that does not increase errors. `local`: polynomials of
  /// mls-detail.
  void prepare(const LocalPolynomials& local, Progress& progress) {
    const bool at_corners = volume().cell_sample.empty();
    if (at_corners)
      find_residuals(progress);
    else
      flat_.emplace(volume(), values_);
    shares_.components = 1;
    shares_.values = confirmed_shares(local, progress);
    if (!at_corners) flat_share_.emplace(volume(), shares_);
  }

  /// Instead of prepare(): M f alone; linear interpolation only where it is not determined. M f is that of the values
  /// minus a plane plus this plane, which is the same where samples determine planes and better where they do not, as
  /// at the ends of overlapping blocks.
  void leave_as_printed() {
    if (!volume().lattice && degree_ > 0) slopes_ = detail::sample_gradients(volume(), values_);
    if (!volume().cell_sample.empty()) flat_.emplace(volume(), values_);
  }

 private:
  static constexpr std::size_t kRow = 8;  // read by the widest vectors

  // Linear interpolation of the samples and of the shares at a point.
  struct Flat {
    double share = 1;
    Vec3 share_slope;
    std::vector<double> values;
    std::vector<Vec3> slopes;
  };
  struct Lists final : Memory {
    SupportIndex::Memory found;
    std::vector<MlsSample> samples;
    MlsTile tile;
    std::array<Flat, kMostPoints> flat;
    std::array<NodeWeights, 8> nodes;
  };

  std::unique_ptr<Memory> memory() const override { return std::make_unique<Lists>(); }
  bool goes_on_straight() const override { return true; }

  StarMetric metric(std::size_t i) const { return metric_of(volume(), metrics_, i); }

  // Gathers the supports that reach a cell; returns the origin of the cell.
  Vec3 gather(const CellLocation& cell, Lists& lists) const {
    const Vec3 origin = index_.of_cell(cell, lists.found);
    lists.samples.resize(lists.found.supports.size());
    for (std::size_t s = 0; s < lists.samples.size(); ++s) {
      const std::size_t i = lists.found.supports[s];
      MlsSample& sample = lists.samples[s];
      sample.position = volume().position(i) - origin;
      sample.metric = metric(i);
      sample.inverse_square = 1 / (static_cast<double>(radii_[i]) * static_cast<double>(radii_[i]));
    }
    return origin;
  }

  // M f for one component at points, padded to whole rows, minus the returned value.
  template <class At>
  double solve(Lists& lists, const Vec3& origin, std::size_t component, std::size_t n, const At& at,
               bool gradient) const {
    const std::size_t c = components(), filled = (n + kRow - 1) / kRow * kRow;
    for (std::size_t i = 0; i < filled; ++i) {
      const Vec3 d = at(std::min(i, n - 1)) - origin;
      for (std::size_t k = 0; k < 3; ++k) lists.tile.x[k][i] = d[k];
    }
    const std::uint32_t own = lists.found.own;
    const double base = values_.values[own * c + component];
    for (std::size_t s = 0; s < lists.samples.size(); ++s)
      lists.samples[s].value = values_.values[lists.found.supports[s] * c + component] - base;
    const Vec3 slope = slopes_.empty() ? Vec3{} : slopes_[own * c + component], from = volume().position(own) - origin;
    if (!slopes_.empty())
      for (MlsSample& s : lists.samples) s.value -= dot(slope, s.position - from);
    detail::solve_mls(lists.samples.data(), lists.samples.size(), metric(own), degree_, filled, gradient, lists.tile);
    for (std::size_t i = 0; i < n && !slopes_.empty(); ++i) {
      lists.tile.value[i] += dot(slope, at(i) - origin - from);
      for (std::size_t k = 0; k < 3 && gradient; ++k) lists.tile.gradient[k][i] += slope[k];
    }
    return base;
  }

  // Share of M f for that variance of unit noise at the samples.
  double steady_share(double variance) const {
    if (variance < 0) return 0;
    const double v = variance / kAllAround[degree_];
    return std::clamp((kUseless - v) / (kUseless - kDoubtful), 0.0, 1.0);
  }

  void find_residuals(Progress& progress) {
    const std::size_t n = volume().size(), c = components(), chunk = 16384;
    std::vector<double> residuals(n * c);
    progress.begin("residuals", (n + chunk - 1) / chunk);
    for (std::size_t first = 0; first < n; first += chunk) {
      std::vector<Vec3> x(std::min(chunk, n - first));
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = volume().position(first + i);
      evaluate(x, {std::span(residuals).subspan(first * c, x.size() * c)});
      progress.advance();
    }
    for (std::size_t i = 0; i < residuals.size(); ++i) residuals[i] = values_.values[i] - residuals[i];
    residuals_ = std::move(residuals);
  }

  // Half-way from the centre of each cell to its corners: a is the correction of linear interpolation by M f, c the one
  // by local polynomials, of which the share t is likely. τ minimises Σ a² (τ a − t c)² over the cells of a sample:
  // large corrections count most, since they make the largest errors.
  std::vector<double> confirmed_shares(const LocalPolynomials& local, Progress& progress) const {
    const std::size_t c = components(), n = volume().size();
    const bool at_corners = volume().cell_sample.empty();
    double largest = 0;
    for (const double v : values_.values) largest = std::max(largest, std::abs(v));
    const double unit = largest > 0 && std::isfinite(1 / largest) ? 1 / largest : 1;
    std::vector<std::array<double, 2>> sums(cell_count(volume()));
    each_cell(sums.size(), "corrections", progress, [&](std::size_t k, Lists& lists) {
      const CellLocation location = location_of_cell(volume(), nth_cell(volume(), k));
      const std::size_t count = location.corner_count;
      const CellShape shape = shape_of_cell(volume(), location.cell);
      std::array<Vec3, 8> x{};
      std::array<std::array<double, 8>, 8> weights{};
      for (std::size_t p = 0; p < count; ++p) {
        for (std::size_t v = 0; v < count; ++v) weights[p][v] = 0.5 / static_cast<double>(count) + (v == p ? 0.5 : 0);
        shape_functions(shape, parameters_of(shape, weights[p]), weights[p]);
        for (std::size_t v = 0; v < count; ++v) x[p] += corner_position(volume(), location.corners[v]) * weights[p][v];
      }
      const Vec3 origin = gather(location, lists);
      const bool own = higher_.has(location.cell);
      for (std::size_t p = 0; own && p < count; ++p) {
        CellLocation there = location;
        there.weights = weights[p];
        higher_.find(there, x[p], false, lists.nodes[p]);
      }
      for (std::size_t m = 0; m < c; ++m) {
        const double base = solve(
            lists, origin, m, count, [&](std::size_t i) { return x[i]; }, false);
        for (std::size_t p = 0; p < count; ++p) {
          double flat = 0, fitted = base + lists.tile.value[p], other = 0, trust = 0;
          const auto add = [&](std::size_t i, double weight) {
            const Vec3 d = x[p] - volume().position(i);
            other += weight * (local.constants[i * c + m] + local.full_rise(i, m, local.metric(volume(), i)(d)));
            trust += weight * static_cast<double>(local.trust[i]);
          };
          if (at_corners) {
            for (std::size_t v = 0; v < count; ++v) {
              const std::size_t i = location.corners[v];
              flat += weights[p][v] * values_.values[i * c + m];
              fitted += weights[p][v] * residuals_[i * c + m];
              add(i, weights[p][v]);
            }
            if (own) flat = lists.nodes[p].value(values_, m);
          } else {
            Flat& all = lists.flat[0];
            all.values.resize(c);
            flat_->evaluate(location, x[p], all.values, {});
            flat = all.values[m];
            add(volume().cell_sample[location.cell], 1);
          }
          const double a = unit * steady_share(lists.tile.variance[p]) * (fitted - flat);
          sums[k][0] += a * a * (a * a), sums[k][1] += a * a * (trust * a * unit * (other - flat));
        }
      }
    });
    std::vector<std::array<double, 2>> of_samples(n);
    for (std::size_t k = 0; k < sums.size(); ++k) {
      const CellLocation location = location_of_cell(volume(), nth_cell(volume(), k));
      const auto add = [&](std::uint32_t i) { of_samples[i][0] += sums[k][0], of_samples[i][1] += sums[k][1]; };
      if (!at_corners)
        add(volume().cell_sample[location.cell]);
      else
        for (std::size_t v = 0; v < location.corner_count; ++v) add(location.corners[v]);
    }
    // Without a correction at any point there is nothing to confirm.
    std::vector<double> shares(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      if (of_samples[i][0] == 0) continue;
      const double share = of_samples[i][1] / of_samples[i][0];
      shares[i] = share > 0 ? std::min(share, 1.0) : 0;
    }
    return shares;
  }

  template <class Visit>
  void each_cell(std::size_t count, const char* what, Progress& progress, const Visit& visit) const {
    constexpr std::size_t kChunk = 256;
    const std::size_t chunks = (count + kChunk - 1) / kChunk;
    progress.begin(what, chunks);
    parallel_ranges(0, chunks, 1, [&](std::size_t begin, std::size_t end) {
      const auto lists = std::make_unique<Lists>();
      for (std::size_t k = begin; k < end; ++k) {
        for (std::size_t i = k * kChunk; i < std::min((k + 1) * kChunk, count); ++i) visit(i, *lists);
        progress.advance();
      }
    });
  }

  void evaluate_group(const Group& group, Memory& memory, const PolynomialValues& wanted) const override {
    static_assert(MlsTile::kTile == kMostPoints);
    Lists& lists = static_cast<Lists&>(memory);
    MlsTile& tile = lists.tile;
    const std::size_t n = group.size, c = components();
    const bool gradient = !wanted.gradients.empty();
    const Vec3 origin = gather(group.cell, lists);
    for (std::size_t i = 0; i < n; ++i)
      interpolate(*group.locations[i], group.x[i], gradient, lists.flat[i], lists.nodes[0]);
    for (std::size_t m = 0; m < c; ++m) {
      const double base = solve(
          lists, origin, m, n, [&](std::size_t i) { return group.x[i]; }, gradient);
      for (std::size_t i = 0; i < n; ++i) {
        const Flat& flat = lists.flat[i];
        const std::size_t to = group.to[i] * c + m;
        // During the computation of residuals only M f counts.
        const double steady = shares_.values.empty() ? tile.variance[i] >= 0 : steady_share(tile.variance[i]);
        const double share = steady * flat.share;
        const CellLocation& location = *group.locations[i];
        // Difference to linear interpolation, M f − L.
        double more = base + tile.value[i] - flat.values[m];
        for (std::size_t v = 0; v < location.corner_count && !residuals_.empty(); ++v)
          more += location.weights[v] * residuals_[location.corners[v] * c + m];
        if (!wanted.values.empty()) wanted.values[to] = flat.values[m] + share * more;
        if (!gradient) continue;
        Vec3 rise = Vec3{tile.gradient[0][i], tile.gradient[1][i], tile.gradient[2][i]} - flat.slopes[m];
        if (!residuals_.empty()) {
          std::array<Vec3, 8> slopes;
          shape_gradients(volume(), location, group.x[i], slopes);
          for (std::size_t v = 0; v < location.corner_count; ++v)
            rise += slopes[v] * residuals_[location.corners[v] * c + m];
        }
        wanted.gradients[to] = flat.slopes[m] + rise * share + flat.share_slope * (steady * more);
      }
    }
    if (wanted.degrees.empty()) return;
    for (std::size_t i = 0; i < n; ++i) {
      const double steady = shares_.values.empty() ? tile.variance[i] >= 0 : steady_share(tile.variance[i]);
      const bool fitted = steady * lists.flat[i].share > 0;
      wanted.degrees[group.to[i]] = static_cast<std::uint8_t>(fitted ? degree_ : 1);
    }
  }

  // L and the share at a point.
  void interpolate(const CellLocation& location, const Vec3& x, bool gradient, Flat& flat, NodeWeights& nodes) const {
    const std::size_t c = components();
    flat.values.assign(c, 0.0), flat.slopes.assign(gradient ? c : 0, Vec3{});
    flat.share = 0, flat.share_slope = {};
    const bool shared = !shares_.values.empty();
    if (flat_) {
      flat_->evaluate(location, x, flat.values, flat.slopes);
      if (flat_share_)
        flat_share_->evaluate(location, x, std::span(&flat.share, 1), std::span(&flat.share_slope, gradient ? 1 : 0));
    } else {
      for (std::size_t v = 0; v < location.corner_count; ++v) {
        const std::size_t i = location.corners[v];
        for (std::size_t m = 0; m < c; ++m) flat.values[m] += location.weights[v] * values_.values[i * c + m];
        if (shared) flat.share += location.weights[v] * shares_.values[i];
      }
      if (gradient) {
        std::array<Vec3, 8> slopes;
        shape_gradients(volume(), location, x, slopes);
        for (std::size_t v = 0; v < location.corner_count; ++v) {
          const std::size_t i = location.corners[v];
          for (std::size_t m = 0; m < c; ++m) flat.slopes[m] += slopes[v] * values_.values[i * c + m];
          if (shared) flat.share_slope += slopes[v] * shares_.values[i];
        }
      }
      if (higher_.find(location, x, gradient, nodes))
        for (std::size_t m = 0; m < c; ++m) {
          flat.values[m] = nodes.value(values_, m);
          if (gradient) flat.slopes[m] = nodes.gradient(values_, m);
        }
    }
    if (!shared) flat.share = 1;
    // In outer half cells, and at corners of cell data, the share may leave the range of the samples.
    if (flat.share < 0 || flat.share > 1) flat.share = std::clamp(flat.share, 0.0, 1.0), flat.share_slope = {};
  }

  VolumeValues values_;
  std::vector<StarMetric> metrics_;
  std::vector<float> radii_;
  SupportIndex index_;
  int degree_;
  std::vector<double> residuals_;
  std::vector<Vec3> slopes_;  // planes that are subtracted from the values, one per component of each sample, or none
  VolumeValues shares_;       // one component per sample
  std::optional<CellInterpolant> flat_, flat_share_;
  HigherOrderFunctions higher_;
};

}  // namespace

static std::unique_ptr<VolumeField> make_mls_field(ReconstructionInput input) {
  const int degree = input.options.degree.value_or(2);
  check_range("degree", degree, 0, LocalPolynomials::kMaxDegree);
  input.report.options.degree = degree;
  std::vector<StarMetric> metrics;
  if (!input.volume->lattice) metrics = star_metrics(*input.volume);
  LocalPolynomials covered;
  covered.metrics = metrics;
  std::vector<float> radii = mls_radii(*input.volume, metrics, degree, covered, input.options.radius);
  auto locator = std::make_shared<const VolumeLocator>(*input.volume);
  const bool interpolate = input.report.options.interpolate.emplace(input.options.interpolate.value_or(true));
  LocalPolynomials local;
  if (interpolate) local = fit_polynomials(*input.volume, input.values, {}, input.progress);
  auto field = std::make_unique<MlsField>(std::move(input.volume), std::move(locator), std::move(input.values),
                                          std::move(metrics), std::move(radii), degree);
  if (interpolate)
    field->prepare(local, input.progress);
  else
    field->leave_as_printed();
  return field;
}

namespace {

constexpr std::string_view kMlsUses[] = {"degree", "radius", "interpolate"};
constexpr VolumeMethod kMlsMethods[] = {{.name = "mls",
                                         .summary = "moving least squares at each point, ellipsoidal weights",
                                         .grids = "all",
                                         .make = make_mls_field,
                                         .uses = kMlsUses}};

}  // namespace

std::span<const VolumeMethod> mls_field_methods() { return kMlsMethods; }

}  // namespace sansmesh::inline v1
