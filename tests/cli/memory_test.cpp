// Tests that memory and time follow the size of a file, whatever its header claims and wherever its points are.
#include <zlib.h>

#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <tuple>
#include <utility>

#include "run_tool.h"
#include "support/sanitizers.h"
#include "support/section_bytes.h"

namespace sansmesh::test {
namespace {

constexpr const char* kInstrumented = "instrumented code takes more of both";

template <class T>
std::string bytes_of(std::initializer_list<T> numbers, bool big = false) {
  std::string s;
  for (const T v : numbers) {
    std::string one(reinterpret_cast<const char*>(&v), sizeof v);
    if (big) std::reverse(one.begin(), one.end());
    s += one;
  }
  return s;
}
std::string ints(std::initializer_list<std::int32_t> numbers) { return bytes_of(numbers); }

std::string deflated(const std::string& plain, bool gzip) {
  z_stream z{};
  deflateInit2(&z, 9, Z_DEFLATED, gzip ? 15 + 16 : 15, 9, Z_DEFAULT_STRATEGY);
  std::string packed(compressBound(plain.size()) + 64, '\0');
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(plain.data())), z.avail_in = static_cast<uInt>(plain.size());
  z.next_out = reinterpret_cast<Bytef*>(packed.data()), z.avail_out = static_cast<uInt>(packed.size());
  deflate(&z, Z_FINISH);
  packed.resize(z.total_out);
  deflateEnd(&z);
  return packed;
}

// ------------------------------------------------------------------------------------- small files, large promises

struct Promise {
  const char* name;  ///< name of the test
  const char* file;
  std::string content;
};

std::string ply_header(const char* format, const std::string& elements) {
  return std::string("ply\nformat ") + format + " 1.0\n" + elements + "end_header\n";
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kTriangle = bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0});

void add_meshes(std::vector<Promise>& all) {
  const char* const little = "binary_little_endian";
  const std::string three = "element vertex 3\n" + kXyz;
  all.push_back({"PlyVertices", "a.ply", ply_header(little, "element vertex 4000000000\n" + kXyz) + kTriangle});
  all.push_back({"PlyText", "a.ply", ply_header("ascii", "element vertex 4000000000\n" + kXyz) + "0 0 0\n"});
  all.push_back(
      {"PlyFaces", "a.ply",
       ply_header(little, three + "element face 4000000000\nproperty list uchar int vertex_indices\n") + kTriangle});
  all.push_back({"PlyList", "a.ply",
                 ply_header(little, three + "element face 1\nproperty list uint int vertex_indices\n") + kTriangle +
                     ints({-1, 0, 1, 2})});
  all.push_back({"PlyTextList", "a.ply",
                 ply_header("ascii", three + "element face 1\nproperty list uint int vertex_indices\n") +
                     "0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n"});
  all.push_back({"Off", "a.off", "OFF\n1000000000 1000000000 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"});
  all.push_back({"OffFace", "a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n1000000000 0 1 2\n"});
  all.push_back({"StlBinary", "a.stl", std::string(80, ' ') + ints({-1}) + std::string(50, '\0')});
  all.push_back({"Table", "a.xyz", "4000000000\n0 0 0\n1 0 0\n"});
  all.push_back({"Vtp", "a.vtp",
                 "<VTKFile type=\"PolyData\" header_type=\"UInt64\"><PolyData><Piece NumberOfPoints=\"4000000000\">"
                 "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/>"
                 "</Points></Piece></PolyData><AppendedData encoding=\"raw\">_" +
                     bytes_of<std::uint64_t>({48000000000}) + "</AppendedData></VTKFile>"});
  const std::string head =
      "<VTKFile type=\"PolyData\" compressor=\"vtkZLibDataCompressor\"><PolyData><Piece NumberOfPoints=\"9\">"
      "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/>";
  const std::string body = "</Points></Piece></PolyData><AppendedData encoding=\"raw\">_";
  const std::string packed = deflated(std::string(36, '\0'), false);
  const auto block = [&](std::int32_t size) {
    return ints({1, size, 0, static_cast<std::int32_t>(packed.size())}) + packed + "</AppendedData></VTKFile>";
  };
  all.push_back({"VtpPacked", "a.vtp", head + body + block(0x7fffffff)});
  // Four arrays at the same offset, with incompressible bytes: each is a third of the file.
  std::string many = head, noise;
  for (unsigned k = 0; k < 360; ++k) noise += static_cast<char>(k * k * 2654435761u >> 13);
  const std::string unpacked = deflated(noise, false);
  for (char c = 'a'; c < 'd'; ++c)
    many += std::string("</Points><PointData><DataArray Name=\"") + c +
            "\" type=\"Float32\" format=\"appended\" offset=\"0\"/></PointData><Points>";
  all.push_back({"VtpOverlapping", "a.vtp",
                 many + body + ints({1, 360, 0, static_cast<std::int32_t>(unpacked.size())}) + unpacked +
                     "</AppendedData></VTKFile>"});
}

void add_clouds(std::vector<Promise>& all) {
  const auto pcd = [](const std::string& points, const std::string& count, const std::string& data) {
    return "VERSION 0.7\nFIELDS x y z d\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 " + count + "\nWIDTH " + points +
           "\nHEIGHT 1\nPOINTS " + points + "\nDATA " + data + "\n";
  };
  all.push_back({"PcdText", "a.pcd", pcd("4000000000", "1", "ascii") + "0 0 0 1\n"});
  all.push_back({"PcdTextWords", "a.pcd", pcd("1", "100000", "ascii") + "0 0 0 1\n"});
  all.push_back({"PcdBinary", "a.pcd", pcd("4000000000", "1", "binary") + kTriangle});
  all.push_back({"PcdRecords", "a.pcd", pcd("3", "100000", "binary") + kTriangle});
  all.push_back({"PcdPacked", "a.pcd",
                 pcd("200000000", "1", "binary_compressed") + ints({4, static_cast<std::int32_t>(3200000000u)}) +
                     std::string(4, '\0')});
  std::string las(227 + 60, '\0');
  las.replace(0, 4, "LASF");
  las[24] = 1, las[25] = 2;
  put_number<std::uint16_t>(las, 94, 227);
  put_number<std::uint32_t>(las, 96, 227);
  put_number<std::uint16_t>(las, 105, 20);
  put_number<std::uint32_t>(las, 107, 4000000000u);
  for (std::size_t k = 0; k < 3; ++k) put_number<double>(las, 131 + 8 * k, 1.0);
  all.push_back({"Las", "a.las", las});
}

void add_images(std::vector<Promise>& all) {
  const auto mha = [](const std::string& more, const std::string& size, const std::string& body) {
    return "ObjectType = Image\nNDims = 3\nDimSize = " + size + "\n" + more +
           "ElementType = MET_FLOAT\nElementDataFile = LOCAL\n" + body;
  };
  const std::string packed = "CompressedData = True\n", zeros = deflated(std::string(100, '\0'), false);
  all.push_back({"MetaImage", "a.mha", mha("", "1000 1000 1000", std::string(40, '\0'))});
  all.push_back({"MetaImagePacked", "a.mha", mha(packed, "1000 1000 1000", zeros)});
  all.push_back({"MetaImagePackedALittleLess", "a.mha", mha(packed, "50 40 1", zeros)});
  all.push_back({"MetaImageText", "a.mha", mha("BinaryData = False\n", "1000 1000 1000", "1 2 3\n")});
  all.push_back({"MetaImageSkew", "a.mha",
                 mha("TransformMatrix = 1 0 0 0.5 1 0 0 0 1\n", "1000 1000 1000", std::string(40, '\0'))});
  all.push_back({"MetaImageAxis", "a.mha", mha("", "16000000 1 1", std::string(40, '\0'))});
  all.push_back({"MetaImageFiles", "a.mhd",
                 "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = " + std::string(200, 'n') +
                     "%06d.raw 1 99999 1\n"});
  const auto nrrd = [](const std::string& sizes, const std::string& encoding, const std::string& body) {
    return "NRRD0004\ntype: float\ndimension: 3\nsizes: " + sizes + "\nendian: little\nencoding: " + encoding + "\n\n" +
           body;
  };
  const std::string gzipped = deflated(std::string(100, '\0'), true);
  all.push_back({"Nrrd", "a.nrrd", nrrd("1000 1000 1000", "raw", std::string(40, '\0'))});
  all.push_back({"NrrdPacked", "a.nrrd", nrrd("1000 1000 1000", "gzip", gzipped)});
  all.push_back({"NrrdComponents", "a.nrrd", nrrd("1000000000 3 2", "gzip", gzipped)});
  all.push_back({"NrrdRaw", "a.nrrd", nrrd("1000000000 3 2", "raw", "1234")});
  all.push_back({"NrrdText", "a.nrrd", nrrd("1000 1000 1000", "text", "1 2 3\n")});
  all.push_back({"NrrdHex", "a.nrrd", nrrd("1000 1000 1000", "hex", "00ff00ff\n")});
  all.push_back({"NrrdFiles", "a.nhdr",
                 "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\ndata file: " +
                     std::string(200, 'n') + "%06d.raw 1 99999 1\n"});
  all.push_back({"Raw", "a_1000x1000x1000_float32.raw", std::string(400, '\0')});
}

void add_grids(std::vector<Promise>& all) {
  all.push_back({"Plot3d", "a.p3d", ints({1000, 1000, 1000}) + std::string(400, '\0')});
  all.push_back({"Plot3dGrids", "a.p3d", ints({200000000, 1000, 1000, 1000}) + std::string(400, '\0')});
  all.push_back({"Plot3dText", "a.p3d", "100 100 100\n1000000*0.5 900000000*1\n"});
  char head[133];
  std::snprintf(head, sizeof head, "%-132s", "#std 4 100 100 100 1000000 1000000 0.0 0 0 1 XUP");
  all.push_back({"Nek", "a0.f00001", std::string(head, 132) + bytes_of<float>({6.54321f}) + std::string(400, '\0')});
  const std::string format = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  all.push_back({"GmshNodes", "a.msh", format + "$Nodes\n1000000000\n1 0 0 0\n$EndNodes\n"});
  all.push_back({"GmshElements", "a.msh",
                 format +
                     "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n1000000000\n1 4 0 1 2 3 "
                     "4\n$EndElements\n"});
  std::string wide = format + "$Nodes\n9\n";
  for (int k = 1; k < 10; ++k) wide += std::to_string(k) + " 0 0 " + std::to_string(k) + "\n";
  wide += "$EndNodes\n$Elements\n1\n1 4 0 1 2 3 4\n$EndElements\n";
  for (char c = 'a'; c < 'f'; ++c) wide += std::string("$NodeData\n1\n\"") + c + "\"\n0\n3\n0\n1000\n0\n$EndNodeData\n";
  all.push_back({"GmshWideData", "a.msh", wide});
  all.push_back({"GmshBinary", "a.msh",
                 "$MeshFormat\n4.1 1 8\n" + ints({1}) + "\n$EndMeshFormat\n$Nodes\n" +
                     bytes_of<std::uint64_t>({1, 1000000000, 1, 1000000000}) + "\n$EndNodes\n"});
  all.push_back({"Medit", "a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n1000000000\n0 0 0 0\nEnd\n"});
  all.push_back({"MeditBinary", "a.meshb", ints({1, 2, 3, 20, 3, 4, 0, 1000000000, 0, 0, 0, 0})});
  // Each list of tetrahedra begins inside the previous one.
  std::string lists = ints({1, 2, 4, 56, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  for (int k = 0; k < 20; ++k) lists += ints({8, 56 + 12 * (k + 1), 1});
  all.push_back({"MeditOverlapping", "a.meshb", lists + std::string(400, '\1')});
  all.push_back({"Tetgen", "a.node", "1000000000 3 0 0\n1 0 0 0\n"});
  all.push_back({"TetgenAttributes", "a.node", "1 3 1000000000 0\n1 0 0 0\n"});
  all.push_back({"Vega", "a.veg", "*VERTICES\n1000000000 3 0 0\n1 0 0 0\n"});
  // A dimension of 10⁹, and a variable with as many doubles.
  const auto netcdf = [](std::initializer_list<std::int32_t> rest) {
    return "CDF\x01" + bytes_of<std::int32_t>({0, 10, 1, 1}, true) + std::string("n\0\0\0", 4) +
           bytes_of<std::int32_t>({1000000000}, true) + bytes_of<std::int32_t>(rest, true);
  };
  all.push_back(
      {"NetcdfVariable", "a.e", netcdf({0, 0, 11, 1, 1, 0x76000000, 1, 0, 0, 0, 6, -1, 100}) + std::string(40, '\0')});
  all.push_back({"NetcdfDimension", "a.e", netcdf({0, 0, 0, 0}) + std::string(40, '\0')});
}

std::string vtk_xml(const std::string& type, const std::string& whole, const std::string& piece,
                    const std::string& inside) {
  const std::string extent = whole.empty() ? "" : " WholeExtent=\"" + whole + "\"";
  return "<VTKFile type=\"" + type + "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"><" + type +
         extent + "><Piece " + piece + ">" + inside + "</Piece></" + type +
         "><AppendedData encoding=\"raw\">_abcdefgh</AppendedData></VTKFile>";
}

void add_vtk(std::vector<Promise>& all) {
  const std::string whole = "0 999 0 999 0 999";
  const auto array = [](const std::string& name, const std::string& more) {
    return "<DataArray type=\"Float64\" Name=\"" + name + "\" " + more + " format=\"appended\" offset=\"0\"/>";
  };
  const std::string data = "<PointData>" + array("a", "") + "</PointData>";
  const std::string points = "<Points>" + array("p", "NumberOfComponents=\"3\"") + "</Points>";
  all.push_back({"Vti", "a.vti", vtk_xml("ImageData", whole, "Extent=\"" + whole + "\"", data)});
  all.push_back({"VtiSmallPiece", "a.vti", vtk_xml("ImageData", whole, "Extent=\"0 1 0 1 0 1\"", data)});
  all.push_back(
      {"VtiAxis", "a.vti", vtk_xml("ImageData", "0 2000000000 0 0 0 0", "Extent=\"0 2000000000 0 0 0 0\"", "")});
  all.push_back({"Vts", "a.vts", vtk_xml("StructuredGrid", whole, "Extent=\"" + whole + "\"", points + data)});
  all.push_back(
      {"Vtu", "a.vtu", vtk_xml("UnstructuredGrid", "", "NumberOfPoints=\"1000000000\" NumberOfCells=\"0\"", points)});
  all.push_back({"VtuCells", "a.vtu",
                 vtk_xml("UnstructuredGrid", "", "NumberOfPoints=\"1\" NumberOfCells=\"1000000000\"",
                         points + "<Cells>" + array("offsets", "") + array("types", "") + "</Cells>")});
  all.push_back({"VtuFields", "a.vtu",
                 vtk_xml("UnstructuredGrid", "", "NumberOfPoints=\"1\" NumberOfCells=\"0\"",
                         "<FieldData>" + array("t", "NumberOfTuples=\"1000000000\"") + "</FieldData>" + points)});
  all.push_back({"Pvti", "a.pvti",
                 "<VTKFile type=\"PImageData\" version=\"1.0\"><PImageData WholeExtent=\"" + whole +
                     "\"><PPointData><PDataArray type=\"Float64\" Name=\"a\"/></PPointData><Piece Extent=\"" + whole +
                     "\" Source=\"none.vti\"/></PImageData></VTKFile>"});
  const std::string legacy = "# vtk DataFile Version 3.0\ntitle\n";
  all.push_back({"LegacyPoints", "a.vtk", legacy + "BINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 1000000000 double\nab"});
  all.push_back(
      {"LegacyText", "a.vtk", legacy + "ASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 1000000000 double\n1 2 3\n"});
  all.push_back(
      {"LegacyCells", "a.vtk",
       legacy + "ASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 1 float\n0 0 0\nCELLS 1000000000 2000000000\n1 0\n"});
  all.push_back({"LegacyScalars", "a.vtk",
                 legacy + "BINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 1000 1000 1000\nORIGIN 0 0 0\nSPACING 1 1 1\n"
                          "POINT_DATA 1000000000\nSCALARS a float 1\nLOOKUP_TABLE default\nabcd"});
  all.push_back(
      {"LegacyAxis", "a.vtk",
       legacy + "BINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2000000000 1 1\nORIGIN 0 0 0\nSPACING 1 1 1\n"});
  all.push_back({"LegacyField", "a.vtk",
                 legacy + "BINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nORIGIN 0 0 0\nSPACING 1 1 1\n"
                          "POINT_DATA 8\nFIELD f 1\na 1000 1000000 float\nabcd"});
}

void add_own(std::vector<Promise>& all) {
  // Also damaged: a file of sections that small cannot contain a function.
  std::string sections = packed({{"META", 1, "{}"}, {"POSITION", 12, ""}});
  put_number<std::uint64_t>(sections, kFileSizeAt, std::uint64_t{1} << 40);
  put_number<std::uint64_t>(sections, kHeaderBytes + kEntryBytes + kEntryBytesAt, std::uint64_t{12} << 36);
  mend_checksums(sections);
  all.push_back({"Function", "a.smf", sections});
  sections[1] = 'S', sections[2] = 'M', sections[3] = 'V';
  mend_checksums(sections);
  all.push_back({"FittedVolume", "a.smv", sections});
  all.push_back({"Series", "a.vtu.series", R"({"file-series-version":"1.0","files":[{"name":"n.vtu","time":1e308}]})"});
  std::string pvd = "<VTKFile type=\"Collection\"><Collection>";
  for (int k = 0; k < 9; ++k) pvd += "<DataSet timestep=\"0\" part=\"4000000000\" file=\"n.vtu\"/>";
  all.push_back({"Collection", "a.pvd", pvd + "</Collection></VTKFile>"});
  all.push_back({"NekSeries", "a.nek5000", "filetemplate: n%01d.f%05d\nfirsttimestep: 1\nnumtimesteps: 10000000\n"});
  all.push_back({"GzippedZeros", "a.xyz.gz", deflated(std::string(900000, '\0'), true)});
  all.push_back({"GzippedPromise", "a.mha.gz",
                 deflated("ObjectType = Image\nNDims = 3\nDimSize = 1000 1000 1000\nElementType = MET_FLOAT\n"
                          "CompressedData = True\nElementDataFile = LOCAL\n" +
                              std::string(100000, '\0'),
                          true)});
}

std::vector<Promise> promises() {
  std::vector<Promise> all;
  add_meshes(all), add_clouds(all), add_images(all), add_grids(all), add_vtk(all), add_own(all);
  return all;
}

class SmallFile : public ToolTest, public ::testing::WithParamInterface<Promise> {};

TEST_P(SmallFile, TakesLittleMemoryAndTimeWhateverItPromises) {
  SANSMESH_NOT_SANITIZED(kInstrumented);
  const Promise& p = GetParam();
  ASSERT_LT(p.content.size(), 1024u);
  write(p.file, p.content);
  const Outcome outcome = run({"info", p.file});
  EXPECT_EQ(outcome.code, 1) << outcome.out << outcome.err;
  EXPECT_EQ(outcome.lines_of_error(), 1) << outcome.err;
  EXPECT_LT(outcome.peak_megabytes, 200) << outcome.err;
  EXPECT_LT(outcome.cpu_seconds, 2) << outcome.err;
}

INSTANTIATE_TEST_SUITE_P(Promises, SmallFile, ::testing::ValuesIn(promises()),
                         [](const auto& of) { return std::string(of.param.name); });

/// The header is valid, and the message has the claimed and the actual size.
TEST_F(ToolTest, MessagesNameWhatIsPromisedAndWhatIsThere) {
  for (const Promise& p : promises()) {
    if (std::string_view(p.name) == "MetaImagePacked") {
      write(p.file, p.content);
      expect_failure({"info", p.file}, 1, "announces 4,000,000,000 bytes of numbers, but its ");
    } else if (std::string_view(p.name) == "NrrdRaw") {
      write(p.file, p.content);
      expect_failure({"info", p.file}, 1, "(of 24,000,000,000, 4 are there)");
    } else if (std::string_view(p.name) == "LegacyText") {
      write(p.file, p.content);
      expect_failure({"info", p.file}, 1, "announces 3,000,000,000 numbers, which take at least 6,000,000,000 bytes");
    }
  }
}

/// Files that caused failures in earlier versions.
TEST_F(ToolTest, FilesThatTookAllMemoryAreOneLine) {
  const auto crash = [](const char* name) { return source_file(std::string("tests/data/crashes/") + name); };
  const std::vector<std::tuple<std::string, const char*, const char*>> cases{
      {"info", "packed-promise.mha", "announces 4,000,000,000 bytes of numbers"},
      {"info", "packed-promise.nrrd", "announces 24,000,000,000 bytes of numbers"},
      {"info", "huge-image.vti", "announces arrays of 8,000,000,000 bytes or more"},
      {"info", "huge-points.vtk", "announces 3,000,000,000 numbers"},
      {"info", "overlapping-lists.meshb", "inside earlier data"},
      {"info", "beyond-float.xyz", "4 of 4 lie farther than 1e+18 from zero"},
      {"reconstruct", "coincident-points.ply.gz", "all points coincide"},
      {"reconstruct", "parts-far-apart.xyz", "the points lie in parts that are 1e+09 apart"}};
  for (const auto& [command, file, words] : cases) {
    std::vector<std::string> arguments{command, crash(file)};
    if (command == "reconstruct") arguments.insert(arguments.end(), {"-o", "out.ply"});
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 1) << file << outcome.err;
    EXPECT_NE(outcome.err.find(file), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    if (!kAddressSanitizer && !kThreadSanitizer) {
      EXPECT_LT(outcome.peak_megabytes, 200) << file;
    }
  }
  const Outcome parts = run({"info", crash("parts-far-apart.xyz")});
  EXPECT_NE(parts.out.find("parts 1e+09 apart"), std::string::npos) << parts.out << parts.err;
}

// ------------------------------------------------------------------------------------------- where points lie

/// A binary PLY with these positions.
std::string ply_of(const std::vector<std::array<float, 3>>& points) {
  std::string s = ply_header("binary_little_endian", "element vertex " + std::to_string(points.size()) + "\n" + kXyz);
  s.append(reinterpret_cast<const char*>(points.data()), points.size() * sizeof points[0]);
  return s;
}

std::vector<std::array<float, 3>> ball_points(std::size_t n, float radius, float middle) {
  std::mt19937_64 random(n);
  std::normal_distribution<float> in(0, 1);
  std::vector<std::array<float, 3>> points(n);
  for (auto& p : points) {
    const float x = in(random), y = in(random), z = in(random), r = radius / std::sqrt(x * x + y * y + z * z);
    p = {r * x, r * y, r * z + middle};
  }
  return points;
}

TEST_F(ToolTest, MemoryOfACloudDoesNotDependOnWhereItsPointsLie) {
  SANSMESH_NOT_SANITIZED(kInstrumented);
  constexpr std::size_t kPoints = 40000;
  const std::vector<std::array<float, 3>> sphere = ball_points(kPoints, 1, 3);
  const std::vector<std::array<float, 3>> cluster = ball_points(kPoints, 1e-7f, 0);
  std::vector<std::array<float, 3>> camera = sphere, close = sphere, places;
  for (std::size_t i = 0; i < kPoints; ++i) {
    if (i % 5 < 3) camera[i] = {0, 0, 0};
    if (i % 2 == 0) close[i] = cluster[i];
    places.push_back(sphere[i * 7 % 10]);
  }
  write("ordinary.ply", ply_of(sphere));
  const Outcome ordinary = run({"info", "ordinary.ply"});
  ASSERT_EQ(ordinary.code, 0) << ordinary.err;
  const std::vector<std::pair<const char*, std::vector<std::array<float, 3>>>> clouds{
      {"coincident", std::vector<std::array<float, 3>>(kPoints, {1, 2, 3})},
      {"camera", camera},
      {"close", close},
      {"cluster", cluster},
      {"places", places}};
  for (const auto& [name, points] : clouds) {
    write("a.ply", ply_of(points));
    const Outcome outcome = run({"info", "a.ply"});
    EXPECT_EQ(outcome.code, 0) << name << outcome.err;
    EXPECT_LT(outcome.peak_megabytes, ordinary.peak_megabytes + 60) << name;
    EXPECT_LT(outcome.cpu_seconds, 10 * ordinary.cpu_seconds + 1) << name;
  }
}

// -------------------------------------------------------------------------------------------- cost by size

/// A file of n points in one of the formats.
struct Sized {
  const char* name;
  const char* file;
  std::function<std::string(std::size_t)> content;
};

std::string rows_joined(std::size_t n, const std::function<std::string(std::size_t)>& row) {
  std::string all;
  for (std::size_t i = 0; i < n; ++i) all += row(i);
  return all;
}
/// Coordinates that are neither all equal nor sorted.
std::string place_text(std::size_t i) {
  const std::size_t k = i * 7919 % 100003;
  return std::to_string(k % 101) + "." + std::to_string(k % 7) + " " + std::to_string(k % 89) + " " +
         std::to_string(k % 97);
}
std::string place_bytes(std::size_t i) {
  const std::size_t k = i * 7919 % 100003;
  return bytes_of<float>({static_cast<float>(k % 101), static_cast<float>(k % 89), static_cast<float>(k % 97)});
}

std::vector<Sized> sized_files() {
  const auto line = [](std::size_t i) { return place_text(i) + "\n"; };
  const auto count = [](std::size_t n) { return std::to_string(n); };
  const auto numbered = [](std::size_t i) { return std::to_string(i + 1) + " " + place_text(i) + "\n"; };
  return {
      {"PlyText", "a.ply",
       [=](std::size_t n) {
         return ply_header("ascii", "element vertex " + count(n) + "\n" + kXyz) + rows_joined(n, line);
       }},
      {"Ply", "a.ply",
       [=](std::size_t n) {
         return ply_header("binary_little_endian", "element vertex " + count(n) + "\n" + kXyz) +
                rows_joined(n, place_bytes);
       }},
      {"Table", "a.xyz", [=](std::size_t n) { return rows_joined(n, line); }},
      {"TableGzipped", "a.xyz.gz", [=](std::size_t n) { return deflated(rows_joined(n, line), true); }},
      {"Obj", "a.obj", [=](std::size_t n) { return rows_joined(n, [&](std::size_t i) { return "v " + line(i); }); }},
      {"Off", "a.off", [=](std::size_t n) { return "OFF\n" + count(n) + " 0 0\n" + rows_joined(n, line); }},
      {"Stl", "a.stl",
       [=](std::size_t n) {
         return std::string(80, ' ') + ints({static_cast<std::int32_t>(n / 3)}) + rows_joined(n / 3, [](std::size_t i) {
                  return std::string(12, '\0') + place_bytes(3 * i) + place_bytes(3 * i + 1) + place_bytes(3 * i + 2) +
                         std::string(2, '\0');
                });
       }},
      {"PcdText", "a.pcd",
       [=](std::size_t n) {
         return "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + count(n) +
                "\nHEIGHT 1\nPOINTS " + count(n) + "\nDATA ascii\n" + rows_joined(n, line);
       }},
      {"Vtp", "a.vtp",
       [=](std::size_t n) {
         return "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"" + count(n) +
                "\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">" +
                rows_joined(n, line) + "</DataArray></Points></Piece></PolyData></VTKFile>";
       }},
      {"MetaImagePacked", "a.mha",
       [=](std::size_t n) {
         return "NDims = 3\nDimSize = " + count(n / 100) +
                " 10 10\nElementType = MET_FLOAT\nCompressedData = True\nElementDataFile = LOCAL\n" +
                deflated(rows_joined(n / 100 * 100, [](std::size_t i) { return place_bytes(i).substr(0, 4); }), false);
       }},
      {"NrrdText", "a.nrrd",
       [=](std::size_t n) {
         return "NRRD0004\ntype: float\ndimension: 3\nsizes: " + count(n / 100) + " 10 10\nencoding: text\n\n" +
                rows_joined(n / 100 * 100, [](std::size_t i) { return std::to_string(i * 7919 % 101) + "\n"; });
       }},
      {"Tetgen", "a.node", [=](std::size_t n) { return count(n / 16) + " 3 0 0\n" + rows_joined(n / 16, numbered); }},
  };
}

class FileOfAnySize : public ToolTest, public ::testing::WithParamInterface<Sized> {};

TEST_P(FileOfAnySize, CostsInProportion) {
  SANSMESH_NOT_SANITIZED(kInstrumented);
  constexpr std::size_t kPoints = 3000;
  std::vector<Outcome> of;
  for (const std::size_t times : {1, 4, 16}) {
    write(GetParam().file, GetParam().content(times * kPoints));
    of.push_back(run({"info", GetParam().file}));
    ASSERT_EQ(of.back().code, 0) << of.back().err;
  }
  // From 4 to 16 parts a linear cost grows by a factor of at most 4, a quadratic one by 16; the limit is 8.
  EXPECT_LT(of[2].cpu_seconds, 8 * of[1].cpu_seconds + 0.2);
  EXPECT_LT(of[2].peak_megabytes - of[0].peak_megabytes, 8 * std::max(4l, of[1].peak_megabytes - of[0].peak_megabytes));
}

INSTANTIATE_TEST_SUITE_P(Sizes, FileOfAnySize, ::testing::ValuesIn(sized_files()),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace sansmesh::test
