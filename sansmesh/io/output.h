// Common parts of the writers: atomic output of files, and fast formatting of rows.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::io {

/// Writes the joined parts into `file` (gzipped if its name ends in ".gz"), as part of the thread's OutputBatch or of a
/// new one. Throws FileError and then leaves an existing file untouched.
void write_whole(const std::string& file, const std::vector<std::string>& parts);
void write_parts(const std::string& file, const std::vector<std::string_view>& parts);
/// The same without gzip.
void write_bytes(const std::string& file, const std::vector<std::string_view>& parts);

/// Appends the bytes that `row(i, p)` writes at p for i in [0, n), formatted in parallel and joined in order. `row`
/// returns the new end, at most `most` bytes further.
template <class Row>
void append_rows(std::vector<std::string>& parts, std::size_t n, std::size_t most, Row&& row) {
  const std::size_t chunk = 1 << 13;
  const std::size_t first_part = parts.size();
  parts.resize(first_part + (n + chunk - 1) / chunk);
  parallel_for(first_part, parts.size(), 1, [&](std::size_t c) {
    const std::size_t first = (c - first_part) * chunk;
    const std::size_t last = first + chunk < n ? first + chunk : n;
    std::string& text = parts[c];
    text.resize((last - first) * most);
    char* p = text.data();
    for (std::size_t i = first; i < last; ++i) p = row(i, p);
    text.resize(static_cast<std::size_t>(p - text.data()));
    text.shrink_to_fit();
  });
}

/// The most characters that a number takes as written below.
inline constexpr std::size_t number_width = 48;

template <class T>
inline char* put(char* p, T value) {
  return std::to_chars(p, p + number_width, value).ptr;
}
inline char* put(char* p, char c) { return *p = c, p + 1; }
inline char* put(char* p, const char* s) { return std::copy_n(s, std::strlen(s), p); }

template <class T>
inline char* put_bytes(char* p, const T& value) {
  return static_cast<char*>(std::memcpy(p, &value, sizeof(T))) + sizeof(T);
}

/// Common data of meshes and clouds, which must outlive this. Clouds are written without their triangles.
struct OutputContent {
  explicit OutputContent(const TriangleMesh& mesh);
  explicit OutputContent(const PointSet& points);

  const Vec3& origin;
  const std::vector<Vec3f>& positions;
  const std::vector<Vec3f>& normals;
  const std::vector<std::array<std::uint8_t, 3>>& colors;
  const AttributeTable& attributes;
  const std::vector<Triangle>& triangles;
  const AttributeTable& triangle_attributes;
  const ReferenceSystem* reference = nullptr;  ///< null if unknown
};

/// Converts stored positions to output coordinates: world = origin + position.
class WorldCoordinates {
 public:
  WorldCoordinates(const Vec3& origin, const std::vector<Vec3f>& positions);

  /// Whether single precision would move a position by more than 1e-7 of the cloud's extent (never without an origin).
  bool needs_double() const { return float_loss_ > 1e-7; }
  /// Largest error of single precision as a fraction of the extent.
  double float_loss() const { return float_loss_; }
  Vec3 world(std::size_t i) const { return origin_ + Vec3(positions_[i]); }
  Vec3f world_float(std::size_t i) const { return Vec3f(world(i)); }

  /// Writes the three coordinates with `separator` between them: without an origin the shortest text that reads back as
  /// the same floats, otherwise as many decimals as resolve 2^-26 of the extent.
  char* put(char* p, std::size_t i, char separator) const;

 private:
  Vec3 origin_;
  const std::vector<Vec3f>& positions_;
  bool shifted_ = false;
  double float_loss_ = 0;
  int decimals_ = 0;
};

// Writers, one per format. Each returns the parts of the file.
std::vector<std::string> mesh_to_ply(const TriangleMesh& mesh, const WriteOptions& options);
std::vector<std::string> mesh_to_obj(const TriangleMesh& mesh, const WriteOptions& options);
std::vector<std::string> mesh_to_stl(const TriangleMesh& mesh, const WriteOptions& options);
std::vector<std::string> mesh_to_off(const TriangleMesh& mesh, const WriteOptions& options);
std::vector<std::string> mesh_to_glb(const TriangleMesh& mesh, const WriteOptions& options);
std::vector<std::string> mesh_to_vtp(const TriangleMesh& mesh, const WriteOptions& options);
std::vector<std::string> points_to_ply(const PointSet& points, const WriteOptions& options);
std::vector<std::string> points_to_obj(const PointSet& points, const WriteOptions& options);
std::vector<std::string> points_to_xyz(const PointSet& points, const WriteOptions& options);
std::vector<std::string> points_to_csv(const PointSet& points, const WriteOptions& options);
std::vector<std::string> points_to_pcd(const PointSet& points, const WriteOptions& options);
std::vector<std::string> points_to_las(const PointSet& points, const WriteOptions& options);
std::vector<std::string> points_to_laz(const PointSet& points, const WriteOptions& options);
std::vector<std::string> points_to_copc(const PointSet& points, const WriteOptions& options);
std::vector<std::string> points_to_vtp(const PointSet& points, const WriteOptions& options);

std::vector<std::string> lines_to_vtp(const PolylineSet& lines, const WriteOptions& options);
std::vector<std::string> lines_to_ply(const PolylineSet& lines, const WriteOptions& options);
std::vector<std::string> lines_to_csv(const PolylineSet& lines, const WriteOptions& options);

}  // namespace sansmesh::inline v1::io
