// Meshes that commands read, write and report.
#pragma once

#include <string>
#include <string_view>

#include "cli/report/console.h"
#include "cli/report/file_reports.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh/topology_words.h"

namespace sansmesh::cli {

class CommandLine;

/// Mesh that a command reads.
struct MeshInput {
  std::string file;
  ReadReport report;

  /// Reads the file; sends warnings and the report `input` to the console. Throws FileError.
  TriangleMesh read(Console& console);
  void add_to(CommandLine& command);
};

/// Warns of parts of a mesh or cloud that are lost: parts not read, and parts that the format of `output` cannot hold.
void warn_of_losses(const std::string& input, const ReadReport& read, const std::string& output,
                    const TriangleMesh& mesh, Console& console);
void warn_of_losses(const std::string& input, const ReadReport& read, const std::string& output, const PointSet& points,
                    Console& console);

/// Warns if the file to be written cannot hold the reference system, or a file .prj beside it states another one.
void warn_of_system(const std::string& output, const ReferenceSystem* system, Console& console);

/// Reports a written mesh. Ends the stage of the progress.
void report_mesh(const std::string& file, const TriangleMesh& mesh, Console& console, std::string_view key = "output");
/// "a.ply: 1,234 triangles, 620 vertices in 1 component, closed".
void print_mesh(const std::string& file, const TriangleMesh& mesh, std::size_t components, bool closed,
                Console& console);

}  // namespace sansmesh::cli
