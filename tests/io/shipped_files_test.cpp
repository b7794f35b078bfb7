// Files by other programs (tests/data, examples/data): the readers' results agree with an independent decoding of the
// files here, or with their known shape.
#include <algorithm>
#include <limits>

#include "io_test_tools.h"
#include "support/mesh_checks.h"
#include "support/places.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

std::string shipped(const std::string& name) { return source_file("tests/data/" + name); }

Vec3 world_position(const PointSet& p, std::size_t i) { return p.origin + Vec3(p.positions[i]); }

template <class T>
T value_at(const std::string& bytes, std::size_t at) {
  T value{};
  EXPECT_LE(at + sizeof(T), bytes.size());
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

/// Volume enclosed by the triangles; positive if they are counter-clockwise seen from outside.
double volume(const TriangleMesh& mesh) {
  double six = 0;
  for (const Triangle& t : mesh.triangles)
    six += dot(Vec3(mesh.vertices[t[0]]), cross(Vec3(mesh.vertices[t[1]]), Vec3(mesh.vertices[t[2]])));
  return six / 6;
}

Vec3 extent(const TriangleMesh& mesh) {
  Box3f box;
  for (const Vec3f& v : mesh.vertices) box.extend(v);
  return Vec3(box.size());
}

class LasByOthers : public ::testing::TestWithParam<const char*> {};

/// The points are the integers of the records, scaled and moved, and are in the box of the header.
TEST_P(LasByOthers, HoldsWhatItsRecordsSay) {
  const std::string file = shipped(GetParam()), bytes = slurp(file);
  ASSERT_GT(bytes.size(), 375u);
  ReadReport report;
  const PointSet p = read_points(file, &report);
  EXPECT_EQ(report.format, "LAS 1." + std::to_string(value_at<std::uint8_t>(bytes, 25)));
  EXPECT_TRUE(report.warnings.empty());
  ASSERT_EQ(p.size(), value_at<std::uint32_t>(bytes, 107));
  const std::size_t data = value_at<std::uint32_t>(bytes, 96), record = value_at<std::uint16_t>(bytes, 105);
  // Positions are single precision relative to the origin.
  const double rounding = norm(Vec3(bounds(p).size())) * 0x1p-23;
  for (std::size_t k = 0; k < 3; ++k) {
    const double scale = value_at<double>(bytes, 131 + 8 * k), offset = value_at<double>(bytes, 155 + 8 * k);
    double low = std::numeric_limits<double>::max(), high = -low;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const double x = value_at<std::int32_t>(bytes, data + record * i + 4 * k) * scale + offset;
      ASSERT_NEAR(world_position(p, i)[k], x, rounding) << i;
      low = std::min(low, world_position(p, i)[k]), high = std::max(high, world_position(p, i)[k]);
    }
    // Writers round or truncate the coordinates, and may round the box as well: one step each.
    EXPECT_NEAR(high, value_at<double>(bytes, 179 + 16 * k), 2 * scale + rounding);
    EXPECT_NEAR(low, value_at<double>(bytes, 187 + 16 * k), 2 * scale + rounding);
  }
  const unsigned format = value_at<std::uint8_t>(bytes, 104);
  EXPECT_EQ(p.has_colors(), format == 2 || format == 3 || format == 5 || format == 7 || format == 8);
}

INSTANTIATE_TEST_SUITE_P(Files, LasByOthers, ::testing::Values("simple.las", "test1_4.las"), [](const auto& name) {
  return std::string(name.param).substr(0, std::string(name.param).find('.'));
});

TEST(ShippedFiles, PcdOfSixteenFields) {
  const std::string file = shipped("autzen-utm.pcd"), bytes = slurp(file);
  const PointSet p = read_points(file);
  ASSERT_EQ(p.size(), 1065u);
  ASSERT_EQ(p.colors.size(), 1065u);
  // SIZE 8 8 8 2 1 1 1 1 1 4 1 2 8 2 2 2: coordinates first, colours last.
  const std::size_t record = 52, data = bytes.find("DATA binary\n") + 12;
  ASSERT_EQ(bytes.size(), data + 1065 * record);
  unsigned brightest = 0;
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      brightest = std::max<unsigned>(brightest, value_at<std::uint16_t>(bytes, data + i * record + 46 + 2 * k));
  ASSERT_LE(brightest, 255u) << "the file holds bytes in words";
  for (std::size_t i = 0; i < p.size(); ++i) {
    const std::size_t at = data + i * record;
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_NEAR(world_position(p, i)[k], value_at<double>(bytes, at + 8 * k), 1e-4) << i;
      ASSERT_EQ(p.colors[i][k], value_at<std::uint16_t>(bytes, at + 46 + 2 * k)) << i;
    }
  }
}

TEST(ShippedFiles, TableWithColoursAndLargeCoordinates) {
  const std::string file = shipped("points_cloudcompare.xyz");
  const PointSet p = read_points(file);
  ASSERT_EQ(p.colors.size(), p.size());
  std::istringstream text(slurp(file));
  std::size_t i = 0;
  for (double v[7]; text >> v[0] >> v[1] >> v[2] >> v[3] >> v[4] >> v[5] >> v[6]; ++i) {
    ASSERT_LT(i, p.size());
    EXPECT_LT(norm(world_position(p, i) - Vec3{v[0], v[1], v[2]}), 1e-5) << i;
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(p.colors[i][k], v[3 + k]) << i;
  }
  EXPECT_EQ(i, p.size());
  EXPECT_EQ(i, 101u);
}

TEST(ShippedFiles, CubesOfQuads) {
  struct Cube {
    const char* file;
    double edge;
  };
  for (const auto& [file, edge] : {Cube{"negative_indices.obj", 2}, Cube{"comments.off", 2 * 1.154701}}) {
    const TriangleMesh mesh = read_mesh(shipped(file));
    EXPECT_EQ(mesh.vertices.size(), 8u) << file;
    EXPECT_EQ(mesh.triangles.size(), 12u) << file;
    const Topology topology = topology_of(mesh);
    EXPECT_TRUE(topology.closed_manifold()) << file;
    EXPECT_EQ(topology.euler, 2) << file;
    EXPECT_NEAR(std::abs(volume(mesh)), edge * edge * edge, 1e-4) << file;
  }
}

TEST(ShippedFiles, LooseTriangles) {
  const std::string file = shipped("soup.stl"), bytes = slurp(file);
  const TriangleMesh mesh = read_mesh(file);
  ASSERT_EQ(mesh.triangles.size(), 100u);
  EXPECT_EQ(mesh.vertices.size(), 300u);
  for (std::size_t t = 0; t < 100; ++t)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(mesh.vertices[mesh.triangles[t][k]], value_at<Vec3f>(bytes, 84 + 50 * t + 12 + 12 * k)) << t;
}

TEST(ShippedFiles, PlateWithFiveHoles) {
  const TriangleMesh mesh = read_mesh(shipped("plate_holes.STL"));
  EXPECT_EQ(mesh.triangles.size(), 1252u);
  const Topology topology = topology_of(mesh);
  EXPECT_TRUE(topology.closed_manifold());
  EXPECT_EQ(topology.euler, 2 - 2 * 5);
  const Vec3 inches = extent(mesh) / 25.4;
  EXPECT_NEAR(inches.x, 8, 1e-5);
  EXPECT_NEAR(inches.y, 12, 1e-5);
  EXPECT_NEAR(inches.z, 0.5, 1e-5);
  EXPECT_GT(volume(mesh), 0);
  EXPECT_LT(volume(mesh), inches.x * inches.y * inches.z * std::pow(25.4, 3));
}

/// Compressed blocks in base64; the file states the range of its points' distances from the origin.
TEST(ShippedFiles, BundledScan) {
  const std::string file = source_file("examples/data/owl.vtp"), text = slurp(file);
  const PointSet p = read_points(file);
  EXPECT_EQ(p.size(), 12442u);
  EXPECT_EQ(p.triangles.size(), 24407u);
  EXPECT_FALSE(p.has_normals());
  double nearest = std::numeric_limits<double>::max(), farthest = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    nearest = std::min(nearest, norm(world_position(p, i)));
    farthest = std::max(farthest, norm(world_position(p, i)));
  }
  const auto stated = [&](const std::string& name) {
    return std::stod(text.substr(text.find(name + "=\"") + name.size() + 2));
  };
  EXPECT_NEAR(nearest, stated("RangeMin"), 1e-4);
  EXPECT_NEAR(farthest, stated("RangeMax"), 1e-4);
}

}  // namespace
}  // namespace sansmesh::inline v1
