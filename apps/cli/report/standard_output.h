// Standard output, whose errors are reported, and standard error, whose errors are ignored.
#pragma once

#include <string_view>

namespace sansmesh::cli {

/// Thrown if the reader of standard output has closed it (`| head -1`).
struct BrokenPipe {};

/// Opens descriptors that are closed at the start, so that output files do not get their numbers and receive printed
/// text. Errors of writing (a closed pipe, a size limit) are reported instead of raised as signals.
void prepare_standard_output();

/// Throws FileError if writing fails, BrokenPipe.
void print_out(std::string_view text);
/// Flushes; throws the errors of print_out.
void finish_out();
/// Ends the program by SIGPIPE, as usual for a closed pipe.
[[noreturn]] void end_by_broken_pipe();

/// Never throws.
void print_err(std::string_view text) noexcept;

}  // namespace sansmesh::cli
