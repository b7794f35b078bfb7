#include "sansmesh/io/tets/write_tets.h"

#include <fmt/core.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/meshes/vtk_xml.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/output.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kPackedBlock = 1 << 17;  ///< bytes per compressed block
constexpr int kPackedLevel = 4;
constexpr std::uint8_t kVtkTetra = 10;

template <class T>
std::string raw_bytes(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

/// Blocks of vtkZLibDataCompressor: their number and size, the size of the last if it differs, packed sizes, then the
/// data.
std::string packed_blocks(const std::string& file, const std::string& bytes) {
  const std::size_t blocks = (bytes.size() + kPackedBlock - 1) / kPackedBlock;
  std::vector<std::string> packed(blocks);
  parallel_for(0, blocks, 1, [&](std::size_t b) {
    const std::size_t first = b * kPackedBlock, size = std::min(kPackedBlock, bytes.size() - first);
    uLongf length = compressBound(static_cast<uLong>(size));
    packed[b].resize(length);
    const int error =
        compress2(reinterpret_cast<Bytef*>(packed[b].data()), &length,
                  reinterpret_cast<const Bytef*>(bytes.data() + first), static_cast<uLong>(size), kPackedLevel);
    packed[b].resize(error == Z_OK ? length : 0);
  });
  std::vector<std::uint64_t> head{blocks, kPackedBlock, bytes.size() % kPackedBlock};
  std::string all;
  for (const std::string& p : packed) {
    if (p.empty()) throw FileError(file, "cannot be written (compression fails)");
    head.push_back(p.size());
  }
  all = raw_bytes(head);
  for (const std::string& p : packed) all += p;
  return all;
}

class VtuFile {
 public:
  explicit VtuFile(const std::string& file) : file_(file) {}

  void line(const std::string& text) { xml_ += text + "\n"; }
  void array(std::string_view name, NumberType type, std::size_t components, const std::string& bytes) {
    line(fmt::format(
        "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>",
        io::vtk_type_name(type), io::to_xml(name), components, offset_));
    parts_.push_back(packed_blocks(file_, bytes));
    offset_ += parts_.back().size();
  }
  void arrays(const char* tag, const AttributeTable& table) {
    line(fmt::format("      <{}>", tag));
    for (const Attribute& a : table)
      array(a.name, a.type(), a.components, std::visit([](const auto& v) { return raw_bytes(v); }, a.values));
    line(fmt::format("      </{}>", tag));
  }
  void finish() {
    std::vector<std::string> all{std::move(xml_) + "  <AppendedData encoding=\"raw\">\n   _"};
    for (std::string& p : parts_) all.push_back(std::move(p));
    all.emplace_back("\n  </AppendedData>\n</VTKFile>\n");
    io::write_whole(file_, all);
  }

 private:
  const std::string& file_;
  std::string xml_;
  std::vector<std::string> parts_;
  std::size_t offset_ = 0;
};

std::string vtu_points(const TetMesh& mesh, NumberType& type) {
  const Box3 box = bounds(mesh);
  double farthest = 0;
  for (const Vec3& p : mesh.vertices) farthest = std::max({farthest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  type = !box.empty() && farthest * 0x1p-24 > 1e-7 * box.diagonal() ? NumberType::f64 : NumberType::f32;
  std::vector<double> wide;
  std::vector<float> narrow;
  for (const Vec3& p : mesh.vertices)
    for (std::size_t c = 0; c < 3; ++c) {
      if (type == NumberType::f64)
        wide.push_back(p[c]);
      else
        narrow.push_back(static_cast<float>(p[c]));
    }
  return type == NumberType::f64 ? raw_bytes(wide) : raw_bytes(narrow);
}

}  // namespace

void check_tets_writable(const std::string& file) {
  if (io::ending(file) != "vtu")
    throw FileError(file, fmt::format("no writer for tetrahedra with the ending '.{}'; known: .vtu", io::ending(file)));
  check_writable(file, "text");
}

void write_tets(const std::string& file, const TetMesh& mesh) {
  if (io::ending(file) != "vtu") check_tets_writable(file);
  mesh.attributes.check_rows(mesh.vertices.size(), "vertices");
  mesh.tet_attributes.check_rows(mesh.tets.size(), "tetrahedra");
  std::vector<std::int32_t> corners;
  std::vector<std::int64_t> ends;
  corners.reserve(4 * mesh.tets.size());
  for (const Tet& t : mesh.tets) {
    for (const std::uint32_t v : t) {
      if (v >= mesh.vertices.size())
        throw ArgumentError(fmt::format("a tetrahedron refers to vertex {} of {}", v, mesh.vertices.size()));
      corners.push_back(static_cast<std::int32_t>(v));
    }
    ends.push_back(static_cast<std::int64_t>(corners.size()));
  }
  VtuFile f(file);
  f.line("<?xml version=\"1.0\"?>");
  f.line(
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" "
      "compressor=\"vtkZLibDataCompressor\">");
  f.line("  <UnstructuredGrid>");
  f.line(fmt::format("    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">", mesh.vertices.size(), mesh.tets.size()));
  f.arrays("PointData", mesh.attributes);
  f.arrays("CellData", mesh.tet_attributes);
  f.line("      <Points>");
  NumberType type = NumberType::f32;
  const std::string points = vtu_points(mesh, type);
  f.array("Points", type, 3, points);
  f.line("      </Points>");
  f.line("      <Cells>");
  f.array("connectivity", NumberType::i32, 1, raw_bytes(corners));
  f.array("offsets", NumberType::i64, 1, raw_bytes(ends));
  f.array("types", NumberType::u8, 1, raw_bytes(std::vector<std::uint8_t>(mesh.tets.size(), kVtkTetra)));
  f.line("      </Cells>");
  f.line("    </Piece>");
  f.line("  </UnstructuredGrid>");
  f.finish();
}

void write_collection(const std::string& file, std::span<const TimedFile> files) {
  std::string xml =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "  <Collection>\n";
  for (const TimedFile& f : files)
    xml += fmt::format("    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", f.time, io::to_xml(f.file));
  write_text(file, xml + "  </Collection>\n</VTKFile>\n");
}

}  // namespace sansmesh::inline v1
