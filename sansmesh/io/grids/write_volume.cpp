#include "sansmesh/io/grids/write_volume.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "sansmesh/core/read_text.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/meshes/vtk_xml.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/output.h"
#include "sansmesh/io/output_batch.h"

namespace sansmesh::inline v1 {
namespace {

constexpr const char* kKnown = ".vti .mhd .mha .nrrd";

struct LatticeSteps {
  std::array<std::size_t, 3> size{};
  Vec3 first;                    ///< position of the first point
  std::array<double, 3> step{};  ///< 1 along axes with one point
};

LatticeSteps steps_of(const GridBlock& block) {
  if (block.kind != GridKind::lattice) throw ArgumentError("only lattices of points are written as images");
  LatticeSteps s;
  s.first = block.origin;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<double>& axis = block.axes[k];
    s.size[k] = axis.size();
    s.step[k] = axis.size() > 1 ? (axis.back() - axis.front()) / static_cast<double>(axis.size() - 1) : 1;
    s.first += block.directions[k] * axis.front();
    for (std::size_t i = 0; i < axis.size(); ++i)
      if (std::abs(axis[i] - axis.front() - static_cast<double>(i) * s.step[k]) > 1e-6 * s.step[k])
        throw ArgumentError("only lattices with equal steps along each axis are written as images");
  }
  if (block.point_arrays.empty()) throw ArgumentError("there is no array to write");
  block.point_arrays.check_rows(s.size[0] * s.size[1] * s.size[2], "points");
  return s;
}

std::string bytes_of(const Attribute& a) {
  return std::visit(
      [](const auto& values) {
        using T = typename std::decay_t<decltype(values)>::value_type;
        std::string bytes(values.size() * sizeof(T), '\0');
        if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
        return bytes;
      },
      a.values);
}

/// The columns of the direction matrix in sequence.
std::string directions_of(const GridBlock& block, bool rows) {
  std::string text;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c)
      text += fmt::format("{}{}", text.empty() ? "" : " ", rows ? block.directions[c][r] : block.directions[r][c]);
  return text;
}

std::vector<std::string> to_vti(const GridBlock& block, const LatticeSteps& s) {
  const std::string extent = fmt::format("0 {} 0 {} 0 {}", s.size[0] - 1, s.size[1] - 1, s.size[2] - 1);
  std::string xml = fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "  <ImageData WholeExtent=\"{}\" Origin=\"{} {} {}\" Spacing=\"{} {} {}\" Direction=\"{}\">\n"
      "    <Piece Extent=\"{}\">\n"
      "      <PointData Scalars=\"{}\">\n",
      extent, s.first.x, s.first.y, s.first.z, s.step[0], s.step[1], s.step[2], directions_of(block, true), extent,
      io::to_xml(block.point_arrays[0].name));
  std::vector<std::string> parts(1);
  std::uint64_t offset = 0;
  for (const Attribute& a : block.point_arrays) {
    xml += fmt::format(
        "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n",
        io::vtk_type_name(a.type()), io::to_xml(a.name), a.components, offset);
    std::string bytes = bytes_of(a);
    const std::uint64_t size = bytes.size();
    std::string head(sizeof(size), '\0');
    std::memcpy(head.data(), &size, sizeof(size));
    offset += sizeof(size) + size;
    parts.push_back(std::move(head));
    parts.push_back(std::move(bytes));
  }
  xml += "      </PointData>\n      <CellData/>\n    </Piece>\n  </ImageData>\n  <AppendedData encoding=\"raw\">\n   _";
  parts[0] = std::move(xml);
  parts.emplace_back("\n  </AppendedData>\n</VTKFile>\n");
  return parts;
}

std::string meta_header(const GridBlock& block, const LatticeSteps& s, const std::string& data) {
  constexpr const char* names[] = {"MET_CHAR", "MET_UCHAR",     "MET_SHORT",      "MET_USHORT", "MET_INT",
                                   "MET_UINT", "MET_LONG_LONG", "MET_ULONG_LONG", "MET_FLOAT",  "MET_DOUBLE"};
  const Attribute& a = block.point_arrays[0];
  return fmt::format(
      "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\n"
      "TransformMatrix = {}\nOffset = {} {} {}\nElementSpacing = {} {} {}\nDimSize = {} {} {}\n"
      "ElementNumberOfChannels = {}\nElementType = {}\nElementDataFile = {}\n",
      directions_of(block, false), s.first.x, s.first.y, s.first.z, s.step[0], s.step[1], s.step[2], s.size[0],
      s.size[1], s.size[2], a.components, names[static_cast<std::size_t>(a.type())], data);
}

std::vector<std::string> to_nrrd(const GridBlock& block, const LatticeSteps& s) {
  constexpr const char* names[] = {"int8",   "uint8", "int16",  "uint16", "int32",
                                   "uint32", "int64", "uint64", "float",  "double"};
  const Attribute& a = block.point_arrays[0];
  const bool several = a.components > 1;
  std::string directions;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 d = block.directions[k] * s.step[k];
    directions += fmt::format(" ({},{},{})", d.x, d.y, d.z);
  }
  std::string header = fmt::format(
      "NRRD0005\ntype: {}\ndimension: {}\nspace dimension: 3\nsizes:{} {} {} {}\nspace directions:{}{}\n"
      "kinds:{} domain domain domain\nendian: little\nencoding: raw\nspace origin: ({},{},{})\n\n",
      names[static_cast<std::size_t>(a.type())], several ? 4 : 3, several ? fmt::format(" {}", a.components) : "",
      s.size[0], s.size[1], s.size[2], several ? " none" : "", directions, several ? " vector" : "", s.first.x,
      s.first.y, s.first.z);
  return {std::move(header), bytes_of(a)};
}

}  // namespace

namespace {

/// The data file beside a .mhd.
std::filesystem::path raw_of(const std::string& file) { return std::filesystem::path(file).replace_extension(".raw"); }

/// Refuses to overwrite data that do not belong to the replaced header.
void check_raw(const std::string& file) {
  const std::filesystem::path raw = raw_of(file);
  std::error_code ignored;
  if (!std::filesystem::exists(raw, ignored)) return;
  std::ifstream header(file);
  for (std::string line; std::getline(header, line);)
    if (line.starts_with("ElementDataFile") && line.ends_with(raw.filename().string())) return;
  throw FileError(
      raw.string(),
      fmt::format("already exists and belongs to no {}: choose another name, or .mha, which holds header and numbers",
                  std::filesystem::path(file).filename().string()));
}

}  // namespace

void check_volume_writable(const std::string& file) {
  const std::string e = io::ending(file);
  if (e != "vti" && e != "mhd" && e != "mha" && e != "nrrd")
    throw FileError(file, e.empty() ? fmt::format("has no ending that names a format for volumes; known: {}", kKnown)
                                    : fmt::format("no writer for volumes with the ending '.{}'; known: {}", e, kKnown));
  check_writable(file, "text");
  if (e == "mhd" && detail::file_to_open(file) != file)
    throw FileError(file, "holds one file: .mha has header and numbers in one");
  if (e == "mhd") check_raw(file);
}

void write_volume(const std::string& file, const GridBlock& block) {
  check_volume_writable(file);
  const LatticeSteps s = steps_of(block);
  const std::string e = io::ending(file);
  if (e == "vti") return io::write_whole(file, to_vti(block, s));
  if (e == "nrrd") return io::write_whole(file, to_nrrd(block, s));
  if (e == "mha") return io::write_whole(file, {meta_header(block, s, "LOCAL"), bytes_of(block.point_arrays[0])});
  const std::filesystem::path raw = raw_of(file);
  OutputBatch both;
  io::write_whole(raw.string(), {bytes_of(block.point_arrays[0])});
  io::write_whole(file, {meta_header(block, s, raw.filename().string())});
  both.commit();
}

}  // namespace sansmesh::inline v1
