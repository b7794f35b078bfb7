// sansmesh flow lines: stream, path, streak and time lines.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "flow_input.h"
#include "line_picture.h"
#include "option_groups.h"
#include "option_values.h"
#include "sansmesh/core/error.h"
#include "sansmesh/flow/flow_lines.h"
#include "sansmesh/io/io.h"

namespace sansmesh::cli {
namespace {

constexpr std::size_t kDefaultSeeds = 200;
constexpr const char* kEnds[] = {"time", "length", "boundary", "critical_point", "steps", "outside"};

struct FlowLinesArguments {
  FlowInput input;
  FlowLineOptions options;
  std::optional<double> start;
  std::string output, direction = "forward", carry = "none";
  bool ascii = false;
  LinePictureArguments preview;
};

/// What --carry names, by name.
std::vector<std::pair<std::string, ArrayChoice>> carried_along(const FlowLinesArguments& a, OpenFlow& flow) {
  if (a.carry == "none") return {};
  OpenVolume* const volume = flow.volume();
  require(volume != nullptr, "--carry needs a steady flow of a file");
  std::vector<std::string> names;
  if (a.carry != "all") names = between_commas(a.carry);
  if (names.empty())
    for (const DatasetArray& array : volume->dataset().arrays()) names.push_back(array.name);
  std::vector<std::pair<std::string, ArrayChoice>> arrays;
  arrays.reserve(names.size());
  for (const std::string& name : names) arrays.emplace_back(name, volume->dataset().choose(name, "carry"));
  return arrays;
}

/// Other arrays of a steady volume at the points.
void carry(const std::vector<std::pair<std::string, ArrayChoice>>& arrays, OpenVolume* volume, PolylineSet& lines,
           Progress& progress) {
  if (arrays.empty()) return;
  progress.begin("carry arrays", arrays.size());
  std::vector<Vec3> x;
  x.reserve(lines.positions.size());
  for (const Vec3f& p : lines.positions) x.push_back(lines.origin + Vec3(p));
  for (const auto& [name, choice] : arrays) {
    const auto field = volume->field(choice);
    std::vector<double> values(x.size() * field->components());
    field->evaluate(x, {values, {}, {}, {}});
    lines.attributes.set(name, std::vector<float>(values.begin(), values.end()), field->components());
    progress.advance();
  }
}

void run_flow_lines(FlowLinesArguments& a, Console& console) {
  check_writable(a.output, "lines");
  const std::string usual_color = a.options.kind == FlowLineKind::path ? "speed" : "time";
  a.preview.check(usual_color);
  a.options.forward = a.direction != "backward", a.options.backward = a.direction != "forward";
  OpenFlow flow(a.input, console);
  const TimeRange times = flow.field().times();
  const Seeds seeds = flow.seeds(kDefaultSeeds, console);
  a.options.start =
      a.start.value_or(std::isfinite(times.first) ? (a.direction == "backward" ? times.last : times.first) : 0);
  a.options.closed = seeds.closed;
  const auto arrays = carried_along(a, flow);
  std::vector<std::string> names = {"time", "speed", "velocity", "vorticity"};
  for (const auto& array : arrays) names.push_back(array.first);
  a.preview.check_color(names);
  Json json = {{"input", flow.json()}};
  try {
    FlowLineReport report;
    PolylineSet lines = flow_lines(flow.field(), seeds.points, a.options, console.progress(), &report);
    carry(arrays, flow.volume(), lines, console.progress());
    std::optional<LinePicture> picture;
    if (!a.preview.file.empty()) picture = draw_lines(lines, a.preview, usual_color, console.progress());
    console.progress().begin("write");
    write_lines(a.output, lines, {a.ascii});
    if (picture) a.preview.picture.write(a.preview.file, picture->image, picture->look);
    console.progress().finish();
    flow.warn_of_steps(console);
    if (report.outside > 0)
      console.warn(a.input.volume.name(), {fmt::format("{} of {} outside of the flow", grouped(report.outside),
                                                       counted(report.seeds, "seed"))});
    console.say(
        fmt::format("{}: {} from {}", flow.name(), counted(lines.size(), "line"), counted(report.seeds, "seed")));
    Json ends;
    std::string said;
    for (std::size_t k = 0; k < report.ends.size(); ++k) {
      if (report.ends[k] == 0) continue;
      ends[kEnds[k]] = report.ends[k];
      std::string word = kEnds[k];
      std::replace(word.begin(), word.end(), '_', ' ');
      said += fmt::format("{}{} {}", said.empty() ? "" : ", ", word, grouped(report.ends[k]));
    }
    if (!said.empty()) console.say("ended by " + said);
    console.say(fmt::format("{}: {}, the longest line {}", a.output, counted(lines.positions.size(), "point"),
                            length(report.longest)));
    if (picture)
      console.say(fmt::format("{}: colours by {} over {:.6g} to {:.6g}, tubes of radius {}", a.preview.file,
                              picture->color_by, picture->lower, picture->upper, length(picture->radius)));
    json["seeds"] = {{"count", report.seeds}, {"outside", report.outside}};
    json["ends"] = ends;
    json["output"] = {
        {"file", a.output}, {"lines", lines.size()}, {"points", lines.positions.size()}, {"longest", report.longest}};
    if (picture)
      json["preview"] = {{"file", a.preview.file},  {"color_by", picture->color_by}, {"lower", picture->lower},
                         {"upper", picture->upper}, {"radius", picture->radius},     {"triangles", picture->triangles}};
  } catch (const DataError& error) {
    throw flow.error(error);
  }
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_flow_lines(CommandLine& flow) {
  CommandLine& c = flow.add_subcommand("lines", "Flow → stream, path, streak and time lines");
  auto shared = std::make_shared<FlowLinesArguments>();
  FlowLinesArguments& a = *shared;
  add_flow_input(c, a.input);
  c.add_option("-o,--output", a.output, "Lines to write: .vtp, .ply or .csv (line,time,x,y,z, …)")
      .type_name("FILE")
      .required();
  c.add_choice<FlowLineKind>(
       "--kind", a.options.kind,
       {{"stream", FlowLineKind::path},
        {"path", FlowLineKind::path},
        {"streak", FlowLineKind::streak},
        {"time", FlowLineKind::time}},
       "stream or path: where particles go; streak: dye from each seed; time: the seeds' curve as it moves [path]")
      .type_name("NAME");
  c.add_option("--direction", a.direction, "forward, backward or both [forward]")
      .one_of({"forward", "backward", "both"})
      .type_name("NAME");
  c.add_option("--start", a.start, "Moment at which particles leave [the first of the flow]").type_name("TIME");
  c.add_option("--time", a.options.duration, "How long they are followed [to the end of the flow]")
      .type_name("DURATION");
  c.add_option("--length", a.options.length, "How long lines are at most [five diagonals, without --time]")
      .type_name("LENGTH");
  c.add_option("--interval", a.options.interval, "Between particles of a streak, or between time lines")
      .type_name("DURATION");
  add_trace_options(c, a.options.trace);
  c.add_option("--least-speed", a.options.trace.least_speed, "Slower ones have arrived [1e-6 of the seeds' median]")
      .type_name("SPEED")
      .group("Steps");
  c.add_option("--most-steps", a.options.trace.most_steps, "Of a particle [20000]").type_name("COUNT").group("Steps");
  c.add_option("--carry", a.carry, "Other arrays at the points: names with commas, all or none [none]")
      .type_name("NAMES");
  add_ascii_flag(c, a.ascii);
  add_line_picture(c, a.preview);
  c.footer(std::string(kFlowsByFormula) +
           "Examples:\n"
           "  sansmesh flow lines office.vtk --seeds 'line(0,0,1, 4,4,1, 50)' -o lines.vtp\n"
           "  sansmesh flow lines eddies.nek5000 --unsteady --kind streak --seeds 'point(3,3,0)' -o dye.vtp\n"
           "  sansmesh flow lines tornado --seeds 'circle(0.5,0.5,0.02, 0,0,1, 0.3, 40)' --time 10 -o column.csv");
  return {&c, [shared](Console& console) { run_flow_lines(*shared, console); }};
}

}  // namespace sansmesh::cli
