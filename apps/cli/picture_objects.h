// Several objects in one picture, each with its own colour.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/data/polyline_set.h"

namespace sansmesh::cli {

class CommandLine;
class Console;
struct RenderArguments;

/// What an object of a picture is.
enum class ObjectKind { mesh, points, lines, function };

/// Looks of objects, in the order of their files; those that are missing follow by themselves.
struct ObjectLooks {
  std::vector<std::string> colors;  ///< "#rrggbb", a name, "own" or "auto"
  std::vector<double> opacities;    ///< 0..1
  std::vector<std::string> names;   ///< in the legend
  bool no_legend = false;           ///< not even where there are several
  bool as_one = false;              ///< several files are one object

  /// Throws ArgumentError for colours that are none, shares beyond 0..1 and more of them than objects.
  void check(std::size_t objects) const;
  /// What the picture of one object without a colour of its own would not show.
  bool translucent() const;
};

/// The lines that a file holds; of other formats than VTP none. Throws FileError.
PolylineSet lines_of_file(const std::string& file);

/// --color, --opacity, --name, --no-legend, --as-one
void add_object_options(CommandLine& command, ObjectLooks& looks);

/// A picture of all files of the arguments, which are complete, each as an object, or all as one. Throws as
/// run_surface_picture.
void run_object_picture(const RenderArguments& arguments, Console& console);

}  // namespace sansmesh::cli
