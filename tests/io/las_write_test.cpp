// Round trips of LAS: version, format, and attributes without a field in a record.
#include <cmath>
#include <limits>

#include "io_test_tools.h"
#include "support/las_file.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

PointSet written_and_read(const Folder& folder, const PointSet& points, std::string* format = nullptr) {
  write_points(folder / "out.las", points);
  ReadReport report;
  PointSet back = read_points(folder / "out.las", &report);
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_TRUE(report.unread.empty());
  if (format) *format = report.format + " " + std::to_string(slurp(folder / "out.las")[104]);
  return back;
}

/// A survey in which every LAS attribute is nonzero somewhere.
PointSet survey(unsigned minor, unsigned format) {
  const Folder folder;
  LasFile las;
  las.minor = minor, las.format = format, las.offset = {637000, 849000, 400};
  for (int i = 0; i < 300; ++i)
    las.points.push_back({.x = 1000 * i,
                          .y = 700 * (i % 29),
                          .z = i * 37 % 901,
                          .intensity = static_cast<std::uint16_t>(219 * i),
                          .return_number = static_cast<unsigned>(1 + i % 3),
                          .returns = static_cast<unsigned>(3 + i % 2),
                          .classification = static_cast<unsigned>(i % 19),
                          .synthetic = i % 7 == 0,
                          .overlap = i % 5 == 0,
                          .scan_angle = i % 41 - 20,
                          .user_data = static_cast<std::uint8_t>(i),
                          .source = static_cast<std::uint16_t>(100 + i / 50),
                          .gps_time = 1e8 + 1e-5 * i,
                          .rgb = {static_cast<std::uint16_t>(257 * (i % 256)), 0, 65535},
                          .near_infrared = static_cast<std::uint16_t>(65535 - i)});
  return read_points(folder.put("in.las", las.bytes()));
}

TEST(LasWriter, KeepsWhatTheFormatsHave) {
  const Folder folder;
  struct Case {
    unsigned minor, format;
    const char* becomes;
  };
  for (const Case& c :
       {Case{2, 0, "LAS 1.2 0"}, Case{2, 1, "LAS 1.2 1"}, Case{2, 2, "LAS 1.2 2"}, Case{2, 3, "LAS 1.2 3"},
        Case{4, 6, "LAS 1.4 6"}, Case{4, 7, "LAS 1.4 7"}, Case{4, 8, "LAS 1.4 8"}}) {
    const PointSet points = survey(c.minor, c.format);
    std::string format;
    const PointSet back = written_and_read(folder, points, &format);
    EXPECT_EQ(format, c.becomes);
    EXPECT_EQ(back.attributes, points.attributes) << c.becomes;
    EXPECT_EQ(back.colors, points.colors) << c.becomes;
    EXPECT_LT(largest_distance(points.origin, points.positions, back.origin, back.positions), 2e-5) << c.becomes;
  }
}

TEST(LasWriter, OtherNumbersBecomeExtraBytes) {
  const Folder folder;
  PointSet points = survey(2, 3);
  const std::size_t n = points.size();
  points.attributes.set("intensity", std::vector<float>(n, 0.5f));            // not integers
  points.attributes.set("classification", std::vector<std::int32_t>(n, -7));  // not in 0..255
  points.attributes.set("scan_angle", std::vector<float>(n, 0.01f));          // between the steps
  points.attributes.set("return_number", std::vector<std::uint8_t>(n, 200));
  points.attributes.set("big", std::vector<std::uint64_t>(n, std::numeric_limits<std::uint64_t>::max()));
  points.attributes.set("direction", std::vector<double>(3 * n, 1.0 / 3), 3);
  points.attributes.set("matrix", std::vector<std::int16_t>(4 * n, -3), 4);
  const PointSet back = written_and_read(folder, points);
  for (const Attribute& a : points.attributes) {
    if (a.name == "matrix") continue;
    const Attribute* const b = back.attributes.find(a.name);
    ASSERT_TRUE(b) << a.name;
    EXPECT_EQ(*b, a) << a.name;
  }
  EXPECT_EQ(*back.attributes.find<std::int16_t>("matrix_3"), std::vector<std::int16_t>(n, -3));
}

TEST(LasWriter, CloudsOfAnySizeKeepTheirFloats) {
  const Folder folder;
  for (const double scale : {1e-9, 1.0, 1e9}) {
    PointSet points;
    points.origin = {5e6 * scale, -3e6 * scale, 0};
    for (int i = 0; i < 50; ++i)
      points.positions.push_back(Vec3f(Vec3{std::sin(i), std::cos(3.0 * i), 0.1 * i} * scale));
    const PointSet back = written_and_read(folder, points);
    EXPECT_LT(largest_distance(points.origin, points.positions, back.origin, back.positions), 6e-7 * scale);
  }
  PointSet one;
  one.positions = {{0, 0, 0}};
  EXPECT_EQ(written_and_read(folder, one).positions, one.positions);
  one.positions = {{0, std::nanf(""), 0}};
  EXPECT_THROW(write_points(folder / "out.las", one), ArgumentError);
}

TEST(LasWriter, HeaderCountsReturnsAndBoundsPoints) {
  const Folder folder;
  const PointSet points = survey(4, 6);
  write_points(folder / "out.las", points);
  const std::string bytes = slurp(folder / "out.las");
  const auto number = [&]<class T>(std::size_t at, T) {
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
  };
  EXPECT_EQ(number(247, std::uint64_t{}), 300u);
  EXPECT_EQ(number(255, std::uint64_t{}), 100u);  // first returns
  EXPECT_EQ(number(107, std::uint32_t{}), 0u);
  EXPECT_NEAR(number(179, double{}), 637299, 1e-3);
  EXPECT_NEAR(number(187, double{}), 637000, 1e-3);
  EXPECT_EQ(number(6, std::uint16_t{}), 17);  // not times of the week; no GeoTIFF keys
}

/// As file checkers require, no record is outside of the header's box, which is that of the records.
TEST(LasWriter, TheBoxIsOfTheRecords) {
  const Folder folder;
  PointSet points;
  points.origin = {500000, 4100000, 0};
  points.positions = {{0.7f, 0.1f, 0.3f}, {311.37f, 17.9f, 5.1f}};
  write_points(folder / "out.las", points);
  const std::string bytes = slurp(folder / "out.las");
  const auto number = [&]<class T>(std::size_t at, T) {
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
  };
  const auto first = number(96, std::uint32_t{});
  const auto size = number(105, std::uint16_t{});
  for (std::size_t k = 0; k < 3; ++k) {
    const double step = number(131 + 8 * k, double{}), offset = number(155 + 8 * k, double{});
    const double a = number(first + 4 * k, std::int32_t{}) * step + offset;
    const double b = number(first + size + 4 * k, std::int32_t{}) * step + offset;
    EXPECT_EQ(number(179 + 16 * k, double{}), std::max(a, b)) << k;
    EXPECT_EQ(number(187 + 16 * k, double{}), std::min(a, b)) << k;
  }
}

TEST(LasWriter, AdjustedTimesOfLongAgoAreNoneOfTheWeek) {
  const Folder folder;
  for (const double time : {-80000000.5, 3.1e8, 5.0}) {
    PointSet points;
    points.positions = {{0, 0, 0}};
    points.attributes.set("gps_time", std::vector<double>{time});
    write_points(folder / "out.las", points);
    EXPECT_EQ(slurp(folder / "out.las")[6] & 1, time == 5 ? 0 : 1) << time;
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
