// COPC: boxes and levels.
#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "laz_test_tools.h"
#include "oracle.h"
#include "sansmesh/box.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/laz/copc.h"
#include "sansmesh/io/reference_text.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

const char* const kFile = "tests/data/1.2-with-color.copc.laz";

const std::string kNoLevels = "has no levels of resolution: all points were read";

/// x, y, z in hundredths, intensity
using Row = std::array<long, 4>;

std::vector<Row> rows_of(const PointSet& p) {
  std::vector<Row> rows;
  const auto& intensity = *p.attributes.find<std::uint16_t>("intensity");
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3 q = p.origin + Vec3(p.positions[i]);
    rows.push_back({std::lround(q.x * 100), std::lround(q.y * 100), std::lround(q.z * 100), intensity[i]});
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

/// Middle of the file's points, and a part of them.
const Box3 kBox{{636500, 849500, 410}, {637500, 851500, 440}};

TEST(Copc, BoxesEqualTheSameSelectionOfAllPoints) {
  ReadReport report;
  const PointSet all = read_points(source_file(kFile), &report);
  EXPECT_EQ(report.format, "COPC, LAZ 1.4");
  EXPECT_EQ(all.size(), 1065u);
  std::vector<Row> expected;
  for (const Row& row : rows_of(all))
    if (kBox.contains(Vec3(0.01 * static_cast<double>(row[0]), 0.01 * static_cast<double>(row[1]),
                           0.01 * static_cast<double>(row[2]))))
      expected.push_back(row);
  ASSERT_GT(expected.size(), 20u);
  ASSERT_LT(expected.size(), 900u);
  EXPECT_EQ(rows_of(read_points(source_file(kFile), nullptr, {.box = kBox})), expected);
}

TEST(Copc, LevelsAreNested) {
  ReadReport report;
  std::size_t last = 0;
  std::vector<Row> coarse;
  for (const double spacing : {1e6, 20.0, 10.0, 1e-3}) {
    const std::vector<Row> rows = rows_of(read_points(source_file(kFile), &report, {.resolution = spacing}));
    EXPECT_EQ(std::count(report.warnings.begin(), report.warnings.end(), kNoLevels), 0);
    EXPECT_GE(rows.size(), last);
    EXPECT_TRUE(std::includes(rows.begin(), rows.end(), coarse.begin(), coarse.end()));
    coarse = rows, last = rows.size();
  }
  EXPECT_EQ(last, 1065u);
  EXPECT_EQ(rows_of(read_points(source_file(kFile), nullptr, {.resolution = 1e6})).size(), 24u);
  read_points(source_file("tests/data/simple.las"), &report, {.resolution = 1.0});
  EXPECT_EQ(std::count(report.warnings.begin(), report.warnings.end(), kNoLevels), 1);
}

/// Damage outside of the needed nodes has no effect: only these are decoded.
TEST(Copc, OnlyNeededNodesAreRead) {
  const Folder folder;
  std::string bytes = slurp(source_file(kFile));
  const std::string name = folder / "a.copc.laz";
  ReadReport report;
  const io::Input in{name, bytes, report, {}, 0, {.resolution = 1e6}};
  const io::LasHeader header = io::read_las_header(in);
  const auto info = io::laz::find_copc_info(header);
  ASSERT_TRUE(info);
  const auto root = io::laz::find_copc_chunks(in, header, *info);
  ASSERT_EQ(root.size(), 1u);
  EXPECT_EQ(root[0].points, 24u);
  const io::Input everything{name, bytes, report, {}, 0, {.resolution = 1e-9}};
  for (const io::laz::Chunk& chunk : io::laz::find_copc_chunks(everything, header, *info))
    if (chunk.begin != root[0].begin)
      std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(chunk.begin), chunk.bytes, '\xff');
  folder.put("a.copc.laz", bytes);
  EXPECT_EQ(read_points(name, nullptr, {.resolution = 1e6}).size(), 24u);
  expect_unreadable(name, "damaged");
}

/// The upper levels may be empty: such a tile takes nothing from the others.
TEST(Copc, LevelsWithoutPoints) {
  const Folder folder;
  std::string bytes = slurp(source_file(kFile));
  const std::size_t root = load_number<std::uint64_t>(bytes, 375 + 54 + 40);
  bytes.replace(root + 28, 4, raw(std::int32_t{0}));
  const std::string empty = folder.put("a.copc.laz", bytes);
  const ReadOptions coarse{.resolution = 1e6};
  expect_file_error(empty, "holds no points at the requested resolution", [&] { read_points(empty, nullptr, coarse); });
  const PointSet merged = read_merged({empty, source_file(kFile)}, nullptr, coarse);
  EXPECT_EQ(merged.size(), 24u);
  EXPECT_TRUE(merged.has_colors());
  EXPECT_THROW(read_merged({empty, empty}, nullptr, coarse), FileError);
}

TEST(Copc, BadHierarchies) {
  const Folder folder;
  const std::string good = slurp(source_file(kFile));
  const std::size_t info = 375 + 54, root = load_number<std::uint64_t>(good, info + 40);
  const std::string name = folder / "a.copc.laz";
  const auto refuse = [&](std::size_t at, const std::string& part, const std::string& cause) {
    folder.put("a.copc.laz", std::string(good).replace(at, part.size(), part));
    expect_file_error(name, cause, [&] { read_points(name, nullptr, {.resolution = 1e-9}); });
  };
  refuse(info + 40, raw(std::uint64_t{1} << 60), "malformed COPC hierarchy: it refers to bytes");
  refuse(info + 48, raw(~std::uint64_t{0}), "malformed COPC hierarchy: it refers to bytes");
  refuse(root, raw(std::int32_t{-1}), "a node is outside of the octree");
  refuse(root + 4, raw(std::int32_t{77}), "a node is outside of the octree");
  refuse(root + 28, raw(std::int32_t{-7}), "a node is outside of the octree");
  refuse(root + 28, raw(std::int32_t{0x7ffffff}), "points cannot be in");
  refuse(root + 24, raw(std::int32_t{0x7fffffff}), "it refers to bytes");
  refuse(root + 16, raw(root) + raw(std::int32_t{64}) + raw(std::int32_t{-1}), "a page refers to itself");
  refuse(root + 16, good.substr(root + 48, 8), "two nodes have the same bytes");
}

/// Terrain of 60,000 points with attributes; a corner with 40 times the density of the rest.
PointSet written_terrain() {
  PointSet points;
  points.origin = {636000, 849000, 400};
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<std::uint16_t> intensity;
  std::vector<double> times;
  for (int i = 0; i < 60000; ++i) {
    const double size = i % 2 ? 1000 : 160, x = size * uniform(random), y = size * uniform(random);
    const auto cents = [](double v) { return static_cast<float>(std::round(v * 100) / 100); };
    points.positions.push_back({cents(x), cents(y), cents(20 * std::sin(x / 90) + 10 * std::cos(y / 70))});
    intensity.push_back(static_cast<std::uint16_t>(i));
    times.push_back(1000 + 0.001 * i);
    points.colors.push_back({static_cast<std::uint8_t>(i), 7, static_cast<std::uint8_t>(i >> 8)});
  }
  points.attributes.set("intensity", std::move(intensity));
  points.attributes.set("gps_time", std::move(times));
  return points;
}

TEST(CopcWriter, KeepsAllPointsInAnOctree) {
  const Folder folder;
  const PointSet given = written_terrain();
  const std::string name = folder / "a.copc.laz";
  write_points(name, given);
  ReadReport report;
  const PointSet all = read_points(name, &report);
  EXPECT_EQ(report.format, "COPC, LAZ 1.4");
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_EQ(rows_of(all), rows_of(given));
  EXPECT_TRUE(all.has_colors());
  EXPECT_TRUE(all.attributes.find<double>("gps_time"));
  const std::string bytes = slurp(name);
  const io::Input in{name, bytes, report, {}, 0, {.resolution = 1e-9}};
  const io::LasHeader header = io::read_las_header(in);
  const auto info = io::laz::find_copc_info(header);
  ASSERT_TRUE(info);
  EXPECT_EQ(load_number<double>(bytes, 375 + 54 + 56), 1000);
  EXPECT_NEAR(load_number<double>(bytes, 375 + 54 + 64), 1059.999, 1e-9);
  const auto nodes = io::laz::find_copc_chunks(in, header, *info);
  EXPECT_GT(nodes.size(), 4u);
  for (const io::laz::Chunk& node : nodes) EXPECT_LE(node.points, 128u * 128 + 8 * 256 + 10000);
  // Points are in the cubes of their nodes: no selection by boxes misses any.
  for (const double at : {100.0, 159.99, 500.0, 700.0}) {
    const Box3 box{{636000.005 + at / 3, 849000.005 + at / 2, 300}, {636000.005 + at, 849000.005 + at, 500}};
    std::vector<Row> expected;
    for (const Row& row : rows_of(given))
      if (box.contains(Vec3(0.01 * static_cast<double>(row[0]), 0.01 * static_cast<double>(row[1]),
                            0.01 * static_cast<double>(row[2]))))
        expected.push_back(row);
    ASSERT_FALSE(expected.empty());
    EXPECT_EQ(rows_of(read_points(name, nullptr, {.box = box})), expected) << at;
  }
  // The root covers the terrain evenly: every cell of 40 × 40 that has points has some there.
  const auto cells = [](const PointSet& points) {
    std::set<std::pair<int, int>> found;
    for (const Vec3f& p : points.positions) {
      const Vec3 q = points.origin + Vec3(p);
      found.insert({static_cast<int>((q.x - 636000) / 40), static_cast<int>((q.y - 849000) / 40)});
    }
    return found;
  };
  const PointSet root = read_points(name, nullptr, {.resolution = info->spacing});
  EXPECT_LT(root.size(), given.size() / 2);
  EXPECT_EQ(cells(root), cells(given));
  std::size_t least = root.size();
  for (double spacing = info->spacing / 2; spacing > info->spacing / 20; spacing /= 2) {
    const std::size_t size = read_points(name, nullptr, {.resolution = spacing}).size();
    EXPECT_GE(size, least);
    least = size;
  }
  EXPECT_EQ(least, given.size());
}

TEST(CopcWriter, WritesFewAndEqualPoints) {
  const Folder folder;
  PointSet one;
  one.positions = {{1, 2, 3}};
  write_points(folder / "one.copc.laz", one);
  EXPECT_EQ(read_points(folder / "one.copc.laz").size(), 1u);
  PointSet same;
  same.positions.assign(30000, {5, 5, 5});
  write_points(folder / "same.copc.laz", same);
  EXPECT_EQ(read_points(folder / "same.copc.laz").size(), 30000u);
}

// Other programs read the field of angles, and extra bytes of one number.
TEST(CopcWriter, UsesWhatOtherProgramsRead) {
  const Folder folder;
  PointSet points;
  points.positions = {{1, 2, 3}, {4, 5, 6}};
  points.attributes.set("scan_angle", std::vector<float>{-7, 10.5f});
  points.attributes.set("flow", std::vector<float>{1, 2, 3, 4, 5, 6}, 3);
  auto system = std::make_shared<ReferenceSystem>();
  system->geo_keys = {1, 1, 0, 1, 1024, 0, 1, 32767};
  points.reference = system;
  const std::string name = folder / "a.copc.laz";
  write_points(name, points);
  const PointSet read = read_points(name);
  ASSERT_EQ(read.size(), 2u);
  const Attribute* const angle = read.attributes.find("scan_angle");
  ASSERT_TRUE(angle);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(angle->number(i), read.positions[i].x < 2 ? -7 : 10.5, 0.0031);
  std::size_t components = 0;
  for (const Attribute& a : read.attributes) components += a.name.starts_with("flow") && a.components == 1 ? 1 : 0;
  EXPECT_EQ(components, 3u);
  EXPECT_NE(io::system_remark(name, system.get()).find("WKT"), std::string::npos);
  EXPECT_EQ(io::system_remark(folder / "a.laz", system.get()), "");
}

TEST(CopcOracle, ReadsWrittenOctrees) {
  const Folder folder;
  const PointSet given = written_terrain();
  const std::string name = folder / "a.copc.laz";
  write_points(name, given);
  const double spacing = load_number<double>(slurp(name), 375 + 54 + 32);
  for (const int level : {0, 1, 20}) {
    bool absent = false;
    std::istringstream theirs(run_oracle(
        "copc.mjs", "'" + name + "' " + std::to_string(level) + " 636050 849040 300 636400 849300 500", absent));
    if (absent) GTEST_SKIP() << "node or its package copc is not installed: scripts/install-deps oracles";
    std::vector<Row> rows;
    for (double x, y, z, i; theirs >> x >> y >> z >> i;)
      rows.push_back({std::lround(x * 100), std::lround(y * 100), std::lround(z * 100), std::lround(i)});
    std::sort(rows.begin(), rows.end());
    ASSERT_GT(rows.size(), 0u);
    const ReadOptions part{.box = Box3{{636050, 849040, 300}, {636400, 849300, 500}},
                           .resolution = std::ldexp(spacing, -level)};
    EXPECT_EQ(rows_of(read_points(name, nullptr, part)), rows) << level;
  }
}

TEST(CopcOracle, AgreesWithCopcOfNpm) {
  for (const int level : {0, 1, 9}) {
    bool absent = false;
    const std::string arguments =
        "'" + source_file(kFile) + "' " + std::to_string(level) + " 636500 849500 410 637500 851500 440";
    std::istringstream theirs(run_oracle("copc.mjs", arguments, absent));
    if (absent) GTEST_SKIP() << "node or its package copc is not installed: scripts/install-deps oracles";
    std::vector<Row> rows;
    for (double x, y, z, i; theirs >> x >> y >> z >> i;)
      rows.push_back({std::lround(x * 100), std::lround(y * 100), std::lround(z * 100), std::lround(i)});
    std::sort(rows.begin(), rows.end());
    ASSERT_GT(rows.size(), 0u);
    const std::string bytes = slurp(source_file(kFile));
    const double spacing = load_number<double>(bytes, 375 + 54 + 32);
    EXPECT_EQ(rows_of(read_points(source_file(kFile), nullptr, {.box = kBox, .resolution = spacing / (1 << level)})),
              rows);
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
