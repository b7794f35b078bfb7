#include "sansmesh/flow_options.h"

#include <string_view>

#include "sansmesh/core/check_range.h"
#include "sansmesh/flow/option_facts.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::string_view kSurfaceKinds[] = {"stream", "path", "streak", "time"};

/// FlowInsertion::interpolated as a flag.
struct InterpolatedFlag {
  static constexpr auto kind = OptionKind::flag;
  static OptionValue get(FlowInsertion v) { return v == FlowInsertion::interpolated; }
  static FlowInsertion from(const OptionValue& v) {
    return std::get<bool>(v) ? FlowInsertion::interpolated : FlowInsertion::traced;
  }
};

}  // namespace

const OptionSchema& FlowSurfaceOptions::schema() {
  using O = FlowSurfaceOptions;
  static const OptionRow rows[] = {
      option<&O::kind>({.text = "stream or path (swept by particles), streak (a curtain of smoke) or time (a drifting "
                                "sheet, see `sweep`)",
                        .from_data = "stream; path for an unsteady flow",
                        .choices = kSurfaceKinds}),
      option<&O::direction>(kDirectionFacts),
      option<&O::start>(kStartFacts),
      option<&O::duration>(kDurationFacts),
      option<&O::length>({.text = "Length of stream and path surfaces",
                          .unit = "length",
                          .from_data = "five diagonals, without `duration` and an end of the flow",
                          .range = positive()}),
      option<&O::seeds>({.text = "Number of particles, evenly on the seed curve",
                         .from_data = "the number of seeds; 256",
                         .range = at_least(2),
                         .name = "particles"}),
      option<&O::sweep>({.text = "Time surfaces: displacement from the first to the last copy of the seed curve"}),
      option<&O::alpha>({.text = "Gaps wider than this times the seeds' distance receive a particle, or tear",
                         .unit = "ratio",
                         .range = {.least = 1, .above = true}}),
      option<&O::beta>(
          {.text = "Gaps tear where they grow by this times a particle's step", .unit = "ratio", .range = positive()}),
      option<&O::delta>({.text = "Particles nearer than this times the seeds' distance may be removed",
                         .unit = "ratio",
                         .range = {.least = 0, .most = 1, .below = true}}),
      option<&O::insertion, InterpolatedFlag>(
          {.text = "Insert particles half-way between others, as in the source, not on the seed curve",
           .name = "interpolated"}),
      option<&O::front_step>(
          {.text = "Time between fronts", .unit = "duration", .from_data = "from the speed", .range = positive()}),
      option<&O::most_fronts>({.text = "Largest number of fronts in each direction", .range = at_least(1)}),
      option<&O::most_points>({.text = "Number of points with which the surface ends", .range = at_least(2)}),
      option_group<&O::trace>(TraceOptions::schema().rows)};
  static const OptionSchema schema{rows};
  return schema;
}

void FlowSurfaceOptions::validate() const {
  validate_options(*this);
  const bool released = kind == FlowSurfaceKind::streak || kind == FlowSurfaceKind::time;
  check_argument(2 * delta <= alpha, "`delta` must be at most half `alpha`");
  check_argument(!length || !released, "`length` is for stream and path surfaces");
  check_argument(!released || direction != FlowDirection::both, "`direction = both` is for stream and path surfaces");
  check_argument(kind != FlowSurfaceKind::time || (sweep && norm(*sweep) > 0),
                 "`sweep` of a time surface must have a length");
}

namespace {

constexpr ReportRow kFlowSurfaceReportRows[] = {
    reported<&FlowSurfaceReport::particles>({.text = "Particles followed, seeds included"}),
    reported<&FlowSurfaceReport::inserted>({.text = "Particles inserted between others"}),
    reported<&FlowSurfaceReport::removed>({.text = "Particles removed between others"}),
    reported<&FlowSurfaceReport::tears>({.text = "Separated pairs of neighbours"}),
    reported<&FlowSurfaceReport::fronts>({.text = "Fronts"}),
    reported<&FlowSurfaceReport::spacing>({.text = "Distance of the particles on the seed curve", .unit = "length"}),
    reported<&FlowSurfaceReport::complete>({.text = "Whether no limit ended it early"})};

}  // namespace

const ReportSchema& FlowSurfaceReport::schema() {
  static constexpr ReportSchema schema{kFlowSurfaceReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
