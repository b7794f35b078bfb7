// Errors. Bad input throws one of these; a numerical failure at one sample is a returned status instead.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

#include "sansmesh/api.h"

namespace sansmesh::inline v1 {

/// Text of a file or of a user, fit for one line of a message: printing characters of UTF-8 stay, all other bytes
/// (control characters, line breaks, what is not UTF-8) become `\xNN`. Of more than `most` characters the middle is
/// left out ("…"). Printable text of at most `most` characters stays as it is.
SANSMESH_API std::string printable(std::string_view text, std::size_t most = std::string_view::npos);

/// Base of everything this library throws on purpose. what() is one line that names the culprit and the cause.
class SANSMESH_API Error : public std::runtime_error {
 public:
  /// From the message.
  using std::runtime_error::runtime_error;
};

/// A file that cannot be opened, read, understood or written. The message starts with the file's name. Causes may hold
/// excerpts of damaged files: name and cause are made printable(), long causes cut.
class SANSMESH_API FileError : public Error {
 public:
  /// The message is "file: cause".
  FileError(const std::string& file, const std::string& cause);
  /// Name of the file as the caller gave it, not made printable.
  const std::string& file() const { return file_; }

 private:
  std::string file_;
};

/// One option with a value that is not allowed.
struct ArgumentFault {
  std::string field;        ///< name of the option
  std::string value;        ///< that was given, as text
  std::string allowed;      ///< "from 1 to 10", "one of compact, gaussian"
  std::string remedy = {};  ///< what to do; empty if `allowed` says it
};

/// An argument or option out of range. Options are named by their fields, between grave accents: `enhance = false`.
class SANSMESH_API ArgumentError : public Error {
 public:
  /// Of several options, or of an argument that is no option: fault() stays empty.
  explicit ArgumentError(const std::string& message) : Error(message) {}
  /// "`degree` must be from 1 to 4, not 7".
  explicit ArgumentError(const ArgumentFault& fault);

  /// The option out of range. Empty where several options do not go together: then only the message tells.
  const ArgumentFault& fault() const { return fault_; }

 private:
  ArgumentFault fault_;
};

/// Input that is well formed but cannot be reconstructed (too few points, all in a plane, no extent).
class SANSMESH_API DataError : public Error {
 public:
  /// From the message.
  using Error::Error;
};

/// Thrown at the next check point after Progress::cancel().
class SANSMESH_API Cancelled : public Error {
 public:
  /// The message is "cancelled".
  Cancelled() : Error("cancelled") {}
};

}  // namespace sansmesh::inline v1
