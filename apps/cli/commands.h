// The commands, each in its own source.
#pragma once

#include <string>
#include <vector>

#include "command.h"

namespace sansmesh::cli {

Command add_reconstruct(CommandLine& app);
Command add_convert(CommandLine& app);
Command add_normals(CommandLine& app);
Command add_assess(CommandLine& app);
Command add_info(CommandLine& app);
Command add_render(CommandLine& app);
Command add_project(CommandLine& app);
Command add_curvature(CommandLine& app);
Command add_advise(CommandLine& app);
Command add_fit(CommandLine& app);
Command add_mesh(CommandLine& app);
Command add_probe(CommandLine& app);
Command add_edit(CommandLine& app);
Command add_diagnose(CommandLine& app);
Command add_section(CommandLine& app);
Command add_compare(CommandLine& app);
Command add_measure(CommandLine& app);
Command add_csg(CommandLine& app);
Command add_simulate(CommandLine& app);
Command add_align(CommandLine& app);
Command add_fill(CommandLine& app);
Command add_simplify(CommandLine& app);
Command add_smooth(CommandLine& app);
Command add_deform(CommandLine& app);
Command add_help(CommandLine& app);
Command add_completion(CommandLine& app);
Command add_manual(CommandLine& app);
Command add_schema_command(CommandLine& app);

/// The commands of `volume`.
std::vector<Command> add_volume(CommandLine& app);
Command add_volume_fit(CommandLine& volume);
Command add_volume_probe(CommandLine& volume);
Command add_volume_resample(CommandLine& volume);
Command add_volume_isosurface(CommandLine& volume);
Command add_volume_render(CommandLine& volume);
Command add_volume_surface(CommandLine& volume);

/// The commands of `flow`.
std::vector<Command> add_flow(CommandLine& app);
Command add_flow_lines(CommandLine& flow);
Command add_flow_render(CommandLine& flow);
Command add_flow_surface(CommandLine& flow);

/// Throws FileError early if no function file of that name can be written.
void check_function_writable(const std::string& file);

}  // namespace sansmesh::cli
