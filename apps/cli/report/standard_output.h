// Standard output, on which results must not be lost, and standard error, on which they may.
#pragma once

#include <string>
#include <string_view>

namespace sansmesh::cli {

/// Thrown where nobody reads standard output any more (`| head -1`).
struct BrokenPipe {};

/// Descriptors that were closed when the program began are taken, so that no file gets their numbers, and with these
/// what is printed. Writing to a pipe that nobody reads, or too much, is an error instead of a signal.
void prepare_standard_output();

/// Throws FileError where it cannot be written, BrokenPipe.
void print_out(std::string_view text);
/// What was printed has arrived, or an error of print_out is thrown.
void finish_out();
/// Ends the program as tools end whose output nobody reads: by SIGPIPE.
[[noreturn]] void end_by_broken_pipe();

/// Never throws.
void print_err(std::string_view text) noexcept;

}  // namespace sansmesh::cli
