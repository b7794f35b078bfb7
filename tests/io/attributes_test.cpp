// Further numbers of the samples reach the files that can hold them.
#include <limits>

#include "io/io_test_tools.h"

namespace sansmesh {
namespace {

using namespace test;

/// 40,001 points: more rows than are made in one piece.
PointSet with_attributes(std::size_t n = 40001) {
  PointSet p;
  Attribute k1{"k1", {}}, shape{"shape_index", {}};
  for (std::size_t i = 0; i < n; ++i) {
    const auto v = static_cast<float>(i);
    p.positions.push_back({std::sin(v), std::cos(v), v / static_cast<float>(n)});
    p.normals.push_back({1, 0, 0});
    p.colors.push_back({static_cast<std::uint8_t>(i % 251), 2, 3});
    p.confidence.push_back(v);
    k1.values.push_back(1 / (v + 3));
    shape.values.push_back(i % 3 == 0 ? -1e-30f : -123456.7f * v);
  }
  p.attributes = {k1, shape};
  return p;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, separator);) fields.push_back(field);
  return fields;
}

TEST(Attributes, AreColumnsOfTables) {
  const Folder folder;
  const PointSet points = with_attributes();
  write_points(folder / "a.csv", points);
  const auto lines = lines_of(slurp(folder / "a.csv"));
  ASSERT_EQ(lines.size(), points.size() + 1);
  EXPECT_EQ(lines[0], "x,y,z,nx,ny,nz,red,green,blue,confidence,k1,shape_index");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto fields = split(lines[i + 1], ',');
    ASSERT_EQ(fields.size(), 12u);
    ASSERT_EQ(std::stof(fields[9]), points.confidence[i]);
    for (std::size_t a = 0; a < 2; ++a)
      ASSERT_EQ(std::strtof(fields[10 + a].c_str(), nullptr), points.attributes[a].values[i]);
  }
  const PointSet back = read_points(folder / "a.csv");
  EXPECT_EQ(back.positions, points.positions);
  EXPECT_EQ(back.colors, points.colors);
  PointSet bare = points;
  bare.normals.clear(), bare.colors.clear(), bare.confidence.clear();
  write_points(folder / "b.csv", bare);
  EXPECT_EQ(slurp(folder / "b.csv").substr(0, 21), "x,y,z,k1,shape_index\n");
}

TEST(Attributes, ArePropertiesOfPly) {
  const PointSet points = with_attributes();
  for (const bool ascii : {false, true}) {
    const Folder folder;
    write_points(folder / "a.ply", points, {.ascii = ascii});
    const std::string file = slurp(folder / "a.ply");
    const std::size_t end = file.find("end_header\n") + 11;
    const std::string header = file.substr(0, end);
    EXPECT_NE(header.find("property float confidence\nproperty float k1\nproperty float shape_index\nend_header"),
              std::string::npos)
        << header;
    const std::string body = file.substr(end);
    if (ascii) {
      const auto lines = lines_of(body);
      ASSERT_EQ(lines.size(), points.size());
      for (std::size_t i = 0; i < lines.size(); ++i) {
        const auto fields = split(lines[i], ' ');
        ASSERT_EQ(fields.size(), 12u);
        for (std::size_t a = 0; a < 2; ++a)
          ASSERT_EQ(std::strtof(fields[10 + a].c_str(), nullptr), points.attributes[a].values[i]);
      }
    } else {
      const std::size_t record = 12 + 12 + 3 + 4 + 8;
      ASSERT_EQ(body.size(), record * points.size());
      for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t a = 0; a < 2; ++a) {
          float value = 0;
          std::memcpy(&value, body.data() + i * record + 31 + 4 * a, 4);
          ASSERT_EQ(value, points.attributes[a].values[i]);
        }
    }
    const PointSet back = read_points(folder / "a.ply");
    EXPECT_EQ(back.positions, points.positions);
    EXPECT_EQ(back.confidence, points.confidence);
  }
}

TEST(Attributes, OfNoNumberAreStillWritten) {
  PointSet points = with_attributes(20);
  points.attributes[0].values[3] = std::numeric_limits<float>::infinity();
  points.attributes[1].values[5] = std::numeric_limits<float>::quiet_NaN();
  const Folder folder;
  for (const char* name : {"a.csv", "a.ply", "b.ply"}) {
    write_points(folder / name, points, {.ascii = name[0] == 'a'});
    EXPECT_EQ(read_points(folder / name).positions, points.positions) << name;
  }
}

TEST(Attributes, LeaveOtherFormatsAsTheyAre) {
  const PointSet points = with_attributes(500);
  PointSet bare = points;
  bare.attributes.clear();
  for (const char* name : {"a.xyz", "a.obj", "a.pcd"}) {
    const Folder folder;
    write_points(folder / name, points);
    const std::string with = slurp(folder / name);
    write_points(folder / name, bare);
    EXPECT_EQ(slurp(folder / name), with) << name;
  }
}

TEST(Attributes, OfAnotherLengthAreRefused) {
  for (const std::size_t length : {0u, 19u, 21u}) {
    PointSet points = with_attributes(20);
    points.attributes[1].values.resize(length);
    for (const char* name : {"a.ply", "a.csv", "a.xyz"}) {
      const Folder folder;
      try {
        write_points(folder / name, points);
        ADD_FAILURE() << name << " was written with " << length << " values";
      } catch (const ArgumentError& error) {
        EXPECT_NE(std::string(error.what()).find("shape_index"), std::string::npos) << error.what();
      }
      EXPECT_EQ(folder.entries(), 0u);
    }
  }
}

TEST(Attributes, WithNamesThatWouldTearTheFileAreRefused) {
  for (const char* name : {"", "two words", "a,b", "line\nbreak", "\"quoted\"", "tab\t"}) {
    PointSet points = with_attributes(20);
    points.attributes[0].name = name;
    for (const char* file : {"a.ply", "a.csv"}) {
      const Folder folder;
      EXPECT_THROW(write_points(folder / file, points), ArgumentError) << '"' << name << '"';
      EXPECT_EQ(folder.entries(), 0u);
    }
  }
}

}  // namespace
}  // namespace sansmesh
