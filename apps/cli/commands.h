// The commands, each in its own source.
#pragma once

#include <string>

#include "command.h"

namespace sansmesh::cli {

Command add_reconstruct(CLI::App& app);
Command add_normals(CLI::App& app);
Command add_evaluate(CLI::App& app);
Command add_info(CLI::App& app);
Command add_render(CLI::App& app);
Command add_project(CLI::App& app);
Command add_curvature(CLI::App& app);
Command add_advise(CLI::App& app);
Command add_fit(CLI::App& app);
Command add_mesh(CLI::App& app);
Command add_eval(CLI::App& app);
Command add_edit(CLI::App& app);
Command add_diagnose(CLI::App& app);
Command add_section(CLI::App& app);
Command add_compare(CLI::App& app);
Command add_measure(CLI::App& app);
Command add_csg(CLI::App& app);

/// Throws FileError early if no function file of that name can be written.
void check_function_writable(const std::string& file);

}  // namespace sansmesh::cli
