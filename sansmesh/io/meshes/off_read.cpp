// OFF with its prefixes ST, C and N (texture, colour, normal); ascii.
#include <fmt/core.h>

#include "sansmesh/core/number_words.h"
#include "sansmesh/io/color_bytes.h"
#include "sansmesh/io/meshes/face_sink.h"
#include "sansmesh/io/points/assemble_points.h"
#include "sansmesh/io/readers.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {
namespace {

/// Lines with something on them, comments removed.
class OffLines {
 public:
  OffLines(const Input& in) : in_(in), text_(in.bytes) {}

  TextScanner next(const char* what, std::uint64_t index, std::uint64_t count) {
    while (!text_.at_end()) {
      std::string_view line = text_.line();
      ++number_;
      line = line.substr(0, line.find('#'));
      TextScanner words(line);
      words.skip_blanks();
      if (!words.at_end()) return words;
    }
    if (count == 0) in_.fail(fmt::format("truncated: the file ends before {}", what));
    in_.fail(fmt::format("truncated: ends at {} {} of {}", what, grouped(index + 1), grouped(count)));
  }
  std::uint64_t number() const { return number_; }
  std::size_t bytes_left() const { return text_.rest().size(); }

 private:
  const Input& in_;
  TextScanner text_;
  std::uint64_t number_ = 0;
};

}  // namespace

PointSet read_off(const Input& in) {
  in.report.format = "OFF";
  OffLines lines(in);
  TextScanner words = lines.next("its header", 0, 0);
  std::string_view magic = words.word();
  if (magic.size() < 3 || !magic.ends_with("OFF") || magic.size() > 8) {
    in.fail("is not an OFF file (does not begin with 'OFF')");
  }
  in.report.format = std::string(magic);
  magic.remove_suffix(3);
  bool has_colors = false, has_normals = false;
  if (magic.starts_with("ST")) magic.remove_prefix(2), in.unread("texture coordinates");  // they come last
  if (magic.starts_with("C")) magic.remove_prefix(1), has_colors = true;
  if (magic.starts_with("N")) magic.remove_prefix(1), has_normals = true;
  if (!magic.empty()) in.fail(fmt::format("unsupported kind of OFF file ('{}')", in.report.format));
  words.skip_blanks();
  if (words.rest().starts_with("BINARY")) in.fail("binary OFF files are not supported; convert it to ascii");
  if (words.at_end()) words = lines.next("its counts", 0, 0);
  std::uint64_t vertices = 0, faces = 0;
  if (!words.number(vertices) || !words.number(faces))
    in.fail("malformed OFF header: no numbers of vertices and faces");
  // A vertex takes at least "0 0 0\n" and a face "0\n".
  const std::size_t room = lines.bytes_left() + 1;
  if (vertices > room / 6 || faces > room / 2) {
    in.fail(fmt::format("truncated: announces {} vertices and {} faces, far more than its {} bytes hold",
                        grouped(vertices), grouped(faces), grouped(in.bytes.size())));
  }

  PointSet points;
  const std::size_t n = static_cast<std::size_t>(vertices);
  std::vector<Vec3> positions(n);
  std::vector<Vec3> colors;
  bool fractional = false;
  for (std::size_t i = 0; i < n; ++i) {
    TextScanner row = lines.next("vertex", i, vertices);
    Vec3& p = positions[i];
    if (!row.number(p.x) || !row.number(p.y) || !row.number(p.z)) {
      in.fail(fmt::format("line {}: a vertex needs three coordinates", grouped(lines.number())));
    }
    if (has_normals) {
      Vec3 normal;
      if (!row.number(normal.x) || !row.number(normal.y) || !row.number(normal.z)) {
        in.fail(fmt::format("line {}: a vertex of this file needs a normal", grouped(lines.number())));
      }
      points.normals.push_back(Vec3f(normal));
    }
    if (has_colors) {
      const std::string_view rest = row.rest();
      Vec3 c;
      if (!row.number(c.x) || !row.number(c.y) || !row.number(c.z)) {
        in.fail(fmt::format("line {}: a vertex of this file needs a colour", grouped(lines.number())));
      }
      fractional |= rest.find('.') != std::string_view::npos;
      colors.push_back(c);
    }
  }
  if (!colors.empty()) {
    double largest = 0;
    for (const Vec3& c : colors) largest = std::max({largest, c.x, c.y, c.z});
    const double scale = color_scale(largest, fractional);
    for (const Vec3& c : colors)
      points.colors.push_back({to_byte(c.x, scale), to_byte(c.y, scale), to_byte(c.z, scale)});
  }
  FaceSink sink(in, points.triangles);
  std::vector<std::int64_t> corners;
  bool face_colors = false;
  for (std::uint64_t f = 0; f < faces; ++f) {
    TextScanner row = lines.next("face", f, faces);
    std::uint64_t count = 0;
    if (!row.number(count) || count > row.rest().size()) {
      in.fail(fmt::format("line {}: a face needs its number of corners and as many indices", grouped(lines.number())));
    }
    corners.resize(count);
    for (std::int64_t& c : corners) {
      if (!row.number(c))
        in.fail(fmt::format("line {}: a face of {} corners lists fewer", grouped(lines.number()), count));
    }
    row.skip_blanks();
    face_colors |= !row.at_end();
    sink.add_polygon(corners);
  }
  sink.done();
  if (face_colors) in.unread("colours of faces");
  place_positions(in, points, n, [&](std::size_t i) { return positions[i]; });
  finish(in, points);
  return points;
}

}  // namespace sansmesh::inline v1::io
