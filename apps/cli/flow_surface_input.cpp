#include "flow_surface_input.h"

#include <fmt/core.h>

#include "command_line.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"

namespace sansmesh::cli {

void add_flow_surface_input(CommandLine& c, FlowSurfaceInput& a) {
  add_flow_input(c, a.flow);
  c.add_choice<FlowSurfaceKind>("--kind", a.kind,
                                {{"stream", FlowSurfaceKind::stream},
                                 {"path", FlowSurfaceKind::path},
                                 {"streak", FlowSurfaceKind::streak},
                                 {"time", FlowSurfaceKind::time}},
                                "stream, path (where particles go), streak (a curtain of smoke) or time (a cloth that "
                                "drifts, see --sweep) [stream, with --unsteady path]")
      .type_name("NAME");
  c.add_choice<FlowDirection>(
       "--direction", a.options.direction,
       {{"forward", FlowDirection::forward}, {"backward", FlowDirection::backward}, {"both", FlowDirection::both}},
       "forward, backward or both [forward]")
      .type_name("NAME");
  c.add_option("--start", a.options.start, "Moment at which particles leave [the first of the flow]").type_name("TIME");
  c.add_option("--time", a.time, "How long they are followed [to the end of the flow]").type_name("DURATION");
  c.add_option("--length", a.options.length,
               "How far, of stream and path surfaces [five diagonals, without --time and where the flow has no end]")
      .type_name("LENGTH");
  c.add_option("--particles", a.particles, "On the seed curve, evenly [the number of seeds; 256]").type_name("COUNT");
  c.add_option("--sweep", a.sweep, "Of time surfaces: the seeds are the curve moved by 0..1 of this")
      .numbers(3)
      .type_name("X,Y,Z");
  const char* const fronts = "Fronts";
  c.add_option("--alpha", a.options.alpha, "Gaps wider than this times those of the seeds get a particle, or tear [2]")
      .type_name("RATIO")
      .group(fronts);
  c.add_option("--beta", a.options.beta, "They tear where they grow by this times a particle's step [2]")
      .type_name("RATIO")
      .group(fronts);
  c.add_option("--delta", a.options.delta, "Particles nearer than this times the gaps of the seeds may go, 0..1 [0.5]")
      .type_name("RATIO")
      .group(fronts);
  c.add_flag("--interpolated", a.interpolated,
             "New particles start half-way between others, as in the source, not on the seed curve")
      .group(fronts);
  c.add_option("--front-step", a.options.front_step, "Time between fronts [from the speed]")
      .type_name("DURATION")
      .group(fronts);
  add_trace_options(c, a.options.trace);
}

void check_flow_surface(const FlowSurfaceInput& a) {
  require(!a.flow.seeds.empty(), "--seeds is needed: a curve such as line(0,0,0, 1,0,0, 100)");
}

FlowSurface trace_flow_surface(const FlowSurfaceInput& a, const OpenFlow& flow, Console& console) {
  FlowSurfaceOptions o = a.options;
  o.kind = a.kind.value_or(a.flow.unsteady ? FlowSurfaceKind::path : FlowSurfaceKind::stream);
  if (a.interpolated) o.insertion = FlowInsertion::interpolated;
  if (a.time) o.duration = *a.time;
  if (!a.sweep.empty()) o.sweep = {a.sweep[0], a.sweep[1], a.sweep[2]};
  const Seeds seeds = flow.seed_curve(console);
  if (a.particles)
    o.seeds = *a.particles;
  else if (seeds.file.empty())
    o.seeds = seeds.points.size();
  o.validate();
  try {
    FlowSurface surface = flow_surface(flow.field(), {seeds.points, seeds.closed}, o, console.progress());
    flow.warn_of_steps(console);
    if (!surface.report.complete)
      console.warn(a.flow.volume.name(),
                   {surface.report.moments_meet
                        ? "ended where fronts are so near in time that their moments are the same number: a --start "
                          "nearer to 0 tells them apart"
                        : "ended after as many fronts or particles as are allowed: --time or --length gives an end"});
    if (const std::size_t outside = surface.report.ends[static_cast<std::size_t>(TraceEnd::outside)]; outside > 0)
      console.warn(a.flow.volume.name(), {fmt::format("{} of {} began outside of the flow", grouped(outside),
                                                      counted(surface.report.particles, "particle"))});
    return surface;
  } catch (const DataError& error) {
    throw flow.error(error);
  }
}

void say_flow_surface(const FlowSurface& surface, const OpenFlow& flow, Console& console) {
  const FlowSurfaceReport& r = surface.report;
  console.say(fmt::format("{}: {} on {}, {} apart at the seeds", flow.name(), counted(r.particles, "particle"),
                          counted(r.fronts, "front"), length(r.spacing)));
  console.say(fmt::format("{} put between others, {} left out, {}", grouped(r.inserted), grouped(r.removed),
                          counted(r.tears, "tear")));
}

Json flow_surface_json(const FlowSurface& surface) {
  const FlowSurfaceReport& r = surface.report;
  return {{"particles", r.particles}, {"inserted", r.inserted}, {"removed", r.removed},  {"tears", r.tears},
          {"fronts", r.fronts},       {"spacing", r.spacing},   {"complete", r.complete}};
}

}  // namespace sansmesh::cli
