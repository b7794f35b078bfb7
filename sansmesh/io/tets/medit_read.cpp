// Medit's .mesh (text) and .meshb (binary): keywords, each followed by a number of rows.
// Layout: P. Frey, "MEDIT: An interactive mesh visualization software", INRIA RT-0253; GMF's table of keywords.
#include <fmt/core.h>

#include <algorithm>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/io/binary.h"
#include "sansmesh/io/grids/volume_readers.h"
#include "sansmesh/io/number_text.h"
#include "sansmesh/io/tets/mesh_cells.h"

namespace sansmesh::inline v1::io {
namespace {

/// Cells: keyword, its number in binary files, corners; cells with a shape are solid.
struct MeditCells {
  const char* keyword;
  int code;
  std::size_t corners;
  bool solid;
  const char* kind;
};
constexpr MeditCells kMeditCells[] = {
    {"edges", 5, 2, false, "edge"},
    {"triangles", 6, 3, false, "triangle"},
    {"quadrilaterals", 7, 4, false, "quadrilateral"},
    {"tetrahedra", 8, 4, true, "tetrahedron"},
    {"prisms", 9, 6, true, "prism"},
    {"hexahedra", 10, 8, true, "hexahedron"},
    {"pyramids", 49, 5, true, "pyramid"},
};

/// The mesh built from either form.
class MeditMesh {
 public:
  explicit MeditMesh(const Input& in) : in_(in), cells_({"reference"}) {}

  void set_dimension(std::int64_t dimension) {
    if (dimension != 3 && dimension != 2) in_.fail(fmt::format("its dimension is {}, not 3 (nor 2)", dimension));
    dimension_ = static_cast<int>(dimension);
  }
  int dimension() const { return dimension_; }

  /// `real` and `whole` return the next number.
  template <class Real, class Whole>
  void add_vertices(std::size_t count, Real&& real, Whole&& whole) {
    if (!points_.empty()) in_.fail("has two lists of vertices");
    points_.reserve(count);
    for (std::size_t k = 0; k < count; ++k) {
      const double x = real(), y = real(), z = dimension_ == 3 ? real() : 0;
      points_.push_back({x, y, z});
      references_.push_back(static_cast<std::int32_t>(whole()));
    }
  }
  template <class Whole>
  void add_cells(const MeditCells& kind, std::size_t count, Whole&& whole) {
    for (std::size_t k = 0; k < count; ++k) {
      std::int64_t named[8] = {};
      for (std::size_t c = 0; c < kind.corners; ++c) named[c] = whole();
      const auto reference = static_cast<std::int32_t>(whole());
      if (kind.corners < 3) continue;
      // Cells may precede vertices: their corners are checked at the end.
      rows_.push_back({&kind, reference, {}});
      std::copy_n(named, 8, rows_.back().corners);
    }
    if (kind.corners < 3 && count > 0) cells_.leave_out(kind.kind, count);
  }

  GridData finished(const std::string& format) {
    if (points_.empty()) in_.fail("holds no vertices");
    GridData result;
    result.format = format;
    GridBlock& block = result.blocks.emplace_back();
    std::vector<std::uint64_t> numbers(points_.size());
    for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = k + 1;
    PointNumbers index(in_, std::move(numbers));
    for (const Row& row : rows_) {
      std::uint32_t c[8] = {};
      for (std::size_t k = 0; k < row.kind->corners; ++k) c[k] = index.at(static_cast<std::uint64_t>(row.corners[k]));
      const std::int32_t tags[] = {row.reference};
      const std::span<const std::uint32_t> corners(c, row.kind->corners);
      if (!row.kind->solid) {
        cells_.add_flat(corners, tags);
        continue;
      }
      if (row.kind->corners == 6)
        std::swap(c[1], c[2]), std::swap(c[4], c[5]);  // VTK's wedge has the opposite orientation
      cells_.add(row.kind->corners == 4   ? CellShape::tetrahedron
                 : row.kind->corners == 5 ? CellShape::pyramid
                 : row.kind->corners == 6 ? CellShape::wedge
                                          : CellShape::hexahedron,
                 corners, tags);
    }
    if (cells_.empty()) in_.fail("holds no cells");
    block.points = std::move(points_);
    index.give_to(block);
    cells_.give_to(block, result);
    if (std::any_of(references_.begin(), references_.end(), [](std::int32_t v) { return v != 0; }))
      block.point_arrays.set("reference", std::move(references_));
    return result;
  }

 private:
  struct Row {
    const MeditCells* kind;
    std::int32_t reference;
    std::int64_t corners[8];
  };
  const Input& in_;
  int dimension_ = 3;
  std::vector<Vec3> points_;
  std::vector<std::int32_t> references_;
  std::vector<Row> rows_;
  MeshCells cells_;
};

GridData read_medit_text(const Input& in) {
  NumberText text(in, in.bytes);
  MeditMesh mesh(in);
  if (lower_case(text.word()) != "meshversionformatted")
    in.fail("does not begin with 'MeshVersionFormatted', as Medit's do");
  text.whole("versions");
  bool ended = false;
  std::string last = "header";
  while (!ended && !text.at_end()) {
    if (text.at_number()) text.fail(fmt::format("more numbers than its {} should have", last));
    last = printable(lower_case(text.word()), 30);
    const char* const of = last.c_str();
    const auto real = [&] { return text.real(of); };
    const auto whole = [&] { return text.whole(of); };
    const auto cells = std::find_if(std::begin(kMeditCells), std::end(kMeditCells),
                                    [&](const MeditCells& c) { return last == c.keyword; });
    if (last == "end") {
      ended = true;
    } else if (last == "dimension") {
      mesh.set_dimension(text.whole(of));
    } else if (last == "vertices") {
      mesh.add_vertices(text.count(of, 6), real, whole);
    } else if (cells != std::end(kMeditCells)) {
      mesh.add_cells(*cells, text.count(of, 2 * cells->corners), whole);
    } else {
      while (text.at_number()) text.real(of);
    }
  }
  if (!ended) in.fail("truncated: 'End' is missing");
  return mesh.finished("Medit, text");
}

/// Parser of the binary form.
class MeditBytes {
 public:
  explicit MeditBytes(const Input& in) : in_(in) {
    if (whole4() != 1) {
      swap_ = true, at_ = 0;
      if (whole4() != 1) in.fail("does not begin with a 1, as binary files of Medit do");
    }
    version_ = whole4();
    if (version_ < 1 || version_ > 4)
      in.fail(fmt::format("is of version {} of Medit's format; 1 to 4 are read", version_));
  }
  std::int64_t whole4() {
    const char* const p = take(4);
    return swap_ ? load<std::int32_t, true>(p) : load<std::int32_t>(p);
  }
  std::int64_t whole8() {
    const char* const p = take(8);
    return swap_ ? load<std::int64_t, true>(p) : load<std::int64_t>(p);
  }
  std::int64_t whole() { return version_ > 3 ? whole8() : whole4(); }
  double real() {
    if (version_ == 1) {
      const char* const p = take(4);
      return static_cast<double>(swap_ ? load<float, true>(p) : load<float>(p));
    }
    const char* const p = take(8);
    return swap_ ? load<double, true>(p) : load<double>(p);
  }
  /// Position of the next keyword; 0 after the last.
  std::int64_t offset() { return version_ > 2 ? whole8() : whole4(); }
  void go(std::int64_t offset) {
    if (offset < 0 || static_cast<std::uint64_t>(offset) > in_.bytes.size())
      in_.fail(fmt::format("truncated, or damaged: a keyword is outside of it, at byte {} of {}", offset,
                           grouped(in_.bytes.size())));
    if (static_cast<std::size_t>(offset) < at_)
      in_.fail(fmt::format("damaged: a keyword is at byte {}, inside earlier data", offset));
    at_ = static_cast<std::size_t>(offset);
  }
  std::size_t count(const char* of, std::size_t numbers) {
    const std::int64_t n = whole();
    if (n < 0 || static_cast<std::uint64_t>(n) > (in_.bytes.size() - at_) / (4 * numbers))
      in_.fail(fmt::format("truncated: {} bytes are left for {} {}", grouped(in_.bytes.size() - at_), n, of));
    return static_cast<std::size_t>(n);
  }

 private:
  const char* take(std::size_t bytes) {
    if (in_.bytes.size() - at_ < bytes) in_.fail_truncated(bytes - (in_.bytes.size() - at_), true);
    at_ += bytes;
    return in_.bytes.data() + at_ - bytes;
  }
  const Input& in_;
  std::size_t at_ = 0;
  std::int64_t version_ = 1;
  bool swap_ = false;
};

GridData read_medit_binary(const Input& in) {
  MeditBytes bytes(in);
  MeditMesh mesh(in);
  constexpr int kDimension = 3, kVertices = 4, kEnd = 54;
  const auto whole = [&] { return bytes.whole(); };
  for (;;) {
    const std::int64_t code = bytes.whole4();
    if (code == kEnd) break;
    const std::int64_t next = bytes.offset();
    const auto cells = std::find_if(std::begin(kMeditCells), std::end(kMeditCells),
                                    [&](const MeditCells& c) { return code == c.code; });
    if (code == kDimension) {
      mesh.set_dimension(bytes.whole4());
    } else if (code == kVertices) {
      const std::size_t count = bytes.count("vertices", 3);
      mesh.add_vertices(
          count, [&] { return bytes.real(); }, whole);
    } else if (cells != std::end(kMeditCells)) {
      const std::size_t count = bytes.count(cells->keyword, cells->corners + 1);
      mesh.add_cells(*cells, count, whole);
    }
    if (next == 0) break;
    bytes.go(next);
  }
  return mesh.finished("Medit, binary");
}

}  // namespace

GridData read_medit(const Input& in) {
  TextScanner s(in.bytes);
  s.skip_space();
  const bool text = !s.at_end() && (*s.position() == '#' || (*s.position() | 0x20) == 'm');
  return text ? read_medit_text(in) : read_medit_binary(in);
}

}  // namespace sansmesh::inline v1::io
