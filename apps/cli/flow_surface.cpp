// sansmesh flow surface: stream, path, streak and time surfaces.
#include <fmt/core.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "flow_input.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"
#include "sansmesh/flow/flow_surface.h"
#include "sansmesh/mesh/mesh_size.h"

namespace sansmesh::cli {
namespace {

struct FlowSurfaceArguments {
  FlowInput input;
  FlowSurfaceOptions options;
  std::optional<FlowSurfaceKind> kind;
  std::optional<std::size_t> particles;
  std::optional<double> time;
  std::vector<double> sweep;
  bool interpolated = false;
  MeshOutput mesh;
};

void run_flow_surface(FlowSurfaceArguments& a, Console& console) {
  a.mesh.check();
  require(!a.input.seeds.empty(), "--seeds is needed: a curve such as line(0,0,0, 1,0,0, 100)");
  FlowSurfaceOptions& o = a.options;
  o.kind = a.kind.value_or(a.input.unsteady ? FlowSurfaceKind::path : FlowSurfaceKind::stream);
  if (a.interpolated) o.insertion = FlowInsertion::interpolated;
  if (a.time) o.duration = *a.time;
  if (!a.sweep.empty()) o.sweep = {a.sweep[0], a.sweep[1], a.sweep[2]};
  OpenFlow flow(a.input, console);
  const Seeds seeds = flow.seeds(0);
  require(seeds.curve, "--seeds must be a curve: line, circle, curve(FILE) or loop(FILE)");
  if (a.particles)
    o.seeds = *a.particles;
  else if (seeds.file.empty())
    o.seeds = seeds.points.size();
  o.validate();
  const SeedCurve curve{seeds.points, seeds.closed};
  Json json = {{"input", flow.json()}};
  try {
    const FlowSurface surface = flow_surface(flow.field(), curve, o, console.progress());
    const FlowSurfaceReport& r = surface.report;
    if (!r.complete)
      console.warn(a.input.volume.name(),
                   {"ended after as many fronts or particles as are allowed: --time gives an end"});
    a.mesh.write(surface.mesh, console.progress());
    console.progress().finish();
    const MeshSize size = measure_size(surface.mesh);
    console.say(fmt::format("{}: {} on {}, {} apart at the seeds", flow.name(), counted(r.particles, "particle"),
                            counted(r.fronts, "front"), length(r.spacing)));
    console.say(fmt::format("{} put between others, {} left out, {}", grouped(r.inserted), grouped(r.removed),
                            counted(r.tears, "tear")));
    console.say(fmt::format("{}: {}, {} vertices, area {:.6g}", a.mesh.file,
                            counted(surface.mesh.triangles.size(), "triangle"), grouped(surface.mesh.vertices.size()),
                            size.area));
    json["surface"] = {{"particles", r.particles}, {"inserted", r.inserted}, {"removed", r.removed},
                       {"tears", r.tears},         {"fronts", r.fronts},     {"spacing", r.spacing},
                       {"complete", r.complete}};
    json["area"] = size.area;
    json["output"] = {{"file", a.mesh.file},
                      {"triangles", surface.mesh.triangles.size()},
                      {"vertices", surface.mesh.vertices.size()}};
  } catch (const DataError& error) {
    throw flow.error(error);
  }
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_flow_surface(CommandLine& flow) {
  CommandLine& c = flow.add_subcommand("surface", "Flow and a seed curve → stream, path, streak or time surface");
  auto shared = std::make_shared<FlowSurfaceArguments>();
  FlowSurfaceArguments& a = *shared;
  add_flow_input(c, a.input);
  add_mesh_output(c, a.mesh);
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
  c.footer(
      std::string("The mesh has for each vertex s (place on the curve), time, speed and front.\n") + kFlowsByFormula +
      "Examples:\n"
      "  sansmesh flow surface office.vtk --seeds 'line(0.5,0.5,1, 4,4,1, 200)' -o stream.ply --preview stream.png\n"
      "  sansmesh flow surface eddies.nek5000 --unsteady --seeds 'line(1,1,0, 5,5,0, 200)' -o path.ply\n"
      "  sansmesh flow surface tornado --seeds 'circle(0.5,0.5,0.02, 0,0,1, 0.2, 100)' --time 5 -o tube.ply");
  return {&c, [shared](Console& console) { run_flow_surface(*shared, console); }};
}

}  // namespace sansmesh::cli
