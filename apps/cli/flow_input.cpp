#include "flow_input.h"

#include <fmt/core.h>

#include "command_line.h"
#include "option_values.h"
#include "sansmesh/core/error.h"
#include "schema_options.h"

namespace sansmesh::cli {

FlowModel FlowInput::open(Console& console) const {
  FlowModel opened = open_flow(volume.files, volume, flow, console.progress());
  console.note(opened.source(), opened.opened_notes());
  return opened;
}

Json FlowInput::json(const FlowModel& opened, Progress& progress) const {
  Json json = opened.volume() ? json_of_volume(volume, *opened.volume(), progress) : volume.json();
  json["vectors"] = opened.vectors().empty() ? opened.name() : opened.vectors();
  return json;
}

void add_flow_input(CommandLine& c, FlowInput& input) {
  add_volume_input(c, input.volume);
  add_schema(c, input.flow);
}

void add_times_option(CommandLine& c, std::vector<double>& times, const char* group) {
  const Option option = c.add_option_function(
                             "--times",
                             [&times](const std::string& text) {
                               const auto read = numbers_in(text);
                               if (!read) throw must_be("numbers with commas between them", text);
                               times.insert(times.end(), read->begin(), read->end());
                             },
                             "With --unsteady: of the files, T0,T1,…, or the first and the step between them [0,1]")
                            .type_name("TIMES");
  if (group != nullptr) option.group(group);
}

std::vector<double> times_of_files(const std::vector<double>& given, std::size_t files) {
  if (given.size() == files) return given;
  if (!given.empty() && given.size() != 2)
    throw ArgumentError(
        fmt::format("--times has {} numbers for {} files: as many, or the first and the step", given.size(), files));
  const double from = given.empty() ? 0 : given[0], step = given.empty() ? 1 : given[1];
  std::vector<double> times(files);
  for (std::size_t i = 0; i < files; ++i) times[i] = from + step * static_cast<double>(i);
  return times;
}

}  // namespace sansmesh::cli
