// The ways in which scanners and programs in use write their files: headers, number formats, padding, elements that
// nobody asked for. One small known shape, written as each of them writes it, comes back whole.
#include <random>

#include "sample_files.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

const TriangleMesh& shape() {
  static const TriangleMesh mesh = made_mesh(4);
  return mesh;
}
const std::vector<float>& qualities() { return *shape().attributes.find<float>("quality"); }

/// printf for one line of numbers.
template <class... T>
std::string line(const char* format, T... values) {
  char text[400];
  const int length = std::snprintf(text, sizeof text, format, values...);
  EXPECT_LT(length, 400);
  return text;
}
std::string vertices(const char* format) {
  std::string s;
  for (const Vec3f& v : shape().vertices) s += line(format, double(v.x), double(v.y), double(v.z));
  return s;
}
std::string vertices_with_normals(const char* format) {
  std::string s;
  for (std::size_t i = 0; i < shape().vertices.size(); ++i) {
    const Vec3f v = shape().vertices[i], n = shape().normals[i];
    s += line(format, double(v.x), double(v.y), double(v.z), double(n.x), double(n.y), double(n.z));
  }
  return s;
}
/// One line a triangle; `first`: the number of the first vertex.
std::string triangles(const char* format, unsigned first = 0) {
  std::string s;
  for (const Triangle& t : shape().triangles) s += line(format, t[0] + first, t[1] + first, t[2] + first);
  return s;
}
std::string facets(const char* head, const char* vertex, const char* tail) {
  std::string s;
  for (const Triangle& t : shape().triangles) {
    s += head;
    for (const std::uint32_t i : t) {
      const Vec3f v = shape().vertices[i];
      s += line(vertex, double(v.x), double(v.y), double(v.z));
    }
    s += tail;
  }
  return s;
}
std::string counts() {
  return std::to_string(shape().vertices.size()) + " " + std::to_string(shape().triangles.size()) + " 0\n";
}
std::string element(const char* name, std::size_t n) {
  return std::string("element ") + name + " " + std::to_string(n) + "\n";
}
std::string xyz_of(const char* type) {
  std::string s;
  for (const char* k : {"x", "y", "z"}) s += std::string("property ") + type + " " + k + "\n";
  return s;
}

enum Holds : unsigned { kTriangles = 1, kNormals = 2, kColors = 4, kConfidence = 8, kScanner = 16 };

struct Dialect {
  const char* name;
  const char* file;
  unsigned holds;
  std::string (*content)();
  double digits = 1e-6;  ///< how far a coordinate may be off: half of the last digit that is written, and rounding
};
void PrintTo(const Dialect& d, std::ostream* out) { *out << d.name; }

/// Raw scans of the Stanford repository: `obj_info` lines, and a grid of which most places are empty.
std::string cyberware_scan() {
  const std::size_t n = shape().vertices.size();
  std::string s =
      "ply\nformat ascii 1.0\nobj_info is_cyberware_data 1\nobj_info is_mesh 0\nobj_info num_cols 8\n"
      "obj_info num_rows 13\nobj_info echo_rgb_offset_x 0.013000\nobj_info echo_rgb_centerpixel 232\n";
  s += element("vertex", n) + xyz_of("float") + element("range_grid", 8 * 13);
  s += "property list uchar int vertex_indices\nend_header\n" + vertices("%.7g %.7g %.7g \n");
  for (std::size_t i = 0; i < 8 * 13; ++i) s += i % 4 ? "0 \n" : "1 " + std::to_string(i / 4) + " \n";
  return s;
}

std::string zippered() {
  std::string s = "ply\nformat ascii 1.0\ncomment zipper output\n" + element("vertex", shape().vertices.size());
  s += xyz_of("float") + "property float confidence\nproperty float intensity\n";
  s += element("face", shape().triangles.size()) + "property list uchar int vertex_indices\nend_header\n";
  for (std::size_t i = 0; i < shape().vertices.size(); ++i) {
    const Vec3f v = shape().vertices[i];
    s += line("%.7g %.7g %.7g %.7g 0.5 \n", double(v.x), double(v.y), double(v.z), double(qualities()[i]));
  }
  return s + triangles("3 %u %u %u \n");
}

/// Big-endian, types named by their width, as plyop leaves them.
std::string plyop() {
  std::string s = "ply\nformat binary_big_endian 1.0\ncomment created by plyop v1.1\ncomment modified by flipply\n";
  s += element("vertex", shape().vertices.size()) + xyz_of("float32") + "property float32 confidence\n";
  s += "property uint8 red\nproperty uint8 green\nproperty uint8 blue\n" + element("face", shape().triangles.size());
  s += "property list uint8 int32 vertex_indices\nend_header\n";
  for (std::size_t i = 0; i < shape().vertices.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) s += raw(shape().vertices[i][k], true);
    s += raw(qualities()[i], true);
    for (const std::uint8_t c : shape().colors[i]) s += raw(c);
  }
  for (const Triangle& t : shape().triangles) {
    s += raw(std::uint8_t{3});
    for (const std::uint32_t i : t) s += raw(static_cast<std::int32_t>(i), true);
  }
  return s;
}

std::string cgal_doubles() {
  std::string s = "ply\nformat binary_little_endian 1.0\ncomment Generated by the CGAL library\n";
  s += element("vertex", shape().vertices.size()) + xyz_of("double");
  s += "property double nx\nproperty double ny\nproperty double nz\nend_header\n";
  for (std::size_t i = 0; i < shape().vertices.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) s += raw(double(shape().vertices[i][k]));
    for (std::size_t k = 0; k < 3; ++k) s += raw(double(shape().normals[i][k]));
  }
  return s;
}

/// A cloud whose header declares faces nevertheless.
std::string vcg_without_faces() {
  return "ply\nformat ascii 1.0\ncomment VCGLIB generated\n" + element("vertex", shape().vertices.size()) +
         xyz_of("float") + element("face", 0) + "property list uchar int vertex_indices\nend_header\n" +
         vertices("%.6g %.6g %.6g \n");
}

/// All faces in a single list, strips divided by −1. Here every strip is one triangle.
std::string one_list_of_strips() {
  std::string s = "ply\nformat binary_little_endian 1.0\n" + element("vertex", shape().vertices.size());
  s += xyz_of("float") + element("tristrips", 1) + "property list int int vertex_indices\nend_header\n";
  for (const Vec3f& v : shape().vertices)
    for (std::size_t k = 0; k < 3; ++k) s += raw(v[k]);
  s += raw(static_cast<std::int32_t>(4 * shape().triangles.size()));
  for (const Triangle& t : shape().triangles) {
    for (const std::uint32_t i : t) s += raw(static_cast<std::int32_t>(i));
    s += raw(std::int32_t{-1});
  }
  return s;
}

std::string obj_of_seventeen_digits() { return vertices("v %.17g %.17g %.17g\n") + triangles("f %u %u %u\n", 1); }

/// Materials, groups, texture coordinates, smoothing.
std::string blender_obj() {
  std::string s = "# Blender v2.71 (sub 0) OBJ File: 'blank.blend'\n# www.blender.org\nmtllib model.mtl\n";
  s += "o mesh20_mesh20-geometry\n" + vertices("v %.6g %.6g %.6g\n");
  for (int i = 0; i < 5; ++i) s += "vt 0.500000 0.250000\n";
  s += "usemtl Material_001\ns off\n";
  for (const Triangle& t : shape().triangles) s += line("f %u/1 %u/2 %u/5\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return s + "o empty\ns 1\n";
}

std::string obj_between_rules() {
  return "# ======= begin mesh ======\n# tolerance = 0.0000000000000000000\n" + vertices("v %.19f %.19f %.19f\n") +
         triangles("f %u %u %u\n", 1) + "# ======== end mesh =======\n";
}

std::string off_with_gaps() {
  return "OFF\n" + counts() + "\n" + vertices("%.7g %.7g %.7g \n") + triangles("3  %u %u %u \n");
}
std::string off_of_fixed_digits() {
  return "OFF\n" + counts() + vertices("%.10f %.10f %.10f\n") + triangles("3 %u %u %u\n");
}

std::string xyz_with_normals() { return vertices_with_normals("%.6f %.6f %.6f %.6f %.6f %.6f \n"); }
std::string xyz_of_five_digits() { return vertices("%.5f %.5f %.5f\n"); }

std::string pcd_head(const std::string& size, const char* view, std::size_t n) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 "
         "1\n" +
         size + "VIEWPOINT " + view + "\nPOINTS " + std::to_string(n) + "\nDATA binary_compressed\n";
}
std::string pcd_body(const std::vector<Vec3f>& points) {
  std::string columns;
  for (std::size_t k = 0; k < 3; ++k)
    for (const Vec3f& v : points) columns += raw(v[k]);
  const std::string packed = lzf_compress(columns);
  return raw(static_cast<std::uint32_t>(packed.size())) + raw(static_cast<std::uint32_t>(columns.size())) + packed;
}

std::string pcd_cloud() {
  const std::size_t n = shape().vertices.size();
  return pcd_head("WIDTH " + std::to_string(n) + "\nHEIGHT 1\n", "0 0 0 1 0 0 0", n) + pcd_body(shape().vertices);
}

/// A depth camera's frame: rows and columns, NaN where nothing was measured, turned about its axis of view.
std::string pcd_frame() {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Vec3f> frame(8 * 13, {nan, nan, nan});
  for (std::size_t i = 0; i < shape().vertices.size(); ++i) frame[4 * i + 2] = shape().vertices[i];
  return pcd_head("WIDTH 8\nHEIGHT 13\n", "0 0 0 0 1 0 0", frame.size()) + pcd_body(frame);
}

/// Without a name, exponents of three digits.
std::string netgen_stl() {
  std::string s = facets("  facet normal 0.000000e+000 0.000000e+000 1.000000e+000\n    outer loop\n",
                         "      vertex %.6e %.6e %.6e\n", "    endloop\n  endfacet\n");
  for (std::size_t at = 0; (at = s.find_first_of("+-", at)) != std::string::npos; ++at)
    if (s[at - 1] == 'e' && std::isdigit(static_cast<unsigned char>(s[at + 3])) == 0) s.insert(at + 1, "0");
  return "solid\n" + s + "endsolid\n";
}

std::string packed_gmsh_stl() {
  return gzip("solid Created by Gmsh\n" +
              facets("facet normal 0.39788 0.122578 -0.909212\n  outer loop\n", "    vertex %.16g %.16g %.16g\n",
                     "  endloop\nendfacet\n") +
              "endsolid Created by Gmsh\n");
}

class Dialects : public ::testing::TestWithParam<Dialect> {};

TEST_P(Dialects, AreRead) {
  const Dialect& d = GetParam();
  const Folder folder;
  const PointSet p = read_points(folder.put(d.file, d.content()));
  const TriangleMesh& truth = shape();
  if (std::string(d.file).find(".stl") != std::string::npos) {
    // Vertices come in the order of the triangles.
    ASSERT_EQ(p.size(), truth.vertices.size());
    ASSERT_EQ(p.triangles.size(), truth.triangles.size());
    for (std::size_t t = 0; t < truth.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_LT(norm(p.positions[p.triangles[t][k]] - truth.vertices[truth.triangles[t][k]]), d.digits);
    return;
  }
  EXPECT_LT(largest_distance(p.origin, p.positions, {}, truth.vertices), d.digits);
  EXPECT_EQ(p.triangles, d.holds & kTriangles ? truth.triangles : std::vector<Triangle>{});
  EXPECT_EQ(p.colors, d.holds & kColors ? truth.colors : decltype(p.colors){});
  ASSERT_EQ(p.normals.size(), d.holds & kNormals ? truth.normals.size() : 0u);
  for (std::size_t i = 0; i < p.normals.size(); ++i) EXPECT_LT(norm(p.normals[i] - truth.normals[i]), 2e-6f);
  const Attribute* const confidence = p.attributes.find("confidence");
  ASSERT_EQ(confidence ? confidence->size() : 0, d.holds & kConfidence ? truth.vertices.size() : 0u);
  for (std::size_t i = 0; confidence && i < confidence->size(); ++i)
    EXPECT_NEAR(confidence->number(i), static_cast<double>(qualities()[i]), 1e-5);
  EXPECT_EQ(p.scanners.size(), d.holds & kScanner ? 1u : 0u);
}

INSTANTIATE_TEST_SUITE_P(Files, Dialects,
                         ::testing::Values(Dialect{"CyberwareScan", "a.ply", kScanner, cyberware_scan},
                                           Dialect{"Zippered", "a.ply", kTriangles | kConfidence, zippered},
                                           Dialect{"Plyop", "a.ply", kTriangles | kColors | kConfidence, plyop},
                                           Dialect{"CgalDoubles", "a.ply", kNormals, cgal_doubles},
                                           Dialect{"VcgWithoutFaces", "a.ply", 0, vcg_without_faces, 1e-5},
                                           Dialect{"OneListOfStrips", "a.ply", kTriangles, one_list_of_strips},
                                           Dialect{"SeventeenDigits", "a.obj", kTriangles, obj_of_seventeen_digits},
                                           Dialect{"Blender", "a.obj", kTriangles, blender_obj, 1e-5},
                                           Dialect{"BetweenRules", "a.obj", kTriangles, obj_between_rules},
                                           Dialect{"OffWithGaps", "a.off", kTriangles, off_with_gaps},
                                           Dialect{"OffOfFixedDigits", "a.off", kTriangles, off_of_fixed_digits},
                                           Dialect{"XyzWithNormals", "a.xyz", kNormals, xyz_with_normals, 2e-6},
                                           Dialect{"PwnWithoutCount", "a.pwn", kNormals, xyz_with_normals, 2e-6},
                                           Dialect{"XyzOfFiveDigits", "a.xyz", 0, xyz_of_five_digits, 1e-5},
                                           Dialect{"PcdCloud", "a.pcd", 0, pcd_cloud},
                                           Dialect{"PcdFrame", "a.pcd", 0, pcd_frame},
                                           Dialect{"NetgenStl", "a.stl", kTriangles, netgen_stl, 2e-6},
                                           Dialect{"GmshStl", "a.stl.gz", kTriangles, packed_gmsh_stl}),
                         [](const auto& of) { return std::string(of.param.name); });

/// Scans in frames of their own, aligned as the Stanford repository does it, meet on the shape that they were taken of:
/// the file's rotation q and translation t bring a scan's p to R(q)ᵀ p + t.
TEST(Alignment, EveryScanMeetsTheShape) {
  const Folder folder;
  std::mt19937 random(5);
  std::normal_distribution<double> gauss;
  std::string conf = "camera -0.0172 -0.0936 -0.734  -0.0461723 0.970603 -0.235889 0.0124573\n";
  const TriangleMesh whole = made_mesh(12);
  const std::size_t scans = 10, n = whole.vertices.size();
  for (std::size_t s = 0; s < scans; ++s) {
    double q[4], length = 0;
    for (double& c : q) c = gauss(random), length += c * c;
    for (double& c : q) c /= std::sqrt(length);
    const Vec3 v{q[0], q[1], q[2]}, t{gauss(random), gauss(random), gauss(random)};
    conf += line("bmesh scan%zu.ply %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", s, t.x, t.y, t.z, q[0], q[1], q[2], q[3]);
    std::string text = "ply\nformat ascii 1.0\nobj_info is_mesh 0\n" + element("vertex", n) + xyz_of("float") +
                       element("range_grid", n) + "property list uchar int vertex_indices\nend_header\n";
    for (const Vec3f& place : whole.vertices) {
      const Vec3 w = Vec3(place) - t, p = w + cross(v, cross(v, w) + w * q[3]) * 2.0;  // R(q) w
      text += line("%.9g %.9g %.9g\n", p.x, p.y, p.z);
    }
    for (std::size_t i = 0; i < n; ++i) text += "1 " + std::to_string(i) + "\n";
    folder.put("scan" + std::to_string(s) + ".ply", text);
  }
  const PointSet all = read_points(folder.put("a.conf", conf));
  ASSERT_EQ(all.size(), scans * n);
  EXPECT_EQ(all.scanners.size(), scans);
  for (std::size_t i = 0; i < all.size(); ++i) {
    ASSERT_EQ(all.scan_of_point[i], i / n);
    ASSERT_LT(norm(all.origin + Vec3(all.positions[i]) - Vec3(whole.vertices[i % n])), 1e-5) << i;
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
