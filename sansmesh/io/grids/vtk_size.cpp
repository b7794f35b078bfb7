#include "sansmesh/io/grids/vtk_size.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/inflate.h"
#include "sansmesh/io/meshes/vtk_xml.h"

namespace sansmesh::inline v1::io {
namespace {

constexpr std::uint64_t kMostPromised = std::uint64_t{1} << 60;
/// Axes of lattices are stored as lists of numbers even without arrays: limit of points along each.
constexpr std::uint64_t kPointsOfAnyAxis = std::uint64_t{1} << 20;
/// Limit of nested references between files.
constexpr int kMostNested = 4;
/// Announced sizes up to this pass any file: the memory exists, and VTK reports missing data itself.
constexpr std::uint64_t kAlwaysGranted = std::uint64_t{64} << 20;
/// LZMA expands up to some 7,000 times, in blocks that are long enough.
constexpr std::uint64_t kMostLzmaExpansion = std::uint64_t{1} << 14;

std::uint64_t capped_product(std::uint64_t a, std::uint64_t b) {
  return b != 0 && a > kMostPromised / b ? kMostPromised : a * b;
}
std::uint64_t capped_sum(std::uint64_t a, std::uint64_t b) { return std::min(kMostPromised, a + b); }

std::uint64_t whole_number(std::string_view text) {
  std::uint64_t n = 0;
  return TextScanner(text).number(n) ? std::min(n, kMostPromised) : 0;
}

/// Bytes per number of a type by VTK's name; 1 for unknown types, which take at least that.
std::uint64_t bytes_of_type(std::string_view type) {
  const std::string t = lower_case(type);
  if (t.ends_with("64") || t == "double" || t == "vtktypeint64" || t == "long" || t == "unsigned_long") return 8;
  if (t.ends_with("32") || t == "float" || t == "int" || t == "unsigned_int" || t == "vtkidtype") return 4;
  if (t.ends_with("16") || t == "short" || t == "unsigned_short") return 2;
  return 1;
}

/// Bytes of `numbers` numbers.
std::uint64_t bytes_of(std::uint64_t numbers, std::string_view type) {
  if (lower_case(type) == "bit") return (numbers + 7) / 8;
  return capped_product(numbers, bytes_of_type(type));
}

/// Size of an extent "0 3 0 4 0 5".
struct Spanned {
  std::uint64_t points = 0, cells = 0, longest = 0;

  explicit Spanned(std::string_view extent) {
    std::int64_t e[6] = {};
    TextScanner s(extent);
    for (std::int64_t& v : e) {
      s.skip_space();
      if (!s.number(v) || v < -(std::int64_t{1} << 40) || v > std::int64_t{1} << 40) return;
    }
    points = cells = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto n = static_cast<std::uint64_t>(std::max<std::int64_t>(0, e[2 * k + 1] - e[2 * k] + 1));
      points = capped_product(points, n), cells = capped_product(cells, std::max<std::uint64_t>(n, 2) - 1);
      longest = std::max(longest, n);
    }
  }
};

/// Sums the sizes that the tags of a file announce.
class XmlPromises {
 public:
  /// Of a piece of a lattice only its own extent is read, whatever the extent of the whole.
  enum class Role { whole, piece };

  XmlPromises(const Input& in, Role role, int depth) : in_(in), role_(role), depth_(depth), held_(in.bytes.size()) {}

  void check() {
    XmlScanner xml(in_);
    while (const auto tag = xml.next()) {
      if (tag->name == "AppendedData") break;
      look_at(*tag);
    }
    const std::uint64_t most = capped_product(held_, expansion_);
    if (const std::uint64_t bytes = announced(); bytes > std::max(most, kAlwaysGranted)) {
      if (!missing_.empty()) throw FileError(missing_, "no such file, named by " + in_.file);
      in_.fail(fmt::format("truncated: announces arrays of {} bytes or more, of which its {} bytes hold {} at most",
                           grouped(bytes), grouped(held_), grouped(most)));
    }
    if (longest_ > std::max(kPointsOfAnyAxis, most))
      in_.fail(fmt::format("announces {} points along an axis and holds {} bytes", grouped(longest_), grouped(held_)));
  }

 private:
  /// Points or cells of an array: of its piece, and of the whole if memory is allocated for that.
  struct Counts {
    std::uint64_t own = 0, whole = 0;
  };

  /// The pieces of a lattice are parts of the whole.
  std::uint64_t announced() const { return std::max({announced_.own, announced_.whole, by_files_}); }

  void look_at(const XmlTag& tag) {
    if (tag.name == "VTKFile") {
      const std::string_view compressor = tag["compressor"];
      if (!compressor.empty()) expansion_ = compressor == "vtkLZMADataCompressor" ? kMostLzmaExpansion : kMostExpansion;
    }
    if (const std::string_view whole = tag["WholeExtent"]; !whole.empty() && role_ == Role::whole) {
      whole_ = Spanned(whole);
      longest_ = std::max(longest_, whole_.longest);
    }
    if (tag.name == "Piece" || tag.name == "DataSet") {
      const Spanned own(tag["Extent"]);
      // Memory is allocated for the whole, however small the pieces are; their arrays are the same.
      points_ = {std::max(own.points, whole_number(tag["NumberOfPoints"])), seen_piece_ ? 0 : whole_.points};
      cells_ = {std::max(own.cells, whole_number(tag["NumberOfCells"])), seen_piece_ ? 0 : whole_.cells};
      seen_piece_ = true;
      longest_ = std::max(longest_, own.longest);
      add_file(tag["Source"], Role::piece), add_file(tag["file"], Role::whole);
    } else if (tag.name == "PointData" || tag.name == "Points") {
      tuples_ = points_;
    } else if (tag.name == "CellData" || tag.name == "Cells") {
      tuples_ = cells_;  // offsets and types are per cell; the connectivity is as long as its data
    } else if (tag.name == "PPointData") {
      tuples_ = {0, whole_.points};
    } else if (tag.name == "PCellData") {
      tuples_ = {0, whole_.cells};
    } else if (std::find(std::begin(kOthers), std::end(kOthers), tag.name) != std::end(kOthers)) {
      tuples_ = {};
    } else if (tag.name == "DataArray" || tag.name == "PDataArray") {
      add_array(tag);
    }
  }

  void add_array(const XmlTag& tag) {
    const std::uint64_t given = whole_number(tag["NumberOfTuples"]);
    const Counts tuples = given > 0 ? Counts{given, given} : tag["Name"] == "connectivity" ? Counts{} : tuples_;
    const std::uint64_t components = std::max<std::uint64_t>(1, whole_number(tag["NumberOfComponents"]));
    const auto bytes = [&](std::uint64_t n) { return bytes_of(capped_product(n, components), tag["type"]); };
    announced_.own = capped_sum(announced_.own, bytes(tuples.own));
    announced_.whole = capped_sum(announced_.whole, bytes(tuples.whole));
  }

  /// Content in referenced files, which are checked recursively.
  void add_file(std::string_view name, Role role) {
    if (name.empty() || depth_ == kMostNested) return;
    std::error_code error;
    const std::string file = (std::filesystem::path(in_.file).parent_path() / from_xml(name)).string();
    if (!std::filesystem::exists(file, error) && missing_.empty()) missing_ = file;
    if (!std::filesystem::is_regular_file(file, error) || std::filesystem::file_size(file, error) == 0 || error) return;
    const FileContent content(file);
    const Input in{file, content.bytes(), in_.report};
    if (content.bytes().substr(0, 4096).find("<VTKFile") == std::string_view::npos) {
      held_ += content.bytes().size();
      return;
    }
    XmlPromises parts(in, role, depth_ + 1);
    parts.check();
    held_ += parts.held_;
    by_files_ = capped_sum(by_files_, parts.announced());
    expansion_ = std::max(expansion_, parts.expansion_);
    if (missing_.empty()) missing_ = parts.missing_;
  }

  /// Elements whose arrays have independent or short lengths.
  static constexpr std::string_view kOthers[] = {"FieldData", "Coordinates", "PCoordinates", "PPoints",
                                                 "Verts",     "Lines",       "Strips",       "Polys"};
  const Input& in_;
  Role role_;
  int depth_;
  bool seen_piece_ = false;
  Spanned whole_{""};
  Counts points_, cells_, tuples_, announced_;
  std::uint64_t held_, longest_ = 0, by_files_ = 0;
  /// Bytes of numbers per byte of the file: in text a number takes a digit and a separator.
  std::uint64_t expansion_ = 4;
  std::string missing_;  ///< the first referenced file that does not exist
};

/// Parses a legacy file as far as it is understood; the rest is left to VTK.
class LegacyPromises {
 public:
  explicit LegacyPromises(const Input& in) : in_(in), text_(in.bytes) {}

  void check() {
    text_.line(), text_.line();
    binary_ = lower_case(text_.word()) == "binary";
    text_.line();
    while (!text_.at_end()) {
      TextScanner words(text_.line());
      words.skip_blanks();
      if (words.at_end()) continue;
      const char first = *words.position();
      const bool word = (first >= 'A' && first <= 'Z') || (first >= 'a' && first <= 'z');
      if (!word && !binary_) continue;  // numbers
      if (!word || (!look_at(lower_case(words.word()), words) && binary_)) return;
    }
  }

 private:
  bool look_at(const std::string& key, TextScanner& words) {
    if (key == "dataset" || key == "origin" || key == "spacing" || key == "aspect_ratio") return true;
    if (key == "metadata") return skip_metadata(), true;
    const auto next = [&] { return whole_number(words.word()); };
    if (key == "dimensions") {
      const std::uint64_t d[] = {next(), next(), next()};
      const std::uint64_t longest = std::max({d[0], d[1], d[2]});
      if (longest > std::max<std::uint64_t>(kPointsOfAnyAxis, in_.bytes.size()))
        in_.fail(fmt::format("announces {} points along an axis and holds {} bytes", grouped(longest),
                             grouped(in_.bytes.size())));
      return true;
    }
    if (key == "points") {
      const std::uint64_t n = next();
      return take(capped_product(n, 3), words.word());
    }
    if (key.ends_with("_coordinates") && key.size() == 13) {
      const std::uint64_t n = next();
      return take(n, words.word());
    }
    if (key == "cells" || key == "polygons" || key == "lines" || key == "vertices" || key == "triangle_strips") {
      const std::uint64_t n = next(), size = next();
      TextScanner ahead = text_;
      if (!lower_case(ahead.word()).starts_with("offsets")) return take(std::max(n, size), "int");
      text_.line();
      if (!take(n, "vtktypeint64")) return false;
      skip_line_end();
      TextScanner second(text_.line());
      return lower_case(second.word()) != "connectivity" || take(size, "vtktypeint64");
    }
    if (key == "cell_types") return take(next(), "int");
    if (key == "point_data" || key == "cell_data") return tuples_ = next(), true;
    return look_at_array(key, words);
  }

  bool look_at_array(const std::string& key, TextScanner& words) {
    if (key == "scalars") {
      words.word();
      const std::string_view type = words.word();
      const std::uint64_t components = std::max<std::uint64_t>(1, whole_number(words.word()));
      TextScanner ahead = text_;
      if (lower_case(ahead.word()) == "lookup_table") text_.line();
      return take(capped_product(tuples_, components), type);
    }
    if (key == "vectors" || key == "normals" || key == "tensors") {
      words.word();
      return take(capped_product(tuples_, key == "tensors" ? 9 : 3), words.word());
    }
    if (key == "lookup_table") {
      words.word();
      return take(capped_product(whole_number(words.word()), 4), "unsigned_char");
    }
    if (key != "field") return false;
    words.word();
    for (std::uint64_t arrays = whole_number(words.word()); arrays > 0 && !text_.at_end(); --arrays) {
      TextScanner head = next_head();
      const std::uint64_t components = whole_number(head.word()), tuples = whole_number(head.word());
      if (!take(capped_product(components, tuples), head.word())) return false;
      if (!binary_) return true;  // in text, other arrays do not begin on the next line
    }
    return true;
  }

  /// Skips the next numbers if they are binary; false for types of unknown length.
  bool take(std::uint64_t numbers, std::string_view type) {
    const std::string t = lower_case(type);
    const std::uint64_t room = text_.rest().size();
    if (t == "string" || t == "variant" || t == "utf8_string") return false;
    const std::uint64_t memory = bytes_of(numbers, t), bytes = binary_ ? memory : capped_product(numbers, 2);
    announced_ = capped_sum(announced_, memory);
    if (bytes > room + 1 && announced_ > kAlwaysGranted)
      in_.fail(fmt::format("truncated: announces {} numbers, which take at least {} bytes, and {} are left",
                           grouped(numbers), grouped(bytes), grouped(room)));
    if (binary_) text_ = TextScanner(text_.rest().substr(std::min(bytes, room)));
    return true;
  }

  /// Moves past the name of the next array of a field, and past the metadata of the previous one.
  TextScanner next_head() {
    skip_line_end();
    for (;;) {
      TextScanner head(text_.line());
      if (lower_case(head.word()) != "metadata" || !head.rest().empty() || text_.at_end()) return head;
      skip_metadata();
    }
  }

  /// Skips to an empty line.
  void skip_metadata() {
    while (!text_.at_end() && !text_.line().empty()) continue;
  }

  void skip_line_end() {
    TextScanner ahead = text_;
    if (ahead.line().empty()) text_ = ahead;
  }

  const Input& in_;
  TextScanner text_;
  bool binary_ = false;
  std::uint64_t tuples_ = 0, announced_ = 0;
};

}  // namespace

void check_vtk_xml_size(const Input& in) { XmlPromises(in, XmlPromises::Role::whole, 0).check(); }

void check_vtk_legacy_size(const Input& in) { LegacyPromises(in).check(); }

}  // namespace sansmesh::inline v1::io
