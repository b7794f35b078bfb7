// Clouds that a command reads: files and point classes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/report/console.h"
#include "cli/report/file_reports.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points/cleaning/point_classes.h"
#include "sansmesh/points/statistics/noise.h"

namespace sansmesh::cli {

class CommandLine;

/// One file, or several that are read as one cloud.
struct CloudInput {
  std::vector<std::string> files;       ///< not empty after parsing
  std::string with, without;            ///< values of --class and --without-class
  std::optional<PointClasses> classes;  ///< derived from these
  bool names_system = true;             ///< prints the reference system and unit of the files, if known
  ReadOptions part;                     ///< the part of the files to read

  /// "a.las", "a.las and 2 other files"
  std::string name() const;
  ReadFiles report() const { return {files}; }
  /// Also reports what was read.
  ReadCloud report(const ReadReport& read, std::size_t points) const {
    return {{files}, read.format, points, read.reference};
  }
  /// Whether any option selects points.
  bool selects() const { return classes || part.box || part.resolution; }
  /// True for a function file, false for a cloud. Throws ArgumentError if points of a function were selected.
  bool is_function() const;
  /// Reads all files as one cloud, as one stage of the progress, and keeps the points of the selected classes. Warnings
  /// are sent to the console. Throws FileError.
  PointSet read(Console& console, ReadReport& report) const;
};

/// Calls `call`; errors of the data become FileError with the file name.
template <class Call>
auto naming(const std::string& file, const Console& console, Call call) {
  try {
    return call();
  } catch (const DataError& error) {
    throw FileError(file, console.in_flags(error.what()));
  }
}

/// Adds a surface (mesh, points or function), as a positional argument. Files is a text or a vector of texts.
template <class Files>
void add_surface_input(CommandLine& command, const std::string& name, Files& files, const std::string& what);
/// Adds --class, --without-class, --read-box and --read-spacing. `of`: the cloud, for commands that read several:
/// " of the reference".
void add_selection_options(CommandLine& command, CloudInput& input, const std::string& of = "");
/// Adds the files and the options that select points. `what` describes the files; `as_one`: several files form one
/// cloud.
void add_cloud_input(CommandLine& command, CloudInput& input, const std::string& what, bool as_one = true);

/// Spacing and noise of a cloud as read; all commands report these values.
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
