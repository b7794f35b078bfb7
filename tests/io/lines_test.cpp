// Tests of lines read from DXF and OBJ files.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io_test_tools.h"
#include "sansmesh/io.h"

namespace sansmesh::test {
namespace {

/// A DXF file from groups "code value".
std::string dxf(const std::vector<std::string>& groups) {
  std::string text;
  const auto put = [&](const std::string& group) {
    const std::size_t blank = group.find(' ');
    text += "  " + group.substr(0, blank) + "\n" + group.substr(blank + 1) + "\n";
  };
  for (const char* group : {"0 SECTION", "2 HEADER", "9 $ACADVER", "1 AC1009", "0 ENDSEC", "0 SECTION", "2 ENTITIES"})
    put(group);
  for (const std::string& group : groups) put(group);
  put("0 ENDSEC"), put("0 EOF");
  return text;
}

std::vector<std::vector<Vec3>> lines_in(const PolylineSet& lines) {
  std::vector<std::vector<Vec3>> found(lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (std::size_t k = lines.offsets[i]; k < lines.offsets[i + 1]; ++k)
      found[i].push_back(lines.origin + Vec3(lines.positions[k]));
  return found;
}

void expect_lines(const PolylineSet& read, const std::vector<std::vector<Vec3>>& expected) {
  const auto found = lines_in(read);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_EQ(found[i].size(), expected[i].size()) << i;
    for (std::size_t k = 0; k < found[i].size(); ++k) EXPECT_LT(norm(found[i][k] - expected[i][k]), 1e-4) << i << k;
  }
}

const std::vector<std::string> kDrawing{
    "0 LINE",     "8 WALLS",    "10 512000.25", "20 5403000.5", "30 312.5",   "11 512010.0", "21 5403000.5",
    "31 313",     "0 TEXT",     "10 1",         "20 2",         "1 a house",  "0 POLYLINE",  "8 EDGES",
    "66 1",       "10 0",       "20 0",         "30 0",         "70 9",       "0 VERTEX",    "10 512000",
    "20 5403000", "30 310",     "70 32",        "0 VERTEX",     "10 512001",  "20 5403000",  "30 311",
    "70 32",      "0 VERTEX",   "10 512001",    "20 5403002",   "30 312",     "70 32",       "0 SEQEND",
    "0 POLYLINE", "66 1",       "10 0",         "20 0",         "30 300",     "70 0",        "0 VERTEX",
    "10 512000",  "20 5403000", "0 VERTEX",     "10 512003",    "20 5403000", "0 SEQEND",    "0 LWPOLYLINE",
    "90 3",       "70 1",       "38 305.5",     "10 512000",    "20 5403001", "10 512002",   "20 5403001",
    "42 0.5",     "10 512002",  "20 5403003"};

TEST(Lines, OfADrawingHaveTheirHeights) {
  const Folder folder;
  ReadReport report;
  const PolylineSet read = read_lines(folder.put("lines.dxf", dxf(kDrawing)), &report);
  expect_lines(
      read, {{{512000.25, 5403000.5, 312.5}, {512010, 5403000.5, 313}},
             {{512000, 5403000, 310}, {512001, 5403000, 311}, {512001, 5403002, 312}, {512000, 5403000, 310}},
             {{512000, 5403000, 300}, {512003, 5403000, 300}},
             {{512000, 5403001, 305.5}, {512002, 5403001, 305.5}, {512002, 5403003, 305.5}, {512000, 5403001, 305.5}}});
  ASSERT_EQ(report.unread.size(), 2u);
  EXPECT_NE(report.unread[0].find("arcs"), std::string::npos);
  EXPECT_NE(report.unread[1].find("TEXT"), std::string::npos);
  // Line ends of other systems.
  std::string other;
  for (const char c : dxf(kDrawing)) other += c == '\n' ? std::string("\r\n") : std::string(1, c);
  expect_lines(read_lines(folder.put("other.DXF", other)), lines_in(read));
}

TEST(Lines, OfADrawingAreThoseOfItsModel) {
  const Folder folder;
  ReadReport report;
  // A line of the paper space, a polyline whose plane faces down, a tilted one, and a drawing in inches.
  std::string text =
      dxf({"0 LINE",    "67 1",          "10 1",         "20 1",          "11 2",       "21 2",          "0 LWPOLYLINE",
           "38 -7",     "230 -1",        "10 -512000",   "20 5403000.01", "10 -512004", "20 5403000.01", "0 LWPOLYLINE",
           "210 1",     "230 0",         "10 1",         "20 1",          "10 2",       "20 2",          "0 LINE",
           "10 512001", "20 5403000.02", "11 512002.03", "21 5403000"});
  text.replace(text.find("  9\n$ACADVER"), 0, "  9\n$INSUNITS\n  70\n1\n");
  const PolylineSet read = read_lines(folder.put("lines.dxf", text), &report);
  expect_lines(
      read, {{{512000, 5403000.01, 7}, {512004, 5403000.01, 7}}, {{512001, 5403000.02, 0}, {512002.03, 5403000, 0}}});
  EXPECT_EQ(report.unread.size(), 2u);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("INSUNITS"), std::string::npos);
}

TEST(Lines, KeepTheirDigitsBesideADistantOne) {
  const Folder folder;
  const PolylineSet read = read_lines(folder.put(
      "a.obj",
      "v 0 0 0\nv 512000.01 5403000.02 1\nv 512001.03 5403000.04 2\nv 512002.01 5403000.03 2\nl 2 3 4\nl 1 2\n"));
  const auto lines = lines_in(read);
  EXPECT_LT(norm(lines[0][0] - Vec3{512000.01, 5403000.02, 1}), 1e-5);
}

TEST(Lines, OfDamagedDrawingsAreErrors) {
  const Folder folder;
  const std::string whole = dxf(kDrawing);
  // A file may lack the line EOF, but no part of its entities.
  const std::size_t complete = whole.rfind("  0\nEOF");
  for (std::size_t length = 0; length < complete - 1; ++length) {
    const std::string file = folder.put("cut.dxf", whole.substr(0, length));
    EXPECT_THROW(read_lines(file), FileError) << length;
  }
  for (const std::string& groups :
       {std::string("0 LINE|10 east"), std::string("0 POLYLINE|70 0|0 LINE|10 1"), std::string("zero LINE"),
        std::string("0 LINE|10 1|20 2|30 3"), std::string("0 LINE|10 1|20 2|11 3"), std::string("0 LINE|10 1e999")}) {
    std::vector<std::string> all;
    for (std::size_t at = 0; at < groups.size();) {
      const std::size_t end = std::min(groups.find('|', at), groups.size());
      all.push_back(groups.substr(at, end - at)), at = end + 1;
    }
    EXPECT_THROW(read_lines(folder.put("bad.dxf", dxf(all))), FileError) << groups;
  }
  EXPECT_THROW(read_lines(folder.put("binary.dxf", "AutoCAD Binary DXF\r\n\x1a")), FileError);
  EXPECT_THROW(read_lines(folder.put("text.dxf", "a letter\nto you\n")), FileError);
}

TEST(Lines, OfAnObjReferToItsVertices) {
  const Folder folder;
  const std::string vertices = "v 0 0 1\nv 1 0 2\nv 1 1 3\n";
  expect_lines(read_lines(folder.put("a.obj", vertices + "l 1 2\nl -1/7 -2 1 # back\n")),
               {{{0, 0, 1}, {1, 0, 2}}, {{1, 1, 3}, {1, 0, 2}, {0, 0, 1}}});
  EXPECT_EQ(read_lines(folder.put("b.obj", vertices)).size(), 0u);
  for (const char* bad : {"l 1 4\n", "l 1 x\n", "l 0 1\n"})
    EXPECT_THROW(read_lines(folder.put("c.obj", vertices + bad)), FileError) << bad;
  // A mesh does not need its lines.
  for (const char* bad : {"l 1 4\n", "l 1 x\n", "l 0 1\n"}) {
    ReadReport report;
    const PointSet mesh = read_points(folder.put("c.obj", vertices + "f 1 2 3\n" + bad), &report);
    EXPECT_EQ(mesh.triangles.size(), 1u) << bad;
    EXPECT_EQ(report.unread, std::vector<std::string>{"lines"}) << bad;
  }
}

}  // namespace
}  // namespace sansmesh::test
