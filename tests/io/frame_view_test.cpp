// Organised clouds: rows and columns determine the visible side of a frame.
#include "sansmesh/io/points/frame_view.h"

#include <cmath>
#include <limits>
#include <optional>

#include "sample_files.h"
#include "sansmesh/points/normals/normals.h"
#include "sansmesh/points/orientation/orientation.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

constexpr std::size_t kRows = 90, kColumns = 120;
const float kMissing = std::numeric_limits<float>::quiet_NaN();

/// Depth along the ray (x to the right, y down, z = 1 forward) of a ball above a table in front of a wall, seen from
/// above at an angle; empty beyond the wall.
double depth_along(const Vec3& ray) {
  double nearest = 1e9;
  const auto plane = [&](const Vec3& n, double d) {
    const double t = d / dot(n, ray);
    if (t > 0) nearest = std::min(nearest, t);
  };
  plane({0, 0, 1}, 4);                       // the wall
  plane(normalized(Vec3{0, 1, 0.35}), 1.6);  // the table
  const Vec3 center{0.3, 0.2, 2};
  const double a = dot(ray, ray), b = dot(ray, center), inside = b * b - a * (dot(center, center) - 0.2);
  if (inside > 0) nearest = std::min(nearest, (b - std::sqrt(inside)) / a);
  return ray.x > 0.6 ? 1e9 : nearest;
}

/// A frame of a camera, moved by a rotation about x and a translation, as a PCD; `eye`: the moved camera.
struct Frame {
  std::vector<Vec3f> points;
  Vec3 eye;
};

Frame make_frame(double turn, const Vec3& shift) {
  Frame f;
  const auto moved = [&](const Vec3& p) {
    return Vec3{p.x, std::cos(turn) * p.y - std::sin(turn) * p.z, std::sin(turn) * p.y + std::cos(turn) * p.z} + shift;
  };
  f.eye = moved({0, 0, 0});
  for (std::size_t r = 0; r < kRows; ++r)
    for (std::size_t c = 0; c < kColumns; ++c) {
      const Vec3 ray{(static_cast<double>(c) - 59.5) / 90, (static_cast<double>(r) - 44.5) / 90, 1};
      const double t = depth_along(ray);
      f.points.push_back(t < 100 ? Vec3f(moved(ray * t)) : Vec3f{kMissing, kMissing, kMissing});
    }
  return f;
}

std::string pcd_of(const Frame& f, const std::string& viewpoint, bool organised = true) {
  std::string text = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH " +
                     std::to_string(organised ? kColumns : f.points.size()) + "\nHEIGHT " +
                     std::to_string(organised ? kRows : 1) + "\n" + viewpoint + "DATA ascii\n";
  char line[100];
  for (const Vec3f& p : f.points) {
    std::snprintf(line, sizeof line, "%.9g %.9g %.9g\n", static_cast<double>(p.x), static_cast<double>(p.y),
                  static_cast<double>(p.z));
    text += line;
  }
  return text;
}

std::string viewpoint(const Vec3& eye) {
  char line[100];
  std::snprintf(line, sizeof line, "VIEWPOINT %.9g %.9g %.9g 1 0 0 0\n", eye.x, eye.y, eye.z);
  return line;
}

/// Share of the estimated, oriented normals that face the eye. At depth jumps, planes through both sides may be
/// edge-on.
double share_facing(PointSet points, const Vec3& eye, OrientBy expected) {
  Progress progress;
  estimate_normals(points, {}, progress);
  EXPECT_EQ(orient_normals(points, {}, progress), expected);
  std::size_t away = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 ray = normalized(eye - points.origin - Vec3(points.positions[i]));
    away += dot(ray, Vec3(points.normals[i])) < -0.1;
  }
  return 1 - static_cast<double>(away) / static_cast<double>(points.size());
}

TEST(Frames, LookAtTheCamera) {
  const Folder folder;
  // As recorded by the camera, with the format's default viewpoint.
  const Frame own = make_frame(0, {});
  EXPECT_EQ(share_facing(read_points(folder.put("a.pcd", pcd_of(own, ""))), own.eye, OrientBy::scanner), 1);
  // Moved to a world with z up, together with the viewpoint.
  const Frame moved = make_frame(-2.0, {10, -4, 3});
  EXPECT_EQ(
      share_facing(read_points(folder.put("b.pcd", pcd_of(moved, viewpoint(moved.eye)))), moved.eye, OrientBy::scanner),
      1);
}

TEST(Frames, WithoutAViewpointRowsAndColumnsTell) {
  const Folder folder;
  const Frame moved = make_frame(-2.0, {0.4, -6, 1.5});
  // A viewpoint that was not moved together with the points, behind the wall and above the table; and no viewpoint.
  for (const char* wrong : {"VIEWPOINT 0 0 0 1 0 0 0\n", "VIEWPOINT nan 0 0 1 0 0 0\n"}) {
    ReadReport report;
    const PointSet points = read_points(folder.put("a.pcd", pcd_of(moved, wrong)), &report);
    EXPECT_TRUE(points.scanners.empty()) << wrong;
    EXPECT_EQ(report.warnings.front().find("viewpoint") != std::string::npos, wrong[10] == '0') << wrong;
    ASSERT_EQ(points.grid_normals.size(), points.size());
    EXPECT_EQ(share_facing(points, moved.eye, OrientBy::rows), 1) << wrong;
  }
}

TEST(Frames, AreNotKnownToEveryCloud) {
  const Folder folder;
  const Frame own = make_frame(0, {});
  // Without rows, the default viewpoint carries no information; another one does.
  const PointSet list = read_points(folder.put("a.pcd", pcd_of(own, viewpoint({}), false)));
  EXPECT_TRUE(list.scanners.empty());
  EXPECT_TRUE(list.grid_normals.empty());
  EXPECT_EQ(read_points(folder.put("b.pcd", pcd_of(own, viewpoint({1, 2, 3}), false))).scanners.size(), 1u);
  // Points without order have no grid.
  Frame shuffled = own;
  std::mt19937 random(1);
  std::shuffle(shuffled.points.begin(), shuffled.points.end(), random);
  EXPECT_FALSE(io::measure_frame(shuffled.points, kColumns, std::nullopt));
  // The default viewpoint carries no information for such a file, nor does one too far away for a direction.
  EXPECT_TRUE(read_points(folder.put("c.pcd", pcd_of(shuffled, viewpoint({})))).scanners.empty());
  EXPECT_TRUE(read_points(folder.put("d.pcd", pcd_of(own, viewpoint({1e39, 0, 0}), false))).scanners.empty());
  EXPECT_FALSE(io::measure_frame({}, 10, std::nullopt));
  EXPECT_FALSE(io::measure_frame(own.points, 1, std::nullopt));
}

TEST(Frames, MirroredOnesAreToldByTheViewpoint) {
  Frame f = make_frame(0, {});
  for (std::size_t r = 0; r < kRows; ++r)
    std::reverse(f.points.begin() + static_cast<std::ptrdiff_t>(r * kColumns),
                 f.points.begin() + static_cast<std::ptrdiff_t>((r + 1) * kColumns));
  const auto view = io::measure_frame(f.points, kColumns, Vec3f(f.eye));
  ASSERT_TRUE(view);
  EXPECT_TRUE(view->seen_from_eye);
  std::size_t away = 0;
  for (std::size_t i = 0; i < f.points.size(); ++i) away += dot(view->normals[i], f.points[i]) > 0;
  EXPECT_EQ(away, 0u);
}

TEST(Frames, EachFileIsAScanOfItsOwn) {
  const Folder folder;
  const Frame one = make_frame(0, {}), other = make_frame(0.5, {2, 0, 0});
  const std::string a = folder.put("a.pcd", pcd_of(one, viewpoint(one.eye))),
                    b = folder.put("b.pcd", pcd_of(other, viewpoint(other.eye))),
                    c = folder.put("c.xyz", "0 0 1\n1 0 1\n");
  const PointSet all = read_merged({a, b, c});
  ASSERT_EQ(all.scanners.size(), 2u);
  ASSERT_EQ(all.scan_of_point.size(), all.size());
  ASSERT_EQ(all.grid_normals.size(), all.size());
  EXPECT_EQ(all.scan_of_point.front(), 0);
  EXPECT_EQ(all.scan_of_point[all.size() - 3], 1);
  // Nothing of this is known for an unordered list of points.
  EXPECT_GE(all.scan_of_point.back(), all.scanners.size());
  EXPECT_EQ(all.grid_normals.back(), Vec3f{});
  EXPECT_LT(norm(Vec3(all.scanners[1]) + all.origin - other.eye), 1e-5);
}

}  // namespace
}  // namespace sansmesh::inline v1
