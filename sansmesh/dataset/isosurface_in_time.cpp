#include "sansmesh/dataset/isosurface_in_time.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sansmesh/core/binary_scale.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// Places at which the slope is looked at in each step, at most.
constexpr std::size_t kSlopesOfStep = 1024;

std::vector<IsosurfaceStep> checked_steps(std::vector<IsosurfaceStep> steps) {
  if (steps.size() < 2) throw ArgumentError("a surface that moves needs two steps at least");
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i].field->components() != 1)
      throw ArgumentError(
          fmt::format("a surface of one value needs one component, not {}", steps[i].field->components()));
    if (!std::isfinite(steps[i].time)) throw ArgumentError(fmt::format("the time of step {} is not known", i));
    if (i > 0 && !(steps[i].time > steps[i - 1].time))
      throw ArgumentError(
          fmt::format("the times of the steps must increase: step {} is of {:.9g}, the one before of {:.9g}", i,
                      steps[i].time, steps[i - 1].time));
  }
  return steps;
}

LocalFrame frame_of_first(const std::vector<IsosurfaceStep>& steps) {
  const Box3 box = steps[0].volume->bounds();
  return frame_for(box.center(), box.diagonal());
}

}  // namespace

IsosurfaceInTime::IsosurfaceInTime(std::vector<IsosurfaceStep> steps, double value)
    : steps_(checked_steps(std::move(steps))),
      frame_(frame_of_first(steps_)),
      value_(value),
      domain_(*steps_[0].volume, frame_) {
  if (!std::isfinite(value)) throw ArgumentError("`value` must be finite");
  std::vector<double> slopes;
  ValueRange all{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  bool occurs = false;
  for (const IsosurfaceStep& step : steps_) {
    ranges_.push_back(std::make_unique<const ValueRanges>(*step.volume, step.sample_value, frame_));
    const ValueRange around = ranges_.back()->around({}, 2);
    const double beyond = ValueRanges::kBeyond * (around.most - around.least) / (1 + 2 * ValueRanges::kBeyond);
    all = {std::min(all.least, around.least + beyond), std::max(all.most, around.most - beyond)};
    const std::vector<Vec3> places = ranges_.back()->places_of(value);
    occurs = occurs || !places.empty();
    std::vector<Vec3> some;
    for (std::size_t i = 0; i < places.size(); i += 1 + places.size() / kSlopesOfStep)
      some.push_back(frame_.to_input(places[i]));
    std::vector<Vec3> gradients(some.size());
    step.field->evaluate(some, {{}, gradients});
    for (const Vec3& g : gradients)
      if (const double slope = long_norm(g); slope > 0) slopes.push_back(slope);
  }
  if (!occurs)
    throw DataError(
        fmt::format("has no surface of the value {:.6g} at any step: values lie between about {:.6g} and {:.6g}", value,
                    all.least, all.most));
  if (slopes.empty()) return;
  const auto middle = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() / 2);
  std::nth_element(slopes.begin(), middle, slopes.end());
  slope_ = *middle * frame_.unit;
}

IsosurfaceInTime::~IsosurfaceInTime() = default;

double IsosurfaceInTime::median_spacing() const { return frame_.from_input(steps_[0].volume->facts.median_spacing); }

double IsosurfaceInTime::shortest_step() const {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < steps_.size(); ++i) least = std::min(least, steps_[i].time - steps_[i - 1].time);
  return least;
}

/// The step at or before a moment, but not the last.
std::size_t IsosurfaceInTime::interval_of(double t) const {
  const auto after = std::upper_bound(steps_.begin(), steps_.end(), t,
                                      [](double moment, const IsosurfaceStep& s) { return moment < s.time; });
  const auto n = static_cast<std::size_t>(after - steps_.begin());
  return std::clamp<std::size_t>(n, 1, steps_.size() - 1) - 1;
}

void IsosurfaceInTime::evaluate(std::span<const Vec3> x, std::span<const double> t, std::span<double> values) const {
  // What each step is asked for, with its share.
  struct Wanted {
    std::vector<std::size_t> which;
    std::vector<double> share;
    std::vector<Vec3> x;
  };
  std::vector<Wanted> wanted(steps_.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::size_t k = interval_of(t[i]);
    const double u = std::clamp((t[i] - steps_[k].time) / (steps_[k + 1].time - steps_[k].time), 0.0, 1.0);
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
    steps_[step].field->evaluate(w.x, {found});
    for (std::size_t n = 0; n < w.which.size(); ++n) values[w.which[n]] += w.share[n] * (value_ - found[n]) / slope_;
  }
  if (steps_[0].volume->lattice) return;  // bounds() says it all
  std::vector<double> beyond(x.size());
  domain_.evaluate(x, beyond);
  for (std::size_t i = 0; i < x.size(); ++i) values[i] = std::max(values[i], beyond[i]);
}

void IsosurfaceInTime::ranges(std::span<const Vec3> x, double radius, std::span<const double> t, double duration,
                              std::span<ValueRange> found) const {
  parallel_for(0, x.size(), 256, [&](std::size_t i) {
    const double infinity = std::numeric_limits<double>::infinity();
    ValueRange range{infinity, -infinity};
    for (std::size_t k = interval_of(t[i] - duration), last = interval_of(t[i] + duration) + 1; k <= last; ++k) {
      const ValueRange r = ranges_[k]->around(x[i], radius);
      range = {std::min(range.least, r.least), std::max(range.most, r.most)};
    }
    // Outside of all cells there is no surface.
    found[i] = range.least > range.most ? ValueRange{1e-9, infinity}
                                        : ValueRange{(value_ - range.most) / slope_, (value_ - range.least) / slope_};
    // Where the volume ends, so does what is inside.
    if (!steps_[0].volume->lattice && found[i].least <= 0) found[i].most = infinity;
  });
}

}  // namespace sansmesh::inline v1
