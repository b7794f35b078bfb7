// Errors in the words of a command.
#pragma once

#include <exception>
#include <string>

#include "cli/line/command_line.h"
#include "sansmesh/error.h"

namespace sansmesh::cli {

/// Message of an error of a file; if the file is not there, with the name that may have been meant.
std::string words_of_file_error(const FileError& error, const CommandLine& command);
/// Message of any other exception; those of the standard library are told in our words.
std::string words_of_error(const std::exception& error);

}  // namespace sansmesh::cli
