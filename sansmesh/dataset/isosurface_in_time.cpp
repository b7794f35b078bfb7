#include "sansmesh/dataset/isosurface_in_time.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/dataset/level_scale.h"
#include "sansmesh/dataset/step_times.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// Largest number of points per step that determine the slope.
constexpr std::size_t kSlopesOfStep = 1024;

std::vector<IsosurfaceStep> checked_steps(std::vector<IsosurfaceStep> steps) {
  if (steps.size() < 2) throw ArgumentError("a surface that moves needs two steps at least");
  for (const IsosurfaceStep& step : steps)
    if (step.field->components() != 1)
      throw ArgumentError(fmt::format("a surface of one value needs one component, not {}", step.field->components()));
  return steps;
}

std::vector<double> times_of(const std::vector<IsosurfaceStep>& steps) {
  std::vector<double> times;
  times.reserve(steps.size());
  for (const IsosurfaceStep& step : steps) times.push_back(step.time);
  check_step_times(times);
  return times;
}

LocalFrame frame_of_first(const std::vector<IsosurfaceStep>& steps) {
  const Box3 box = steps[0].volume->bounds();
  return frame_for(box.center(), box.diagonal());
}

}  // namespace

IsosurfaceInTime::IsosurfaceInTime(std::vector<IsosurfaceStep> steps, double value)
    : steps_(checked_steps(std::move(steps))),
      times_(times_of(steps_)),
      frame_(frame_of_first(steps_)),
      value_(value),
      domain_(*steps_[0].volume, frame_) {
  if (!std::isfinite(value)) throw ArgumentError("`value` must be finite");
  std::vector<double> slopes;
  ValueRange all{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  bool occurs = false;
  for (const IsosurfaceStep& step : steps_) {
    ranges_.push_back(std::make_unique<const ValueRanges>(*step.volume, step.sample_value, frame_));
    const ValueRange samples = ranges_.back()->of_samples();
    all = {std::min(all.least, samples.least), std::max(all.most, samples.most)};
    const std::vector<Vec3> points = ranges_.back()->points_with(value);
    occurs = occurs || !points.empty();
    const std::vector<double> found = slopes_at(*step.field, value, points, frame_, kSlopesOfStep);
    slopes.insert(slopes.end(), found.begin(), found.end());
  }
  if (!occurs)
    throw DataError(
        fmt::format("has no surface of the value {:.6g} at any step: values lie between about {:.6g} and {:.6g}", value,
                    all.least, all.most));
  if (!slopes.empty()) slope_ = median(slopes) * frame_.unit;
}

IsosurfaceInTime::~IsosurfaceInTime() = default;

double IsosurfaceInTime::median_spacing() const { return frame_.from_input(steps_[0].volume->facts.median_spacing); }

double IsosurfaceInTime::shortest_step() const {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < times_.size(); ++i) least = std::min(least, times_[i] - times_[i - 1]);
  return least;
}

void IsosurfaceInTime::evaluate(std::span<const Vec3> x, std::span<const double> t, std::span<double> values) const {
  // Query points of each step, and its share.
  struct Wanted {
    std::vector<std::size_t> which;
    std::vector<double> share;
    std::vector<Vec3> x;
  };
  std::vector<Wanted> wanted(steps_.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::size_t k = step_interval(times_, t[i]);
    const double u = std::clamp((t[i] - times_[k]) / (times_[k + 1] - times_[k]), 0.0, 1.0);
    for (const auto& [step, share] : {std::pair{k, 1 - u}, std::pair{k + 1, u}}) {
      if (share == 0) continue;
      Wanted& w = wanted[step];
      w.which.push_back(i), w.share.push_back(share), w.x.push_back(frame_.to_input(x[i]));
    }
  }
  std::fill(values.begin(), values.end(), 0.0);
  std::vector<double> found;
  for (std::size_t step = 0; step < steps_.size(); ++step) {
    const Wanted& w = wanted[step];
    if (w.x.empty()) continue;
    found.resize(w.x.size());
    evaluate_level(*steps_[step].field, value_, w.x, {found});
    for (std::size_t n = 0; n < w.which.size(); ++n) values[w.which[n]] += w.share[n] * (value_ - found[n]) / slope_;
  }
  if (steps_[0].volume->lattice) return;  // bounds() suffices
  std::vector<double> beyond(x.size());
  domain_.evaluate(x, beyond);
  for (std::size_t i = 0; i < x.size(); ++i) values[i] = std::max(values[i], beyond[i]);
}

void IsosurfaceInTime::ranges(std::span<const Vec3> x, double radius, std::span<const double> t, double duration,
                              std::span<ValueRange> found) const {
  parallel_for(0, x.size(), 256, [&](std::size_t i) {
    const double infinity = std::numeric_limits<double>::infinity();
    ValueRange range{infinity, -infinity};
    const std::size_t last = step_interval(times_, t[i] + duration) + 1;
    for (std::size_t k = step_interval(times_, t[i] - duration); k <= last; ++k) {
      const ValueRange r = ranges_[k]->around(x[i], radius);
      range = {std::min(range.least, r.least), std::max(range.most, r.most)};
    }
    found[i] = level_range(range, value_, slope_);
    // The end of the volume is also the end of the inside.
    if (!steps_[0].volume->lattice && found[i].least <= 0) found[i].most = infinity;
  });
}

}  // namespace sansmesh::inline v1
