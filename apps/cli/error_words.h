// Errors in the words of a command.
#pragma once

#include <exception>
#include <string>

#include "command_line.h"
#include "sansmesh/error.h"

namespace sansmesh::cli {

/// Of a file that is not there, with what may have been meant.
std::string words_of_file_error(const FileError& error, const CommandLine& command);
/// Of an exception of another library, in our words.
std::string words_of_error(const std::exception& error);

}  // namespace sansmesh::cli
