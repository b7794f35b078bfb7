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
      option<&O::kind>({.text = "stream, path (where particles go), streak (a curtain of smoke) or time (a cloth that "
                                "drifts, see `sweep`)",
                        .from_data = "stream, of a flow that changes path",
                        .choices = kSurfaceKinds}),
      option<&O::direction>(kDirectionFacts),
      option<&O::start>(kStartFacts),
      option<&O::duration>(kDurationFacts),
      option<&O::length>({.text = "How far, of stream and path surfaces",
                          .unit = "length",
                          .from_data = "five diagonals, without `duration` and where the flow has no end",
                          .range = positive()}),
      option<&O::seeds>({.text = "On the seed curve, evenly",
                         .from_data = "the number of seeds; 256",
                         .range = at_least(2),
                         .name = "particles"}),
      option<&O::sweep>({.text = "Of time surfaces: the seeds are the curve moved by 0..1 of this"}),
      option<&O::alpha>({.text = "Gaps wider than this times those of the seeds get a particle, or tear",
                         .unit = "ratio",
                         .range = {.least = 1, .above = true}}),
      option<&O::beta>(
          {.text = "They tear where they grow by this times a particle's step", .unit = "ratio", .range = positive()}),
      option<&O::delta>({.text = "Particles nearer than this times the gaps of the seeds may go",
                         .unit = "ratio",
                         .range = {.least = 0, .most = 1, .below = true}}),
      option<&O::insertion, InterpolatedFlag>(
          {.text = "New particles start half-way between others, as in the source, not on the seed curve",
           .name = "interpolated"}),
      option<&O::front_step>(
          {.text = "Time between fronts", .unit = "duration", .from_data = "from the speed", .range = positive()}),
      option<&O::most_fronts>({.text = "In each direction", .range = at_least(1)}),
      option<&O::most_points>({.text = "The surface ends with the front that reaches so many", .range = at_least(2)}),
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
    reported<&FlowSurfaceReport::particles>({.text = "Particles that were followed, seeds included"}),
    reported<&FlowSurfaceReport::inserted>({.text = "Particles that were put between others"}),
    reported<&FlowSurfaceReport::removed>({.text = "Particles that were left out between others"}),
    reported<&FlowSurfaceReport::tears>({.text = "Pairs of neighbours that were parted"}),
    reported<&FlowSurfaceReport::fronts>({.text = "Fronts"}),
    reported<&FlowSurfaceReport::spacing>({.text = "Distance of the particles at the seeds", .unit = "length"}),
    reported<&FlowSurfaceReport::complete>({.text = "Whether nothing ended it before its end"})};

}  // namespace

const ReportSchema& FlowSurfaceReport::schema() {
  static constexpr ReportSchema schema{kFlowSurfaceReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
