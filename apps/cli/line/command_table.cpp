#include "cli/line/command_table.h"

#include <vector>

#include "cli/line/commands.h"
#include "cli/line/help_levels.h"
#include "cli/line/schema_options.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::cli {
namespace {

constexpr const char* kExamples = R"(
Examples:
  sansmesh reconstruct scan.ply -o surface.ply
  sansmesh reconstruct scan.ply -o surface.glb --preview surface.png
  sansmesh assess surface.ply reference.ply
  sansmesh help COMMAND

Lengths are in the unit of the input. Options that are not given are chosen from the data.
Exit codes: 0 success, 1 error in a file or its data, 2 error in the command line, 130 interrupted.)";

void add_common(CommandLine& line, CommonArguments& common) {
  line.add_flag("--json", common.console.json, "Print the results as one JSON object");
  line.add_flag("--verbose", common.console.verbose, "Print the time of each stage");
  line.add_flag("--quiet", common.console.quiet, "Print only errors");
  line.add_option("--threads", common.threads, "Number of threads; results do not depend on it [all cores]")
      .within(1, ThreadScope::kMost)
      .type_name("COUNT");
  line.add_flag_callback(
      "-h,--help", [] {}, "Print the basic options, and the names of the others");
  line.add_flag_callback(
      "--help-all", [] {}, "Print every option");
  line.add_flag_callback(
      "-V,--version", [] {}, "Print the version");
}

}  // namespace

Registry<CommandEntry>& CommandEntry::registry() {
  static Registry<CommandEntry> added("command", {});
  return added;
}

std::vector<Command> add_commands(CommandLine& line, CommonArguments& common) {
  line.footer(kExamples);
  add_common(line, common);
  std::vector<Command> commands = own_commands(line);
  for (const CommandEntry* const entry : CommandEntry::registry().all()) commands.push_back(entry->add(line));
  for (const auto add : {add_help, add_completion, add_manual, add_schema_command}) commands.push_back(add(line));
  for (const Command& command : commands) name_flags(*command.line);
  arrange_help(commands);
  return commands;
}

}  // namespace sansmesh::cli
