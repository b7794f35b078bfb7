#include "cli/report/mesh_words.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "cli/line/command_line.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/io/reference_text.h"

namespace sansmesh::cli {
namespace {

void warn_of(const std::string& input, const ReadReport& read, const std::string& output,
             const std::vector<std::string>& lost, Console& console) {
  if (!read.unread.empty())
    console.warn(input,
                 {fmt::format("not read, since meshes and clouds cannot hold it: {}", fmt::join(read.unread, ", "))});
  if (!lost.empty()) console.warn(input, {fmt::format("{} cannot hold {}: dropped", output, fmt::join(lost, ", "))});
}

}  // namespace

TriangleMesh MeshInput::read(Console& console) {
  console.progress().begin("read");
  TriangleMesh mesh = read_mesh(file, &report);
  console.warn(file, report.warnings);
  console.report(ReadMesh{file, mesh.triangles.size()}, "input");
  return mesh;
}

void MeshInput::add_to(CommandLine& c) {
  c.add_option("input", file, "Mesh").reads(endings_read(kPoints)).required();
  c.announce({report_of<ReadMesh>("input")});
}

void warn_of_losses(const std::string& input, const ReadReport& read, const std::string& output,
                    const TriangleMesh& mesh, Console& console) {
  warn_of(input, read, output, left_out(output, mesh), console);
}

void warn_of_losses(const std::string& input, const ReadReport& read, const std::string& output, const PointSet& points,
                    Console& console) {
  warn_of(input, read, output, left_out(output, points), console);
}

void warn_of_system(const std::string& output, const ReferenceSystem* system, Console& console) {
  if (const std::string remark = io::system_remark(output, system); !remark.empty()) console.warn(output, {remark});
}

void report_mesh(const std::string& file, const TriangleMesh& mesh, Console& console, std::string_view key) {
  console.progress().finish();
  if (console.options().json) console.report(WrittenMesh(file, mesh), key);
}

void print_mesh(const std::string& file, const TriangleMesh& mesh, std::size_t components, bool closed,
                Console& console) {
  console.print(fmt::format("{}: {}, {} vertices in {}{}", file, counted(mesh.triangles.size(), "triangle"),
                            grouped(mesh.vertices.size()), counted(components, "component"),
                            closed ? ", closed" : ", with borders"));
}

}  // namespace sansmesh::cli
