// Exceptions. Invalid input throws one of these; a numerical failure at one sample is a returned status instead.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

#include "sansmesh/api.h"

namespace sansmesh::inline v1 {

/// Makes text of a file or a user printable on one line: printable UTF-8 characters stay, all other bytes (control
/// characters, line breaks, invalid UTF-8) become `\xNN`. Texts of more than `most` characters lose their middle ("…").
SANSMESH_API std::string printable(std::string_view text, std::size_t most = std::string_view::npos);

/// Base of all exceptions of this library. what() is one line that names the input and the cause.
class SANSMESH_API Error : public std::runtime_error {
 public:
  /// Takes the message.
  using std::runtime_error::runtime_error;
};

/// A file that cannot be opened, read, parsed or written. The message starts with the file's name. Causes may quote
/// damaged files: name and cause are made printable(), and long causes are shortened.
class SANSMESH_API FileError : public Error {
 public:
  /// The message is "file: cause".
  FileError(const std::string& file, const std::string& cause);
  /// Name of the file as the caller gave it, before printable().
  const std::string& file() const { return file_; }

 private:
  std::string file_;
};

/// Option with an invalid value.
struct ArgumentFault {
  std::string field;        ///< name of the option
  std::string value;        ///< given value, as text
  std::string allowed;      ///< allowed values: "from 1 to 10", "one of compact, gaussian"
  std::string remedy = {};  ///< remedy; empty if `allowed` states it
};

/// An argument or option out of range. Messages name options by their fields, between grave accents, or by the name in
/// their schema if that differs: `enhance = false`.
class SANSMESH_API ArgumentError : public Error {
 public:
  /// Error about several options, or an argument that is not an option: fault() stays empty.
  explicit ArgumentError(const std::string& message) : Error(message) {}
  /// The message is "`degree` must be from 1 to 4, not 7".
  explicit ArgumentError(const ArgumentFault& fault);

  /// The invalid option. Empty if several options conflict: the message then names them.
  const ArgumentFault& fault() const { return fault_; }

 private:
  ArgumentFault fault_;
};

/// Well-formed input that cannot be reconstructed: too few points, all points in a plane, or no extent.
class SANSMESH_API DataError : public Error {
 public:
  /// Takes the message.
  using Error::Error;
};

/// Thrown at the next check point after Progress::cancel().
class SANSMESH_API Cancelled : public Error {
 public:
  /// The message is "cancelled".
  Cancelled() : Error("cancelled") {}
};

}  // namespace sansmesh::inline v1
