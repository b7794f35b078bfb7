#include "sansmesh/dataset/volume_flow.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <future>
#include <mutex>
#include <utility>

#include "sansmesh/core/cancel_scope.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/dataset/step_times.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

class VolumeFlow final : public VectorField {
 public:
  explicit VolumeFlow(std::shared_ptr<const VolumeField> field) : field_(std::move(field)) {
    const std::size_t n = field_->components();
    if (n != 2 && n != 3)
      throw ArgumentError("a flow needs vectors of two or three components, not " + std::to_string(n));
  }
  Box3 bounds() const override { return field_->bounds(); }
  void evaluate(std::span<const Vec3> x, std::span<const double> t, std::span<Vec3> vectors,
                std::span<std::uint8_t> inside, std::span<Jacobian> jacobian) const override {
    const std::size_t n = x.size(), components = field_->components();
    // Particles evaluate small batches many times.
    static thread_local std::vector<double> value_store;
    static thread_local std::vector<Vec3> slope_store;
    std::vector<double> many_values;
    std::vector<Vec3> many_slopes;
    constexpr std::size_t kSmall = 1024;
    std::vector<double>& values = n <= kSmall ? value_store : many_values;
    std::vector<Vec3>& gradients = n <= kSmall ? slope_store : many_slopes;
    values.resize(n * components);
    gradients.resize(jacobian.empty() ? 0 : n * components);
    field_->evaluate(x, {values, gradients, inside});
    parallel_for(0, n, 4096, [&](std::size_t i) {
      inside[i] = inside[i] != 0 && std::isfinite(t[i]);
      vectors[i] = {};
      if (!jacobian.empty()) jacobian[i] = {};
      if (inside[i] == 0) return;
      for (std::size_t c = 0; c < components; ++c) {
        vectors[i][c] = values[i * components + c];
        for (std::size_t k = 0; k < 3 && !jacobian.empty(); ++k) jacobian[i][k][c] = gradients[i * components + c][k];
      }
    });
  }

 private:
  std::shared_ptr<const VolumeField> field_;
};

class FlowInTime final : public VectorField {
 public:
  FlowInTime(std::vector<double> times, std::function<FlowStep(std::size_t)> load, const FlowSeriesOptions& options)
      : times_(std::move(times)), load_(std::move(load)), options_(options) {
    if (times_.size() < 2) throw ArgumentError("a flow in time needs two steps at least");
    check_step_times(times_);
    bounds_ = steps({0, 1})[0]->bounds();
  }
  ~FlowInTime() override {
    stop_.cancel();
    if (ahead_.valid()) ahead_.wait();
  }
  FlowInTime(const FlowInTime&) = delete;
  FlowInTime& operator=(const FlowInTime&) = delete;

  Box3 bounds() const override { return bounds_; }
  TimeRange times() const override { return {times_.front(), times_.back()}; }
  std::span<const double> sample_times() const override { return times_; }

  void evaluate(std::span<const Vec3> x, std::span<const double> t, std::span<Vec3> vectors,
                std::span<std::uint8_t> inside, std::span<Jacobian> jacobian) const override {
    // Groups points by time interval, so that every step is read once. In most batches all intervals are equal.
    std::vector<std::size_t> interval(x.size());
    bool alike = true;
    for (std::size_t i = 0; i < x.size(); ++i) {
      interval[i] = times().contains(t[i]) ? step_interval(times_, t[i]) : kNever;
      alike = alike && interval[i] == interval[0];
    }
    if (x.empty()) return;
    if (alike && interval[0] != kNever) return blend(interval[0], x, t, {vectors, inside, jacobian});
    std::fill(vectors.begin(), vectors.end(), Vec3{});
    std::fill(inside.begin(), inside.end(), std::uint8_t{0});
    std::fill(jacobian.begin(), jacobian.end(), Jacobian{});
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (interval[i] != kNever) order.push_back(i);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return interval[a] < interval[b]; });
    Gathered part;
    for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
      while (last < order.size() && interval[order[last]] == interval[order[first]]) ++last;
      const std::span which(order.data() + first, last - first);
      part.gather(x, t, which, !jacobian.empty());
      blend(interval[which[0]], part.x, part.t, part.results());
      for (std::size_t k = 0; k < which.size(); ++k) {
        vectors[which[k]] = part.vectors[k], inside[which[k]] = part.inside[k];
        if (!jacobian.empty()) jacobian[which[k]] = part.jacobian[k];
      }
    }
  }

 private:
  using Loaded = std::shared_ptr<const VectorField>;
  static constexpr std::size_t kNever = ~std::size_t{0};

  struct Results {
    std::span<Vec3> vectors;
    std::span<std::uint8_t> inside;
    std::span<Jacobian> jacobian;  // empty: not requested
  };

  /// Points and times of a group from a batch, with storage for the results.
  struct Gathered {
    std::vector<Vec3> x;
    std::vector<double> t;
    std::vector<Vec3> vectors;
    std::vector<std::uint8_t> inside;
    std::vector<Jacobian> jacobian;

    void gather(std::span<const Vec3> from, std::span<const double> moments, std::span<const std::size_t> which,
                bool derivatives) {
      x.clear(), t.clear();
      for (const std::size_t i : which) x.push_back(from[i]), t.push_back(moments[i]);
      vectors.resize(which.size()), inside.resize(which.size()), jacobian.resize(derivatives ? which.size() : 0);
    }
    Results results() { return {vectors, inside, jacobian}; }
  };

  /// Weights of the steps first, first + 1, … at a time in an interval.
  struct Shares {
    std::size_t first = 0, count = 0;
    std::array<double, 4> of{};
  };
  Shares shares_at(std::size_t interval, double t) const {
    const double a = times_[interval], b = times_[interval + 1], u = (t - a) / (b - a);
    // The time of a step needs that step only: particles arrive there, and the next step is not needed yet.
    if (u <= 0) return {interval, 1, {1}};
    if (u >= 1) return {interval + 1, 1, {1}};
    if (options_.interpolation == TimeInterpolation::constant) return {interval, 1, {1}};
    if (options_.interpolation == TimeInterpolation::linear) return {interval, 2, {1 - u, u}};
    // Hermite's cubic with slopes of parabolas through three steps, at the ends through two.
    const std::size_t first = interval > 0 ? interval - 1 : 0, last = std::min(interval + 2, times_.size() - 1);
    Shares s{first, last - first + 1, {}};
    const double h = b - a, u2 = u * u, u3 = u2 * u;
    const std::size_t at = interval - first;
    s.of[at] += 2 * u3 - 3 * u2 + 1;
    s.of[at + 1] += 3 * u2 - 2 * u3;
    const auto slope = [&](std::size_t k, double weight) {  // slope at step k, times the interval
      if (k == 0 || k + 1 == times_.size()) {
        const std::size_t low = k == 0 ? 0 : k - 1;
        const double d = times_[low + 1] - times_[low];
        s.of[low - first] -= weight * h / d;
        s.of[low + 1 - first] += weight * h / d;
        return;
      }
      const double before = times_[k] - times_[k - 1], after = times_[k + 1] - times_[k];
      const double p = after / (before * (before + after)), n = before / (after * (before + after));
      s.of[k - 1 - first] -= weight * h * p;
      s.of[k - first] += weight * h * (p - n);
      s.of[k + 1 - first] += weight * h * n;
    };
    slope(interval, u3 - 2 * u2 + u);
    slope(interval + 1, u3 - u2);
    return s;
  }

  /// The results at times in one interval.
  void blend(std::size_t interval, std::span<const Vec3> x, std::span<const double> t, const Results& into) const {
    const std::size_t n = x.size();
    const bool derivatives = !into.jacobian.empty();
    std::fill(into.vectors.begin(), into.vectors.end(), Vec3{});
    std::fill(into.inside.begin(), into.inside.end(), std::uint8_t{1});
    std::fill(into.jacobian.begin(), into.jacobian.end(), Jacobian{});
    std::vector<Shares> shares(n);
    std::size_t first = times_.size(), last = 0;
    // Some particles reach the next step before others: it belongs to the same window.
    bool on_the_way = false;
    for (std::size_t i = 0; i < n; ++i) {
      shares[i] = shares_at(interval, t[i]);
      first = std::min(first, shares[i].first);
      last = std::max(last, shares[i].first + shares[i].count);
      on_the_way = on_the_way || t[i] > times_[interval];
    }
    const std::vector<Loaded> loaded = steps({first, on_the_way ? std::max(last, interval + 2) : last});
    std::vector<std::size_t> which;
    Gathered part;
    for (std::size_t k = first; k < last; ++k) {
      which.clear();
      for (std::size_t i = 0; i < n; ++i)
        if (k >= shares[i].first && k < shares[i].first + shares[i].count) which.push_back(i);
      if (which.empty()) continue;
      part.gather(x, t, which, derivatives);
      loaded[k - first]->evaluate(part.x, part.t, part.vectors, part.inside, part.jacobian);
      for (std::size_t w = 0; w < which.size(); ++w) {
        const std::size_t i = which[w];
        const double share = shares[i].of[k - shares[i].first];
        if (part.inside[w] == 0) into.inside[i] = 0;
        into.vectors[i] += part.vectors[w] * share;
        for (std::size_t c = 0; c < 3 && derivatives; ++c) into.jacobian[i][c] += part.jacobian[w][c] * share;
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (into.inside[i] != 0) continue;
      into.vectors[i] = {};
      if (derivatives) into.jacobian[i] = {};
    }
  }

  struct Range {
    std::size_t first, last;  // exclusive end
  };
  struct Read {
    std::size_t step;
    Loaded field;
    std::size_t bytes;
    std::function<void()> taken;
  };

  /// A range of steps; the next one in the direction of the calls is read in parallel.
  std::vector<Loaded> steps(Range wanted) const {
    const std::lock_guard lock(mutex_);
    std::vector<Loaded> found;
    for (std::size_t k = wanted.first; k < wanted.last; ++k) found.push_back(step(k));
    if (wanted.first < latest_.first || wanted.last > latest_.last) {  // else a time in the same steps
      back_ = wanted.last <= latest_.last;
      latest_ = wanted;
    }
    const std::size_t next =
        back_ ? wanted.first - 1 : wanted.last;  // below the first step it wraps around, beyond the end
    if (next < times_.size() && !ahead_.valid() && !is_kept(next)) {
      ahead_step_ = next;
      ahead_ = std::async(std::launch::async, [this, next, threads = thread_count()] {
        const CancelScope until_it_ends(stop_);  // the present caller may have finished by then
        const ThreadScope scope(std::min(threads, ThreadScope::kMost));
        return read(next);
      });
    }
    return found;
  }

  bool is_kept(std::size_t k) const {
    return std::any_of(kept_.begin(), kept_.end(), [&](const Read& r) { return r.step == k; });
  }

  Loaded step(std::size_t k) const {
    if (!is_kept(k)) {
      if (ahead_.valid()) {
        while (ahead_.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready) check_cancelled();
        const bool right = ahead_step_ == k;
        try {
          keep(ahead_.get());
        } catch (...) {
          if (right) throw;  // otherwise the step was not requested
        }
      }
      if (!is_kept(k)) keep(read(k));
    }
    // Moves the step to the end: most recently used.
    const auto at = std::find_if(kept_.begin(), kept_.end(), [&](const Read& r) { return r.step == k; });
    std::rotate(at, at + 1, kept_.end());
    if (kept_.back().taken) std::exchange(kept_.back().taken, {})();
    return kept_.back().field;
  }

  Read read(std::size_t k) const {
    FlowStep step = load_(k);
    return {k, volume_flow(std::move(step.field)), step.bytes, std::move(step.taken)};
  }

  void keep(Read read) const {
    largest_ = std::max<std::uint64_t>(largest_, read.bytes);
    total_ += read.bytes;
    kept_.push_back(std::move(read));
    // Drops the most recently used step that is not needed now: calls pass the steps in one direction, and then restart
    // at the beginning.
    const std::size_t needed = options_.interpolation == TimeInterpolation::cubic ? 4 : 2;
    while (kept_.size() > needed && total_ + largest_ > options_.memory) {
      const auto gone = kept_.end() - static_cast<std::ptrdiff_t>(needed) - 1;
      total_ -= gone->bytes;
      kept_.erase(gone);
    }
  }

  std::vector<double> times_;
  std::function<FlowStep(std::size_t)> load_;
  FlowSeriesOptions options_;
  Box3 bounds_;
  mutable std::mutex mutex_;
  mutable std::vector<Read> kept_;  ///< the most recently used is last
  mutable std::uint64_t total_ = 0, largest_ = 0;
  Progress stop_;  ///< stops the thread that reads ahead
  mutable std::future<Read> ahead_;
  mutable std::size_t ahead_step_ = 0;
  mutable Range latest_{0, 0};
  mutable bool back_ = false;
};

}  // namespace

std::unique_ptr<VectorField> volume_flow(std::shared_ptr<const VolumeField> field) {
  return std::make_unique<VolumeFlow>(std::move(field));
}

std::unique_ptr<VectorField> flow_in_time(std::vector<double> times, std::function<FlowStep(std::size_t)> load,
                                          const FlowSeriesOptions& options) {
  return std::make_unique<FlowInTime>(std::move(times), std::move(load), options);
}

}  // namespace sansmesh::inline v1
