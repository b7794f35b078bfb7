#include "cli/report/file_reports.h"

#include <fmt/core.h>

#include <optional>
#include <utility>

#include "sansmesh/data/reference_system.h"

namespace sansmesh::cli {
namespace {

std::optional<std::string> single(const std::vector<std::string>& files) {
  return files.size() == 1 ? std::optional(files[0]) : std::nullopt;
}

std::optional<std::string> system_name(const ReadCloud& r) {
  return r.reference ? std::optional(system_words(*r.reference)) : std::nullopt;
}

std::optional<std::string> length_unit(const ReadCloud& r) {
  return r.reference && !r.reference->unit.empty() ? std::optional(r.reference->unit) : std::nullopt;
}

constexpr ReportRow kReadFiles[] = {
    reported<[](const ReadFiles& r) { return single(r.files); }>({.name = "file", .text = "File, if there is one"}),
    reported<[](const ReadFiles& r) { return value_if(r.files.size() != 1, r.files); }>(
        {.name = "files", .text = "Files, if there are several"})};
constexpr ReportRow kReadCloud[] = {
    reported_base<ReadFiles, ReadCloud>(), reported<&ReadCloud::format>({.text = "Format of the file"}),
    reported<&ReadCloud::points>({.text = "Points or vertices of the input"}),
    reported<[](const ReadCloud& r) { return system_name(r); }>(
        {.name = "reference_system", .text = "Coordinate reference system of the file"}),
    reported<[](const ReadCloud& r) { return length_unit(r); }>(
        {.name = "unit", .text = "Unit of all lengths, if the file states it"})};
constexpr ReportRow kReadMesh[] = {reported<&ReadMesh::file>({.text = "File"}),
                                   reported<&ReadMesh::triangles>({.text = "Triangles of the mesh"})};
constexpr ReportRow kFileReport[] = {reported<&FileReport::file>({.text = "File"})};
constexpr ReportRow kWrittenPoints[] = {reported<&WrittenPoints::file>({.text = "File"}),
                                        reported<&WrittenPoints::points>({.text = "Points in the file"})};
constexpr ReportRow kWrittenMesh[] = {reported<&WrittenMesh::file>({.text = "File"}),
                                      reported<&WrittenMesh::vertices>({.text = "Vertices of the mesh"}),
                                      reported<&WrittenMesh::triangles>({.text = "Triangles of the mesh"}),
                                      reported<[](const WrittenMesh& r) { return r.topology.closed(); }>(
                                          {.name = "closed", .text = "Whether the mesh is closed"}),
                                      reported<[](const WrittenMesh& r) { return r.topology.components; }>(
                                          {.name = "components", .text = "Connected components of the mesh"}),
                                      reported<[](const WrittenMesh& r) { return r.topology.boundary_edges; }>(
                                          {.name = "boundary_edges", .text = "Edges with one triangle"})};
constexpr ReportRow kWrittenPictures[] = {
    reported<&WrittenPictures::files>({.text = "Pictures"}),
    reported<[](const WrittenPictures& r) { return single(r.files); }>(
        {.name = "file", .text = "Picture, if there is one"}),
    reported<&WrittenPictures::width>({.text = "Width of each", .unit = "pixels"}),
    reported<&WrittenPictures::height>({.text = "Height of each", .unit = "pixels"})};

template <auto& rows>
constexpr ReportSchema kSchema{rows};

}  // namespace

const ReportSchema& ReadFiles::schema() { return kSchema<kReadFiles>; }
const ReportSchema& ReadCloud::schema() { return kSchema<kReadCloud>; }
const ReportSchema& ReadMesh::schema() { return kSchema<kReadMesh>; }
const ReportSchema& FileReport::schema() { return kSchema<kFileReport>; }
const ReportSchema& WrittenPoints::schema() { return kSchema<kWrittenPoints>; }
const ReportSchema& WrittenMesh::schema() { return kSchema<kWrittenMesh>; }
const ReportSchema& WrittenPictures::schema() { return kSchema<kWrittenPictures>; }

WrittenMesh::WrittenMesh(std::string file_name, const TriangleMesh& mesh)
    : file(std::move(file_name)),
      vertices(mesh.vertices.size()),
      triangles(mesh.triangles.size()),
      topology(measure_topology(mesh)) {}

std::string WrittenPictures::size_line() const { return fmt::format("{}: {} × {} pixels", words(), width, height); }

std::string WrittenPictures::words() const {
  return files.size() == 1 ? files[0] : files.front() + " to " + files.back();
}

}  // namespace sansmesh::cli
