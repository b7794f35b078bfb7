// Merged files, and survey coordinates: millimetres over a thousand kilometres.
#include <cmath>
#include <iomanip>
#include <limits>

#include "io_test_tools.h"
#include "sample_files.h"
#include "support/las_file.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

const Vec3 kFar{1234567.891, -5432109.877, 321.005};

/// Positions in integer millimetres, within a kilometre.
std::vector<std::array<std::int32_t, 3>> millimetres(std::size_t n) {
  std::mt19937 random(3);
  std::vector<std::array<std::int32_t, 3>> places(n);
  for (auto& p : places)
    for (std::int32_t& c : p) c = static_cast<std::int32_t>(random() % 1000000);
  return places;
}

Vec3 far_place(const std::array<std::int32_t, 3>& p) { return kFar + Vec3{0.001 * p[0], 0.001 * p[1], 0.001 * p[2]}; }

std::string digits(const Vec3& p) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << p.x << ' ' << p.y << ' ' << p.z << '\n';
  return text.str();
}

/// A LAS file, a table and a PLY of the same points.
std::vector<std::string> put_far(const Folder& folder, const std::vector<std::array<std::int32_t, 3>>& places) {
  LasFile las{.format = 1, .offset = kFar};
  std::string table;
  PlyElement vertices("vertex", {"double x", "double y", "double z"});
  for (const auto& p : places) {
    las.points.push_back({.x = p[0], .y = p[1], .z = p[2]});
    const Vec3 x = far_place(p);
    table += digits(x);
    vertices.row({x.x, x.y, x.z});
  }
  return {folder.put("far.las", las.bytes()), folder.put("far.xyz", table),
          folder.put("far.ply", make_ply(Ply::little, {vertices})),
          folder.put("far_text.ply", make_ply(Ply::ascii, {vertices}))};
}

double worst_error(const PointSet& p, const std::vector<std::array<std::int32_t, 3>>& places, std::size_t first = 0) {
  double worst = 0;
  for (std::size_t i = 0; i < places.size(); ++i)
    worst = std::max(worst, norm(p.origin + Vec3(p.positions[first + i]) - far_place(places[i])));
  return worst;
}

TEST(SurveyCoordinates, KeepMillimetresInAndOut) {
  const Folder folder;
  const auto places = millimetres(3000);
  for (const std::string& file : put_far(folder, places)) {
    const PointSet p = read_points(file);
    ASSERT_EQ(p.size(), places.size()) << file;
    EXPECT_LT(worst_error(p, places), 1e-4) << file;
    for (const char* name : {"out.ply", "out.obj", "out.xyz", "out.csv", "out.vtp", "out.pcd"})
      for (const bool ascii : {false, true}) {
        write_points(folder / name, p, {.ascii = ascii});
        EXPECT_LT(worst_error(read_points(folder / name), places), 2e-4) << file << " as " << name;
      }
  }
}

/// Lines of zeros are common among survey coordinates. They must not reduce the precision of the others.
TEST(SurveyCoordinates, SurviveStraysAtTheOriginOfTheWorld) {
  const Folder folder;
  for (const std::size_t n : {30, 3000, 200000}) {
    auto places = millimetres(n);
    std::string table = digits({0, 0, 0});
    for (const auto& p : places) table += digits(far_place(p));
    table += digits({0, 0, 0});
    if (n == 30) table = table.substr(digits({0, 0, 0}).size());
    const PointSet p = read_points(folder.put("a.xyz", table));
    const std::size_t first = n == 30 ? 0 : 1;
    ASSERT_EQ(p.size(), n + 1 + first);
    EXPECT_LT(worst_error(p, places, first), 1e-4) << n;
    EXPECT_LT(norm(p.origin + Vec3(p.positions.back())), 1) << n;
  }
}

/// Two tiles share a strip, each with a separate offset, as survey software writes them. Common points coincide bit by
/// bit, so that duplicates are found, and rounding errors are no larger than for a single file.
TEST(MergedFiles, TilesHaveOneOriginAndMeetExactly) {
  const Folder folder;
  const auto places = millimetres(4000);
  LasFile west{.format = 6, .offset = {1234000, -5432000, 0}}, east{.format = 1, .offset = {1230000, -5430000, 100}};
  std::vector<std::array<std::int32_t, 3>> order, shared;
  const auto put = [](LasFile& tile, const std::array<std::int32_t, 3>& p, unsigned source) {
    const Vec3 steps = (far_place(p) - tile.offset) * 1000.0;
    tile.points.push_back({.x = static_cast<std::int32_t>(std::lround(steps.x)),
                           .y = static_cast<std::int32_t>(std::lround(steps.y)),
                           .z = static_cast<std::int32_t>(std::lround(steps.z)),
                           .source = static_cast<std::uint16_t>(source)});
  };
  for (const auto& p : places)
    if (p[0] < 600000) put(west, p, 1), order.push_back(p);
  for (const auto& p : places)
    if (p[0] >= 400000) put(east, p, 2), order.push_back(p);
  const std::string a = folder.put("west.las", west.bytes()), b = folder.put("east.las", east.bytes());
  ReadReport report;
  const PointSet all = read_merged({a, b}, &report);
  EXPECT_EQ(report.format, "2 files, LAS 1.4");
  EXPECT_TRUE(report.warnings.empty());
  ASSERT_EQ(all.size(), order.size());
  EXPECT_EQ(all.origin, read_points(a).origin);
  EXPECT_LT(worst_error(all, order), 2e-4);
  std::size_t met = 0;
  for (std::size_t i = 0; i < west.points.size(); ++i)
    for (std::size_t j = west.points.size(); j < order.size(); ++j)
      if (order[i] == order[j]) {
        ASSERT_EQ(all.positions[i], all.positions[j]);
        ++met;
      }
  EXPECT_GT(met, 500u);
  const auto& source = *all.attributes.find<std::uint16_t>("point_source_id");
  for (std::size_t i = 0; i < source.size(); ++i) ASSERT_EQ(source[i], i < west.points.size() ? 1 : 2);
}

TEST(MergedFiles, OneFileIsThatFile) {
  const Folder folder;
  for (const SampleFile& s : sample_files()) folder.put(s.name, s.content);
  for (const SampleFile& s : sample_files()) {
    const PointSet alone = read_points(folder / s.name), merged = read_merged({folder / s.name});
    EXPECT_EQ(alone.origin, merged.origin) << s.name;
    EXPECT_EQ(alone.positions, merged.positions) << s.name;
    EXPECT_EQ(alone.triangles, merged.triangles) << s.name;
    EXPECT_EQ(alone.attributes, merged.attributes) << s.name;
  }
  EXPECT_THROW(read_merged({}), ArgumentError);
}

TEST(MergedFiles, AttributesOfAllAreKept) {
  const Folder folder;
  LasFile las{.format = 1};
  for (int i = 0; i < 4; ++i)
    las.points.push_back({.x = 1000 * i, .y = 2000 * i, .z = i, .classification = 2, .scan_angle = 5});
  const std::string a = folder.put("a.las", las.bytes());
  const std::string b = folder.put("b.csv", "x,y,z,classification,height\n1,2,3,7,0.5\n4,5,6,9,1.5\n");
  const std::string c = folder.put(
      "c.ply",
      make_ply(Ply::little,
               {PlyElement("vertex", {"float x", "float y", "float z", "uchar classification"}).row({7, 8, 9, 6})}));
  ReadReport report;
  const PointSet p = read_merged({a, b, c}, &report);
  ASSERT_EQ(p.size(), 7u);
  EXPECT_LT(norm(p.origin + Vec3(p.positions[4]) - Vec3{1, 2, 3}), 1e-6);
  EXPECT_LT(norm(p.origin + Vec3(p.positions[6]) - Vec3{7, 8, 9}), 1e-6);
  // The table has classes of another type: unknown, that is 0.
  EXPECT_EQ(*p.attributes.find<std::uint8_t>("classification"), (std::vector<std::uint8_t>{2, 2, 2, 2, 0, 0, 6}));
  const auto& angle = *p.attributes.find<float>("scan_angle");
  EXPECT_EQ(angle[3], 5);
  EXPECT_TRUE(std::isnan(angle[4]) && std::isnan(angle[6]));
  const auto& height = *p.attributes.find<double>("height");
  EXPECT_EQ(height[5], 1.5);
  EXPECT_TRUE(std::isnan(height[0]) && std::isnan(height[6]));
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_EQ(report.warnings[0].find(b + ": 'classification' is of another type"), 0u) << report.warnings[0];
}

TEST(MergedFiles, NormalsAndColoursUnlessAFileHasNone) {
  const Folder folder;
  const std::string a = folder.put("a.xyz", "0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n");
  const std::string b = folder.put("b.xyz", "5 0 0 0 0 1\n6 0 0 0 1 0\n");
  const std::string c = folder.put("c.xyz", "9 9 9\n8 8 8\n");
  const PointSet two = read_merged({a, b});
  ASSERT_EQ(two.normals.size(), 5u);
  EXPECT_EQ(two.normals[4], (Vec3f{0, 1, 0}));
  ReadReport report;
  const PointSet three = read_merged({a, b, c}, &report);
  EXPECT_EQ(three.size(), 7u);
  EXPECT_TRUE(three.normals.empty());
  EXPECT_EQ(report.warnings, std::vector<std::string>{c + ": has no normals: those of the other files were left out"});
}

TEST(MergedFiles, ScannersAndFacesAreNumberedAnew) {
  const Folder folder;
  for (const SampleFile& s : sample_files()) folder.put(s.name, s.content);
  const PointSet one = read_points(folder / "little.ply");
  for (const char* name : {"little.ply", "a.conf"})
    std::filesystem::copy_file(folder / name, folder / ("copy_" + std::string(name)));
  const PointSet meshes = read_merged({folder / "little.ply", folder / "a.obj", folder / "copy_little.ply"});
  ASSERT_EQ(meshes.size(), 12u);
  ASSERT_EQ(meshes.triangles.size(), 12u);
  for (std::size_t t = 0; t < 4; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(meshes.triangles[t][k], one.triangles[t][k]);
      EXPECT_EQ(meshes.triangles[8 + t][k], one.triangles[t][k] + 8);
    }
  const PointSet scans = read_merged({folder / "a.conf", folder / "copy_a.conf"});
  ASSERT_EQ(scans.scanners.size(), 4u);
  ASSERT_EQ(scans.scan_of_point.size(), 16u);
  EXPECT_EQ(scans.scan_of_point[0], 0);
  EXPECT_EQ(scans.scan_of_point[7], 1);
  EXPECT_EQ(scans.scan_of_point[8], 2);
  EXPECT_EQ(scans.scan_of_point[15], 3);
  EXPECT_EQ(scans.scanners[2], scans.scanners[0]);
}

TEST(MergedFiles, AreScansWithNames) {
  const Folder folder;
  for (const SampleFile& s : sample_files()) folder.put(s.name, s.content);
  const std::string list = folder.put("list.xyz", "0 0 1\n1 0 1\n"), other = folder.put("other.xyz", "5 0 1\n1 5 1\n");
  const PointSet alignment = read_points(folder / "a.conf");
  ASSERT_EQ(alignment.scan_names.size(), 2u);
  // Scans with scanner positions come first, then lists with unknown viewpoints.
  const PointSet all = read_merged({list, other});
  EXPECT_EQ(all.scan_of_point, (std::vector<std::uint16_t>{0, 0, 1, 1}));
  EXPECT_EQ(all.scan_names, (std::vector<std::string>{list, other}));
  EXPECT_TRUE(all.scanners.empty());
}

TEST(MergedFiles, ErrorsNameTheFile) {
  const Folder folder;
  const std::string a = folder.put("a.xyz", "0 0 0\n1 0 0\n0 1 0\n");
  const std::string mesh = folder.put("mesh.ply", tetrahedron_ply(Ply::little));
  const std::string bad = folder.put("bad.ply", "ply\n");
  const auto refuse = [&](const std::vector<std::string>& files, const std::string& culprit, const std::string& part) {
    expect_file_error(culprit, part, [&] { read_merged(files); });
  };
  refuse({a, folder / "none.xyz"}, folder / "none.xyz", "no such file");
  refuse({a, bad, a}, bad, "truncated");
  refuse({a, mesh}, mesh, "holds faces");
  refuse({mesh, a}, a, "holds no faces");
}

}  // namespace
}  // namespace sansmesh::inline v1
