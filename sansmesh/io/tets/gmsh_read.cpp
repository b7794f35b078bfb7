// Gmsh's MSH, versions 2 and 4, in text and binary: sections between $Name and $EndName.
// Layout: Gmsh's reference manual, "MSH file format" and "MSH file format version 2 (Legacy)".
#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <map>
#include <string_view>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/io/binary.h"
#include "sansmesh/io/grids/volume_readers.h"
#include "sansmesh/io/number_text.h"
#include "sansmesh/io/tets/mesh_cells.h"

namespace sansmesh::inline v1::io {
namespace {

/// Numbers of a section, as text or as bytes.
class GmshNumbers {
 public:
  GmshNumbers(const Input& in, std::string_view body, bool binary, bool swap, std::size_t size_bytes)
      : in_(in), text_(in, body), rest_(body), binary_(binary), swap_(swap), size_bytes_(size_bytes) {}

  /// Four bytes in binary files.
  std::int64_t whole(const char* of) {
    if (!binary_) return text_.whole(of);
    const char* const p = take(4, of);
    return swap_ ? load<std::int32_t, true>(p) : load<std::int32_t>(p);
  }
  /// In binary files of the size in the header.
  std::uint64_t size(const char* of) {
    if (!binary_) {
      const std::int64_t n = text_.whole(of);
      if (n < 0) text_.fail(fmt::format("a negative number among its {}", of));
      return static_cast<std::uint64_t>(n);
    }
    const char* const p = take(size_bytes_, of);
    if (size_bytes_ == 4) return swap_ ? load<std::uint32_t, true>(p) : load<std::uint32_t>(p);
    return swap_ ? load<std::uint64_t, true>(p) : load<std::uint64_t>(p);
  }
  /// A number of following entries, each of at least `numbers` numbers.
  std::size_t count(const char* of, std::size_t numbers = 1) { return checked(size(of), of, numbers); }
  /// The same for entries with a count of four bytes.
  std::size_t small_count(const char* of) {
    const std::int64_t n = whole(of);
    if (n < 0) in_.fail(fmt::format("an impossible number of {1}: {0}", n, of));
    return checked(static_cast<std::uint64_t>(n), of, 1);
  }
  /// A number of entries on a line of text, also in binary files.
  std::size_t line_count(const char* of, std::size_t numbers) {
    if (!binary_) return count(of, numbers);
    NumberText head(in_, line());
    const std::int64_t n = head.whole(of);
    if (n < 0) in_.fail(fmt::format("an impossible number of {1}: {0}", n, of));
    return checked(static_cast<std::uint64_t>(n), of, numbers);
  }
  double real(const char* of) {
    if (!binary_) return text_.real(of);
    const char* const p = take(8, of);
    return swap_ ? load<double, true>(p) : load<double>(p);
  }
  /// A line of text, also in binary files.
  std::string_view line() {
    if (!binary_) return text_.line();
    TextScanner s(rest_);
    const std::string_view found = s.line();
    rest_ = s.rest();
    return found;
  }
  std::string_view rest() { return binary_ ? rest_ : text_.scanner().rest(); }

 private:
  std::size_t checked(std::uint64_t n, const char* of, std::size_t numbers) {
    const std::size_t least = numbers * (binary_ ? 4 : 2);
    if (n > (rest().size() + 1) / least)
      in_.fail(fmt::format("truncated: {} bytes are left for {} {}", grouped(rest().size()), grouped(n), of));
    return static_cast<std::size_t>(n);
  }
  const char* take(std::size_t bytes, const char* of) {
    if (rest_.size() < bytes) in_.fail(fmt::format("truncated: it ends within its {}", of));
    const char* const p = rest_.data();
    rest_.remove_prefix(bytes);
    return p;
  }

  const Input& in_;
  NumberText text_;
  std::string_view rest_;
  bool binary_, swap_;
  std::size_t size_bytes_;
};

/// Kinds of elements: their number of nodes and their conversion.
struct GmshElement {
  std::uint8_t type, nodes, corners;
  const char* name;  ///< null for solid elements, whose shape follows from the number of corners
};
constexpr GmshElement kGmshElements[] = {
    {1, 2, 2, "edge"},       {2, 3, 3, "triangle"},       {3, 4, 4, "quadrilateral"}, {4, 4, 4, nullptr},
    {5, 8, 8, nullptr},      {6, 6, 6, nullptr},          {7, 5, 5, nullptr},         {8, 3, 2, "edge"},
    {9, 6, 3, "triangle"},   {10, 9, 4, "quadrilateral"}, {11, 10, 4, nullptr},       {12, 27, 8, nullptr},
    {13, 18, 6, nullptr},    {14, 14, 5, nullptr},        {15, 1, 1, "single point"}, {16, 8, 4, "quadrilateral"},
    {17, 20, 8, nullptr},    {18, 15, 6, nullptr},        {19, 13, 5, nullptr},       {20, 9, 3, "triangle"},
    {21, 10, 3, "triangle"}, {22, 12, 3, "triangle"},     {23, 15, 3, "triangle"},    {24, 15, 3, "triangle"},
    {25, 21, 3, "triangle"}, {26, 4, 2, "edge"},          {27, 5, 2, "edge"},         {28, 6, 2, "edge"},
    {29, 20, 4, nullptr},    {30, 35, 4, nullptr},        {31, 56, 4, nullptr},       {92, 64, 8, nullptr},
    {93, 125, 8, nullptr}};

/// Arrays have a number for each node or element, but sections of data may name only a few of these.
constexpr std::uint64_t kMostNumbersPerByte = 16;

CellShape shape_of_corners(std::size_t corners) {
  return corners == 4   ? CellShape::tetrahedron
         : corners == 5 ? CellShape::pyramid
         : corners == 6 ? CellShape::wedge
                        : CellShape::hexahedron;
}

class GmshFile {
 public:
  explicit GmshFile(const Input& in) : in_(in), cells_({"physical", "entity"}) {}

  GridData read() {
    std::string_view rest = in_.bytes;
    while (const auto name = next_section(rest)) {
      if (version_ == 0 && *name != "MeshFormat") in_.fail("does not begin with $MeshFormat, as Gmsh's files do");
      const std::string end = fmt::format("$End{}", *name);
      if (*name == "MeshFormat") {
        read_format(rest);
      } else if (*name == "Entities" && version_ >= 4) {
        read_entities(rest);
      } else if (*name == "Nodes") {
        if (seen_nodes_) in_.fail("has two sections of nodes");
        read_nodes(rest);
      } else if (*name == "Elements") {
        if (seen_elements_) in_.fail("has two sections of elements");
        read_elements(rest);
      } else if (*name == "NodeData" || *name == "ElementData") {
        read_data(rest, *name == "NodeData");
      }
      if (*name == "Nodes" || *name == "Elements" || name->ends_with("Data")) {
        TextScanner s(rest);
        s.skip_space();
        if (!s.at_end() && *s.position() != '$')
          in_.fail(fmt::format("more data in its ${} than announced", printable(*name, 40)));
      }
      const std::size_t at = rest.find(end);
      if (at == std::string_view::npos) in_.fail(fmt::format("truncated: '{}' is missing", end));
      rest.remove_prefix(at + end.size());
    }
    if (!seen_nodes_) in_.fail("truncated: it holds no nodes");
    if (points_.empty()) in_.fail("holds no nodes");
    if (!seen_elements_) in_.fail("truncated: it holds no elements");
    return finished();
  }

 private:
  struct Data {
    std::string name;
    bool of_nodes;
    std::size_t components;
    std::vector<std::pair<std::uint64_t, std::vector<double>>> rows;
  };

  /// Moves past the name of the next section.
  std::optional<std::string> next_section(std::string_view& rest) const {
    TextScanner s(rest);
    for (;;) {
      s.skip_space();
      if (s.at_end()) return std::nullopt;
      if (*s.position() != '$') {
        // Text outside of sections: comments of some programs.
        s.line();
        continue;
      }
      const std::string_view line = s.line();
      rest = s.rest();
      std::string name(line.substr(1));
      while (!name.empty() && TextScanner::is_blank(name.back())) name.pop_back();
      if (name.size() > 60 || name.starts_with("End"))
        in_.fail(fmt::format("'${}' instead of a section", name.substr(0, 40)));
      return name;
    }
  }

  GmshNumbers numbers(std::string_view rest) const { return {in_, rest, binary_, swap_, size_bytes_}; }

  void read_format(std::string_view& rest) {
    TextScanner s(rest);
    int type = 0, bytes = 0;
    if (!s.number(version_) || !s.number(type) || !s.number(bytes))
      in_.fail("its format cannot be understood: $MeshFormat requires a version, 0 or 1, and a size");
    if (!(version_ >= 2 && version_ < 3) && !(version_ >= 4 && version_ < 4.15))
      in_.fail(fmt::format("is of version {} of Gmsh's format; 2, 4.0 and 4.1 are read: write it again with Gmsh",
                           version_));
    if ((type != 0 && type != 1) || (bytes != 4 && bytes != 8) || (version_ < 3 && bytes != 8))
      in_.fail("its format cannot be understood: neither text nor binary, or numbers of an unknown size");
    binary_ = type == 1;
    // Sizes of version 4.0 are unsigned long.
    size_bytes_ = static_cast<std::size_t>(bytes);
    s.line();
    rest = s.rest();
    if (!binary_) return;
    if (numbers(rest).whole("format") != 1) {
      swap_ = true;
      if (numbers(rest).whole("format") != 1) in_.fail("the number that shows its byte order is 1 in neither order");
    }
    rest.remove_prefix(4);
  }

  /// Physical groups of volumes and surfaces.
  void read_entities(std::string_view& rest) {
    GmshNumbers n = numbers(rest);
    const char* const of = "entities";
    std::size_t counts[4];
    for (std::size_t& c : counts) c = n.count(of);
    for (int dim = 0; dim < 4; ++dim) {
      for (std::size_t k = 0; k < counts[dim]; ++k) {
        const auto tag = static_cast<std::int32_t>(n.whole(of));
        const int box = dim == 0 && version_ > 4.05 ? 3 : 6;
        for (int j = 0; j < box; ++j) n.real(of);
        const std::size_t groups = n.count(of);
        for (std::size_t j = 0; j < groups; ++j) {
          const auto group = static_cast<std::int32_t>(n.whole(of));
          if (j == 0) physical_[{dim, tag}] = group;
        }
        if (dim == 0) continue;
        const std::size_t bounds = n.count(of);
        for (std::size_t j = 0; j < bounds; ++j) n.whole(of);
      }
    }
    rest = n.rest();
  }

  void add_node(std::uint64_t number, GmshNumbers& n, int parameters = 0) {
    tags_.push_back(number);
    read_node(n, parameters);
  }
  void read_node(GmshNumbers& n, int parameters) {
    const char* const of = "nodes";
    const double x = n.real(of), y = n.real(of), z = n.real(of);
    for (int k = 0; k < parameters; ++k) n.real(of);
    points_.push_back({x, y, z});
  }

  void read_nodes(std::string_view& rest) {
    seen_nodes_ = true;
    GmshNumbers n = numbers(rest);
    const char* const of = "nodes";
    if (version_ < 3) {
      const std::size_t count = n.line_count(of, 4);
      points_.reserve(count);
      for (std::size_t k = 0; k < count; ++k) add_node(static_cast<std::uint64_t>(n.whole(of)), n);
    } else {
      const std::size_t blocks = n.count(of), all = n.count(of, 3);
      if (version_ > 4.05) n.size(of), n.size(of);
      points_.reserve(all);
      for (std::size_t b = 0; b < blocks; ++b) {
        const std::int64_t first = n.whole(of), second = n.whole(of);
        const int dim = static_cast<int>(version_ > 4.05 ? first : second);
        const bool parametric = n.whole(of) != 0;
        const int parameters = parametric ? std::clamp(dim, 0, 3) : 0;
        const std::size_t count = n.count(of, 4);
        if (version_ > 4.05) {
          for (std::size_t k = 0; k < count; ++k) tags_.push_back(n.size(of));
          for (std::size_t k = 0; k < count; ++k) read_node(n, parameters);
        } else {
          for (std::size_t k = 0; k < count; ++k) add_node(static_cast<std::uint64_t>(n.whole(of)), n, parameters);
        }
      }
      if (points_.size() != all)
        in_.fail(fmt::format("holds {} nodes, not {} as announced", grouped(points_.size()), grouped(all)));
    }
    numbers_.emplace(in_, tags_);
    rest = n.rest();
  }

  const GmshElement& element(std::int64_t type) const {
    for (const GmshElement& e : kGmshElements)
      if (e.type == type) return e;
    in_.fail(fmt::format("holds elements of the unknown type {}", type));
  }

  /// An element whose nodes come next.
  template <class Node>
  void add_element(const GmshElement& e, std::uint64_t number, std::int32_t physical, std::int32_t entity,
                   Node&& node) {
    std::uint32_t c[8] = {};
    for (std::size_t k = 0; k < e.nodes; ++k) {
      const std::uint64_t named = node();
      if (k < e.corners) c[k] = numbers_->at(named);
    }
    const std::int32_t tags[] = {physical, entity};
    const std::span<const std::uint32_t> corners(c, e.corners);
    if (e.name && e.corners < 3) return cells_.leave_out(e.name);
    if (e.name) {
      cells_.add_flat(corners, tags);
      flat_numbers_.push_back(number);
      return;
    }
    if (e.nodes > e.corners) cells_.simplify();
    if (e.corners == 6) std::swap(c[1], c[2]), std::swap(c[4], c[5]);  // VTK's wedge has the opposite orientation
    cells_.add(shape_of_corners(e.corners), corners, tags);
    cell_numbers_.push_back(number);
  }

  void read_elements(std::string_view& rest) {
    if (!numbers_) in_.fail("its elements come before its nodes");
    seen_elements_ = true;
    GmshNumbers n = numbers(rest);
    const char* const of = "elements";
    if (version_ < 3) {
      const std::size_t count = n.line_count(of, 3);
      const auto tagged = [&](const GmshElement& e, std::uint64_t number, std::size_t tags) {
        std::int32_t t[2] = {0, 0};
        for (std::size_t k = 0; k < tags; ++k) {
          const auto tag = static_cast<std::int32_t>(n.whole(of));
          if (k < 2) t[k] = tag;
        }
        add_element(e, number, t[0], t[1], [&] { return static_cast<std::uint64_t>(n.whole(of)); });
      };
      for (std::size_t k = 0; k < count;) {
        if (!binary_) {
          const auto number = static_cast<std::uint64_t>(n.whole(of));
          const GmshElement& e = element(n.whole(of));
          tagged(e, number, n.small_count(of));
          ++k;
          continue;
        }
        const GmshElement& e = element(n.whole(of));
        const std::size_t many = n.small_count(of), tags = n.small_count(of);
        if (many == 0 || many > count - k) in_.fail("it has more elements than announced");
        for (std::size_t j = 0; j < many; ++j) tagged(e, static_cast<std::uint64_t>(n.whole(of)), tags);
        k += many;
      }
    } else {
      const std::size_t blocks = n.count(of), all = n.count(of, 2);
      if (version_ > 4.05) n.size(of), n.size(of);
      std::size_t sum = 0;
      for (std::size_t b = 0; b < blocks; ++b) {
        std::int64_t dim = n.whole(of), tag = n.whole(of);
        if (version_ < 4.05) std::swap(dim, tag);
        const GmshElement& e = element(n.whole(of));
        const std::size_t many = n.count(of, 2);
        sum += many;
        const auto entity = static_cast<std::int32_t>(tag);
        const auto group = physical_.find({static_cast<int>(dim), entity});
        for (std::size_t j = 0; j < many; ++j) {
          const auto next = [&] { return version_ > 4.05 ? n.size(of) : static_cast<std::uint64_t>(n.whole(of)); };
          const std::uint64_t number = next();
          add_element(e, number, group == physical_.end() ? 0 : group->second, entity, next);
        }
      }
      if (sum != all) in_.fail(fmt::format("holds {} elements, not {} as announced", grouped(sum), grouped(all)));
    }
    rest = n.rest();
  }

  void read_data(std::string_view& rest, bool of_nodes) {
    const char* const of = of_nodes ? "node data" : "element data";
    TextScanner head(rest);
    const auto head_count = [&] {
      TextScanner line(head.line());
      std::size_t count = 0;
      if (!line.number(count) || count > 100) in_.fail(fmt::format("a number is missing among its {}", of));
      return count;
    };
    Data data{"", of_nodes, 1, {}};
    const std::size_t strings = head_count();
    for (std::size_t k = 0; k < strings; ++k) {
      std::string_view line = head.line();
      if (k > 0) continue;
      if (const std::size_t open = line.find('"'); open != std::string_view::npos) {
        line.remove_prefix(open + 1);
        line = line.substr(0, line.find('"'));
      }
      data.name = printable(line, 200);
    }
    const std::size_t reals = head_count();
    for (std::size_t k = 0; k < reals; ++k) head.line();
    const std::size_t wholes = head_count();
    std::int64_t whole[3] = {0, 1, 0};
    for (std::size_t k = 0; k < wholes; ++k) {
      TextScanner line(head.line());
      std::int64_t v = 0;
      if (!line.number(v)) in_.fail(fmt::format("a number is missing among its {}", of));
      if (k < 3) whole[k] = v;
    }
    if (wholes < 3 || whole[1] < 1 || whole[1] > 1000 || whole[2] < 0)
      in_.fail(fmt::format("its {} do not state their numbers of rows and components", of));
    data.components = static_cast<std::size_t>(whole[1]);
    GmshNumbers n = numbers(head.rest());
    const auto rows = static_cast<std::uint64_t>(whole[2]);
    if (rows > n.rest().size() / (2 * (data.components + 1)))
      in_.fail(
          fmt::format("truncated: {} bytes are left for {} rows of {}", grouped(n.rest().size()), grouped(rows), of));
    for (std::uint64_t k = 0; k < rows; ++k) {
      auto& row = data.rows.emplace_back(static_cast<std::uint64_t>(n.whole(of)), std::vector<double>());
      for (std::size_t c = 0; c < data.components; ++c) row.second.push_back(n.real(of));
    }
    rest = n.rest();
    if (data.name.empty()) data.name = fmt::format("data_{}", data_.size() + 1);
    const auto same = [&](const Data& d) { return d.of_nodes == of_nodes && d.name == data.name; };
    if (std::any_of(data_.begin(), data_.end(), same)) {
      ++later_steps_;
      return;
    }
    data_.push_back(std::move(data));
  }

  /// Assigns rows to their nodes or elements; the rows of others are unknown.
  void give_data(const Data& d, std::size_t rows, const std::map<std::uint64_t, std::size_t>& row_of,
                 AttributeTable& table) const {
    std::vector<double> values(rows * d.components, std::numeric_limits<double>::quiet_NaN());
    for (const auto& [number, row] : d.rows) {
      const auto it = row_of.find(number);
      if (it != row_of.end())
        std::copy(row.begin(), row.end(), values.begin() + static_cast<std::ptrdiff_t>(it->second * d.components));
    }
    table.set({d.name, std::move(values), d.components});
  }

  GridData finished() {
    GridData result;
    result.format = fmt::format("Gmsh MSH {}, {}",
                                version_ < 3      ? "2"
                                : version_ > 4.05 ? "4.1"
                                                  : "4.0",
                                binary_ ? "binary" : "text");
    GridBlock& block = result.blocks.emplace_back();
    block.points = std::move(points_);
    numbers_->give_to(block);
    const bool flat = !cells_.solid();
    const std::vector<std::uint64_t>& cells = flat ? flat_numbers_ : cell_numbers_;
    cells_.give_to(block, result);
    std::map<std::uint64_t, std::size_t> nodes, elements;
    std::uint64_t numbers = 0;
    for (const Data& d : data_) {
      auto& row_of = d.of_nodes ? nodes : elements;
      const std::vector<std::uint64_t>& all = d.of_nodes ? tags_ : cells;
      numbers += all.size() * d.components;
      if (numbers > kMostNumbersPerByte * in_.bytes.size())
        in_.fail(fmt::format("its arrays would have {} numbers or more, far more than its {} bytes hold",
                             grouped(numbers), grouped(in_.bytes.size())));
      if (row_of.empty())
        for (std::size_t k = 0; k < all.size(); ++k) row_of.emplace(all[k], k);
      if (!all.empty()) give_data(d, all.size(), row_of, d.of_nodes ? block.point_arrays : block.cell_arrays);
    }
    if (later_steps_ > 0)
      result.notes.push_back(fmt::format("of arrays of the same name the first is taken: {} left out", later_steps_));
    return result;
  }

  const Input& in_;
  double version_ = 0;
  bool binary_ = false, swap_ = false, seen_nodes_ = false, seen_elements_ = false;
  std::size_t size_bytes_ = 8;
  std::map<std::pair<int, std::int32_t>, std::int32_t> physical_;  ///< first group of an entity (dimension, number)
  std::vector<std::uint64_t> tags_, cell_numbers_, flat_numbers_;
  std::vector<Vec3> points_;
  std::optional<PointNumbers> numbers_;
  MeshCells cells_;
  std::vector<Data> data_;
  std::size_t later_steps_ = 0;
};

}  // namespace

GridData read_gmsh(const Input& in) {
  if (in.bytes.starts_with("(")) in.fail("is a mesh of another program (Fluent), not of Gmsh, which share this ending");
  return GmshFile(in).read();
}

}  // namespace sansmesh::inline v1::io
