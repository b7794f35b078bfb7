// Commands not listed in apps/cli/CMakeLists.txt: those about the tool itself, groups, and the commands of groups.
#pragma once

#include <string>
#include <vector>

#include "cli/line/command.h"

namespace sansmesh::cli {

Command add_help(CommandLine& app);
Command add_completion(CommandLine& app);
Command add_manual(CommandLine& app);
Command add_schema_command(CommandLine& app);

/// The commands of `volume`.
std::vector<Command> add_volume(CommandLine& app);
Command add_volume_fit(CommandLine& volume);
Command add_volume_probe(CommandLine& volume);
Command add_volume_resample(CommandLine& volume);
Command add_volume_smooth(CommandLine& volume);
Command add_volume_isosurface(CommandLine& volume);
Command add_volume_render(CommandLine& volume);
Command add_volume_surface(CommandLine& volume);

/// The commands of `flow`.
std::vector<Command> add_flow(CommandLine& app);
Command add_flow_lines(CommandLine& flow);
Command add_flow_render(CommandLine& flow);
Command add_flow_surface(CommandLine& flow);

/// Throws FileError early if the function file cannot be written.
void check_function_writable(const std::string& file);

}  // namespace sansmesh::cli
