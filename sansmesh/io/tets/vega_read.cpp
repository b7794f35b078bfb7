// Vega FEM's .veg: sections that begin with an asterisk, and included files.
// Layout: Vega FEM's user manual, "The .veg file format".
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "sansmesh/core/option_text.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/grids/header_fields.h"
#include "sansmesh/io/grids/volume_readers.h"
#include "sansmesh/io/number_text.h"
#include "sansmesh/io/tets/mesh_cells.h"

namespace sansmesh::inline v1::io {
namespace {

constexpr int kMostIncluded = 8;       ///< nesting depth of included files
constexpr int kMostInclusions = 1000;  ///< in total: files that include each other repeatedly would not end

std::string_view without_comment(std::string_view line) { return without_blanks(line.substr(0, line.find('#'))); }

class VegaFile {
 public:
  explicit VegaFile(const Input& in) : in_(in) {}

  GridData read() {
    read_sections(in_, 0);
    if (!points_) in_.fail("holds no *VERTICES");
    if (elements_.empty()) in_.fail("holds no *ELEMENTS");
    GridData result;
    result.format = "Vega";
    GridBlock& block = result.blocks.emplace_back();
    MeshCells cells({});
    for (const Element& e : elements_) {
      std::uint32_t c[8] = {};
      for (std::size_t k = 0; k < corners_; ++k) c[k] = points_->at(e.corners[k]);
      cells.add(corners_ == 4 ? CellShape::tetrahedron : CellShape::hexahedron, {c, corners_}, {});
    }
    block.points = std::move(positions_);
    points_->give_to(block);
    cells.give_to(block, result);
    give_materials(block, result);
    return result;
  }

 private:
  struct Element {
    std::uint64_t number;
    std::uint64_t corners[8];
  };
  struct Material {
    double density, young, poisson;
  };

  void read_sections(const Input& in, int depth) {
    NumberText text(in, in.bytes);
    while (!text.at_end()) {
      const std::string_view word = text.word();
      if (!word.starts_with('*')) text.fail(fmt::format("'{}' instead of a section", word.substr(0, 30)));
      const std::string section = lower_case(word);
      if (section == "*vertices") {
        read_vertices(in, text);
      } else if (section == "*elements") {
        read_elements(in, text);
      } else if (section == "*include") {
        if (depth == kMostIncluded) in.fail(fmt::format("includes files in files, more than {} deep", kMostIncluded));
        if (++inclusions_ > kMostInclusions) in_.fail(fmt::format("includes more than {} files", kMostInclusions));
        const std::string name = beside(in, without_comment(text.line()));
        const FileContent content(name);
        read_sections({name, content.bytes(), in.report}, depth + 1);
      } else if (section == "*material") {
        read_material(text);
      } else if (section == "*set") {
        read_set(text);
      } else if (section == "*region") {
        read_region(in, text);
      } else {
        text.fail(fmt::format("unknown section '{}'", printable(word, 30)));
      }
    }
  }

  void read_vertices(const Input& in, NumberText& text) {
    if (points_) in.fail("has two sections *VERTICES");
    const char* const of = "vertices";
    const std::size_t count = text.count(of, 6);
    if (count == 0) in.fail("holds no vertices");
    const std::int64_t dimension = text.whole(of);
    if (dimension != 3) in.fail(fmt::format("its vertices have {} coordinates, not 3", dimension));
    text.line();
    std::vector<std::uint64_t> numbers;
    numbers.reserve(count);
    positions_.reserve(count);
    for (std::size_t k = 0; k < count; ++k) {
      numbers.push_back(static_cast<std::uint64_t>(text.whole(of)));
      const double x = text.real(of), y = text.real(of), z = text.real(of);
      positions_.push_back({x, y, z});
    }
    points_.emplace(in_, std::move(numbers));
  }

  void read_elements(const Input& in, NumberText& text) {
    const char* const of = "elements";
    const std::string kind = lower_case(text.word());
    const std::size_t corners = kind.starts_with("tet") ? 4 : kind.starts_with("cub") ? 8 : 0;
    if (corners == 0) text.fail(fmt::format("elements of the kind '{}'; TET and CUBIC are read", printable(kind, 30)));
    if (!elements_.empty() && corners != corners_) in.fail("has elements of several kinds");
    corners_ = corners;
    const std::size_t count = text.count(of, 2 * corners);
    const std::int64_t given = text.whole(of);
    if (given != static_cast<std::int64_t>(corners))
      in.fail(fmt::format("its elements have {} corners, not {}", given, corners));
    text.line();
    for (std::size_t k = 0; k < count; ++k) {
      Element& e = elements_.emplace_back();
      e.number = static_cast<std::uint64_t>(text.whole(of));
      for (std::size_t c = 0; c < corners; ++c) e.corners[c] = static_cast<std::uint64_t>(text.whole(of));
    }
  }

  /// The next lines up to a section; blanks and commas separate.
  static std::vector<std::string> words_of_section(NumberText& text) {
    std::vector<std::string> words;
    while (!text.at_end() && *text.scanner().position() != '*') {
      const std::string_view line = without_comment(text.line());
      for (std::size_t at = 0; at < line.size();) {
        const std::size_t end = std::min(line.find_first_of(", \t", at), line.size());
        if (end > at) words.emplace_back(line.substr(at, end - at));
        at = end + 1;
      }
    }
    return words;
  }

  void read_material(NumberText& text) {
    const std::string name(without_comment(text.line()));
    const std::vector<std::string> words = words_of_section(text);
    if (words.empty() || lower_case(words[0]) != "enu") {
      other_materials_.insert(name);
      return;
    }
    double v[3] = {};
    for (std::size_t k = 0; k < 3; ++k) {
      TextScanner s(k + 1 < words.size() ? std::string_view(words[k + 1]) : std::string_view());
      if (!s.number(v[k]) || !s.at_end())
        text.fail(fmt::format("the material '{}' must be ENU, density, Young's modulus, Poisson's ratio",
                              printable(name, 40)));
    }
    if (!(std::isfinite(v[0]) && v[0] > 0 && std::isfinite(v[1]) && v[1] > 0 && v[2] > -1 && v[2] < 0.5))
      text.fail(
          fmt::format("the material '{}' must have a density and a Young's modulus above 0 and a Poisson's ratio "
                      "between -1 and 0.5, not {:g}, {:g}, {:g}",
                      printable(name, 40), v[0], v[1], v[2]));
    materials_[name] = {v[0], v[1], v[2]};
  }

  void read_set(NumberText& text) {
    const std::string name(without_comment(text.line()));
    std::vector<std::uint64_t>& set = sets_[name];
    for (const std::string& word : words_of_section(text)) {
      TextScanner s(word);
      std::uint64_t n = 0;
      if (!s.number(n) || !s.at_end())
        text.fail(fmt::format("'{}' in the set '{}' is not a number", printable(word, 30), printable(name, 40)));
      set.push_back(n);
    }
  }

  void read_region(const Input& in, NumberText& text) {
    const std::vector<std::string> words = words_of_section(text);
    if (words.size() != 2) text.fail("a region must name a set and a material");
    if (words[0] != "allElements" && !sets_.contains(words[0]))
      in.fail(fmt::format("a region names the missing set '{}'", printable(words[0], 40)));
    regions_.emplace_back(words[0], words[1]);
  }

  /// Materials of elements as arrays; later regions override earlier ones.
  void give_materials(GridBlock& block, GridData& data) {
    if (!other_materials_.empty()) data.notes.emplace_back("materials of other kinds than ENU were left out");
    std::vector<double> columns[3];
    for (auto& c : columns) c.assign(elements_.size(), std::numeric_limits<double>::quiet_NaN());
    std::map<std::uint64_t, std::size_t> row_of;
    bool any = false;
    for (const auto& [set, material] : regions_) {
      const auto m = materials_.find(material);
      if (m == materials_.end() && other_materials_.contains(material)) continue;
      if (m == materials_.end())
        in_.fail(fmt::format("a region names the missing material '{}'", printable(material, 40)));
      const double v[] = {m->second.density, m->second.young, m->second.poisson};
      const auto give = [&](std::size_t e) {
        for (std::size_t k = 0; k < 3; ++k) columns[k][e] = v[k];
      };
      any = true;
      if (set == "allElements") {
        for (std::size_t e = 0; e < elements_.size(); ++e) give(e);
        continue;
      }
      if (row_of.empty())
        for (std::size_t e = 0; e < elements_.size(); ++e) row_of.emplace(elements_[e].number, e);
      for (const std::uint64_t n : sets_[set]) {
        const auto it = row_of.find(n);
        if (it == row_of.end())
          in_.fail(fmt::format("the set '{}' names the missing element {}", printable(set, 40), n));
        give(it->second);
      }
    }
    if (!any) return;
    block.cell_arrays.set("density", std::move(columns[0]));
    block.cell_arrays.set("young", std::move(columns[1]));
    block.cell_arrays.set("poisson", std::move(columns[2]));
  }

  const Input& in_;
  std::vector<Vec3> positions_;
  std::optional<PointNumbers> points_;
  std::size_t corners_ = 4;
  std::vector<Element> elements_;
  std::map<std::string, Material> materials_;
  std::map<std::string, std::vector<std::uint64_t>> sets_;
  std::vector<std::pair<std::string, std::string>> regions_;
  std::set<std::string> other_materials_;  ///< not ENU
  int inclusions_ = 0;
};

}  // namespace

GridData read_vega(const Input& in) { return VegaFile(in).read(); }

}  // namespace sansmesh::inline v1::io
