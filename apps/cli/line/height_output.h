// Height grids that commands write, with contour lines and a picture.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/report/console.h"
#include "sansmesh/convert.h"

namespace sansmesh::cli {

class CommandLine;

/// File of a height grid or of one of its tiles.
struct WrittenHeights {
  std::string file;
  std::size_t cells = 0;

  static const ReportSchema& schema();
};

/// Height grid in place of another output, by its suffix.
struct HeightOutput {
  HeightGridOptions options;
  std::string breaklines;           ///< file of lines to read; empty: none
  std::string contours, hillshade;  ///< files beside the grid

  static bool is_grid(const std::string& file);
  /// Throws ArgumentError for bad options, and for any without a grid; FileError early if files cannot be written.
  /// FileError also if an input or the breaklines would be overwritten.
  void check(const std::string& output, std::optional<double> tile_size, const std::vector<std::string>& inputs) const;
  /// The breaklines and the size of tiles. Throws FileError if there are no lines.
  HeightGridUse use(std::optional<double> tile_size, Console& console) const;
  /// Writes the grid, in tiles if a size is given, and reports it. Appends lines to the summary. Throws FileError.
  void write(const std::string& output, const HeightGridResult& made, std::optional<double> tile_size,
             const std::vector<std::string>& inputs, std::vector<std::string>& summary, Console& console) const;
};

/// Adds --cell, --interval, --contours and --hillshade; `of_samples`: also --gap and --breaklines.
void add_height_output(CommandLine& command, HeightOutput& output, bool of_samples);

/// Names of parts of an output, which must not be those of an input: NAME_001.ply, or NAME_512000_5403000.ply if there
/// are places. Warns of a further one of connected parts, which is not new.
std::vector<std::string> names_of_parts(const std::string& output, std::size_t parts,
                                        const std::vector<std::string>& places, const std::vector<std::string>& inputs,
                                        Console& console);

}  // namespace sansmesh::cli
