// E57: every kind of field in packets of any size, scans with poses, broken files.
#include <limits>
#include <random>

#include "e57_test_files.h"
#include "io_test_tools.h"
#include "oracle.h"
#include "sansmesh/io/e57/crc32c.h"
#include "sansmesh/io/meshes/vtk_xml.h"
#include "support/any_threads.h"
#include "support/places.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

/// Random points of a box of 2 m.
struct RandomPoints {
  std::vector<double> x, y, z;
};

RandomPoints random_points(std::size_t n, unsigned seed = 7) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> in_box(-1, 1);
  RandomPoints p;
  for (std::size_t i = 0; i < n; ++i)
    p.x.push_back(in_box(random)), p.y.push_back(in_box(random)), p.z.push_back(in_box(random));
  return p;
}

E57TestScan plain_scan(const RandomPoints& p) {
  return {{E57TestField::real("cartesianX", p.x), E57TestField::real("cartesianY", p.y),
           E57TestField::real("cartesianZ", p.z)}};
}

PointSet read_bytes(const std::string& bytes, ReadReport* report = nullptr) {
  const Folder folder;
  return read_points(folder.put("a.e57", bytes), report);
}

Vec3 e57_point(const PointSet& p, std::size_t i) { return p.origin + Vec3(p.positions[i]); }

TEST(E57, ChecksumIsCastagnolis) {
  EXPECT_EQ(io::crc32c("123456789"), 0xe3069283u);
  std::string bytes;
  for (int k = 0; k < 100; ++k) {
    EXPECT_EQ(io::crc32c(bytes), slow_crc32c(bytes));
    bytes += static_cast<char>(37 * k);
  }
}

TEST(E57, EveryNumberOfBitsInPacketsOfAnySize) {
  const std::size_t n = 777;
  const RandomPoints p = random_points(n);
  std::mt19937_64 random(3);
  for (const std::size_t packet : {1u, 7u, 64u, 1000u}) {
    E57TestScan scan = plain_scan(p);
    scan.bytes_per_stream = packet;
    std::vector<std::vector<std::int64_t>> values;
    for (unsigned bits = 1; bits <= 64; bits += bits < 56 ? 5 : 1) {
      const std::int64_t lowest = bits == 64 ? std::numeric_limits<std::int64_t>::min() : -5;
      const std::uint64_t range = bits == 64 ? ~0ull : (1ull << bits) - 1;
      const auto highest = static_cast<std::int64_t>(static_cast<std::uint64_t>(lowest) + range);
      if (highest < lowest) continue;  // more than fits above -5
      std::vector<std::int64_t>& v = values.emplace_back();
      for (std::size_t i = 0; i < n; ++i)
        v.push_back(static_cast<std::int64_t>(static_cast<std::uint64_t>(lowest) + (random() & range)));
      scan.fields.push_back(E57TestField::whole("a" + std::to_string(bits), lowest, highest, v));
    }
    scan.fields.push_back(E57TestField::whole("constant", 3, 3, std::vector<std::int64_t>(n, 3)));
    scan.fields.push_back(
        E57TestField::whole("scaled", -100, 1000, std::vector<std::int64_t>(n, 7), "scale=\"0.01\" offset=\"2\""));
    const PointSet read = read_bytes(e57_file({scan}));
    ASSERT_EQ(read.size(), n);
    for (std::size_t i = 0; i < n; ++i) EXPECT_LT(norm(e57_point(read, i) - Vec3{p.x[i], p.y[i], p.z[i]}), 1e-6);
    ASSERT_EQ(read.attributes.size(), values.size() + 1);
    for (std::size_t a = 0; a < values.size(); ++a)
      for (std::size_t i = 0; i < n; ++i)
        std::visit([&](const auto& v) { ASSERT_EQ(static_cast<std::int64_t>(v[i]), values[a][i]); },
                   read.attributes[a].values);
    ASSERT_TRUE(read.attributes.find<double>("scaled"));
    EXPECT_DOUBLE_EQ((*read.attributes.find<double>("scaled"))[n / 2], 2.07);
  }
}

TEST(E57, PosesMoveScansAndGiveTheirScanners) {
  const RandomPoints p = random_points(200);
  const double h = std::sqrt(0.5);
  E57TestScan turned = plain_scan(p), plain = plain_scan(p), shifted = plain_scan(p);
  turned.xml = "<name type=\"String\">north &amp; east</name>" + e57_pose({h, 0, 0, h}, {10.25, 20, 30});
  shifted.xml = e57_pose({1, 0, 0, 0}, {300, -200, 0});
  for (auto* scan : {&turned, &plain, &shifted})
    for (const char* axis : {"X", "Y", "Z"})
      scan->fields.push_back(
          E57TestField::single(std::string("nor:normal") + axis, std::vector<double>(200, *axis == 'X' ? 1 : 0)));
  ReadReport report;
  const PointSet read = read_bytes(e57_file({plain, turned, shifted}), &report);
  ASSERT_EQ(read.size(), 600u);
  EXPECT_EQ(report.format, "E57, 3 scans");
  EXPECT_TRUE(report.warnings.empty());
  for (std::size_t i = 0; i < 200; ++i) {
    EXPECT_LT(norm(e57_point(read, i) - Vec3{p.x[i], p.y[i], p.z[i]}), 1e-4);
    EXPECT_LT(norm(e57_point(read, 200 + i) - Vec3{10.25 - p.y[i], 20 + p.x[i], 30 + p.z[i]}), 1e-4);
    EXPECT_LT(norm(e57_point(read, 400 + i) - Vec3{300 + p.x[i], -200 + p.y[i], p.z[i]}), 1e-4);
    EXPECT_LT(norm(read.normals[200 + i] - Vec3f{0, 1, 0}), 1e-6);
    EXPECT_EQ(read.normals[i], (Vec3f{1, 0, 0}));
  }
  // A shift of coordinates is no scanner; scans with a scanner have the first numbers.
  ASSERT_EQ(read.scanners.size(), 1u);
  EXPECT_LT(norm(read.origin + Vec3(read.scanners[0]) - Vec3{10.25, 20, 30}), 1e-4);
  EXPECT_EQ(read.scan_names, (std::vector<std::string>{"north & east", "1", "3"}));
  EXPECT_EQ(read.scan_of_point[0], 1);
  EXPECT_EQ(read.scan_of_point[200], 0);
  EXPECT_EQ(read.scan_of_point[400], 2);
}

TEST(E57, SphericalCoordinatesAreSeenFromTheirOrigin) {
  const RandomPoints p = random_points(100);
  std::vector<double> range, azimuth, elevation;
  for (std::size_t i = 0; i < 100; ++i) {
    range.push_back(std::sqrt(p.x[i] * p.x[i] + p.y[i] * p.y[i] + p.z[i] * p.z[i]));
    azimuth.push_back(std::atan2(p.y[i], p.x[i]));
    elevation.push_back(std::asin(p.z[i] / range.back()));
  }
  E57TestScan scan{{E57TestField::real("sphericalRange", range), E57TestField::real("sphericalAzimuth", azimuth),
                    E57TestField::real("sphericalElevation", elevation)}};
  std::vector<std::int64_t> invalid(100);
  invalid[3] = 2, invalid[99] = 1;
  scan.fields.push_back(E57TestField::whole("sphericalInvalidState", 0, 2, invalid));
  ReadReport report;
  const PointSet read = read_bytes(e57_file({scan}), &report);
  ASSERT_EQ(read.size(), 98u);
  for (std::size_t i = 4; i < 99; ++i) EXPECT_LT(norm(e57_point(read, i - 1) - Vec3{p.x[i], p.y[i], p.z[i]}), 1e-6);
  ASSERT_EQ(read.scanners.size(), 1u);
  EXPECT_EQ(read.origin + Vec3(read.scanners[0]), Vec3{});
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_EQ(report.warnings[0], "2 of 100 points are marked as invalid (no return) and were left out");
}

TEST(E57, RowsAndColumnsSeenFromTheirOriginGiveTheScanner) {
  // A sphere seen from within, in rows and columns, and the same samples seen from elsewhere.
  for (const double shift : {0.0, 5.0}) {
    RandomPoints p;
    std::vector<std::int64_t> rows, columns;
    for (int r = 0; r < 30; ++r)
      for (int c = 0; c < 40; ++c) {
        const double e = 0.5 - r * 0.03, a = -c * 0.03;
        p.x.push_back(3 * std::cos(e) * std::cos(a) - shift), p.y.push_back(3 * std::cos(e) * std::sin(a));
        p.z.push_back(3 * std::sin(e)), rows.push_back(r), columns.push_back(c);
      }
    E57TestScan scan = plain_scan(p);
    scan.fields.push_back(E57TestField::whole("rowIndex", 0, 29, rows));
    scan.fields.push_back(E57TestField::whole("columnIndex", 0, 39, columns));
    const PointSet read = read_bytes(e57_file({scan}));
    EXPECT_EQ(read.scanners.size(), shift == 0 ? 1u : 0u);
    EXPECT_TRUE(read.attributes.find<std::uint8_t>("row"));
    EXPECT_TRUE(read.attributes.find<std::uint8_t>("column"));
  }
}

TEST(E57, ColoursFollowTheirLimitsAndPartialArraysAreLeftOut) {
  const RandomPoints p = random_points(3);
  E57TestScan scan = plain_scan(p), bare = plain_scan(p);
  for (const char* color : {"colorRed", "colorGreen", "colorBlue"})
    scan.fields.push_back(E57TestField::whole(color, 0, 65535, {0, 2048, 4095}));
  scan.fields.push_back(E57TestField::single("intensity", {0.5, 0.25, 1}));
  scan.fields.push_back(E57TestField::whole("returnIndex", 0, 3, {0, 1, 2}));
  const auto limits = [](const std::string& c, int most) {
    return "<" + c + "Minimum type=\"Integer\"/><" + c + "Maximum type=\"Integer\">" + std::to_string(most) + "</" + c +
           "Maximum>";
  };
  scan.xml = "<colorLimits type=\"Structure\">" + limits("colorRed", 4095) + limits("colorGreen", 0) +
             limits("colorBlue", 4095) + "</colorLimits>";
  ReadReport report;
  const PointSet one = read_bytes(e57_file({scan}, "", "<vectorChild type=\"Structure\"/>"), &report);
  ASSERT_EQ(one.colors.size(), 3u);
  EXPECT_EQ(one.colors[0], (std::array<std::uint8_t, 3>{0, 0, 0}));
  EXPECT_EQ(one.colors[2], (std::array<std::uint8_t, 3>{255, 16, 255}));  // no limits of green: those of the field
  EXPECT_EQ(report.unread, std::vector<std::string>{"1 picture"});
  EXPECT_EQ(*one.attributes.find<std::uint8_t>("return_number"), (std::vector<std::uint8_t>{1, 2, 3}));

  const PointSet two = read_bytes(e57_file({scan, bare}), &report);
  EXPECT_TRUE(two.colors.empty());
  EXPECT_EQ(report.warnings, std::vector<std::string>{"only 1 of 2 scans have colours: left out"});
  ASSERT_TRUE(two.attributes.find<float>("intensity"));
  EXPECT_EQ((*two.attributes.find<float>("intensity"))[1], 0.25f);
  EXPECT_TRUE(std::isnan((*two.attributes.find<float>("intensity"))[4]));
}

TEST(E57, ReturnsCountFromOneWhateverTheirRange) {
  constexpr auto most = std::numeric_limits<std::int64_t>::max();
  for (const std::int64_t highest : {std::int64_t{2}, std::int64_t{255}, most}) {
    E57TestScan scan = plain_scan(random_points(3));
    scan.fields.push_back(E57TestField::whole("returnIndex", 0, highest, {0, 1, 2}));
    const PointSet read = read_bytes(e57_file({scan}));
    const Attribute* const returns = read.attributes.find("return_number");
    ASSERT_TRUE(returns);
    for (std::size_t i = 0; i < 3; ++i)
      std::visit([&](const auto& v) { EXPECT_EQ(static_cast<std::size_t>(v[i]), i + 1); }, returns->values);
  }
  E57TestScan scaled = plain_scan(random_points(3));
  scaled.fields.push_back(E57TestField::whole("returnIndex", 0, 7, {0, 1, 2}, "scale=\"1\""));
  const PointSet read = read_bytes(e57_file({scaled}));
  ASSERT_TRUE(read.attributes.find<double>("return_number"));
  EXPECT_EQ(*read.attributes.find<double>("return_number"), (std::vector<double>{1, 2, 3}));
}

TEST(E57, SurveyCoordinatesKeepTheirMillimetres) {
  RandomPoints p = random_points(500);
  for (std::size_t i = 0; i < 500; ++i) p.x[i] += 512345, p.y[i] += 5403210;
  const PointSet read = read_bytes(e57_file({plain_scan(p)}));
  for (std::size_t i = 0; i < 500; ++i) EXPECT_LT(norm(e57_point(read, i) - Vec3{p.x[i], p.y[i], p.z[i]}), 1e-6);
}

TEST(E57, InvalidPointsDoNotSpoilTheOrigin) {
  RandomPoints p = random_points(500);
  std::vector<std::int64_t> invalid(500);
  for (std::size_t i = 0; i < 500; ++i) {
    invalid[i] = i % 5 < 2;
    if (invalid[i] == 0)
      p.x[i] += 512345, p.y[i] += 5403210;
    else
      p.x[i] = p.y[i] = p.z[i] = 0;
  }
  E57TestScan scan = plain_scan(p);
  scan.fields.push_back(E57TestField::whole("cartesianInvalidState", 0, 1, invalid));
  ReadReport report;
  const PointSet read = read_bytes(e57_file({scan, plain_scan({{512345}, {5403210}, {0}})}), &report);
  ASSERT_EQ(read.size(), 301u);
  for (std::size_t i = 0, k = 0; i < 500; ++i)
    if (invalid[i] == 0) EXPECT_LT(norm(e57_point(read, k++) - Vec3{p.x[i], p.y[i], p.z[i]}), 1e-6);
  EXPECT_EQ(report.warnings.size(), 1u);
}

TEST(E57, ThreadsDoNotMatter) {
  const RandomPoints p = random_points(40000);
  E57TestScan scan = plain_scan(p);
  scan.bytes_per_stream = 3001;
  const std::string bytes = e57_file({scan, scan});
  compare_threads([&] { return read_bytes(bytes); },
                  [](const PointSet& a, const PointSet& b) {
                    EXPECT_EQ(a.positions, b.positions);
                    EXPECT_EQ(a.origin, b.origin);
                  });
}

TEST(E57Xml, EntitiesTakeLinearTime) {
  EXPECT_EQ(io::from_xml("a &lt;b&gt; &amp;amp; &#65;&#0000066; &x; &; & &quot;&apos;"), "a <b> &amp; AB &x; &; & \"'");
  // Some milliseconds; minutes if every character looked for the end of an entity.
  const std::string text(std::size_t{1} << 22, 'x'), marks(std::size_t{1} << 22, '&');
  EXPECT_EQ(io::from_xml(text + ";"), text + ";");
  EXPECT_EQ(io::from_xml(marks), marks);
}

class E57Broken : public ::testing::Test {
 protected:
  void expect(const std::string& bytes, const std::string& part) {
    expect_unreadable(folder_.put("a.e57", bytes), part);
  }
  /// The good file with a part of its content replaced, and with right checksums.
  std::string changed(const std::string& from, const std::string& to) const {
    std::string content;
    for (std::size_t at = 0; at < good_.size(); at += 1024) content += good_.substr(at, 1020);
    const std::size_t at = content.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    content.replace(at, to.size(), to);
    return e57_pages(content);
  }
  const Folder folder_;
  const std::string good_ = e57_file({plain_scan(random_points(100))});
};

TEST_F(E57Broken, AFlippedBitNamesItsPage) {
  for (std::size_t page = 0; page < good_.size() / 1024; ++page) {
    std::string bytes = good_;
    bytes[page * 1024 + 500] = static_cast<char>(bytes[page * 1024 + 500] ^ 4);
    expect(bytes, "damaged: page " + std::to_string(page + 1) + " (bytes ");
  }
}

TEST_F(E57Broken, EveryCutIsAnError) {
  for (const std::size_t length : {9u, 47u, 48u, 1000u, 1024u, 2048u}) expect(good_.substr(0, length), "");
  expect(good_.substr(0, good_.size() - 1), "truncated: 1 byte");
}

TEST_F(E57Broken, AbsurdNumbersAreNamed) {
  expect(changed("recordCount=\"100\"", "recordCount=\"999\""), "truncated: ");
  expect(changed("fileOffset=\"48\"", "fileOffset=\"99\""), "malformed E57: no section of points at byte 99 (scan 1)");
  expect(changed("recordCount=\"100\"", "recordCount=\"000\""), "holds no points");
  expect(changed("recordCount=\"100\"", "recordCount=\"1x0\""), "is not a number");
  expect(changed("cartesianX", "cartesianW"), "neither Cartesian nor spherical");
  expect(changed("type=\"Float\"", "type=\"Flaot\""), "is of type 'Flaot'");
  expect(changed("<prototype", "<prototypo"), "malformed XML");
  std::string long_xml = good_;
  long_xml.replace(32, 8, "\1\0\0\4\0\0\0\0", 8);
  long_xml.replace(0, 1024, e57_pages(long_xml.substr(0, 1020)));
  expect(long_xml, "its XML section has 67,108,865 bytes; at most 67,108,864 are supported");
  expect(changed("</data3D>", "</dat!3D>"), "malformed XML: an end tag without a start");
}

TEST(E57, ScansThatShareTheirBytesAreRefused) {
  E57TestScan scan = plain_scan(random_points(1000));
  std::string other = "<points type=\"CompressedVector\" fileOffset=\"48\" recordCount=\"1000\"><prototype>";
  for (const E57TestField& field : scan.fields) other += "<" + field.name + " " + field.xml + "/>";
  other += "</prototype></points></vectorChild><vectorChild type=\"Structure\">";
  for (int k = 0; k < 5; ++k) scan.xml += other;
  const Folder folder;
  expect_unreadable(folder.put("a.e57", e57_file({scan})), "malformed E57: the points of scan 2 overlap those of");
}

TEST(E57Oracle, AgreesWithWebE57) {
  const Folder folder;
  const RandomPoints p = random_points(3000);
  E57TestScan turned = plain_scan(p), scaled;
  turned.xml = e57_pose({0.1, 0.7, -0.1, 0.7}, {10.25, -20, 30});
  turned.bytes_per_stream = 1000;
  turned.with_other_packets = scaled.with_other_packets = false;  // it cannot read them
  const std::vector<double>* const axes[] = {&p.x, &p.y, &p.z};
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<std::int64_t> steps;
    for (const double v : *axes[k]) steps.push_back(std::lround(v * 1e5));
    scaled.fields.push_back(E57TestField::whole(std::string("cartesian") + "XYZ"[k], -100000, 100000, steps,
                                                "scale=\"0.00001\" offset=\"7\""));
  }
  std::vector<std::string> files = {folder.put("made.e57", e57_file({turned, scaled})),
                                    source_file("tests/data/A_B.e57")};
  for (const char* name : {"A4", "ColouredCubeFloat", "bunnyDouble"})
    if (const std::string file = shared_points(std::string("survey/") + name + ".e57"); std::filesystem::exists(file))
      files.push_back(file);
  for (const std::string& file : files) {
    SCOPED_TRACE(file);
    bool absent = false;
    std::istringstream theirs(run_oracle("web_e57.mjs", "'" + file + "'", absent));
    if (absent) GTEST_SKIP() << "node or its package web-e57 is not installed: scripts/install-deps oracles";
    const PointSet ours = read_points(file);
    std::size_t lines = 0;
    for (std::string line; std::getline(theirs, line); ++lines) {
      std::istringstream words(line);
      Vec3 q;
      ASSERT_TRUE(words >> q.x >> q.y >> q.z) << line;
      ASSERT_LT(lines, ours.size());
      ASSERT_LT(norm(e57_point(ours, lines) - q), 5e-6) << lines;
      if (int r = 0, g = 0, b = 0; words >> r >> g >> b && ours.has_colors()) {
        ASSERT_EQ(int{ours.colors[lines][0]}, r);
        ASSERT_EQ(int{ours.colors[lines][1]}, g);
        ASSERT_EQ(int{ours.colors[lines][2]}, b);
      }
    }
    EXPECT_EQ(lines, ours.size());
  }
}

TEST(E57, ShippedFiles) {
  const PointSet p = read_points(source_file("tests/data/A_B.e57"));
  ASSERT_EQ(p.size(), 6u);
  EXPECT_LT(norm(e57_point(p, 0) - Vec3{-42.63949966430664, 1.8725999593734741, 0.666700005531311}), 1e-6);
  EXPECT_LT(norm(e57_point(p, 5) - Vec3{-44.95220184326172, -1.3493000268936157, -0.607699990272522}), 1e-6);
  EXPECT_EQ(p.colors[5], (std::array<std::uint8_t, 3>{0, 255, 0}));
  EXPECT_EQ(p.scan_names, (std::vector<std::string>{"B2 - Cloud", "A4 - Cloud"}));
  expect_unreadable(source_file("tests/data/ZeroPoints.e57"), "holds no points");
  expect_unreadable(source_file("tests/data/InvalidCVHeader.e57"), "holds no points");
  expect_unreadable(source_file("tests/data/bad-crc.e57"), "damaged: page 1 (bytes 0 to 1023, in the header)");
}

}  // namespace
}  // namespace sansmesh::inline v1
