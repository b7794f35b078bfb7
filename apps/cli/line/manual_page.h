// Manual pages, made from the table of options.
#pragma once

#include <string>

#include "cli/line/command_line.h"

namespace sansmesh::cli {

/// A page of section 1 in the macros of man(7), ASCII alone.
std::string manual_page(const CommandLine& command, const std::string& version);
/// "sansmesh-volume-probe.1"
std::string manual_page_name(const CommandLine& command);

}  // namespace sansmesh::cli
