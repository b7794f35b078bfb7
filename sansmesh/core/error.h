// Errors. Bad input throws one of these; a numerical failure at one sample is a returned status instead.
#pragma once

#include <stdexcept>
#include <string>

namespace sansmesh {

/// Base of everything this library throws on purpose. what() is one line that names the culprit and the cause.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A file that cannot be opened, read, understood or written. The message starts with the file's name.
class FileError : public Error {
 public:
  FileError(const std::string& file, const std::string& cause) : Error(file + ": " + cause), file_(file) {}
  const std::string& file() const { return file_; }

 private:
  std::string file_;
};

/// An argument or option out of its valid range: names it, its value and the remedy.
class ArgumentError : public Error {
 public:
  using Error::Error;
};

/// Input that is well formed but cannot be reconstructed (too few points, all in a plane, no extent).
class DataError : public Error {
 public:
  using Error::Error;
};

/// Thrown at the next check point after Progress::cancel().
class Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled") {}
};

}  // namespace sansmesh
