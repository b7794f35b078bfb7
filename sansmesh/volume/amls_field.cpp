// amls: approximate moving least squares, ellipsoidal, normalised, iterated, with precomputed coefficients.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/lattice_polynomials.h"
#include "sansmesh/volume/reconstruction_makers.h"
#include "sansmesh/volume/support_blend.h"
#include "sansmesh/volume/support_index.h"

namespace sansmesh {
namespace {

// exp(−2 t) (1 − t)⁴ with t = r² / R² is exp(−6 t) to first order: ε r² = 6 t.
constexpr double kFall = 2, kDecay = kFall + 4;
constexpr double kShapes[] = {0.7, 1.0, 1.5, 2.2};
constexpr int kMostIterations = 20;
constexpr std::size_t kMostForChoice = 200000;
constexpr double kDefaultShape = 1.5;
constexpr int kDefaultIterations = 5;

detail::SupportShape amls_shape(int order) {
  detail::SupportShape shape;
  shape.fall = static_cast<float>(kFall);
  const auto d = static_cast<float>(kDecay);
  if (order == 4) shape.l0 = 2.5f, shape.l1 = -d;
  if (order == 6) shape.l0 = 4.375f, shape.l1 = -3.5f * d, shape.l2 = 0.5f * d * d;
  return shape;
}

struct AmlsEntry {
  std::uint32_t column;
  float phi, weight;
};

// φ_j at all samples x_i, and what the local polynomials add there.
class AmlsSystem {
 public:
  AmlsSystem(const SampledVolume& volume, const VolumeValues& values, const LocalPolynomials& local,
             std::span<const float> radii, const detail::SupportShape& shape)
      : values_(values), n_(volume.size()), c_(values.components), rises_(n_ * c_, 0.0) {
    const SupportIndex index(volume, local.metrics.view(), radii);
    constexpr std::size_t kChunk = 1024;
    std::vector<std::vector<AmlsEntry>> parts((n_ + kChunk - 1) / kChunk);
    std::vector<std::uint32_t> counts(n_);
    parallel_ranges(0, parts.size(), 4, [&](std::size_t begin, std::size_t end) {
      SupportIndex::Memory found;
      for (std::size_t p = begin; p < end; ++p)
        for (std::size_t i = p * kChunk; i < std::min(n_, (p + 1) * kChunk); ++i) {
          index.of_sample(static_cast<std::uint32_t>(i), found);
          const std::size_t before = parts[p].size();
          const Vec3 x = volume.position(i);
          for (const std::uint32_t j : found.supports) {
            const Vec3 u = local.metric(volume, j)(x - volume.position(j));
            const double radius = static_cast<double>(radii[j]), t = squared_norm(u) / (radius * radius);
            if (!(t < 1)) continue;
            const double q = 1 - t, q2 = q * q, w = q2 * q2 * std::exp(-kFall * t);
            const double phi = w * (static_cast<double>(shape.l0) +
                                    t * (static_cast<double>(shape.l1) + t * static_cast<double>(shape.l2)));
            parts[p].push_back({j, static_cast<float>(phi), static_cast<float>(w)});
            for (std::size_t m = 0; m < c_; ++m) rises_[i * c_ + m] += phi * local.rise(j, m, u);
          }
          counts[i] = static_cast<std::uint32_t>(parts[p].size() - before);
        }
    });
    first_.assign(1, 0);
    for (const std::uint32_t count : counts) first_.push_back(first_.back() + count);
    entries_.reserve(first_.back());
    for (auto& part : parts) entries_.insert(entries_.end(), part.begin(), part.end()), part = {};
  }

  /// Σ_j φ_j(x_i) numbers_j / D_i without the columns in `without`; what the local polynomials add is added if asked
  /// for.
  void apply(std::span<const double> numbers, bool rises, std::span<const std::uint8_t> without,
             std::span<double> result) const {
    parallel_for(0, n_, 1024, [&](std::size_t i) {
      double weight = 0, size = 0;
      for (std::size_t m = 0; m < c_; ++m) result[i * c_ + m] = rises ? rises_[i * c_ + m] : 0;
      for (std::uint64_t e = first_[i]; e < first_[i + 1]; ++e) {
        const AmlsEntry& entry = entries_[e];
        if (!without.empty() && without[entry.column] != 0) continue;
        const auto phi = static_cast<double>(entry.phi);
        weight += static_cast<double>(entry.weight), size += std::abs(phi);
        for (std::size_t m = 0; m < c_; ++m) result[i * c_ + m] += phi * numbers[entry.column * c_ + m];
      }
      const double divisor = std::max(weight, 0.55 * size);
      for (std::size_t m = 0; m < c_; ++m) result[i * c_ + m] = divisor > 1e-30 ? result[i * c_ + m] / divisor : 0;
    });
  }

  /// The values, then n times what the field misses at the samples added: g = f + Σ_{k < n} (I − A)^k r, r = f − A f −
  /// what the local polynomials add. Calls after(k, g) after k = 0, 1, … iterations.
  template <class After>
  std::vector<double> iterate(int iterations, std::span<const std::uint8_t> without, const After& after) const {
    std::vector<double> g = values_.values, product(n_ * c_), residual(n_ * c_);
    apply(g, true, without, product);
    for (std::size_t i = 0; i < residual.size(); ++i) residual[i] = values_.values[i] - product[i];
    for (int k = 0;; ++k) {
      after(k, g);
      if (k == iterations) return g;
      for (std::size_t i = 0; i < g.size(); ++i) g[i] += residual[i];
      apply(residual, false, without, product);
      for (std::size_t i = 0; i < residual.size(); ++i) residual[i] -= product[i];
    }
  }

  std::size_t components() const { return c_; }

 private:
  const VolumeValues& values_;
  std::size_t n_, c_;
  std::vector<double> rises_;
  std::vector<std::uint64_t> first_;
  std::vector<AmlsEntry> entries_;
};

// Samples to be left out, one in twenty, by their places: whatever their order.
std::vector<std::uint8_t> held_out(const SampledVolume& volume) {
  std::vector<std::uint8_t> out(volume.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Vec3 x = volume.position(i);
    std::uint64_t h = 0x9e3779b97f4a7c15ULL;
    for (std::size_t k = 0; k < 3; ++k) {
      h ^= std::bit_cast<std::uint64_t>(x[k] + 0.0);
      h = (h ^ h >> 30) * 0xbf58476d1ce4e5b9ULL;
      h = (h ^ h >> 27) * 0x94d049bb133111ebULL;
      h ^= h >> 31;
    }
    out[i] = h % 20 == 0;
  }
  return out;
}

// Local polynomials, the choice of shape and iterations where they were not chosen, and the iterated constants.
ReconstructionCoefficients fit_amls(const ReconstructionInput& input, const detail::SupportShape& shape,
                                    double& epsilon, int& iterations) {
  const SampledVolume& volume = *input.volume;
  // What is known at the samples besides their values: gradients and second derivatives.
  LocalPolynomialOptions how;
  how.fit.max_degree = 2;
  how.fit.robust = false;
  LocalPolynomials local = fit_polynomials(volume, input.values, how, input.progress);
  const std::vector<float> least = support_radii(volume, local, 1);
  const auto radii_of = [&](double epsilon) {
    std::vector<float> radii = least;
    for (float& r : radii) r = std::max(r, static_cast<float>(std::sqrt(kDecay / epsilon)));
    return radii;
  };

  if ((!input.options.shape || !input.options.iterations) && volume.size() <= kMostForChoice) {
    const std::vector<std::uint8_t> without = held_out(volume);
    double best = std::numeric_limits<double>::infinity();
    std::vector<double> shapes(std::begin(kShapes), std::end(kShapes));
    if (input.options.shape) shapes = {*input.options.shape};
    input.progress.begin("shape and iterations", shapes.size());
    for (const double e : shapes) {
      const std::vector<float> radii = radii_of(e);
      const AmlsSystem system(volume, input.values, local, radii, shape);
      const std::size_t c = system.components();
      std::vector<double> predicted(volume.size() * c);
      system.iterate(input.options.iterations.value_or(kMostIterations), without,
                     [&](int k, std::span<const double> g) {
                       if (input.options.iterations && k != *input.options.iterations) return;
                       system.apply(g, true, without, predicted);
                       double sum = 0;
                       for (std::size_t i = 0; i < volume.size(); ++i)
                         for (std::size_t m = 0; m < c && without[i] != 0; ++m) {
                           const double miss = predicted[i * c + m] - input.values.values[i * c + m];
                           sum += miss * miss;
                         }
                       // Of nearly equal ones the one with the fewest iterations, the widest.
                       if (sum < 0.96 * best) best = sum, epsilon = e, iterations = k;
                     });
      input.progress.advance();
    }
  }

  std::vector<float> radii = radii_of(epsilon);
  {
    const AmlsSystem system(volume, input.values, local, radii, shape);
    local.constants = system.iterate(iterations, {}, [](int, std::span<const double>) {});
  }
  return {std::move(local), std::move(radii)};
}

}  // namespace

std::unique_ptr<VolumeField> make_amls_field(ReconstructionInput input) {
  const int order = input.options.order.value_or(2);
  const detail::SupportShape shape = amls_shape(order);
  double epsilon = input.options.shape.value_or(kDefaultShape);
  int iterations = input.options.iterations.value_or(kDefaultIterations);
  ReconstructionCoefficients& fitted = input.coefficients;
  if (fitted.empty()) fitted = fit_amls(input, shape, epsilon, iterations);
  ReconstructionOptions& chosen = input.report.options;
  chosen.order = order, chosen.shape = epsilon, chosen.iterations = iterations;
  auto locator = std::make_shared<const VolumeLocator>(*input.volume);
  return make_support_blend(std::move(input.volume), std::move(locator), fitted.polynomials, fitted.radii, shape);
}

}  // namespace sansmesh
