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

/// Non-empty lines without comments.
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

struct OffHeader {
  bool colors = false, normals = false;
  std::uint64_t vertices = 0, faces = 0;
};

OffHeader read_off_header(const Input& in, OffLines& lines) {
  OffHeader h;
  TextScanner words = lines.next("its header", 0, 0);
  std::string_view magic = words.word();
  if (magic.size() < 3 || !magic.ends_with("OFF") || magic.size() > 8)
    in.fail("is not an OFF file (does not begin with 'OFF')");
  in.report.format = std::string(magic);
  magic.remove_suffix(3);
  if (magic.starts_with("ST")) magic.remove_prefix(2), in.unread("texture coordinates");  // they are the last columns
  if (magic.starts_with("C")) magic.remove_prefix(1), h.colors = true;
  if (magic.starts_with("N")) magic.remove_prefix(1), h.normals = true;
  if (!magic.empty()) in.fail(fmt::format("unsupported kind of OFF file ('{}')", in.report.format));
  words.skip_blanks();
  if (words.rest().starts_with("BINARY")) in.fail("binary OFF files are not supported; convert it to ascii");
  if (words.at_end()) words = lines.next("its counts", 0, 0);
  if (!words.number(h.vertices) || !words.number(h.faces))
    in.fail("malformed OFF header: no numbers of vertices and faces");
  // A vertex takes at least 6 characters ("0 0 0" and a line end), a face 2.
  const std::size_t room = lines.bytes_left() + 1;
  if (h.vertices > room / 6 || h.faces > room / 2) {
    in.fail(fmt::format("truncated: announces {} vertices and {} faces, far more than its {} bytes hold",
                        grouped(h.vertices), grouped(h.faces), grouped(in.bytes.size())));
  }
  return h;
}

/// Returns the positions; appends normals and colours to `points`.
std::vector<Vec3> read_off_vertices(const Input& in, OffLines& lines, const OffHeader& h, PointSet& points) {
  std::vector<Vec3> positions(h.vertices), colors;
  bool fractional = false;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    TextScanner row = lines.next("vertex", i, h.vertices);
    const auto take = [&](Vec3& v, const char* needs) {
      if (!row.vector(v)) in.fail(fmt::format("line {}: a vertex {}", grouped(lines.number()), needs));
    };
    take(positions[i], "needs three coordinates");
    if (h.normals) {
      Vec3 normal;
      take(normal, "of this file needs a normal");
      points.normals.push_back(Vec3f(normal));
    }
    if (h.colors) {
      fractional |= row.rest().find('.') != std::string_view::npos;
      take(colors.emplace_back(), "of this file needs a colour");
    }
  }
  double largest = 0;
  for (const Vec3& c : colors) largest = std::max({largest, c.x, c.y, c.z});
  const double scale = color_scale(largest, fractional);
  for (const Vec3& c : colors) points.colors.push_back({to_byte(c.x, scale), to_byte(c.y, scale), to_byte(c.z, scale)});
  return positions;
}

void read_off_faces(const Input& in, OffLines& lines, const OffHeader& h, PointSet& points) {
  FaceSink sink(in, points.triangles);
  std::vector<std::int64_t> corners;
  bool face_colors = false;
  for (std::uint64_t f = 0; f < h.faces; ++f) {
    TextScanner row = lines.next("face", f, h.faces);
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
}

}  // namespace

PointSet read_off(const Input& in) {
  in.report.format = "OFF";
  OffLines lines(in);
  const OffHeader header = read_off_header(in, lines);
  PointSet points;
  const std::vector<Vec3> positions = read_off_vertices(in, lines, header, points);
  read_off_faces(in, lines, header, points);
  store_positions(in, points, positions.size(), [&](std::size_t i) { return positions[i]; });
  finish(in, points);
  return points;
}

}  // namespace sansmesh::inline v1::io
