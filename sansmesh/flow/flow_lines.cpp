#include "sansmesh/flow/flow_lines.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <string_view>
#include <utility>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/flow/option_facts.h"
#include "sansmesh/flow/trace.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::string_view kLineKinds[] = {"path", "streak", "time", "stream"};

/// Words of the line kinds; the last word is an alias of the first.
struct LineKind {
  static constexpr auto kind = OptionKind::choice;
  static OptionValue get(FlowLineKind v) { return static_cast<std::int64_t>(v); }
  static FlowLineKind from(const OptionValue& v) {
    const auto index = static_cast<std::size_t>(std::get<std::int64_t>(v));
    return index + 1 < std::size(kLineKinds) ? static_cast<FlowLineKind>(index) : FlowLineKind::path;
  }
};

constexpr double kDiagonals = 5;
constexpr double kStill = 1e-6;  // least speed over the seeds' median
constexpr double kStreakParts = 100, kTimeParts = 10;
constexpr double kMostParticles = 2e8;
constexpr std::size_t kBlock = 65'536;  // points per evaluation of the field along lines

/// Lines under construction: positions, times and seed index of each.
struct Builder {
  std::vector<Vec3> positions;
  std::vector<double> times;
  std::vector<std::size_t> offsets{0};
  std::vector<std::int32_t> seeds, ends;
  std::optional<double> now;  ///< streaks: moment of all positions; `times` are those of release

  void add(const Vec3& x, double t) { positions.push_back(x), times.push_back(t); }
  void finish_line(std::size_t seed, std::int32_t end) {
    if (positions.size() == offsets.back()) return;
    offsets.push_back(positions.size());
    seeds.push_back(static_cast<std::int32_t>(seed));
    ends.push_back(end);
  }
};

/// Joins the backward and the forward trace of each seed; a trace may be empty.
void join_paths(const Traces& back, Traces& on, Builder& lines) {
  if (back.size() == 0) {  // no backward traces
    lines.positions = std::move(on.positions), lines.times = std::move(on.times);
    for (std::size_t i = 0; i < on.size(); ++i) {
      if (on.offsets[i + 1] == on.offsets[i]) continue;
      lines.offsets.push_back(on.offsets[i + 1]);
      lines.seeds.push_back(static_cast<std::int32_t>(i));
      lines.ends.push_back(static_cast<std::int32_t>(on.ends[i]));
    }
    return;
  }
  const bool both = back.size() > 0 && on.size() > 0;
  for (std::size_t i = 0; i < std::max(back.size(), on.size()); ++i) {
    if (back.size() > 0)
      for (std::size_t k = back.offsets[i + 1]; k > back.offsets[i]; --k)
        lines.add(back.positions[k - 1], back.times[k - 1]);
    if (on.size() > 0)
      for (std::size_t k = on.offsets[i] + (both ? 1 : 0); k < on.offsets[i + 1]; ++k)
        lines.add(on.positions[k], on.times[k]);
    lines.finish_line(i, static_cast<std::int32_t>((on.size() > 0 ? on : back).ends[i]));
  }
}

class LineMaker {
 public:
  LineMaker(const VectorField& field, std::span<const Vec3> seeds, const FlowLineOptions& options, Progress& progress)
      : field_(field), seeds_(seeds), options_(options), trace_(options.trace), progress_(progress) {
    trace_.backward = options.direction == FlowDirection::backward;
    const TimeRange times = field.times();
    const double first = trace_.backward ? times.last : times.first;
    start_ = options.start.value_or(std::isfinite(first) ? first : 0);
  }

  FlowLineReport report;

  Builder make() {
    look_at_seeds();
    Builder lines;
    if (options_.kind == FlowLineKind::path)
      paths(lines);
    else if (options_.kind == FlowLineKind::streak)
      streaks(lines);
    else
      time_lines(lines);
    return lines;
  }

 private:
  void look_at_seeds() {
    report.seeds = seeds_.size();
    if (seeds_.empty()) throw DataError("there are no seeds");
    const TimeRange times = field_.times();
    if (!times.contains(start_))
      throw ArgumentError("`start` is not in the time of the flow, " + std::to_string(times.first) + " to " +
                          std::to_string(times.last));
    const Particles p = particles_at(field_, seeds_, std::vector<double>(seeds_.size(), start_));
    std::vector<double> speeds;
    for (std::size_t i = 0; i < seeds_.size(); ++i) {
      if (p.ends[i])
        ++report.outside;
      else
        speeds.push_back(norm(p.velocities[i]));
    }
    if (speeds.empty()) throw DataError("no seed is in the flow");
    const double fastest = *std::max_element(speeds.begin(), speeds.end());
    if (!(fastest > 0)) throw DataError("the flow is zero at all seeds");
    const double middle = median(speeds);
    if (trace_.least_speed == 0) trace_.least_speed = kStill * (middle > 0 ? middle : fastest);
    five_diagonals_ = kDiagonals * field_.bounds().diagonal();
    usual_speed_ = middle > 0 ? middle : fastest;
  }

  /// The given duration, or the time that particles of the median speed need for the default length.
  double duration() const {
    double d = options_.duration.value_or(options_.length.value_or(five_diagonals_) / usual_speed_);
    const TimeRange times = field_.times();
    d = std::min(d, trace_.backward ? start_ - times.first : times.last - start_);
    if (!(d > 0)) throw ArgumentError("`start` is the end of the flow's time");
    return d;
  }

  void paths(Builder& lines) {
    if (options_.duration) trace_.duration = *options_.duration;
    if (options_.length) trace_.length = *options_.length;
    if (!options_.duration && !options_.length) trace_.length = five_diagonals_;
    const std::vector<double> moments(seeds_.size(), start_);
    Traces back, on;
    if (options_.direction != FlowDirection::forward)
      trace_.backward = true, back = trace_lines(field_, seeds_, moments, trace_, progress_);
    if (options_.direction != FlowDirection::backward)
      trace_.backward = false, on = trace_lines(field_, seeds_, moments, trace_, progress_);
    for (const Traces* t : {&back, &on})
      for (const TraceEnd end : t->ends) ++report.ends[static_cast<std::size_t>(end)];
    join_paths(back, on, lines);
  }

  void streaks(Builder& lines) {
    const double d = duration(), interval = options_.interval.value_or(d / kStreakParts);
    const double many = std::floor(d / interval) + 1;
    check_argument(many * static_cast<double>(seeds_.size()) < kMostParticles,
                   "`interval` is too short: too many particles");
    const auto n = static_cast<std::size_t>(many);
    const double sign = trace_.backward ? -1 : 1, end = start_ + sign * d;
    std::vector<Vec3> starts;
    std::vector<double> moments;
    for (const Vec3& seed : seeds_)
      for (std::size_t k = 0; k < n; ++k) {
        starts.push_back(seed);
        moments.push_back(start_ + sign * interval * static_cast<double>(k));
      }
    Particles p = particles_at(field_, starts, moments);
    std::vector<std::uint32_t> all(starts.size());
    std::iota(all.begin(), all.end(), 0u);
    progress_.begin("trace");
    move_particles(field_, p, all, end, trace_);
    lines.now = end;
    // Latest release first; particles that have ended interrupt the line.
    for (std::size_t s = 0; s < seeds_.size(); ++s) {
      for (std::size_t k = n; k-- > 0;) {
        const std::size_t i = s * n + k;
        if (p.ends[i])
          lines.finish_line(s, 0);
        else
          lines.add(p.positions[i], moments[i]);
      }
      lines.finish_line(s, 0);
    }
  }

  void time_lines(Builder& lines) {
    const double d = duration(), interval = options_.interval.value_or(d / kTimeParts);
    const double many = std::floor(d / interval * (1 + 1e-9)) + 1;
    check_argument(many * static_cast<double>(seeds_.size()) < kMostParticles,
                   "`interval` is too short: too many lines");
    const double sign = trace_.backward ? -1 : 1;
    Particles p = particles_at(field_, seeds_, std::vector<double>(seeds_.size(), start_));
    std::vector<std::uint32_t> all(seeds_.size());
    std::iota(all.begin(), all.end(), 0u);
    const auto steps = static_cast<std::size_t>(many);
    progress_.begin("trace", steps);
    for (std::size_t m = 0; m < steps; ++m) {
      const double t = start_ + sign * std::min(interval * static_cast<double>(m), d);
      if (m > 0) move_particles(field_, p, all, t, trace_);
      const bool whole = std::none_of(p.ends.begin(), p.ends.end(), [](const auto& e) { return e.has_value(); });
      for (std::size_t i = 0; i < seeds_.size(); ++i) {
        if (p.ends[i])
          lines.finish_line(m, 0);
        else
          lines.add(p.positions[i], t);
      }
      if (options_.closed && whole) lines.add(p.positions[0], t);
      lines.finish_line(m, 0);
      progress_.advance();
      progress_.check();
    }
  }

  const VectorField& field_;
  std::span<const Vec3> seeds_;
  const FlowLineOptions& options_;
  TraceOptions trace_;
  Progress& progress_;
  double start_ = 0, five_diagonals_ = 0, usual_speed_ = 0;
};

}  // namespace

const OptionSchema& FlowLineOptions::schema() {
  using O = FlowLineOptions;
  static const OptionRow rows[] = {
      option<&O::kind, LineKind>(
          {.text = "stream or path: trajectories; streak: dye from each seed; time: the moving curve of the seeds",
           .choices = kLineKinds}),
      option<&O::direction>(kDirectionFacts),
      option<&O::start>(kStartFacts),
      option<&O::duration>(kDurationFacts),
      option<&O::length>({.text = "Largest length of a line",
                          .unit = "length",
                          .from_data = "five diagonals, without `duration`",
                          .range = positive()}),
      option<&O::interval>({.text = "Time between particles of a streak, or between time lines",
                            .unit = "duration",
                            .from_data = "a hundredth or a tenth of the duration",
                            .range = positive()}),
      option_group<&O::trace>(TraceOptions::schema().rows)};
  static const OptionSchema schema{rows};
  return schema;
}

void FlowLineOptions::validate() const {
  validate_options(*this);
  check_argument(kind == FlowLineKind::path || direction != FlowDirection::both,
                 "`direction = both` is for path lines: streak and time lines have one direction");
  check_argument(!length || kind == FlowLineKind::path, "`length` is for path lines");
  check_argument(!interval || kind != FlowLineKind::path, "`interval` is for streak and time lines");
}

PolylineSet flow_lines(const VectorField& field, std::span<const Vec3> seeds, const FlowLineOptions& options,
                       Progress& progress, FlowLineReport* report) {
  options.validate();
  LineMaker maker(field, seeds, options, progress);
  Builder made = maker.make();
  const std::size_t n = made.positions.size();

  progress.begin("along lines");
  std::vector<float> speed(n), velocity(3 * n), vorticity(3 * n);
  // In blocks, because the derivatives of all points would take most of the memory; a flow in time in one block, so
  // that each of its time steps is read once.
  const std::size_t block = field.sample_times().empty() ? kBlock : n;
  std::vector<Vec3> velocities;
  std::vector<std::uint8_t> inside;
  std::vector<Jacobian> jacobian;
  std::vector<double> moments;
  for (std::size_t first = 0; first < n; first += block) {
    const std::size_t count = std::min(block, n - first);
    velocities.resize(count), inside.resize(count), jacobian.resize(count);
    if (made.now)
      moments.assign(count, *made.now);
    else
      moments.assign(made.times.begin() + static_cast<std::ptrdiff_t>(first),
                     made.times.begin() + static_cast<std::ptrdiff_t>(first + count));
    field.evaluate(std::span(made.positions).subspan(first, count), moments, velocities, inside, jacobian);
    parallel_for(0, count, 4096, [&](std::size_t k) {
      const std::size_t i = first + k;
      speed[i] = static_cast<float>(norm(velocities[k]));
      const Vec3 turn = curl(jacobian[k]);
      for (std::size_t c = 0; c < 3; ++c) {
        velocity[3 * i + c] = static_cast<float>(velocities[k][c]);
        vorticity[3 * i + c] = static_cast<float>(turn[c]);
      }
    });
    progress.check();
  }
  PolylineSet lines;
  lines.offsets = made.offsets;
  lines.origin = field.bounds().center();
  lines.positions.reserve(n);
  for (const Vec3& x : made.positions) lines.positions.push_back(Vec3f(x - lines.origin));
  std::vector<float> lengths(lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    double sum = 0;
    for (std::size_t k = lines.offsets[i]; k + 1 < lines.offsets[i + 1]; ++k)
      sum += norm(made.positions[k + 1] - made.positions[k]);
    lengths[i] = static_cast<float>(sum);
    maker.report.longest = std::max(maker.report.longest, sum);
  }
  lines.attributes.set("time", std::move(made.times));
  lines.attributes.set("speed", std::move(speed));
  lines.attributes.set("velocity", std::move(velocity), 3);
  lines.attributes.set("vorticity", std::move(vorticity), 3);
  lines.line_attributes.set("seed", made.seeds);
  lines.line_attributes.set("length", std::move(lengths));
  if (options.kind == FlowLineKind::path) lines.line_attributes.set("end", made.ends);
  if (report) *report = maker.report;
  progress.finish();
  return lines;
}

namespace {

ReportCounts counted_ends(const FlowLineReport& report) {
  ReportCounts counts;
  for (std::size_t k = 0; k < report.ends.size(); ++k)
    if (report.ends[k] > 0) counts.emplace_back(kTraceEndWords[k], static_cast<std::int64_t>(report.ends[k]));
  return counts;
}

constexpr ReportRow kFlowLineReportRows[] = {
    reported<&FlowLineReport::seeds>({.name = "seeds.count", .text = "Seeds"}),
    reported<&FlowLineReport::outside>({.name = "seeds.outside", .text = "Seeds outside the flow"}),
    reported<[](const FlowLineReport& r) { return counted_ends(r); }>(
        {.name = "ends", .text = "Numbers of lines by reason of their end"}),
    reported<&FlowLineReport::longest>(
        {.name = "output.longest", .text = "Length of the longest line", .unit = "length"})};

}  // namespace

const ReportSchema& FlowLineReport::schema() {
  static constexpr ReportSchema schema{kFlowLineReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
