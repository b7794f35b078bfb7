#include "cli/input/flow_input.h"

#include "cli/line/command_line.h"
#include "cli/line/option_values.h"
#include "cli/line/schema_options.h"

namespace sansmesh::cli {

FlowModel FlowInput::open(Console& console) const {
  FlowModel opened = open_flow(volume.files, volume, flow, console.progress());
  console.note(opened.source(), opened.opened_notes());
  return opened;
}

ReadFlow FlowInput::report(const FlowModel& opened, Progress& progress) const {
  return {{volume.files},
          opened.volume() ? std::optional(volume_use(*opened.volume(), progress)) : std::nullopt,
          opened.vectors().empty() ? opened.name() : opened.vectors()};
}

const ReportSchema& ReadFlow::schema() {
  static constexpr ReportRow rows[] = {reported_base<ReadFiles, ReadFlow>(), reported_inline<&ReadFlow::volume>(),
                                       reported<&ReadFlow::vectors>({.text = "Array of vectors, or the formula"})};
  return report_schema<rows>();
}

void add_flow_input(CommandLine& c, FlowInput& input) {
  add_volume_input(c, input.volume);
  add_schema(c, input.flow);
}

void add_flow_surface_input(CommandLine& c, FlowInput& input, TraceSurfaceOptions& options) {
  add_flow_input(c, input);
  const std::vector<std::string_view> fronts = {"alpha", "beta", "delta", "interpolated", "front_step"},
                                      steps = {"integrator", "tolerance", "step_length"};
  std::vector<std::string_view> others = {"most_fronts", "most_points", "least_speed", "most_steps"};
  others.insert(others.end(), fronts.begin(), fronts.end());
  others.insert(others.end(), steps.begin(), steps.end());
  add_schema(c, options, {.without = others});
  add_schema(c, options, {.group = "Fronts", .only = fronts});
  add_schema(c, options, {.group = "Steps", .only = steps});
}

void add_times_option(CommandLine& c, std::vector<double>& times, const char* group) {
  const Option option = c.add_option_function(
                             "--times",
                             [&times](const std::string& text) {
                               const auto read = numbers_in(text);
                               if (!read) throw must_be("comma-separated numbers", text);
                               times.insert(times.end(), read->begin(), read->end());
                             },
                             "With --unsteady: times of the files, T0,T1,…, or the first and the interval [0,1]")
                            .type_name("TIMES");
  if (group != nullptr) option.group(group);
}

}  // namespace sansmesh::cli
