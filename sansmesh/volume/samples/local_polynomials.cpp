#include "sansmesh/volume/samples/local_polynomials.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/cells/cell_adjacency.h"
#include "sansmesh/volume/cells/higher_order_functions.h"
#include "sansmesh/volume/methods/cell_agreement.h"
#include "sansmesh/volume/samples/sample_set.h"
#include "sansmesh/volume/samples/sample_stencil.h"
#include "sansmesh/volume/samples/stencil_fit.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kStencilRings = 6;
constexpr double kEnough = 2, kPlenty = 4;  // samples of a stencil, in multiples of the number of polynomials

// Fits the polynomials of a mesh sample by sample.
class MeshFitter {
 public:
  MeshFitter(const SampledVolume& volume, const Adjacency& cells, const VolumeValues& values,
             const LocalPolynomialOptions& options)
      : volume_(volume), cells_(cells), values_(values), options_(options), stencil_(volume), fit_(options.fit) {}

  void append(std::uint32_t i, const StarMetric& metric, PolynomialPart& part) {
    const auto basis = static_cast<double>(monomial_count(3, options_.fit.max_degree));
    stencil_.gather(i, metric, static_cast<std::size_t>(kEnough * basis), static_cast<std::size_t>(kPlenty * basis),
                    kStencilRings);
    const auto samples = stencil_.samples();
    const std::size_t n = samples.size(), c = values_.components;
    f_.resize(n * c);
    for (std::size_t m = 0; m < c; ++m)
      for (std::size_t s = 0; s < n; ++s)
        f_[m * n + s] = values_.values[samples[s] * c + m] - values_.values[i * c + m];
    tests_.clear();
    const auto local = [&](const Vec3& x) { return metric(x - volume_.positions[i]); };
    for (const std::uint32_t cell : cells_[i]) {
      const auto corners = volume_.cells[cell];
      Vec3 mean;
      for (const std::uint32_t k : corners) {
        mean += volume_.corner(k);
        if (!volume_.cell_sample.empty()) tests_.push_back(local(volume_.corner(k)));
      }
      tests_.push_back(local(mean / static_cast<double>(corners.size())));
    }
    fit_.fit(stencil_.local(), f_, c, tests_);
    part.append(fit_, values_.of(i), options_.share, true);
  }

 private:
  const SampledVolume& volume_;
  const Adjacency& cells_;
  const VolumeValues& values_;
  LocalPolynomialOptions options_;
  SampleStencil stencil_;
  StencilFit fit_;
  std::vector<Vec3> tests_;
  std::vector<double> f_;
};

// Extent of the samples beyond an edge, in edge lengths: in the star and in the ring after it. From kNear, or kFar, on
// the second differences over the edge are determined; below kNone the edge crosses a layer at which the stars of both
// sides end.
constexpr double kNear = 0.95, kFar = 1.6, kNone = 0.5, kLeastKnown = 0.45;
// Corrections of this size relative to the differences of neighbours count as under-resolved: parabolas have extrema
// within the edges.
constexpr double kCoarse = 0.25;
/// Corrections and disagreements up to this share of the largest difference to a neighbour, or of the largest value,
/// are rounding errors: coefficients are floats, values come from sums. Such disagreement is no doubt.
constexpr double kRoundedDifference = 1e-6, kRoundedValue = 1e-13;
constexpr double kClearlyKnown = 1e4;  // second differences, in squares of rounding errors
constexpr double kDisagreement = 2.5;  // variance of a correction, in squares of half the difference of neighbours

// Corrections that change by this share (squared) with the degree, or with the terms they follow from, are unreliable:
// series of polynomials converge badly where steps grow as fast as the lengths over which a function falls.
constexpr double kUnsettled = 0.125;

class EdgeSupport {
 public:
  explicit EdgeSupport(const SampledVolume& volume) : volume_(volume) {}

  /// Sets the sample whose edges are evaluated, with its star.
  void set(const Vec3& x, const StarMetric& metric, std::span<const std::uint32_t> star) {
    x_ = x, metric_ = metric;
    behind_.begin(star);
  }

  /// Doubt of a correction at the middle of the edge of length u (local) to sample j: 0 where samples extend beyond one
  /// of its ends by the length of the edge.
  double doubt(std::uint32_t j, const Vec3& u) {
    const double length = squared_norm(u);
    if (!(length > 0)) return 0;
    const Vec3 e = u / length;
    Reach reach = reach_of(behind_, e * -1.0, 0);
    if (reach.known() >= 1) return 0;
    volume_.star(j, star_);
    ahead_.begin(star_);
    const Reach other = reach_of(ahead_, e, 1);
    reach = {std::max(reach.first, other.first), std::max(reach.second, other.second)};
    if (reach.second < kNone || reach.known() >= 1) return 0;
    const double known = std::max(reach.known(), kLeastKnown);
    return 1 / (known * known * known * known) - 1;
  }

 private:
  struct Reach {
    double first = 0, second = 0;
    double known() const { return std::max(first / kNear, second / kFar); }
  };
  /// The star and the additional samples of the next ring, without duplicates, in the metric.
  struct Rings {
    std::vector<std::uint32_t> star;
    std::vector<Vec3> first, second;
    bool has_first = false, has_second = false;

    void begin(std::span<const std::uint32_t> of) {
      star.assign(of.begin(), of.end());
      has_first = has_second = false;
    }
  };

  Vec3 local(std::uint32_t sample) const { return metric_(volume_.position(sample) - x_); }

  void find_first(Rings& rings) const {
    rings.first.clear();
    for (const std::uint32_t k : rings.star) rings.first.push_back(local(k));
    rings.has_first = true;
  }

  void find_second(Rings& rings) {
    rings.second.clear();
    seen_.clear();
    for (const std::uint32_t k : rings.star) seen_.insert(k);
    for (const std::uint32_t k : rings.star) {
      volume_.star(k, next_);
      for (const std::uint32_t l : next_)
        if (seen_.insert(l)) rings.second.push_back(local(l));
    }
    rings.has_second = true;
  }

  /// The next ring is only computed if the star does not reach far enough.
  Reach reach_of(Rings& rings, const Vec3& e, double end) {
    if (!rings.has_first) find_first(rings);
    Reach reach;
    for (const Vec3& u : rings.first) reach.first = std::max(reach.first, dot(u, e) - end);
    reach.second = reach.first;
    if (reach.known() >= 1) return reach;
    if (!rings.has_second) find_second(rings);
    for (const Vec3& u : rings.second) reach.second = std::max(reach.second, dot(u, e) - end);
    return reach;
  }

  const SampledVolume& volume_;
  Vec3 x_;
  StarMetric metric_;
  Rings behind_, ahead_;
  SampleSet seen_;
  std::vector<std::uint32_t> star_, next_;
};

double value_at(std::span<const float> c, const Vec3& u, double factor = 1) {
  const auto& order = PolynomialOrder<3>::get();
  std::array<double, monomial_count(3, LocalPolynomials::kMaxDegree)> monomial{1.0};
  double sum = 0;
  for (std::size_t j = 1; j <= c.size(); ++j) {
    const auto& step = order[static_cast<int>(j)];
    monomial[j] = u[static_cast<std::size_t>(step.variable)] * monomial[static_cast<std::size_t>(step.predecessor)];
    sum += static_cast<double>(c[j - 1]) * monomial[j] * (j > 3 ? factor : 1);
  }
  return sum;
}

/// A component between two samples.
struct TrustEdge {
  std::size_t i, j, component;
};

/// Squared changes of a correction `a` half-way along an edge, at `d` from its first end: by the terms of the highest
/// degree, and if it follows from the slopes at both ends alone (not of planes, which are nothing but slopes). Zero for
/// both if polynomials have converged there.
double correction_changes(const LocalPolynomials& p, std::span<const float> lower, const SampledVolume& volume,
                          const TrustEdge& edge, const Vec3& d, double a) {
  const auto at_end = [&](std::size_t sample, const Vec3& to, double& by_degree, double& slope) {
    const Vec3 u = p.metric(volume, sample)(to);
    const auto terms = p.of(sample, edge.component);
    by_degree += value_at(terms, u) - value_at(p.in(lower, sample, edge.component), u);
    slope += value_at(terms.first(std::min<std::size_t>(terms.size(), 3)), u);
  };
  double by_degree = 0, slopes = 0;
  at_end(edge.i, d, by_degree, slopes);
  at_end(edge.j, -d, by_degree, slopes);
  const bool planes = p.degrees[edge.i] < 2 || p.degrees[edge.j] < 2;
  const double by_slopes = planes ? 0 : a - 0.25 * slopes;
  return 0.25 * by_degree * by_degree + by_slopes * by_slopes;
}

}  // namespace

double LocalPolynomials::rise(std::size_t sample, std::size_t component, const Vec3& u) const {
  return value_at(of(sample, component), u, static_cast<double>(trust[sample]));
}

double LocalPolynomials::full_rise(std::size_t sample, std::size_t component, const Vec3& u) const {
  return value_at(of(sample, component), u);
}

StarMetric LocalPolynomials::metric(const SampledVolume& volume, std::size_t sample) const {
  return metric_of(volume, metrics.view(), sample);
}

std::vector<float> polynomial_trust(const SampledVolume& volume, const VolumeValues& values, const LocalPolynomials& p,
                                    std::span<const float> lower, std::span<const std::uint8_t> split, bool in_cells) {
  const std::size_t n = volume.size(), c = values.components;
  std::vector<float> trust(n, 1.0f);
  const auto at = [&](std::size_t i, std::size_t m, const Vec3& x) {
    return p.constants[i * c + m] + value_at(p.of(i, m), p.metric(volume, i)(x - volume.position(i)));
  };
  const CellAgreement agreement = in_cells ? CellAgreement(volume, values, at, split) : CellAgreement();
  const HigherOrderFunctions higher(volume);
  const Adjacency cells = higher.empty() ? Adjacency() : cells_of_samples(volume);
  parallel_ranges(0, n, 512, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> star;
    NodeWeights nodes;
    EdgeSupport support(volume);
    for (std::size_t i = begin; i < end; ++i) {
      volume.star(i, star);
      double gain = 0, doubt = 0, open = 0, unsettled = 0, varied = 0, rounding = 0;
      const Vec3 x = volume.position(i);
      const StarMetric metric = p.metric(volume, i);
      support.set(x, metric, star);
      for (const std::uint32_t j : star) {
        const Vec3 d = (volume.position(j) - x) * 0.5;
        const double unknown = support.doubt(j, metric(d) * 2.0);
        const bool of_cell = !higher.empty() && higher.at_edge(cells[i], static_cast<std::uint32_t>(i), j, nodes);
        for (std::size_t m = 0; m < c; ++m) {
          const double own = p.constants[i * c + m] + value_at(p.of(i, m), metric(d));
          const double other = p.constants[j * c + m] + value_at(p.of(j, m), p.metric(volume, j)(-d));
          const double fi = values.values[i * c + m], fj = values.values[j * c + m];
          const double flat = of_cell ? nodes.value(values, m) : 0.5 * (fi + fj);
          const double a = 0.5 * (own + other) - flat, b = 0.5 * (own - other);
          // Polynomials on both sides of a step disagree without being doubtful.
          if (split[i] != 0 && split[j] != 0 && std::abs(own - fi) + std::abs(other - fj) < 0.5 * std::abs(fi - fj))
            continue;
          const double sure = of_cell ? agreed_square(own - flat, other - flat) : a * a;
          gain += sure, open += unknown * sure;
          doubt += kDisagreement * (of_cell ? std::min(b * b, (own - flat) * (own - flat)) : b * b);
          if (!lower.empty() && !of_cell) unsettled += correction_changes(p, lower, volume, {i, j, m}, d, a);
          const double rounded =
              std::max(kRoundedDifference * std::abs(fi - fj), kRoundedValue * std::max(std::abs(fi), std::abs(fj)));
          rounding = std::max(rounding, rounded * rounded);
          // In cells of higher order the second difference is known, and the correction is of higher order.
          const double known = of_cell ? flat - 0.5 * (fi + fj) : fi - fj;
          varied += known * known + (of_cell ? kClearlyKnown * rounded * rounded : 0);
        }
      }
      // The mean over cell centres counts as much as that over edges.
      CellAgreement::Share inside = agreement.of(i);
      inside.gain *= static_cast<double>(star.size()), inside.doubt *= static_cast<double>(star.size());
      // Large corrections derived from differences over short edges are unreliable over long ones.
      if (gain > 0) {
        const double coarse = varied > 0 ? std::min(gain / (kCoarse * kCoarse * varied), 1.0) : 1;
        doubt += coarse * coarse * coarse * open * (1 + inside.gain / gain);
        unsettled = std::max(unsettled - rounding * static_cast<double>(star.size()), 0.0);
        const double unsure = unsettled / (kUnsettled * gain);
        doubt += unsure * unsure * unsettled;
      }
      gain += inside.gain, doubt += kDisagreement * inside.doubt;
      doubt -= rounding * static_cast<double>(star.size());
      if (doubt > 0) trust[i] = static_cast<float>(gain / (gain + doubt));
    }
  });
  return trust;
}

LocalPolynomials fit_local_polynomials(const SampledVolume& volume, const VolumeValues& values,
                                       const LocalPolynomialOptions& options, Progress& progress) {
  return fit_local_polynomials(volume, values, options, star_metrics(volume), progress);
}

LocalPolynomials fit_local_polynomials(const SampledVolume& volume, const VolumeValues& values,
                                       const LocalPolynomialOptions& options, std::vector<StarMetric> metrics,
                                       Progress& progress) {
  const Adjacency cells = cells_of_samples(volume);
  return gather_polynomials<PolynomialPart>(
      volume, values, progress, [&] { return MeshFitter(volume, cells, values, options); },
      [&](MeshFitter& fitter, std::size_t i, PolynomialPart& part) {
        fitter.append(static_cast<std::uint32_t>(i), metrics[i], part);
      },
      metrics, options.ask_in_cells);
}

}  // namespace sansmesh::inline v1
