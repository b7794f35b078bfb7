// Meshes of files as commands read, write and tell of them.
#pragma once

#include <string>
#include <string_view>

#include "cli/report/console.h"
#include "cli/report/told_files.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh/topology_words.h"

namespace sansmesh::cli {

class CommandLine;

/// A mesh that a command reads.
struct MeshInput {
  std::string file;
  ReadReport report;

  /// Reads it; warnings go to the console, which tells of it as `input`. Throws FileError.
  TriangleMesh read(Console& console);
  void add_to(CommandLine& command);
};

/// Warns of what a mesh or a cloud loses on its way through: what was not read, and what the format of `output` has no
/// room for.
void warn_of_losses(const std::string& input, const ReadReport& read, const std::string& output,
                    const TriangleMesh& mesh, Console& console);
void warn_of_losses(const std::string& input, const ReadReport& read, const std::string& output, const PointSet& points,
                    Console& console);

/// Tells of a mesh that was written. The stage of the progress ends.
void tell_mesh(const std::string& file, const TriangleMesh& mesh, Console& console, std::string_view key = "output");
/// "a.ply: 1,234 triangles, 620 vertices in 1 component, closed".
void say_mesh(const std::string& file, const TriangleMesh& mesh, std::size_t components, bool closed, Console& console);

}  // namespace sansmesh::cli
