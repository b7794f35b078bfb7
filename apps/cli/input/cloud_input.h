// The clouds that a command reads: files, and which of their points.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/report/console.h"
#include "cli/report/told_files.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points/noise.h"
#include "sansmesh/points/point_classes.h"

namespace sansmesh::cli {

class CommandLine;

/// One file, or several that are read as one cloud.
struct CloudInput {
  std::vector<std::string> files;       ///< at least one once the command line is read
  std::string with, without;            ///< as given to --class and --without-class
  std::optional<PointClasses> classes;  ///< what follows from these

  /// "a.las", "a.las and 2 other files"
  std::string name() const;
  ReadFiles told() const { return {files}; }
  /// With what was read.
  ReadCloud told(const ReadReport& read, std::size_t points) const { return {{files}, read.format, points}; }
  /// Whether it is a function file and not a cloud. Throws ArgumentError where points of it were to be chosen.
  bool is_function() const;
  /// Reads all as one cloud, as a stage of the progress, and keeps the points of the classes that were asked for.
  /// Warnings go to the console. Throws FileError.
  PointSet read(Console& console, ReadReport& report) const;
};

/// Calls; errors of the data become FileError that name the file.
template <class Call>
auto naming(const std::string& file, const Console& console, Call call) {
  try {
    return call();
  } catch (const DataError& error) {
    throw FileError(file, console.in_flags(error.what()));
  }
}

/// --class and --without-class. `of`: whose points they choose, where a command reads several clouds: " of the
/// reference".
void add_class_options(CommandLine& command, CloudInput& input, const std::string& of = "");
/// The files, --class and --without-class. `what` describes the files; `as_one`: several of them are one.
void add_cloud_input(CommandLine& command, CloudInput& input, const std::string& what, bool as_one = true);

/// How fine and how noisy a cloud is, as it was read: the same by every command that says so of a file.
struct CloudScale {
  double spacing = 0;
  NoiseEstimate noise;

  explicit CloudScale(const PointSet& points);
  CloudScale(double spacing_of, const NoiseEstimate& noise_of) : spacing(spacing_of), noise(noise_of) {}
  /// "unknown: 0.02 at most, of shape or noise", "0.0039"
  std::string noise_words() const;

  static const ReportSchema& schema();
};

}  // namespace sansmesh::cli
