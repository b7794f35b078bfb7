#include "sansmesh/io/points/point_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "sansmesh/error.h"
#include "support/places.h"

namespace sansmesh::inline v1 {
namespace {

std::string written(const std::string& name, const std::string& text) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / name;
  std::ofstream(file) << text;
  return file.string();
}

TEST(PointTable, KeepsOrderPrecisionAndRowsThatAreNotFinite) {
  const auto points = read_point_table(written("order.csv", "id,x,y,z\n7,1234567.123456789,2,3\n8,nan,5,6\n9,7,,9\n"));
  ASSERT_EQ(points.size(), 3u);
  EXPECT_EQ(points[0], Vec3(1234567.123456789, 2, 3));
  EXPECT_TRUE(std::isnan(points[1].x));
  EXPECT_EQ(points[1].y, 5);
  EXPECT_TRUE(std::isnan(points[2].y));
}

TEST(PointTable, TakesTheFirstThreeColumnsWithoutNames) {
  const auto points = read_point_table(written("plain.xyz", "# places\n1 2 3 4\n\n-1e-3 0 5 6\n"));
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[1], Vec3(-1e-3, 0, 5));
}

TEST(PointTable, NamesTheLineThatIsWrong) {
  const auto message_of = [](const std::string& name, const std::string& text) {
    try {
      read_point_table(written(name, text));
    } catch (const FileError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message_of("word.csv", "x,y,z\n1,2,3\n1,two,3\n").find("line 3"), std::string::npos);
  EXPECT_NE(message_of("short.csv", "x,y,z\n1,2\n").find("line 2"), std::string::npos);
  EXPECT_NE(message_of("names.csv", "a,b,c\n1,2,3\n").find("x, y and z"), std::string::npos);
  EXPECT_NE(message_of("empty.csv", "x,y,z\n"), "");
  EXPECT_THROW(read_point_table(written("none", "") + "-not-there.csv"), FileError);
}

}  // namespace
}  // namespace sansmesh::inline v1
