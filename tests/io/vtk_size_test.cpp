// Sizes announced by VTK files: larger ones than the file holds are refused, valid ones never.
#include "sansmesh/io/grids/vtk_size.h"

#include "vtk_test_files.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

constexpr const char* kZlib = "vtkZLibDataCompressor";
/// An image of 256 × 256 × 256 points.
const std::string kWhole = "0 255 0 255 0 255";
constexpr std::size_t kWholeBytes = std::size_t{8} << 24;  // size of the doubles

void check_xml(const std::string& file) {
  const std::string bytes = slurp(file);
  ReadReport report;
  io::check_vtk_xml_size({file, bytes, report});
}
void check_legacy(const std::string& file) {
  const std::string bytes = slurp(file);
  ReadReport report;
  io::check_vtk_legacy_size({file, bytes, report});
}

/// A file with arrays compressed to this size.
std::string compressed(const std::string& type, const std::string& content, std::size_t bytes,
                       const std::string& compressor = kZlib) {
  return "<VTKFile type=\"" + type + "\" compressor=\"" + compressor + "\">" + content +
         "<AppendedData encoding=\"raw\">_" + std::string(bytes, 'x') + "</AppendedData></VTKFile>";
}
std::string array_of(const std::string& type, const std::string& more = {}) {
  return "<DataArray type=\"" + type + "\" Name=\"a\" format=\"appended\" offset=\"0\" " + more + "/>";
}
std::string piece(const std::string& extent, const std::string& array) {
  return "<Piece Extent=\"" + extent + "\"><PointData>" + array + "</PointData></Piece>";
}
std::string image(const std::string& pieces) {
  return "<ImageData WholeExtent=\"" + kWhole + "\">" + pieces + "</ImageData>";
}
std::string parallel_image(const std::string& pieces) {
  return vtk_file("PImageData", "<PImageData WholeExtent=\"" + kWhole +
                                    "\"><PPointData><PDataArray type=\"Float64\" Name=\"a\"/></PPointData>" + pieces +
                                    "</PImageData>");
}
std::string slab(int k) { return "0 255 0 255 " + std::to_string(16 * k) + " " + std::to_string(16 * k + 15); }

TEST(VtkSizes, PiecesOfLatticesMayNameTheWhole) {
  const Folder folder;
  std::string pieces;
  for (int k = 0; k < 16; ++k) {
    const std::string name = "p" + std::to_string(k) + ".vti";
    folder.put(name, compressed("ImageData", image(piece(slab(k), array_of("Float64"))), kWholeBytes / 16 / 1000));
    pieces += "<Piece Extent=\"" + slab(k) + "\" Source=\"" + name + "\"/>";
  }
  check_xml(folder.put("a.pvti", parallel_image(pieces)));
  // For a single file, memory is allocated for the whole.
  EXPECT_THROW(check_xml(folder / "p3.vti"), FileError);
  folder.put("p3.vti",
             compressed("ImageData", image(piece(slab(3), array_of("Float64", "NumberOfTuples=\"99999999\""))), 9000));
  expect_file_error(folder / "p3.vti", "truncated: announces arrays of 799,999,992 bytes",
                    [&] { check_xml(folder / "a.pvti"); });
}

TEST(VtkSizes, ParallelFilesOfSmallPiecesAreRead) {
  if (!has_vtk_readers()) GTEST_SKIP();
  const Folder folder;
  // Each piece states the size of the whole, and holds a layer of two.
  const std::string whole = "0 30 0 1 0 0";
  std::string sources;
  for (int k = 0; k < 2; ++k) {
    const std::string extent = std::to_string(15 * k) + " " + std::to_string(15 * k + 15) + " 0 1 0 0";
    std::vector<int> x;
    for (int i = 0; i < 32; ++i) x.push_back(15 * k + i % 16);
    folder.put(
        "p" + std::to_string(k) + ".vti",
        vtk_file("ImageData", "<ImageData WholeExtent=\"" + whole +
                                  "\" Origin=\"0 0 0\" Spacing=\"1 1 1\"><Piece Extent=\"" + extent + "\"><PointData>" +
                                  data_array("Float64", "x", 1, words(x)) + "</PointData></Piece></ImageData>"));
    sources += "<Piece Extent=\"" + extent + "\" Source=\"p" + std::to_string(k) + ".vti\"/>";
  }
  const GridData data = read_volume(folder.put(
      "a.pvti", vtk_file("PImageData", "<PImageData WholeExtent=\"" + whole +
                                           "\" GhostLevel=\"0\" Origin=\"0 0 0\" Spacing=\"1 1 1\"><PPointData>"
                                           "<PDataArray type=\"Float64\" Name=\"x\"/></PPointData>" +
                                           sources + "</PImageData>")));
  ASSERT_EQ(data.blocks.size(), 1u);
  ASSERT_EQ(point_count(data.blocks[0]), 62u);
  for (std::size_t i = 0; i < 62; ++i)
    EXPECT_EQ(number(data.blocks[0].point_arrays, "x", i), place(data.blocks[0], i).x);
}

TEST(VtkSizes, PiecesOfAFileArePartsOfItsWhole) {
  const Folder folder;
  std::string pieces;
  for (int k = 0; k < 16; ++k) pieces += piece(slab(k), array_of("Float64"));
  check_xml(folder.put("a.vti", compressed("ImageData", image(pieces), kWholeBytes / 1000)));
  EXPECT_THROW(check_xml(folder.put("a.vti", compressed("ImageData", image(pieces), kWholeBytes / 2000))), FileError);
}

TEST(VtkSizes, ManyPiecesOfOneFileAreAddedUp) {
  const Folder folder;
  folder.put("p.vtu",
             "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"5000000\" "
             "NumberOfCells=\"0\"><PointData>" +
                 array_of("Float64") + "</PointData></Piece></UnstructuredGrid></VTKFile>");
  check_xml(folder / "p.vtu");
  std::string sources;
  for (int k = 0; k < 20; ++k) sources += "<Piece Source=\"p.vtu\"/>";
  expect_file_error(folder / "a.pvtu", "announces arrays of 800,000,000 bytes",
                    [&] { check_xml(folder.put("a.pvtu", vtk_file("PUnstructuredGrid", sources))); });
}

TEST(VtkSizes, BitsAreEightToAByteAndSomeCompressorsAreBetter) {
  const Folder folder;
  const auto field = [](const char* type, const char* tuples) {
    return "<FieldData>" + array_of(type, std::string("NumberOfTuples=\"") + tuples + "\"") + "</FieldData>";
  };
  check_xml(folder.put("a.vti", compressed("ImageData", field("Bit", "800000000"), 100'000)));
  EXPECT_THROW(check_xml(folder.put("a.vti", compressed("ImageData", field("UInt8", "800000000"), 100'000))),
               FileError);
  // LZMA compresses zeros by 7,000.
  check_xml(
      folder.put("a.vti", compressed("ImageData", field("UInt8", "700000000"), 100'000, "vtkLZMADataCompressor")));
  EXPECT_THROW(check_xml(folder.put("a.vti", compressed("ImageData", field("UInt8", "700000000"), 100'000, kZlib))),
               FileError);
}

TEST(VtkSizes, WhatIsNotThereIsNamed) {
  const Folder folder;
  const std::string file =
      folder.put("a.pvti", parallel_image("<Piece Extent=\"" + kWhole + "\" Source=\"none.vti\"/>"));
  expect_file_error(folder / "none.vti", "no such file, named by " + file, [&] { check_xml(file); });
}

TEST(VtkSizes, MetadataOfLegacyFieldsAreNoArrays) {
  const Folder folder;
  std::string text =
      "# vtk DataFile Version 4.2\ntitle\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nORIGIN 0 0 0\nSPACING 1 "
      "1 "
      "1\nPOINT_DATA 8\nFIELD FieldData 6\n";
  for (char c = 'a'; c < 'g'; ++c) {
    text += std::string(1, c) + " 1 8 double\n";
    for (int i = 0; i < 8; ++i) text += raw(1e9 * i + c, true);
    text += "\nMETADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 4000000000 8000000000 \n\n";
  }
  const std::string file = folder.put("a.vtk", text);
  check_legacy(file);
  // Later arrays are still counted.
  const std::string last = "f 1 8 double";
  std::string lies = text;
  lies.replace(lies.find(last), last.size(), "f 9 80000000 double");
  expect_file_error(folder / "b.vtk", "truncated: announces 720,000,000 numbers",
                    [&] { check_legacy(folder.put("b.vtk", lies)); });
  if (!has_vtk_readers()) GTEST_SKIP();
  const GridData data = read_volume(file);
  ASSERT_EQ(data.blocks.size(), 1u);
  for (char c = 'a'; c < 'g'; ++c) EXPECT_EQ(number(data.blocks[0].point_arrays, std::string(1, c), 7), 7e9 + c) << c;
}

}  // namespace
}  // namespace sansmesh::inline v1
