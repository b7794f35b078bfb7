#include "sansmesh/dataset/volume_flow.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <future>
#include <mutex>
#include <optional>
#include <utility>

#include "sansmesh/core/error.h"

namespace sansmesh {
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
    std::vector<double> values(n * components);
    std::vector<Vec3> gradients(jacobian.empty() ? 0 : n * components);
    field_->evaluate(x, {values, gradients, inside, {}});
    for (std::size_t i = 0; i < n; ++i) {
      inside[i] = inside[i] != 0 && std::isfinite(t[i]);
      vectors[i] = {};
      if (!jacobian.empty()) jacobian[i] = {};
      if (inside[i] == 0) continue;
      for (std::size_t c = 0; c < components; ++c) {
        vectors[i][c] = values[i * components + c];
        for (std::size_t k = 0; k < 3 && !jacobian.empty(); ++k) jacobian[i][k][c] = gradients[i * components + c][k];
      }
    }
  }

 private:
  std::shared_ptr<const VolumeField> field_;
};

class FlowInTime final : public VectorField {
 public:
  FlowInTime(std::vector<double> times, std::function<std::shared_ptr<const VolumeField>(std::size_t)> load,
             TimeInterpolation interpolation)
      : times_(std::move(times)), load_(std::move(load)), interpolation_(interpolation) {
    if (times_.size() < 2) throw ArgumentError("a flow in time needs two steps at least");
    for (std::size_t i = 0; i < times_.size(); ++i)
      if (!std::isfinite(times_[i]) || (i > 0 && !(times_[i] > times_[i - 1])))
        throw ArgumentError("the times of the steps must increase");
    bounds_ = step(0)->bounds();
  }
  ~FlowInTime() override {
    if (ahead_.valid()) ahead_.wait();
  }
  FlowInTime(const FlowInTime&) = delete;
  FlowInTime& operator=(const FlowInTime&) = delete;

  Box3 bounds() const override { return bounds_; }
  TimeRange times() const override { return {times_.front(), times_.back()}; }
  std::span<const double> moments() const override { return times_; }

  void evaluate(std::span<const Vec3> x, std::span<const double> t, std::span<Vec3> vectors,
                std::span<std::uint8_t> inside, std::span<Jacobian> jacobian) const override {
    std::fill(vectors.begin(), vectors.end(), Vec3{});
    std::fill(inside.begin(), inside.end(), std::uint8_t{0});
    std::fill(jacobian.begin(), jacobian.end(), Jacobian{});
    // By the interval of time that each lies in, so that every step is read once.
    std::vector<std::pair<std::size_t, std::size_t>> order;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (times().contains(t[i])) order.emplace_back(interval_of(t[i]), i);
    std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t first = 0; first < order.size();) {
      std::size_t last = first;
      while (last < order.size() && order[last].first == order[first].first) ++last;
      Part part;
      for (std::size_t k = first; k < last; ++k) {
        part.x.push_back(x[order[k].second]);
        part.t.push_back(t[order[k].second]);
      }
      blend(order[first].first, part, !jacobian.empty());
      for (std::size_t k = first; k < last; ++k) {
        const std::size_t i = order[k].second;
        vectors[i] = part.vectors[k - first], inside[i] = part.inside[k - first];
        if (!jacobian.empty()) jacobian[i] = part.jacobian[k - first];
      }
      first = last;
    }
  }

 private:
  struct Part {
    std::vector<Vec3> x;
    std::vector<double> t;
    std::vector<Vec3> vectors;
    std::vector<std::uint8_t> inside;
    std::vector<Jacobian> jacobian;
  };

  /// The step at or before a moment, but not the last.
  std::size_t interval_of(double t) const {
    const auto after = std::upper_bound(times_.begin(), times_.end(), t);
    return std::min(static_cast<std::size_t>(after - times_.begin()), times_.size() - 1) - 1;
  }

  /// Shares of the steps first, first + 1, … at a moment of an interval.
  struct Shares {
    std::size_t first = 0, count = 0;
    std::array<double, 4> of{};
  };
  Shares shares_at(std::size_t interval, double t) const {
    const double a = times_[interval], b = times_[interval + 1], u = (t - a) / (b - a);
    if (interpolation_ == TimeInterpolation::constant) return {u < 1 ? interval : interval + 1, 1, {1}};
    if (interpolation_ == TimeInterpolation::linear) return {interval, 2, {1 - u, u}};
    // Hermite's cubic with the slopes of parabolas through three steps, at the ends of one through two.
    const std::size_t first = interval > 0 ? interval - 1 : 0, last = std::min(interval + 2, times_.size() - 1);
    Shares s{first, last - first + 1, {}};
    const double h = b - a, u2 = u * u, u3 = u2 * u;
    const std::size_t at = interval - first;
    s.of[at] += 2 * u3 - 3 * u2 + 1;
    s.of[at + 1] += 3 * u2 - 2 * u3;
    const auto slope = [&](std::size_t k, double weight) {  // of step k, times the interval
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

  void blend(std::size_t interval, Part& part, bool derivatives) const {
    const std::size_t n = part.x.size();
    part.vectors.assign(n, {}), part.inside.assign(n, 1);
    part.jacobian.assign(derivatives ? n : 0, Jacobian{});
    std::vector<Shares> shares(n);
    std::size_t first = times_.size(), last = 0;
    for (std::size_t i = 0; i < n; ++i) {
      shares[i] = shares_at(interval, part.t[i]);
      first = std::min(first, shares[i].first);
      last = std::max(last, shares[i].first + shares[i].count);
    }
    std::vector<Vec3> v(n);
    std::vector<std::uint8_t> there(n);
    std::vector<Jacobian> j(part.jacobian.size());
    for (std::size_t k = first; k < last; ++k) {
      step(k)->evaluate(part.x, part.t, v, there, j);
      for (std::size_t i = 0; i < n; ++i) {
        const Shares& s = shares[i];
        if (k < s.first || k >= s.first + s.count) continue;
        if (there[i] == 0) part.inside[i] = 0;
        part.vectors[i] += v[i] * s.of[k - s.first];
        for (std::size_t c = 0; c < 3 && derivatives; ++c) part.jacobian[i][c] += j[i][c] * s.of[k - s.first];
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (part.inside[i] != 0) continue;
      part.vectors[i] = {};
      if (derivatives) part.jacobian[i] = {};
    }
  }

  using Loaded = std::shared_ptr<const VectorField>;

  /// One of the steps; the next one in the same direction is read meanwhile.
  Loaded step(std::size_t k) const {
    const std::lock_guard lock(mutex_);
    const auto kept = std::find_if(kept_.begin(), kept_.end(), [&](const auto& e) { return e.first == k; });
    if (kept != kept_.end()) {
      auto entry = *kept;
      kept_.erase(kept);
      kept_.push_back(entry);
      return entry.second;
    }
    Loaded loaded;
    if (ahead_.valid()) {
      Loaded other = ahead_.get();
      if (ahead_step_ == k)
        loaded = std::move(other);
      else
        keep(ahead_step_, std::move(other));
    }
    if (!loaded) loaded = read(k);
    const bool back = latest_ && k < *latest_;
    latest_ = k;
    keep(k, loaded);
    const std::size_t next = back ? k - 1 : k + 1;  // wraps around below the first, which is beyond the last
    const bool known = std::any_of(kept_.begin(), kept_.end(), [&](const auto& e) { return e.first == next; });
    if (next < times_.size() && !known) {
      ahead_step_ = next;
      ahead_ = std::async(std::launch::async, [this, next] { return read(next); });
    }
    return loaded;
  }

  Loaded read(std::size_t k) const { return volume_flow(load_(k)); }

  void keep(std::size_t k, Loaded loaded) const {
    const std::size_t most = interpolation_ == TimeInterpolation::cubic ? 4 : 2;
    kept_.emplace_back(k, std::move(loaded));
    while (kept_.size() > most) kept_.pop_front();
  }

  std::vector<double> times_;
  std::function<std::shared_ptr<const VolumeField>(std::size_t)> load_;
  TimeInterpolation interpolation_;
  Box3 bounds_;
  mutable std::mutex mutex_;
  mutable std::deque<std::pair<std::size_t, Loaded>> kept_;  ///< the last that was asked for at the end
  mutable std::future<Loaded> ahead_;
  mutable std::size_t ahead_step_ = 0;
  mutable std::optional<std::size_t> latest_;
};

}  // namespace

std::unique_ptr<VectorField> volume_flow(std::shared_ptr<const VolumeField> field) {
  return std::make_unique<VolumeFlow>(std::move(field));
}

std::unique_ptr<VectorField> flow_in_time(std::vector<double> times,
                                          std::function<std::shared_ptr<const VolumeField>(std::size_t)> load,
                                          TimeInterpolation interpolation) {
  return std::make_unique<FlowInTime>(std::move(times), std::move(load), interpolation);
}

}  // namespace sansmesh
