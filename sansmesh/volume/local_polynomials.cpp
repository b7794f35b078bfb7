#include "sansmesh/volume/local_polynomials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "sansmesh/approximation/orthogonal_polynomials.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/sample_stencil.h"

namespace sansmesh {
double tun(const char* n, double d) { const char* s = getenv(n); return s ? atof(s) : d; }
namespace {

class PolynomialFitter {
 public:
  PolynomialFitter(const SampledVolume& volume, const Adjacency& cells, const VolumeValues& values,
                   const LocalPolynomialOptions& options)
      : volume_(volume), cells_(cells), values_(values), options_(options), stencil_(volume) {}

  int fit(std::uint32_t i, const StarMetric& metric, std::vector<double>& constants, std::vector<float>& out) {
    static const double kEnough = tun("ENOUGH", 2.0), kMost = tun("MOST", 4.0), kWidth = tun("WIDTH", 1.1), kGain = tun("GAIN", 0.9);
    const auto basis = static_cast<double>(monomial_count(3, options_.max_degree));
    stencil_.gather(i, metric, static_cast<std::size_t>(kEnough * basis), static_cast<std::size_t>(kMost * basis), 6);
    const auto samples = stencil_.samples();
    const std::size_t n = samples.size(), c = values_.components;
    for (auto& u : u_) u.resize(n);
    weights_.resize(n);
    f_.resize(n * c);
    for (std::size_t s = 0; s < n; ++s) {
      const Vec3& u = stencil_.local()[s];
      for (std::size_t k = 0; k < 3; ++k) u_[k][s] = u[k];
      weights_[s] = std::max(std::exp(-squared_norm(u) / (kWidth * kWidth)), 1e-4);
      for (std::size_t m = 0; m < c; ++m)
        f_[m * n + s] = values_.values[samples[s] * c + m] - values_.values[i * c + m];
    }
    fit_.reset({{u_[0], u_[1], u_[2]}, std::span(f_).first(n), weights_}, ApproximationFrame<3>{});
    tests_.clear();
    for (const std::uint32_t cell : cells_[i]) {
      const auto corners = volume_.cells[cell];
      Vec3 mean;
      for (const std::uint32_t k : corners) mean += volume_.corner(k);
      const Vec3 u = metric(mean / static_cast<double>(corners.size()) - volume_.positions[i]);
      tests_.push_back({u.x, u.y, u.z});
    }
    amplification_.assign(tests_.size(), 0.0);
    static const double kBound = tun("BOUND", 16);
    int best = 0;
    double best_score = 0;
    leverage_.assign(n, 0.0);
    int counted = 0;
    for (int d = 0; d <= options_.max_degree; ++d) {
      if (static_cast<double>(n) < 1.5 * monomial_count(3, d)) break;
      if (!fit_.raise() && d > 0) break;
      psi_.resize(static_cast<std::size_t>(fit_.size()));
      double worst = 0;
      for (std::size_t t = 0; t < tests_.size(); ++t) {
        fit_.basis(tests_[t], psi_);
        for (int j = counted; j < fit_.size(); ++j)
          if (!fit_.is_dropped(j)) amplification_[t] += psi_[j] * psi_[j] / fit_.squared_norm(j);
        worst = std::max(worst, amplification_[t]);
      }
      if (d > 0 && worst > kBound) break;
      for (; counted < fit_.size(); ++counted) {
        if (fit_.is_dropped(counted)) continue;
        const auto row = fit_.weighted_basis(counted);
        const double inverse = 1 / fit_.squared_norm(counted);
        for (std::size_t s = 0; s < n; ++s) leverage_[s] += row[s] * row[s] * inverse;
      }
      double score = 0;
      const auto r = fit_.weighted_residuals();
      for (std::size_t s = 0; s < n; ++s) {
        const double e = r[s] / std::max(1 - leverage_[s], 0.02);
        score += e * e;
      }
      if (d == 0 || score < kGain * best_score) best = d, best_score = score;
      //if (score == 0) break;
    }
    static const int force = static_cast<int>(tun("FORCE", -1));
    if (force >= 0) best = std::min(force, fit_.degree());
    const auto terms = static_cast<std::size_t>(monomial_count(3, best));
    for (std::size_t m = 0; m < c; ++m) {
      orthogonal_.assign(terms, 0.0);
      monomial_.assign(terms, 0.0);
      for (std::size_t j = 0; j < terms; ++j) orthogonal_[j] = fit_.coefficient(static_cast<int>(j));
      fit_.monomial_coefficients(orthogonal_, monomial_);
      constants.push_back(values_.values[i * c + m] + (1 - options_.share) * monomial_[0]);
      for (std::size_t j = 1; j < terms; ++j) out.push_back(static_cast<float>(monomial_[j]));
    }
    return best;
  }

 private:
  const SampledVolume& volume_;
  const Adjacency& cells_;
  const VolumeValues& values_;
  LocalPolynomialOptions options_;
  SampleStencil stencil_;
  OrthogonalFit<3> fit_{OrthogonalFitOptions{tun("RANK", 0.05)}};
  std::array<std::vector<double>, 3> u_;
  std::vector<std::array<double, 3>> tests_;
  std::vector<double> amplification_, psi_;
  std::vector<double> f_, weights_, leverage_, orthogonal_, monomial_;
};

double value_at(const float* c, int degree, const Vec3& u) {
  const auto& order = PolynomialOrder<3>::get();
  std::array<double, monomial_count(3, LocalPolynomials::kMaxDegree)> monomial{1.0};
  double sum = 0;
  for (int j = 1; j < monomial_count(3, degree); ++j) {
    const auto& step = order[j];
    const double t = u[static_cast<std::size_t>(step.variable)] * monomial[static_cast<std::size_t>(step.predecessor)];
    monomial[static_cast<std::size_t>(j)] = t;
    sum += static_cast<double>(c[j - 1]) * t;
  }
  return sum;
}

// How far polynomials of neighbours agree half-way between them, against how far they are from linear there.
std::vector<float> trust_of(const SampledVolume& volume, const VolumeValues& values,
                            std::span<const StarMetric> metrics, std::span<const double> constants,
                            std::span<const std::uint8_t> degrees, std::span<const std::uint64_t> first,
                            std::span<const float> coefficients) {
  const std::size_t n = volume.size(), c = values.components;
  std::vector<float> trust(n, 1.0f);
  static const double kDoubt = tun("DOUBT", 1);
  parallel_for(0, n, 512, [&](std::size_t i) {
    double gain = 0, doubt = 0;
    const auto half = [&](std::size_t k, const Vec3& d, std::size_t m) {
      const auto terms = static_cast<std::size_t>(monomial_count(3, degrees[k]) - 1);
      return constants[k * c + m] + value_at(coefficients.data() + first[k] + m * terms, degrees[k], metrics[k](d));
    };
    for (const std::uint32_t j : volume.stars[i]) {
      const Vec3 d = (volume.positions[j] - volume.positions[i]) * 0.5;
      for (std::size_t m = 0; m < c; ++m) {
        const double own = half(i, d, m), other = half(j, -d, m);
        const double linear = 0.5 * (values.values[i * c + m] + values.values[j * c + m]);
        const double a = 0.5 * (own + other) - linear, b = 0.5 * (own - other);
        gain += a * a, doubt += b * b;
      }
    }
    static const double kFree = tun("FREE", 0.5); doubt -= kFree * gain;
    if (doubt > 0) trust[i] = static_cast<float>(gain / (gain + kDoubt * doubt));
  });
  return trust;
}

}  // namespace

Adjacency cells_of_samples(const SampledVolume& volume) {
  const std::size_t n = volume.size();
  const CellList& cells = volume.cells;
  Adjacency result;
  result.first.assign(n + 1, 0);
  const auto each = [&](const auto& visit) {
    for (std::size_t c = 0; c < cells.size(); ++c) {
      if (!volume.cell_sample.empty()) {
        visit(volume.cell_sample[c], c);
        continue;
      }
      const auto corners = cells[c];
      for (std::size_t k = 0; k < corners.size(); ++k)
        if (std::find(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(k), corners[k]) ==
            corners.begin() + static_cast<std::ptrdiff_t>(k))
          visit(corners[k], c);
    }
  };
  each([&](std::uint32_t sample, std::size_t) { ++result.first[sample + 1]; });
  for (std::size_t i = 0; i < n; ++i) result.first[i + 1] += result.first[i];
  result.entries.resize(result.first.back());
  std::vector<std::uint64_t> at(result.first.begin(), result.first.end() - 1);
  each([&](std::uint32_t sample, std::size_t c) { result.entries[at[sample]++] = static_cast<std::uint32_t>(c); });
  return result;
}

LocalPolynomials fit_local_polynomials(const SampledVolume& volume, const VolumeValues& values,
                                       const LocalPolynomialOptions& options, Progress& progress) {
  const std::size_t n = volume.size(), chunk = 2048, chunks = (n + chunk - 1) / chunk;
  LocalPolynomials result;
  result.components = values.components;
  std::vector<StarMetric> metrics = star_metrics(volume);
  const Adjacency cells = cells_of_samples(volume);
  struct Part {
    std::vector<double> constants;
    std::vector<float> coefficients;
    std::vector<std::uint8_t> degrees;
  };
  std::vector<Part> parts(chunks);
  progress.begin("local polynomials", chunks);
  parallel_ranges(0, chunks, 8, [&](std::size_t begin, std::size_t end) {
    PolynomialFitter fitter(volume, cells, values, options);
    for (std::size_t p = begin; p < end; ++p) {
      for (std::size_t i = p * chunk; i < std::min(n, (p + 1) * chunk); ++i)
        parts[p].degrees.push_back(static_cast<std::uint8_t>(
            fitter.fit(static_cast<std::uint32_t>(i), metrics[i], parts[p].constants, parts[p].coefficients)));
      progress.advance();
    }
  });
  std::vector<double> constants;
  std::vector<float> coefficients;
  std::vector<std::uint8_t> degrees;
  std::vector<std::uint64_t> first{0};
  for (Part& part : parts) {
    constants.insert(constants.end(), part.constants.begin(), part.constants.end());
    coefficients.insert(coefficients.end(), part.coefficients.begin(), part.coefficients.end());
    for (const std::uint8_t d : part.degrees) {
      degrees.push_back(d);
      first.push_back(first.back() + values.components * static_cast<std::uint64_t>(monomial_count(3, d) - 1));
    }
    part = {};
  }
  result.trust = trust_of(volume, values, metrics, constants, degrees, first, coefficients);
  result.metrics = std::move(metrics);
  result.constants = std::move(constants);
  result.coefficients = std::move(coefficients);
  result.degrees = std::move(degrees);
  result.first = std::move(first);
  return result;
}

}  // namespace sansmesh
