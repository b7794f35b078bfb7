// Reference systems survive files of every format.
#include "io_test_tools.h"
#include "sansmesh/data/reference_system.h"
#include "sansmesh/io/formats.h"
#include "sansmesh/io/reference_text.h"
#include "support/places.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

constexpr const char* kFeet =
    R"(PROJCS["Survey",GEOGCS["NAD83",UNIT["degree",0.0174532925199433]],UNIT["US survey foot",0.304800609601219]])";

TEST(Reference, EveryFormatOfPointsKeepsIt) {
  const Folder folder;
  PointSet points = made_points(8, {500000, 4000000, 100});
  points.reference = system_of_text(kFeet);
  for (const std::string& ending : endings_written(kPoints)) {
    SCOPED_TRACE(ending);
    const std::string file = folder / ("a" + ending);
    write_points(file, points);
    const bool in_file = ending == ".las" || ending == ".laz" || ending == ".copc.laz" || ending == ".ply";
    EXPECT_EQ(std::filesystem::exists(folder / "a.prj"), !in_file);
    ReadReport report;
    const PointSet again = read_points(file, &report);
    ASSERT_TRUE(again.reference);
    EXPECT_EQ(system_words(*again.reference), "Survey, unit US survey foot");
    EXPECT_EQ(again.reference->wkt, kFeet);
    EXPECT_EQ(report.reference, again.reference);
    std::filesystem::remove(folder / "a.prj");
  }
}

TEST(Reference, EveryFormatOfMeshesKeepsIt) {
  const Folder folder;
  TriangleMesh mesh = made_mesh();
  mesh.reference = system_of_text("EPSG:32633");
  for (const std::string& ending : endings_written(kMesh)) {
    SCOPED_TRACE(ending);
    const std::string file = folder / ("a" + ending);
    write_mesh(file, mesh);
    const TriangleMesh again = read_mesh(file);
    ASSERT_TRUE(again.reference);
    EXPECT_EQ(again.reference->code, 32633);
    EXPECT_EQ(std::filesystem::exists(folder / "a.prj"), ending != ".ply" && ending != ".glb");
    std::filesystem::remove(folder / "a.prj");
  }
}

TEST(Reference, FilesOfOtherDataNeitherCountNorChange) {
  const Folder folder;
  const std::string other = "EPSG:32633\n";
  folder.put("a.prj", other);
  PointSet points = made_points(8);
  TriangleMesh mesh = made_mesh();
  const auto remark = [&](const std::string& name) { return io::system_remark(folder / name, points.reference.get()); };
  write_points(folder / "a.ply", points), write_mesh(folder / "a.glb", mesh);
  EXPECT_FALSE(read_points(folder / "a.ply").reference);
  EXPECT_FALSE(read_mesh(folder / "a.glb").reference);
  EXPECT_EQ(remark("a.ply"), "");
  EXPECT_NE(remark("a.xyz").find("a.prj beside it states a reference system (WGS 84 / UTM zone 33N"),
            std::string::npos);
  points.reference = system_of_text("EPSG:32633");
  EXPECT_EQ(remark("a.xyz"), "");
  points.reference = mesh.reference = system_of_text(kFeet);
  write_points(folder / "a.ply", points), write_points(folder / "a.xyz", points), write_mesh(folder / "a.obj", mesh);
  EXPECT_EQ(slurp(folder / "a.prj"), other);
  EXPECT_NE(remark("a.xyz").find("a.prj beside it states another reference system"), std::string::npos);
  EXPECT_EQ(remark("b.xyz"), "");
}

TEST(Reference, SystemsWithoutTextAreReportedAsLost) {
  const auto code = system_of_text("EPSG:2193");
  const std::vector<std::uint16_t> own = {1, 1, 0, 2, 1024, 0, 1, 1, 3076, 0, 1, 9001};
  const auto keys = system_of_keys(own, {}, {});
  for (const char* const file : {"a.obj", "a.stl", "a.xyz.gz"})
    EXPECT_NE(io::system_remark(file, code.get()).find("cannot hold the reference system (EPSG:2193, unit unknown)"),
              std::string::npos);
  for (const char* const file : {"a.las", "a.laz", "a.ply", "a.glb"}) {
    EXPECT_EQ(io::system_remark(file, code.get()), "");
    EXPECT_EQ(io::system_remark(file, keys.get()).empty(), std::string(file).starts_with("a.la")) << file;
  }
  EXPECT_EQ(io::system_remark("a.obj", nullptr), "");
}

TEST(Reference, LasKeepsKeysAndCodes) {
  const Folder folder;
  PointSet points = made_points(8);
  const std::vector<std::uint16_t> keys = {1, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, 2056, 3076, 0, 1, 9001};
  points.reference = system_of_keys(keys, std::vector<double>{1.5}, "a|");
  write_points(folder / "a.las", points);
  PointSet again = read_points(folder / "a.las");
  ASSERT_TRUE(again.reference);
  EXPECT_EQ(again.reference->geo_keys, keys);
  EXPECT_EQ(again.reference->geo_doubles, std::vector<double>{1.5});
  EXPECT_EQ(again.reference->geo_ascii, "a|");
  points.reference = system_of_text("EPSG:2056+5728");
  write_points(folder / "a.las", points);
  again = read_points(folder / "a.las");
  ASSERT_TRUE(again.reference);
  EXPECT_EQ(again.reference->code, 2056);
  EXPECT_EQ(again.reference->vertical_code, 5728);
}

/// WKT too long for a record is left out: the header must not promise it.
TEST(Reference, LasWithoutRoomForWktHasKeys) {
  const Folder folder;
  PointSet points = made_points(8);
  points.attributes.set("classification", std::vector<std::uint8_t>(points.size(), 100));  // LAS 1.4
  ReferenceSystem system = *system_of_text("EPSG:2056");
  for (const std::size_t length : {std::size_t{10}, std::size_t{70000}}) {
    system.wkt = R"(PROJCS[")" + std::string(length, 'a') + R"(",UNIT["metre",1]])";
    points.reference = std::make_shared<ReferenceSystem>(system);
    write_points(folder / "a.las", points);
    EXPECT_EQ(slurp(folder / "a.las")[6] & 16, length == 10 ? 16 : 0);
  }
  EXPECT_EQ(read_points(folder / "a.las").reference->code, 2056);
}

TEST(Reference, LasReportsRecordsInAnUnknownForm) {
  const Folder folder;
  PointSet points = made_points(8);
  points.reference = system_of_text(kFeet);
  write_points(folder / "a.las", points);
  std::string bytes = slurp(folder / "a.las");
  bytes.replace(bytes.find("PROJCS"), 6, "NO_WKT");
  ReadReport report;
  EXPECT_FALSE(read_points(folder.put("a.las", bytes), &report).reference);
  EXPECT_EQ(report.unread, std::vector<std::string>{"a reference system in an unknown form"});
}

/// Writes points in a system. Returns the path.
std::string put_in(const Folder& folder, const std::string& name, const std::string& system) {
  PointSet points = made_points(8);
  points.reference = system_of_text(system);
  write_points(folder / name, points);
  return folder / name;
}

TEST(Reference, DifferentSystemsAreNotReadAsOne) {
  const Folder folder;
  const auto put = [&](const std::string& name, const std::string& system) { return put_in(folder, name, system); };
  const std::string a = put("a.las", "EPSG:25832"), b = put("b.las", "EPSG:25833"), c = put("c.las", "");
  const std::string text = expect_file_error(b, "EPSG:25833", [&] { read_merged({a, b}); });
  EXPECT_NE(text.find("ETRS89 / UTM zone 32N (EPSG:25832), unit metre"), std::string::npos) << text;
  ReadReport report;
  EXPECT_EQ(read_merged({c, a}, &report).reference->code, 25832);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("c.las: states no reference system"), std::string::npos) << report.warnings[0];
}

TEST(Reference, AFileWithoutCodeDoesNotHideDifferentOnes) {
  const Folder folder;
  const auto put = [&](const std::string& name, const std::string& system) { return put_in(folder, name, system); };
  const std::string unit = put("unit.ply", "LOCAL_CS[\"\",UNIT[\"metre\",1]]"), a = put("a.ply", "EPSG:25832"),
                    b = put("b.ply", "EPSG:25833");
  const SharedSystem common = read_merged({unit, a}).reference;
  ASSERT_TRUE(common);
  EXPECT_EQ(common->code, 25832);
  expect_file_error(b, "and that of " + a + " is", [&] { read_merged({unit, a, b}); });
}

TEST(Reference, DistortingUnitsAreWarnings) {
  const Folder folder;
  PointSet points = made_points(8);
  points.reference = system_of_text("EPSG:25832");
  write_points(folder / "a.xyz", points);
  const auto warnings_with = [&](const std::string& prj) {
    folder.put("a.prj", prj);
    ReadReport report;
    read_points(folder / "a.xyz", &report);
    return report.warnings.empty() ? std::string() : report.warnings[0];
  };
  EXPECT_NE(warnings_with(R"(GEOGCS["WGS 84",UNIT["degree",0.0174532925199433]])").find("degrees"), std::string::npos);
  EXPECT_NE(warnings_with(R"(COMPD_CS["a",PROJCS["b",UNIT["metre",1]],VERT_CS["c",UNIT["foot",0.3048]]])")
                .find("another unit (foot)"),
            std::string::npos);
  EXPECT_NE(warnings_with("nonsense").find("a.prj beside it is no WKT"), std::string::npos);
  EXPECT_EQ(warnings_with(kFeet), "");
}

}  // namespace
}  // namespace sansmesh::inline v1
