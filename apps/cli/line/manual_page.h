// Manual pages, generated from the table of options.
#pragma once

#include <string>

#include "cli/line/command_line.h"

namespace sansmesh::cli {

/// Page of section 1 in macros of man(7), ASCII only.
std::string manual_page(const CommandLine& command, const std::string& version);
/// "sansmesh-volume-probe.1"
std::string manual_page_name(const CommandLine& command);

}  // namespace sansmesh::cli
