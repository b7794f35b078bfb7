// Error messages with flags of a command.
#pragma once

#include <exception>
#include <string>

#include "cli/line/command_line.h"
#include "sansmesh/error.h"

namespace sansmesh::cli {

/// Message of a file error; for a missing file, with a suggestion of similar names.
std::string words_of_file_error(const FileError& error, const CommandLine& command);
/// Message of any other exception; standard exceptions have our own texts.
std::string words_of_error(const std::exception& error);

}  // namespace sansmesh::cli
