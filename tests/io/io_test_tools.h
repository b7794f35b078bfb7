// Common tools of reader and writer tests: a temporary folder, synthetic clouds and meshes.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "support/clean_text.h"

namespace sansmesh::test {

/// A new folder, removed with its content at the end of the test.
class Folder {
 public:
  Folder() {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("sansmesh_io_test_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  const std::filesystem::path& path() const { return path_; }
  /// Writes `content` and returns the full name.
  std::string put(const std::string& name, const std::string& content) const {
    std::ofstream(*this / name, std::ios::binary) << content;
    return *this / name;
  }
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::filesystem::path path_;
};

inline std::string slurp(const std::string& file) {
  std::ifstream f(file, std::ios::binary);
  std::stringstream s;
  s << f.rdbuf();
  return s.str();
}

template <class T>
std::string raw(const T& value, bool big_endian = false) {
  std::string s(reinterpret_cast<const char*>(&value), sizeof(T));
  return big_endian ? std::string(s.rbegin(), s.rend()) : s;
}

/// Runs `action`, expects a FileError whose message begins with `file` and contains `part`; returns the message.
template <class Action>
std::string expect_file_error(const std::string& file, const std::string& part, Action&& action) {
  try {
    action();
  } catch (const FileError& e) {
    const std::string message = e.what();
    EXPECT_EQ(message.rfind(file + ": ", 0), 0u) << message;
    EXPECT_NE(message.find(part), std::string::npos) << "got: " << message << "\nexpected: …" << part << "…";
    EXPECT_TRUE(is_clean(message)) << "not one printable line: " << message;
    return message;
  } catch (const std::exception& e) {
    ADD_FAILURE() << "another exception: " << e.what();
    return {};
  }
  ADD_FAILURE() << file << ": no error, expected …" << part << "…";
  return {};
}
inline std::string expect_unreadable(const std::string& file, const std::string& part) {
  return expect_file_error(file, part, [&] { read_points(file); });
}

/// A bumpy sphere of 2·m·(m-1)+2 vertices with every attribute.
inline TriangleMesh made_mesh(int m = 12, Vec3 origin = {}) {
  TriangleMesh mesh;
  mesh.origin = origin;
  const int columns = 2 * m;
  std::vector<float> quality;
  const auto vertex = [&](double theta, double phi) {
    const Vec3 d{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
    const double r = 1 + 0.1 * std::sin(3 * phi) * std::sin(theta);
    mesh.vertices.push_back(Vec3f(d * r));
    const Vec3f n = normalized(Vec3f(d));
    mesh.normals.push_back(n);
    const auto byte = [](double v) { return static_cast<std::uint8_t>(std::lround(127.5 + 127.5 * v)); };
    mesh.colors.push_back({byte(d.x), byte(d.y), byte(d.z)});
    quality.push_back(static_cast<float>(theta * 0.3 + phi));
  };
  const double pi = std::acos(-1.0);
  vertex(0, 0);
  for (int i = 1; i < m; ++i) {
    for (int j = 0; j < columns; ++j) vertex(pi * i / m, 2 * pi * j / columns);
  }
  vertex(pi, 0);
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(1 + (i - 1) * columns + j % columns); };
  const std::uint32_t south = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  for (int j = 0; j < columns; ++j) {
    mesh.triangles.push_back({0, at(1, j), at(1, j + 1)});
    for (int i = 1; i + 1 < m; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
    mesh.triangles.push_back({at(m - 1, j), south, at(m - 1, j + 1)});
  }
  mesh.attributes.set("quality", std::move(quality));
  return mesh;
}

/// The same as a cloud without triangles.
inline PointSet made_points(int m = 12, Vec3 origin = {}) {
  TriangleMesh mesh = made_mesh(m, origin);
  PointSet p;
  p.origin = origin;
  p.positions = mesh.vertices, p.normals = mesh.normals, p.colors = mesh.colors, p.attributes = mesh.attributes;
  return p;
}

inline double largest_distance(const Vec3& origin_a, const std::vector<Vec3f>& a, const Vec3& origin_b,
                               const std::vector<Vec3f>& b) {
  EXPECT_EQ(a.size(), b.size());
  double worst = a.size() == b.size() ? 0 : 1e300;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    worst = std::max(worst, norm(origin_a + Vec3(a[i]) - origin_b - Vec3(b[i])));
  }
  return worst;
}

}  // namespace sansmesh::test
