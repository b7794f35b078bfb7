// mls: moving least squares about each point.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "sansmesh/approximation/polynomial_order.h"
#include "sansmesh/core/check_range.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/grouped_field.h"
#include "sansmesh/volume/mls_kernels.h"
#include "sansmesh/volume/reconstruction_makers.h"
#include "sansmesh/volume/sample_stencil.h"
#include "sansmesh/volume/star_metric.h"
#include "sansmesh/volume/support_blend.h"
#include "sansmesh/volume/support_index.h"

namespace sansmesh {
namespace {

using detail::MlsSample;
using detail::MlsTile;

constexpr double kSamplesPerTerm = 4, kWidest = 4;
// Variance of a value in units of that of a weighted mean: from here on, at the boundary, linear interpolation takes
// over, and beyond it is all.
constexpr double kDoubtful = 30, kUseless = 120;

// Radii of the samples' weights, in the local metrics: cells that a sample belongs to lie well inside, and each reaches
// as many samples as a fit needs.
std::vector<float> mls_radii(const SampledVolume& volume, std::span<const StarMetric> metrics, int degree,
                             const LocalPolynomials& covered, std::optional<double> asked) {
  std::vector<float> radii = support_radii(volume, covered, 1);
  const double enough = kSamplesPerTerm * monomial_count(3, degree);
  if (asked) {
    for (float& r : radii) r = std::max(r, static_cast<float>(*asked));
    return radii;
  }
  if (volume.lattice) {
    // Steps are 1 in the local metric: so many are in a ball of this radius.
    const double radius = std::cbrt(enough / (4.0 / 3 * 3.14159265358979));
    parallel_for(0, radii.size(), 8192, [&](std::size_t i) {
      // Half the ball is empty on each boundary.
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
        degree_(degree) {}

  /// f_i − M f(x_i), which linear interpolation adds where samples are corners of cells.
  void correct(Progress& progress) {
    if (!volume().cell_sample.empty()) return;
    const std::size_t n = volume().size(), c = components(), chunk = 16384;
    std::vector<double> residuals(n * c);
    progress.begin("residuals", (n + chunk - 1) / chunk);
    for (std::size_t first = 0; first < n; first += chunk) {
      std::vector<Vec3> x(std::min(chunk, n - first));
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = volume().position(first + i);
      evaluate(x, {std::span(residuals).subspan(first * c, x.size() * c), {}, {}, {}});
      progress.advance();
    }
    for (std::size_t i = 0; i < residuals.size(); ++i) residuals[i] = values_.values[i] - residuals[i];
    residuals_ = std::move(residuals);
  }

 private:
  struct Lists final : Memory {
    SupportIndex::Memory found;
    std::vector<MlsSample> samples;
    MlsTile tile;
  };

  std::unique_ptr<Memory> memory() const override { return std::make_unique<Lists>(); }
  bool goes_on_straight() const override { return true; }

  StarMetric metric(std::size_t i) const {
    return volume().lattice ? lattice_metric(*volume().lattice, i) : metrics_[i];
  }

  void answer(const Group& group, Memory& memory, const VolumeAnswers& wanted) const override {
    static_assert(MlsTile::kTile == kMostPoints);
    Lists& lists = static_cast<Lists&>(memory);
    MlsTile& tile = lists.tile;
    const std::size_t n = group.size, c = components();
    const bool gradient = !wanted.gradients.empty();
    const Vec3 origin = index_.of_cell(group.cell, lists.found);
    const std::uint32_t own = lists.found.own;
    constexpr std::size_t kRow = 8;
    const std::size_t filled = (n + kRow - 1) / kRow * kRow;
    for (std::size_t i = 0; i < filled; ++i) {
      const Vec3 d = group.x[std::min(i, n - 1)] - origin;
      for (std::size_t k = 0; k < 3; ++k) tile.x[k][i] = d[k];
    }
    lists.samples.resize(lists.found.supports.size());
    for (std::size_t s = 0; s < lists.samples.size(); ++s) {
      const std::size_t i = lists.found.supports[s];
      MlsSample& sample = lists.samples[s];
      sample.position = volume().position(i) - origin;
      sample.metric = metric(i);
      sample.inverse_square = 1 / (static_cast<double>(radii_[i]) * static_cast<double>(radii_[i]));
    }
    const StarMetric frame = metric(own);
    const bool linear = volume().cell_sample.empty();  // there is linear interpolation to fall back on
    for (std::size_t m = 0; m < c; ++m) {
      const double base = values_.values[own * c + m];
      for (std::size_t s = 0; s < lists.samples.size(); ++s)
        lists.samples[s].value = values_.values[lists.found.supports[s] * c + m] - base;
      detail::solve_mls(lists.samples.data(), lists.samples.size(), frame, degree_, filled, gradient, !linear, tile);
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t to = group.to[i] * c + m;
        double value = base;
        Vec3 g;
        if (tile.degree[i] >= 0) {
          value += tile.value[i];
          if (gradient) g = {tile.gradient[0][i], tile.gradient[1][i], tile.gradient[2][i]};
        }
        if (!residuals_.empty())
          interpolate(residuals_, *group.places[i], group.x[i], m, 1, value, gradient ? &g : nullptr);
        if (linear && (tile.variance[i] > kDoubtful || tile.degree[i] < 0)) {
          const double share =
              tile.degree[i] < 0 ? 0 : std::clamp((kUseless - tile.variance[i]) / (kUseless - kDoubtful), 0.0, 1.0);
          value *= share, g *= share;
          interpolate(values_.values, *group.places[i], group.x[i], m, 1 - share, value, gradient ? &g : nullptr);
        }
        if (!wanted.values.empty()) wanted.values[to] = value;
        if (gradient) wanted.gradients[to] = g;
      }
    }
    if (wanted.degrees.empty()) return;
    for (std::size_t i = 0; i < n; ++i)
      wanted.degrees[group.to[i]] = static_cast<std::uint8_t>(std::max(tile.degree[i], 0.0));
  }

  // Adds `share` times the linear interpolation of numbers of the samples.
  void interpolate(std::span<const double> numbers, const VolumePlace& place, const Vec3& x, std::size_t m,
                   double share, double& value, Vec3* gradient) const {
    const std::size_t c = components();
    for (std::size_t v = 0; v < place.corner_count; ++v)
      value += share * place.weights[v] * numbers[place.corners[v] * c + m];
    if (gradient == nullptr) return;
    std::array<Vec3, 8> slopes;
    shape_gradients(volume(), place, x, slopes);
    for (std::size_t v = 0; v < place.corner_count; ++v)
      *gradient += slopes[v] * (share * numbers[place.corners[v] * c + m]);
  }

  VolumeValues values_;
  std::vector<StarMetric> metrics_;
  std::vector<float> radii_;
  SupportIndex index_;
  int degree_;
  std::vector<double> residuals_;
};

}  // namespace

std::unique_ptr<VolumeField> make_mls_field(ReconstructionInput input) {
  const int degree = input.options.degree.value_or(2);
  check_range("degree", degree, 0, LocalPolynomials::kMaxDegree);
  input.report.options.degree = degree;
  std::vector<StarMetric> metrics;
  if (!input.volume->lattice) metrics = star_metrics(*input.volume);
  LocalPolynomials covered;
  covered.metrics = metrics;
  std::vector<float> radii = mls_radii(*input.volume, metrics, degree, covered, input.options.radius);
  auto locator = std::make_shared<const VolumeLocator>(*input.volume);
  auto field = std::make_unique<MlsField>(std::move(input.volume), std::move(locator), std::move(input.values),
                                          std::move(metrics), std::move(radii), degree);
  field->correct(input.progress);
  return field;
}

}  // namespace sansmesh
