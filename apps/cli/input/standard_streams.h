// The file name `-`: standard input or output.
#pragma once

#include "cli/line/command_line.h"

namespace sansmesh::cli {

/// Replaces `-` and `-.ENDING` in file options by the names by which readers and writers know standard input and
/// output. Without an ending, output has the first format of the option, and input is identified by content, unless the
/// option has one format only. Throws UsageError if one stream is named twice.
void name_standard_streams(CommandLine& command);

}  // namespace sansmesh::cli
