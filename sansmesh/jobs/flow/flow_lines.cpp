// Lines of an open flow.
#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/data/world_points.h"
#include "sansmesh/error.h"
#include "sansmesh/flow.h"
#include "sansmesh/flow/flow_lines.h"
#include "sansmesh/jobs/flow/flow_model.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kDefaultLineSeeds = 200;

struct CarriedArray {
  std::string name;
  ArrayChoice choice;
};

std::vector<CarriedArray> carried_along(const FlowModel& flow, const std::string& carry) {
  if (carry == "none") return {};
  const std::optional<VolumeModel>& volume = flow.volume();
  if (!volume) throw ArgumentError("`carry` needs a steady flow of a file");
  std::vector<std::string> names;
  if (carry == "all")
    for (const DatasetArray& array : volume->arrays()) names.push_back(array.name);
  else
    names = between_commas(carry);
  std::vector<CarriedArray> arrays;
  arrays.reserve(names.size());
  for (const std::string& name : names) arrays.push_back({name, volume->choose(name, "carry")});
  return arrays;
}

/// Samples other arrays at the points.
void carry_along(const std::vector<CarriedArray>& arrays, const VolumeModel& volume, TraceLinesResult& result,
                 Progress& progress) {
  PolylineSet& lines = result.lines;
  progress.begin("carry arrays", arrays.size());
  const std::vector<Vec3> x = world_points(lines.origin, lines.positions);
  for (const CarriedArray& array : arrays) {
    const auto field = volume.field(array.choice, progress, result.notes);
    std::vector<double> values(x.size() * field->components());
    field->query({.points = x}, {.values = values});
    lines.attributes.set(array.name, std::vector<float>(values.begin(), values.end()), field->components());
    progress.advance();
  }
}

}  // namespace

const OptionSchema& TraceLinesOptions::schema() {
  using O = TraceLinesOptions;
  static const OptionRow rows[] = {option<&O::seeds>({.text = kSeedsText, .unit = "seeds", .from_data = "box(200)"}),
                                   option_group<&O::lines>(FlowLineOptions::schema().rows),
                                   option<&O::carry>({.text = "Other arrays at the points: names with commas, all or "
                                                              "none",
                                                      .unit = "names"})};
  return option_schema<rows>();
}

void TraceLinesOptions::validate() const { lines.validate(); }

std::string default_color(const FlowLineOptions& options) {
  return options.kind == FlowLineKind::path ? "speed" : "time";
}

std::vector<std::string> arrays_along_lines(const FlowModel& flow, const TraceLinesOptions& options) {
  std::vector<std::string> names = {"time", "speed", "velocity", "vorticity"};
  for (const CarriedArray& array : carried_along(flow, options.carry)) names.push_back(array.name);
  return names;
}

TraceLinesResult trace_lines_of(const FlowModel& flow, const TraceLinesOptions& options, Progress& progress) {
  options.validate();
  TraceLinesResult result;
  const Seeds seeds = flow.seeds(options.seeds, kDefaultLineSeeds, result.notes);
  FlowLineOptions lines = options.lines;
  lines.closed = seeds.closed;
  const std::vector<CarriedArray> arrays = carried_along(flow, options.carry);
  try {
    result.lines = flow_lines(flow.field(), seeds.points, lines, progress, &result.report);
    if (!arrays.empty()) carry_along(arrays, *flow.volume(), result, progress);
  } catch (const DataError& error) {
    throw in_flow(flow, error);
  }
  for (Note& note : flow.step_notes()) result.notes.push_back(std::move(note));
  if (result.report.outside > 0)
    result.notes.push_back({.code = "outside",
                            .text = fmt::format("{} of {} outside of the flow", grouped(result.report.outside),
                                                counted(result.report.seeds, "seed")),
                            .of = flow.source()});
  return result;
}

std::vector<std::string> summary_of(const TraceLinesResult& made) {
  const FlowLineReport& r = made.report;
  std::vector<std::string> lines{fmt::format("{} from {}: {}, the longest line {}", counted(made.lines.size(), "line"),
                                             counted(r.seeds, "seed"), counted(made.lines.positions.size(), "point"),
                                             length_words(r.longest))};
  std::string ends;
  for (std::size_t k = 0; k < r.ends.size(); ++k)
    if (r.ends[k] > 0) ends += fmt::format("{}{} {}", ends.empty() ? "" : ", ", kTraceEndWords[k], grouped(r.ends[k]));
  std::replace(ends.begin(), ends.end(), '_', ' ');
  if (!ends.empty()) lines.push_back("ended by " + ends);
  return lines;
}

}  // namespace sansmesh::inline v1
