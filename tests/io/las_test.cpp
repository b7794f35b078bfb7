// Attributes of points in LAS files, for each point format.
#include "compress_las.h"
#include "io_test_tools.h"
#include "support/las_file.h"
#include "support/places.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

/// Points with all values different and within the format's ranges.
std::vector<LasPoint> varied_points(const LasFile& of, std::size_t n) {
  std::mt19937 random(7);
  const auto below = [&](unsigned limit) { return static_cast<unsigned>(random() % limit); };
  std::vector<LasPoint> points(n);
  for (LasPoint& p : points) {
    p.x = static_cast<std::int32_t>(below(1000000)), p.y = -static_cast<std::int32_t>(below(1000000));
    p.z = static_cast<std::int32_t>(below(50000));
    p.intensity = static_cast<std::uint16_t>(random());
    p.return_number = below(of.wide() ? 16 : 8), p.returns = below(of.wide() ? 16 : 8);
    p.classification = below(of.wide() ? 256 : 32);
    p.synthetic = below(3) == 0, p.key_point = below(3) == 0, p.overlap = below(3) == 0;
    p.scan_angle = of.wide() ? static_cast<int>(below(60001)) - 30000 : static_cast<int>(below(181)) - 90;
    p.user_data = static_cast<std::uint8_t>(random()), p.source = static_cast<std::uint16_t>(random());
    p.gps_time = 3.1e8 + 1e-7 * static_cast<double>(below(1u << 30));
    for (std::uint16_t& c : p.rgb) c = static_cast<std::uint16_t>(random());
    p.near_infrared = static_cast<std::uint16_t>(random());
  }
  return points;
}

template <class T, class Get>
void expect_attribute(const PointSet& cloud, const char* name, const std::vector<LasPoint>& points, Get&& get) {
  const std::vector<T>* const values = cloud.attributes.find<T>(name);
  ASSERT_NE(values, nullptr) << name;
  ASSERT_EQ(values->size(), points.size()) << name;
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_EQ((*values)[i], get(points[i])) << name << ' ' << i;
}

TEST(LasAttributes, OfEveryVersionAndPointFormat) {
  using u8 = std::uint8_t;
  using u16 = std::uint16_t;
  const Folder folder;
  for (unsigned minor = 0; minor <= 4; ++minor) {
    for (unsigned format = 0; format <= last_point_format(minor); ++format) {
      SCOPED_TRACE(std::to_string(minor) + ", format " + std::to_string(format));
      LasFile file{.minor = minor, .format = format, .extra = format % 3};
      file.points = varied_points(file, 500);
      ReadReport report;
      const PointSet p = read_points(folder.put("a.las", file.bytes()), &report);
      EXPECT_TRUE(report.warnings.empty());
      ASSERT_EQ(p.size(), file.points.size());
      const auto& points = file.points;
      expect_attribute<u16>(p, "intensity", points, [](const LasPoint& q) { return q.intensity; });
      expect_attribute<u8>(p, "return_number", points, [](const LasPoint& q) { return q.return_number; });
      expect_attribute<u8>(p, "number_of_returns", points, [](const LasPoint& q) { return q.returns; });
      expect_attribute<u8>(p, "classification", points, [](const LasPoint& q) { return q.classification; });
      expect_attribute<u8>(p, "synthetic", points, [](const LasPoint& q) { return q.synthetic; });
      const double step = file.wide() ? 0.006 : 1;
      expect_attribute<float>(p, "scan_angle", points,
                              [&](const LasPoint& q) { return static_cast<float>(q.scan_angle * step); });
      // LAS 1.0 has one byte, the "file marker", at the position of user data.
      expect_attribute<u16>(p, "point_source_id", points,
                            [&](const LasPoint& q) { return minor == 0 ? q.user_data : q.source; });
      std::size_t others = 0;
      if (minor > 0) {
        expect_attribute<u8>(p, "user_data", points, [](const LasPoint& q) { return q.user_data; });
        ++others;
      }
      if (file.wide()) {
        expect_attribute<u8>(p, "overlap", points, [](const LasPoint& q) { return q.overlap; });
        ++others;
      }
      if (file.has_time()) {
        expect_attribute<double>(p, "gps_time", points, [](const LasPoint& q) { return q.gps_time; });
        ++others;
      }
      if (file.has_infrared()) {
        expect_attribute<u16>(p, "near_infrared", points, [](const LasPoint& q) { return q.near_infrared; });
        ++others;
      }
      EXPECT_EQ(p.attributes.size(), 7 + others);
      ASSERT_EQ(p.has_colors(), file.has_colors());
      for (std::size_t i = 0; i < p.size() && p.has_colors(); ++i)
        for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(p.colors[i][k], points[i].rgb[k] / 257.0, 1) << i;
    }
  }
}

/// A record between header and points.
std::string variable_record(const std::string& user, std::uint16_t number, const std::string& content) {
  std::string s(54, '\0');
  s.replace(2, user.size(), user);
  s.replace(18, 2, raw(number)), s.replace(20, 2, raw(static_cast<std::uint16_t>(content.size())));
  return s + content;
}

/// LAS 1.4 descriptions of numbers after those of the point format.
std::string description(unsigned type, const std::string& name, unsigned options = 0, double scale = 0,
                        double offset = 0) {
  std::string s(192, '\0');
  s[2] = static_cast<char>(type), s[3] = static_cast<char>(options);
  s.replace(4, name.size(), name);
  for (std::size_t k = 0; k < 3; ++k) {
    s.replace(112 + 8 * k, 8, raw(scale * static_cast<double>(k + 1)));
    s.replace(136 + 8 * k, 8, raw(offset));
  }
  return s;
}

TEST(LasAttributes, OfExtraBytes) {
  const Folder folder;
  for (const auto& [minor, format] : {std::pair{2u, 3u}, std::pair{4u, 6u}}) {
    LasFile file{.minor = minor, .format = format, .extra = 2};
    file.points = varied_points(file, 300);
    file.own = [](const LasPoint& p) {
      return raw(static_cast<std::uint16_t>(p.intensity / 2)) + std::string("\1\2\3") + raw(0.25f * p.source) +
             raw(std::int16_t{7}) + raw(static_cast<std::int16_t>(-p.user_data)) + raw(std::int32_t{0}) +
             raw(std::uint8_t{9});
    };
    const std::string described = description(3, "Amplitude", 8, 0.01) + description(0, "nothing", 3) +
                                  description(9, "Reflectance") + description(14, "tilt", 8 | 16, 0.5, -1) +
                                  description(6, "zero") + description(1, "intensity");
    file.variable = variable_record("LASF_Spec", 3, std::string(40, 'x')) +
                    variable_record("somebody", 4, std::string(192, '\1')) + variable_record("LASF_Spec", 4, described);
    file.variable_count = 3;
    ReadReport report;
    const PointSet p = read_points(folder.put("a.las", file.bytes()), &report);
    EXPECT_EQ(report.warnings, std::vector<std::string>{"'intensity' occurs twice: the second one was left out"});
    const auto& amplitude = *p.attributes.find<double>("Amplitude");
    const auto& reflectance = *p.attributes.find<float>("Reflectance");
    const auto& tilt = *p.attributes.find<double>("tilt");
    ASSERT_EQ(tilt.size(), 600u);
    for (std::size_t i = 0; i < p.size(); ++i) {
      const LasPoint& q = file.points[i];
      ASSERT_EQ(amplitude[i], 0.01 * std::floor(q.intensity / 2.0)) << i;
      ASSERT_EQ(reflectance[i], 0.25f * q.source) << i;
      ASSERT_EQ(tilt[2 * i], 0.5 * 7 - 1) << i;
      ASSERT_EQ(tilt[2 * i + 1], 1.0 * -q.user_data - 1) << i;
    }
    EXPECT_EQ(p.attributes.find("zero"), nullptr);
    EXPECT_EQ(p.attributes.find("nothing"), nullptr);
    const PointSet bare = [&] {
      LasFile plain = file;
      plain.variable.clear(), plain.variable_count = 0;
      return read_points(folder.put("b.las", plain.bytes()));
    }();
    EXPECT_EQ(p.attributes.size(), bare.attributes.size() + 3);
    EXPECT_EQ(*p.attributes.find("intensity"), *bare.attributes.find("intensity"));

    // Damaged descriptions affect only themselves.
    const std::size_t extras = file.variable.size() - described.size();
    for (std::size_t at = 0; at < file.variable.size(); ++at) {
      LasFile damaged = file;
      damaged.variable[at] = static_cast<char>(at < extras ? 255 : damaged.variable[at] ^ 0x5f);
      EXPECT_EQ(read_points(folder.put("b.las", damaged.bytes())).positions, p.positions) << at;
    }
  }
}

TEST(LasAttributes, ThatAreZeroEverywhereAreLeftOut) {
  const Folder folder;
  for (const unsigned format : {3u, 8u}) {
    LasFile file{.format = format};
    for (int i = 0; i < 40000; ++i) file.points.push_back({.x = i, .y = 2 * i, .z = i % 7});
    EXPECT_TRUE(read_points(folder.put("a.las", file.bytes())).attributes.empty()) << format;
    file.points.back().classification = 2;
    const PointSet p = read_points(folder.put("a.las", file.bytes()));
    ASSERT_EQ(p.attributes.size(), 1u);
    EXPECT_EQ(p.attributes[0].name, "classification");
    EXPECT_EQ(p.attributes[0].number(39998), 0);
    EXPECT_EQ(p.attributes[0].number(39999), 2);
  }
}

TEST(Las, WithheldPointsAreLeftOutAndCounted) {
  const Folder folder;
  for (const unsigned format : {0u, 1u, 5u, 6u, 10u}) {
    LasFile file{.format = format};
    for (int i = 0; i < 3000; ++i)
      file.points.push_back({.x = i,
                             .y = i * i % 1000,
                             .z = 5,
                             .classification = 6,
                             .withheld = i % 3 == 1,
                             .source = static_cast<std::uint16_t>(i)});
    ReadReport report;
    const PointSet p = read_points(folder.put("a.las", file.bytes()), &report);
    ASSERT_EQ(p.size(), 2000u);
    EXPECT_EQ(report.warnings,
              std::vector<std::string>{"1,000 of 3,000 points are flagged as withheld and were left out"});
    const auto& source = *p.attributes.find<std::uint16_t>("point_source_id");
    for (std::size_t i = 0; i < p.size(); ++i) {
      ASSERT_EQ(source[i], 3 * i / 2 + i % 2);  // 0, 2, 3, 5, 6, 8, …
      ASSERT_NEAR(p.origin.x + static_cast<double>(p.positions[i].x), 0.001 * source[i], 1e-6);
      ASSERT_EQ(p.attributes.find("classification")->number(i), 6);
    }
    for (LasPoint& q : file.points) q.withheld = true;
    expect_unreadable(folder.put("a.las", file.bytes()), "all 3,000 are flagged as withheld");
  }
}

/// Withheld points in a box are like none: other tiles may have points there.
TEST(Las, BoxesOfWithheldPointsAreEmpty) {
  const Folder folder;
  LasFile file{.format = 6};
  for (int i = 0; i < 30; ++i) file.points.push_back({.x = 1000 * i, .z = i % 2, .withheld = i < 10});
  const std::string a = folder.put("a.las", file.bytes());
  for (LasPoint& p : file.points) p.withheld = false;
  const std::string b = folder.put("b.las", file.bytes());
  const ReadOptions box{.box = Box3{{-1, -1, -1}, {8.5, 1, 1}}};
  expect_file_error(a, "holds no points in the box", [&] { read_points(a, nullptr, box); });
  EXPECT_EQ(read_merged({a, b}, nullptr, box).size(), 9u);
}

/// The depth of colours does not depend on the selected points.
TEST(Las, DarkPointsInBoxesHaveTheColoursOfTheFile) {
  const Folder folder;
  LasFile file{.format = 2};
  for (int i = 0; i < 30; ++i) {
    const auto c = static_cast<std::uint16_t>(i < 10 ? 20 * i : 2001 * i);
    file.points.push_back({.x = 1000 * i, .z = i % 2, .rgb = {c, c, c}});
  }
  const ReadOptions box{.box = Box3{{-1, -1, -1}, {8.5, 1, 1}}};
  const std::string plain = folder.put("a.las", file.bytes());
  const PointSet whole = read_points(plain);
  ReadReport report;
  const PointSet some = read_points(plain, &report, box);
  ASSERT_EQ(some.size(), 9u);
  ASSERT_EQ(some.colors.size(), 9u);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(some.colors[i], whole.colors[i]);
  EXPECT_TRUE(report.warnings.empty());
  // Of compressed files only the selected points are at hand.
  read_points(folder.put("a.laz", compress_las(file.bytes())), &report, box);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("are at most 255 and were read as 8-bit colours"), std::string::npos);
}

/// LAS 1.4 has two counts: in 32 bits as before (0 if the format is new or the number too large), and in 64.
TEST(Las, CountsOfVersion14) {
  const Folder folder;
  LasFile file{.format = 1};
  for (int i = 0; i < 50; ++i) file.points.push_back({.x = i, .y = 3 * i % 7, .z = i % 2});
  const auto size = [&] { return read_points(folder.put("a.las", file.bytes())).size(); };
  EXPECT_EQ(size(), 50u);
  file.short_count = 0;
  EXPECT_EQ(size(), 50u);
  file.short_count = 20, file.long_count = 50;
  EXPECT_EQ(size(), 50u);
  file.short_count = 50, file.long_count = 0;
  EXPECT_EQ(size(), 50u);
  file.short_count = 0;
  expect_unreadable(folder.put("a.las", file.bytes()), "holds no points");
  file.long_count = 51;
  expect_unreadable(folder.put("a.las", file.bytes()), "truncated: 28 bytes are missing");
}

TEST(Las, CutOffAnywhereIsAnError) {
  const Folder folder;
  for (unsigned format = 0; format <= 10; ++format) {
    LasFile file{.format = format};
    file.points = varied_points(file, 3);
    const std::string whole = file.bytes();
    for (std::size_t size = 4; size < whole.size(); ++size)
      expect_unreadable(folder.put("a.las", whole.substr(0, size)), "truncated");
  }
}

/// Formats with attributes preserve all attributes of LAS, number by number.
TEST(LasAttributes, SurviveOtherFormats) {
  const Folder folder;
  LasFile file{.format = 8};
  file.points = varied_points(file, 200);
  const PointSet p = read_points(folder.put("a.las", file.bytes()));
  for (const char* name : {"a.ply", "a.pcd", "a.vtp", "a.csv"}) {
    write_points(folder / name, p);
    const PointSet back = read_points(folder / name);
    ASSERT_EQ(back.attributes.size(), p.attributes.size()) << name;
    for (const Attribute& a : p.attributes) {
      const Attribute* const there = back.attributes.find(a.name);
      ASSERT_NE(there, nullptr) << name << ' ' << a.name;
      for (std::size_t i = 0; i < p.size(); ++i)
        ASSERT_EQ(static_cast<float>(there->number(i)), static_cast<float>(a.number(i))) << name << ' ' << a.name;
    }
  }
}

/// Files by other programs: results match their headers and records.
TEST(LasAttributes, OfFilesByOthers) {
  for (const auto& [name, format] : {std::pair{"simple.las", 3u}, std::pair{"test1_4.las", 6u}}) {
    const std::string file = source_file(std::string("tests/data/") + name), bytes = slurp(file);
    const PointSet p = read_points(file);
    ASSERT_EQ(static_cast<unsigned char>(bytes[104]), format);
    std::uint32_t data = 0;
    std::uint16_t record = 0;
    std::memcpy(&data, bytes.data() + 96, 4), std::memcpy(&record, bytes.data() + 105, 2);
    const auto byte = [&](std::size_t i, std::size_t at) {
      return static_cast<unsigned>(static_cast<unsigned char>(bytes[data + i * record + at]));
    };
    const auto number = [&](const char* attribute, std::size_t i) {
      const Attribute* const a = p.attributes.find(attribute);
      return a ? a->number(i) : 0.0;
    };
    for (std::size_t i = 0; i < p.size(); ++i) {
      ASSERT_EQ(number("intensity", i), byte(i, 12) | byte(i, 13) << 8);
      ASSERT_EQ(number("classification", i), format < 6 ? byte(i, 15) & 31 : byte(i, 16));
      const unsigned returns = byte(i, 14);
      ASSERT_EQ(number("return_number", i), returns & (format < 6 ? 7 : 15));
      ASSERT_EQ(number("number_of_returns", i), format < 6 ? returns >> 3 & 7 : returns >> 4);
      // No return number exceeds the number of returns.
      ASSERT_LE(number("return_number", i), number("number_of_returns", i));
      const std::size_t at = format < 6 ? 18 : 20;
      ASSERT_EQ(number("point_source_id", i), byte(i, at) | byte(i, at + 1) << 8);
    }
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
