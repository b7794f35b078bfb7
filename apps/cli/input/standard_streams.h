// The word `-` in place of a file: standard input or output.
#pragma once

#include "cli/line/command_line.h"

namespace sansmesh::cli {

/// Gives `-` and `-.ENDING`, where the command line has them for files, the names by which readers and writers know
/// standard input and output. Without an ending, output has the first format that the option takes, and the content of
/// input says what it is, unless the option takes one format only. Throws UsageError where one of both is named twice.
void name_standard_streams(CommandLine& command);

}  // namespace sansmesh::cli
