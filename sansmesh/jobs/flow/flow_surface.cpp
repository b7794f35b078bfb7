// Surfaces of an open flow from a seed curve.
#include <fmt/core.h>

#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/flow.h"
#include "sansmesh/flow/flow_surface.h"
#include "sansmesh/jobs/flow/flow_model.h"
#include "sansmesh/mesh/mesh_size.h"

namespace sansmesh::inline v1 {

const OptionSchema& TraceSurfaceOptions::schema() {
  using O = TraceSurfaceOptions;
  static const OptionRow rows[] = {option<&O::seeds>({.text = kSeedsText, .unit = "seeds"}),
                                   option_group<&O::surface>(FlowSurfaceOptions::schema().rows)};
  return option_schema<rows>();
}

void TraceSurfaceOptions::validate() const {
  if (seeds.empty()) throw ArgumentError("`seeds` is required: a curve, for example line(0,0,0, 1,0,0, 100)");
  surface.validate();
}

TraceSurfaceResult trace_surface(const FlowModel& flow, const TraceSurfaceOptions& options, Progress& progress) {
  options.validate();
  TraceSurfaceResult result;
  FlowSurfaceOptions o = options.surface;
  if (!o.kind) o.kind = flow.unsteady() ? FlowSurfaceKind::path : FlowSurfaceKind::stream;
  const Seeds seeds = flow.seed_curve(options.seeds, result.notes);
  if (!o.seeds && seeds.file.empty()) o.seeds = seeds.points.size();
  try {
    result.surface = flow_surface(flow.field(), {seeds.points, seeds.closed}, o, progress);
  } catch (const DataError& error) {
    throw in_flow(flow, error);
  }
  for (Note& note : flow.step_notes()) result.notes.push_back(std::move(note));
  const auto note = [&](const char* code, std::string text, const char* remedy = "") {
    result.notes.push_back({.code = code, .text = std::move(text), .remedy = remedy, .of = flow.source()});
  };
  result.area = measure_size(result.surface.mesh).area;
  const FlowSurfaceReport& r = result.surface.report;
  if (!r.complete && r.moments_meet)
    note("moments_meet", "ended where the times of successive fronts are equal in double precision",
         "a `start` nearer to 0 separates them");
  else if (!r.complete)
    note("too_many", "ended at the limit of fronts or particles", "set `duration` or `length`");
  if (const std::size_t outside = r.ends[static_cast<std::size_t>(TraceEnd::outside)]; outside > 0)
    note("outside",
         fmt::format("{} of {} started outside the flow", grouped(outside), counted(r.particles, "particle")));
  return result;
}

std::vector<std::string> summary_of(const FlowSurfaceReport& r) {
  return {
      fmt::format("{} on {}, {} apart at the seeds", counted(r.particles, "particle"), counted(r.fronts, "front"),
                  length_words(r.spacing)),
      fmt::format("{} inserted, {} removed, {}", grouped(r.inserted), grouped(r.removed), counted(r.tears, "tear"))};
}

const ReportSchema& TraceSurfaceResult::schema() {
  static constexpr ReportRow rows[] = {
      reported<[](const TraceSurfaceResult& r) { return r.surface.report; }>(
          {.name = "surface", .text = "Traced surface"}),
      reported<&TraceSurfaceResult::area>({.text = "Area of its mesh", .unit = "length²"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
