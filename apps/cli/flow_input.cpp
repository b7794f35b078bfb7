#include "flow_input.h"

#include "command_line.h"
#include "option_values.h"
#include "schema_options.h"

namespace sansmesh::cli {

FlowModel FlowInput::open(Console& console) const {
  FlowModel opened = open_flow(volume.files, volume, flow, console.progress());
  console.note(opened.source(), opened.opened_notes());
  return opened;
}

ReadFlow FlowInput::told(const FlowModel& opened, Progress& progress) const {
  return {{volume.files},
          opened.volume() ? std::optional(volume_use(*opened.volume(), progress)) : std::nullopt,
          opened.vectors().empty() ? opened.name() : opened.vectors()};
}

const ReportSchema& ReadFlow::schema() {
  static constexpr ReportRow rows[] = {reported_base<ReadFiles, ReadFlow>(), reported_beside<&ReadFlow::volume>(),
                                       reported<&ReadFlow::vectors>({.text = "Array of vectors, or the formula"})};
  static constexpr ReportSchema schema{rows};
  return schema;
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

}  // namespace sansmesh::cli
