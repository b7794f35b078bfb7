// Wavefront OBJ: v (with colours on the line), vn, f in all its forms, and l; groups and materials are skipped.
#include <fmt/core.h>

#include "sansmesh/core/number_words.h"
#include "sansmesh/io/color_bytes.h"
#include "sansmesh/io/meshes/face_sink.h"
#include "sansmesh/io/meshes/line_input.h"
#include "sansmesh/io/points/assemble_points.h"
#include "sansmesh/io/points/columns.h"
#include "sansmesh/io/readers.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {
namespace {

class ObjReader {
 public:
  explicit ObjReader(const Input& in) : in_(in), faces_(in, points_.triangles) {}

  PointSet read() {
    scan();
    if (positions_.empty()) in_.fail("holds no points (no line 'v x y z')");
    faces_.done();
    const std::size_t n = positions_.size();
    store_positions(in_, points_, n, [&](std::size_t i) { return positions_[i]; });
    assign_normals();
    assign_colors();
    finish(in_, points_);
    if (textures_) in_.unread("texture coordinates");
    if (materials_) in_.unread("materials");
    if (groups_) in_.unread("groups of faces");
    if (has_lines_) in_.unread("lines");
    return std::move(points_);
  }

  PolylineSet read_lines() {
    wants_lines_ = true;
    scan();
    PolylineSet lines;
    std::vector<Vec3> positions;
    for (const std::vector<std::int64_t>& line : lines_) {
      for (const std::int64_t v : line) {
        if (v >= static_cast<std::int64_t>(positions_.size()))
          in_.fail(fmt::format("a line refers to vertex {}, but there are only {}", grouped(v + 1),
                               grouped(positions_.size())));
        positions.push_back(positions_[static_cast<std::size_t>(v)]);
      }
      lines.offsets.push_back(positions.size());
    }
    place_lines(lines, positions);
    return lines;
  }

 private:
  void scan() {
    TextScanner text(in_.bytes);
    std::string joined;
    while (!text.at_end()) {
      std::string_view line = text.line();
      ++line_;
      if (!line.empty() && line.back() == '\\') {  // continued on the next line
        joined.clear();
        while (!line.empty() && line.back() == '\\' && !text.at_end()) {
          joined.append(line.substr(0, line.size() - 1)).push_back(' ');
          line = text.line();
          ++line_;
        }
        joined.append(line);
        line = joined;
      }
      TextScanner words(line);
      const std::string_view key = words.word();
      if (key == "v")
        vertex(words);
      else if (key == "vn")
        normal(words);
      else if (key == "f" || key == "fo")
        face(words);
      else if (key == "l")
        polyline(words);
      else
        other(key);
    }
  }

  [[noreturn]] void malformed(const std::string& what) const {
    in_.fail(fmt::format("line {}: {}", grouped(line_), what));
  }

  /// Reports skipped elements that may matter.
  void other(std::string_view key) {
    textures_ |= key == "vt";
    materials_ |= key == "usemtl";
    groups_ |= key == "g" || key == "o" || key == "s";
  }

  void polyline(TextScanner& words) {
    has_lines_ = true;
    if (!wants_lines_) return;
    lines_.emplace_back();
    for (std::string_view word = words.word(); !word.empty() && word.front() != '#'; word = words.word()) {
      std::int64_t v = 0;
      if (!TextScanner(word).number(v)) malformed(fmt::format("'{}' is not a vertex of a line", word.substr(0, 40)));
      lines_.back().push_back(resolve(v, positions_.size(), "vertex"));
    }
    if (lines_.back().empty()) lines_.pop_back();
  }

  void vertex(TextScanner& words) {
    double v[8];
    int count = 0;
    while (count < 8 && words.number(v[count])) ++count;
    if (count < 3) malformed("a vertex needs three coordinates");
    positions_.push_back({v[0], v[1], v[2]});
    if (count >= 6) {
      colors_.resize(positions_.size() - 1);  // earlier vertices have no colour: black
      colors_.push_back({v[3], v[4], v[5]});
    }
  }

  void normal(TextScanner& words) {
    Vec3 n;
    if (!words.vector(n)) malformed("a normal needs three components");
    normals_.push_back(Vec3f(n));
  }

  /// Maps indices 1, 2, … and -1 (the last), -2, … to 0, 1, …
  std::int64_t resolve(std::int64_t index, std::size_t count, const char* what) const {
    const std::int64_t n = static_cast<std::int64_t>(count);
    if (index == 0 || index < -n)
      malformed(fmt::format("there is no {} {} here ({} so far)", what, index, grouped(count)));
    return index > 0 ? index - 1 : n + index;
  }

  void face(TextScanner& words) {
    corners_.clear();
    for (std::string_view word = words.word(); !word.empty(); word = words.word()) {
      if (word.front() == '#') break;
      TextScanner parts(word);
      std::int64_t v = 0, ignored = 0, vn = 0;
      if (!parts.number(v)) malformed(fmt::format("'{}' is not a corner of a face", word.substr(0, 40)));
      const auto slash = [&] {
        return !parts.at_end() && *parts.position() == '/' && (parts = TextScanner(parts.rest().substr(1)), true);
      };
      if (slash()) {
        parts.number(ignored);
        if (slash()) parts.number(vn);
      }
      if (!parts.at_end()) malformed(fmt::format("'{}' is not a corner of a face", word.substr(0, 40)));
      const std::int64_t corner = resolve(v, positions_.size(), "vertex");
      corners_.push_back(corner);
      if (vn != 0) uses_.push_back({corner, resolve(vn, normals_.size(), "normal")});
    }
    faces_.add_polygon(corners_);
  }

  /// A vertex receives a normal if all faces around it agree (within 2.5 degrees); at creases they do not.
  void assign_normals() {
    const std::size_t n = positions_.size();
    if (uses_.empty()) {
      if (points_.triangles.empty() && normals_.size() == n) points_.normals = normals_;
      return;
    }
    points_.normals.assign(n, {});
    std::vector<char> conflict(n, 0);
    for (const auto& [v, vn] : uses_) {
      if (vn >= static_cast<std::int64_t>(normals_.size())) {
        in_.fail(fmt::format("a face refers to normal {}, but there are only {}", grouped(vn + 1),
                             grouped(normals_.size())));
      }
      if (v >= static_cast<std::int64_t>(n)) continue;  // `finish` reports it
      const Vec3f candidate = normals_[static_cast<std::size_t>(vn)];
      Vec3f& normal = points_.normals[static_cast<std::size_t>(v)];
      if (normal == Vec3f{})
        normal = candidate;
      else if (normal != candidate && dot(normalized(Vec3(normal)), normalized(Vec3(candidate))) < 0.999)
        conflict[v] = 1;
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (conflict[i]) points_.normals[i] = {};
    }
    if (std::find(conflict.begin(), conflict.end(), 1) != conflict.end())
      in_.unread("normals of vertices whose faces have different ones");
  }

  void assign_colors() {
    if (colors_.empty()) return;
    colors_.resize(positions_.size());
    double largest = 0;
    for (const Vec3& c : colors_) largest = std::max({largest, c.x, c.y, c.z});
    const double scale = color_scale(largest, true);
    points_.colors.reserve(colors_.size());
    for (const Vec3& c : colors_) {
      points_.colors.push_back({to_byte(c.x, scale), to_byte(c.y, scale), to_byte(c.z, scale)});
    }
  }

  const Input& in_;
  PointSet points_;
  FaceSink faces_;
  std::vector<Vec3> positions_;
  std::vector<Vec3> colors_;
  std::vector<Vec3f> normals_;
  std::vector<std::array<std::int64_t, 2>> uses_;  ///< (vertex, normal) of every corner with a normal
  std::vector<std::int64_t> corners_;
  std::uint64_t line_ = 0;
  std::vector<std::vector<std::int64_t>> lines_;  ///< vertices of each line
  bool wants_lines_ = false, has_lines_ = false, textures_ = false, materials_ = false, groups_ = false;
};

}  // namespace

PolylineSet read_obj_lines(const Input& in) {
  in.report.format = "OBJ";
  return ObjReader(in).read_lines();
}

PointSet read_obj(const Input& in) {
  in.report.format = "OBJ";
  return ObjReader(in).read();
}

}  // namespace sansmesh::inline v1::io
