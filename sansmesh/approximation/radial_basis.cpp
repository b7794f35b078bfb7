#include "sansmesh/approximation/radial_basis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "sansmesh/approximation/radial_cover.h"
#include "sansmesh/approximation/radial_system.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kAutomaticDense = 1500;

template <int D>
void check(std::span<const Position<D>> positions, std::span<const double> values, const RbfOptions& o) {
  if (values.size() != positions.size()) throw ArgumentError("approximation: as many values as positions are needed");
  if (positions.empty()) throw DataError("approximation: no samples");
  require_finite(values);
  const int order = RadialKernel(o.function).order();
  if (o.degree && (*o.degree < order - 1 || *o.degree > 2))
    throw ArgumentError("approximation: the polynomial of '" + std::string(name_of(o.function)) +
                        "' must have a degree of " + std::to_string(order - 1) + " to 2, not " +
                        std::to_string(*o.degree));
  if (!(o.ridge >= 0 && std::isfinite(o.ridge))) throw ArgumentError("approximation: the ridge must not be negative");
  if (!(o.tolerance > 0 && o.tolerance < 1)) throw ArgumentError("approximation: the tolerance must lie in (0, 1)");
  if (o.max_iterations < 1) throw ArgumentError("approximation: at least one iteration is needed");
  if (o.local_samples < 10 || o.local_samples > 400)
    throw ArgumentError("approximation: local_samples must lie in 10 … 400");
  if (o.solver == RbfSolver::kSparse && !RadialKernel(o.function).is_compact())
    throw ArgumentError("approximation: '" + std::string(name_of(o.function)) +
                        "' has no compact support: sparse systems need wendland-c2 or wendland-c4");
}

// Merges coincident samples; their `values` become means.
template <int D>
std::size_t merge(std::vector<Position<D>>& x, std::vector<double>& values) {
  std::vector<std::uint32_t> order(x.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return x[a] != x[b] ? x[a] < x[b] : a < b; });
  std::vector<std::uint8_t> gone(x.size(), 0);
  std::size_t merged = 0;
  for (std::size_t i = 0; i < order.size();) {
    std::size_t end = i + 1;
    double sum = values[order[i]];
    for (; end < order.size() && x[order[end]] == x[order[i]]; ++end) {
      sum += values[order[end]];
      gone[order[end]] = 1;
      ++merged;
    }
    if (end > i + 1) values[order[i]] = sum / static_cast<double>(end - i);
    i = end;
  }
  if (merged == 0) return 0;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (!gone[i]) x[kept] = x[i], values[kept] = values[i], ++kept;
  x.resize(kept);
  values.resize(kept);
  return merged;
}

double default_scale(RadialFunction function, int dimension, double spacing) {
  switch (function) {
    case RadialFunction::kWendlandC2:
    case RadialFunction::kWendlandC4:
      return (dimension == 1 ? 16 : dimension == 2 ? 8 : 4) * spacing;
    case RadialFunction::kMultiquadric:
    case RadialFunction::kInverseMultiquadric:
    case RadialFunction::kGaussian:
      return 2 * spacing;
    default:
      return spacing;
  }
}

}  // namespace

template <int D>
struct RbfInterpolant<D>::State {
  // One system: positions and coefficients side by side, for evaluation in one sweep.
  struct System {
    std::vector<Position<D>> x;
    std::vector<double> c;
    detail::PolynomialTail<D> tail;
  };

  explicit State(const RadialKernel& k) : kernel(k) {}

  RadialKernel kernel;
  std::vector<System> systems;   // one, or one per ball of the cover
  SampleIndex<D> index;          // compact support only
  detail::RadialCover<D> cover;  // kLocal only

  void sum(const System& system, const Position<D>& x, std::vector<typename SampleIndex<D>::Hit>& hits, bool compact,
           double& value, Position<D>* gradient) const {
    value = 0;
    if (gradient) gradient->fill(0);
    const auto add = [&](double r2, std::size_t i) {
      if (!gradient) {
        value += system.c[i] * kernel(r2);
        return;
      }
      const RadialValue v = kernel.with_slope(r2);
      value += system.c[i] * v.value;
      for (std::size_t k = 0; k < D; ++k) (*gradient)[k] += system.c[i] * v.slope * (x[k] - system.x[i][k]);
    };
    if (compact) {
      index.within(x, kernel.support(), hits);
      for (const auto& hit : hits) add(hit.squared_distance, hit.index);
    } else {
      for (std::size_t i = 0; i < system.x.size(); ++i) add(squared_distance<D>(x, system.x[i]), i);
    }
    system.tail.add(x, value, gradient);
  }
};

template <int D>
RbfInterpolant<D>::RbfInterpolant(std::span<const Position<D>> positions, std::span<const double> values,
                                  const RbfOptions& options)
    : options_(options) {
  check<D>(positions, values, options);
  std::vector<Position<D>> x(positions.begin(), positions.end());
  std::vector<double> f(values.begin(), values.end());
  SampleIndex<D> index(x);  // rejects values that are not finite
  report_.merged = merge<D>(x, f);
  if (report_.merged > 0) index = SampleIndex<D>(x);
  report_.scale = options.scale ? *options.scale : default_scale(options.function, D, index.spacing());
  const RadialKernel kernel(options.function, report_.scale);
  const int degree = options.degree ? *options.degree : 1;

  report_.solver = options.solver;
  if (options.solver == RbfSolver::kAutomatic)
    report_.solver = x.size() <= kAutomaticDense ? RbfSolver::kDense
                     : kernel.is_compact()       ? RbfSolver::kSparse
                                                 : RbfSolver::kLocal;
  if (report_.solver == RbfSolver::kDense && x.size() > kMaxDense)
    throw ArgumentError("approximation: " + std::to_string(x.size()) + " samples are too many for a dense system (" +
                        std::to_string(kMaxDense) + "): choose local systems or a function with compact support");

  const auto state = std::make_shared<State>(kernel);
  state_ = state;
  if (report_.solver != RbfSolver::kLocal) {
    auto& system = state->systems.emplace_back();
    system.tail = detail::make_tail<D>(x, degree);
    system.c.resize(x.size());
    if (report_.solver == RbfSolver::kDense) {
      const detail::DenseResult result = detail::solve_dense<D>(kernel, options.ridge, x, f, system.tail, system.c);
      report_.dropped_polynomials = result.dropped;
      report_.added_ridge = result.added_ridge;
    } else {
      const detail::SparseResult result = detail::solve_sparse<D>(kernel, options.ridge, index, f, options.tolerance,
                                                                  options.max_iterations, system.tail, system.c);
      report_.dropped_polynomials = result.dropped;
      report_.iterations = result.iterations;
      report_.residual = result.residual;
    }
    if (kernel.is_compact()) state->index = std::move(index);
    system.x = std::move(x);
    return;
  }

  state->cover = detail::RadialCover<D>(index, options.local_samples);
  const std::size_t count = state->cover.balls().size();
  state->systems.resize(count);
  std::vector<detail::DenseResult> results(count);
  parallel_for(0, count, 1, [&](std::size_t s) {
    auto& system = state->systems[s];
    std::vector<std::uint32_t> members;
    state->cover.members(s, index, members);
    std::vector<double> own;
    for (const std::uint32_t i : members) system.x.push_back(x[i]), own.push_back(f[i]);
    system.tail = detail::make_tail<D>(system.x, degree);
    system.c.resize(own.size());
    results[s] = detail::solve_dense<D>(kernel, options.ridge, system.x, own, system.tail, system.c);
  });
  report_.systems = count;
  for (const auto& r : results) {
    report_.dropped_polynomials = std::max(report_.dropped_polynomials, r.dropped);
    report_.added_ridge = std::max(report_.added_ridge, r.added_ridge);
  }
}

template <int D>
void RbfInterpolant<D>::evaluate(std::span<const Position<D>> x, std::span<double> values,
                                 std::span<Position<D>> gradients) const {
  if (values.size() != x.size() || !(gradients.empty() || gradients.size() == x.size()))
    throw ArgumentError("approximation: the sizes of values and gradients must match the number of points");
  const State& state = *state_;
  const bool local = report_.solver == RbfSolver::kLocal, compact = !local && state.kernel.is_compact();
  parallel_ranges(0, x.size(), 16, [&](std::size_t first, std::size_t last) {
    std::vector<typename SampleIndex<D>::Hit> hits;
    std::vector<typename detail::RadialCover<D>::Part> parts;
    for (std::size_t i = first; i < last; ++i) {
      Position<D>* gradient = gradients.empty() ? nullptr : &gradients[i];
      bool finite = true;
      for (const double v : x[i]) finite = finite && std::isfinite(v);
      if (!finite) {
        values[i] = std::numeric_limits<double>::quiet_NaN();
        if (gradient) gradient->fill(values[i]);
        continue;
      }
      if (!local) {
        state.sum(state.systems[0], x[i], hits, compact, values[i], gradient);
        continue;
      }
      // Σ w s / Σ w and its derivative.
      state.cover.find(x[i], parts);
      double sum = 0, weights = 0;
      Position<D> sum_slope{}, weight_slope{};
      for (const auto& part : parts) {
        double value;
        Position<D> slope;
        state.sum(state.systems[part.ball], x[i], hits, false, value, gradient ? &slope : nullptr);
        sum += part.weight * value;
        weights += part.weight;
        for (std::size_t k = 0; gradient && k < D; ++k) {
          sum_slope[k] += part.weight * slope[k] + part.slope[k] * value;
          weight_slope[k] += part.slope[k];
        }
      }
      values[i] = sum / weights;
      for (std::size_t k = 0; gradient && k < D; ++k)
        (*gradient)[k] = (sum_slope[k] - values[i] * weight_slope[k]) / weights;
    }
  });
}

template class RbfInterpolant<1>;
template class RbfInterpolant<2>;
template class RbfInterpolant<3>;

}  // namespace sansmesh::inline v1
