// COPC: boxes and levels.
#include <algorithm>

#include "laz_test_tools.h"
#include "oracle.h"
#include "sansmesh/box.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/laz/copc.h"

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
