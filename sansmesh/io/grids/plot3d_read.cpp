// PLOT3D: curvilinear grids and their solutions. Files do not describe their layout. Each possible layout predicts the
// size of a file from the numbers at its beginning; the reader chooses the one whose prediction is exact.
// Layouts: P. P. Walatka, P. G. Buning, L. Pierce, P. A. Elson, PLOT3D User's Manual, NASA TM 101067, 1990, chapter 8.
#include <fmt/core.h>

#include <cmath>
#include <filesystem>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/io/binary.h"
#include "sansmesh/io/file_content.h"
#include "sansmesh/io/grids/image_block.h"
#include "sansmesh/io/grids/volume_readers.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {
namespace {

enum class P3dContent : std::uint8_t { grid, solution, functions };

struct P3dLayout {
  bool text = false, marks = false, big = false, multi = false, iblank = false, flat = false;
  std::size_t real = 4;                          ///< bytes per number
  std::vector<std::array<std::size_t, 3>> dims;  ///< per grid
  std::vector<std::size_t> functions;            ///< per grid: numbers per point
  std::vector<std::size_t> at;  ///< beginning of each grid's numbers: a byte offset, or the index of a number in text
  std::size_t end = 0;          ///< end of the last grid

  std::size_t points(std::size_t grid) const { return dims[grid][0] * dims[grid][1] * dims[grid][2]; }
  std::string words() const {
    return fmt::format("{}{}{}{}{}",
                       text  ? "text"
                       : big ? "big endian"
                             : "little endian",
                       text        ? ""
                       : real == 8 ? ", double"
                                   : ", float",
                       marks ? ", Fortran records" : "", multi ? fmt::format(", {} grids", dims.size()) : "",
                       iblank ? ", iblank" : "");
  }
};

/// The numbers of a text file, or nothing for binary files. Expands repetitions (3*0.5).
std::optional<std::vector<double>> p3d_numbers(std::string_view bytes) {
  for (const char c : bytes.substr(0, 256)) {
    if (!(c >= '0' && c <= '9') && !TextScanner::is_blank(c) &&
        std::string_view("\n+-.eEdD*,").find(c) == std::string_view::npos)
      return std::nullopt;
  }
  std::vector<double> numbers;
  const std::size_t most = std::max<std::size_t>(std::size_t{1} << 20, bytes.size() * 16);
  const auto separates = [](char c) { return TextScanner::is_blank(c) || c == '\n' || c == ','; };
  const char *p = bytes.data(), *const end = p + bytes.size();
  std::string word;
  while (p != end) {
    if (separates(*p)) {
      ++p;
      continue;
    }
    word.clear();
    while (p != end && !separates(*p) && word.size() < 64) word += *p == 'd' || *p == 'D' ? 'e' : *p, ++p;
    std::size_t times = 1;
    std::string_view value = word;
    if (const std::size_t star = value.find('*'); star != std::string_view::npos) {
      TextScanner count(value.substr(0, star));
      if (!count.number(times) || !count.at_end() || times > most) return std::nullopt;
      value.remove_prefix(star + 1);
    }
    TextScanner s(value);
    double v = 0;
    if (!s.number(v) || !s.at_end() || numbers.size() + times > most) return std::nullopt;
    numbers.insert(numbers.end(), times, v);
  }
  return numbers;
}

class P3dFile {
 public:
  explicit P3dFile(std::string_view bytes) : bytes_(bytes), text_(p3d_numbers(bytes)) {}

  /// All matching layouts; planar ones only if there are no others. `whole`: matches to the last byte; else more bytes
  /// may follow.
  std::vector<P3dLayout> layouts(P3dContent content, bool whole = true) const {
    std::vector<P3dLayout> found;
    for (const bool flat : {false, true}) {
      if (flat && !found.empty()) break;
      for (const bool multi : {false, true}) {
        P3dLayout l;
        l.flat = flat, l.multi = multi;
        if (text_) {
          l.text = true, l.real = 1;
          fit_bodies(content, l, whole, found);
        } else {
          for (const bool marks : {false, true}) {
            for (const bool big : {false, true}) {
              l.marks = marks, l.big = big;
              fit_bodies(content, l, whole, found);
            }
          }
        }
      }
    }
    return found;
  }

  /// Numbers of a layout; `at` is in the unit of P3dLayout::at.
  AttributeValues reals(const P3dLayout& l, std::size_t at, std::size_t count) const {
    if (text_) {
      const auto begin = text_->begin() + static_cast<std::ptrdiff_t>(at);
      return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(count));
    }
    return decode_values(bytes_.data() + at, count, l.real == 8 ? NumberType::f64 : NumberType::f32, l.big);
  }
  std::vector<std::int32_t> wholes(const P3dLayout& l, std::size_t at, std::size_t count) const {
    std::vector<std::int32_t> values(count);
    for (std::size_t i = 0; i < count; ++i)
      values[i] = static_cast<std::int32_t>(integer(l, at + i * (l.text ? 1 : 4)));
    return values;
  }

 private:
  std::size_t size() const { return text_ ? text_->size() : bytes_.size(); }
  /// Integer at an existing position; −1 if the text has no integer there.
  std::int64_t integer(const P3dLayout& l, std::size_t at) const {
    if (text_) {
      const double v = (*text_)[at];
      return v == std::floor(v) && std::abs(v) < 0x1p31 ? static_cast<std::int64_t>(v) : -1;
    }
    return l.big ? load<std::int32_t, true>(bytes_.data() + at) : load<std::int32_t>(bytes_.data() + at);
  }
  /// Whether a record mark with this value is at `at`; moves past it.
  bool mark(const P3dLayout& l, std::size_t& at, std::uint64_t value) const {
    if (!l.marks) return true;
    if (value > 0x7fffffffu || at + 4 > size() || integer(l, at) != static_cast<std::int64_t>(value)) return false;
    at += 4;
    return true;
  }

  /// Reads the sizes at the beginning; `at` receives their end.
  bool header(P3dContent content, P3dLayout& l, std::size_t& at) const {
    const std::size_t one = l.text ? 1 : 4, axes = l.flat ? 2 : 3, row = axes + (content == P3dContent::functions);
    std::size_t grids = 1;
    at = 0;
    if (l.multi) {
      if (!mark(l, at, 4) || at + one > size()) return false;
      const std::int64_t n = integer(l, at);
      if (n < 1 || static_cast<std::uint64_t>(n) > size() / one) return false;
      grids = static_cast<std::size_t>(n), at += one;
      if (!mark(l, at, 4)) return false;
    }
    if (!mark(l, at, row * grids * one) || grids * row * one > size() - at) return false;
    l.dims.clear(), l.functions.clear();
    std::uint64_t all = 0;
    for (std::size_t g = 0; g < grids; ++g) {
      std::array<std::size_t, 3> d{1, 1, 1};
      std::uint64_t points = 1;
      for (std::size_t k = 0; k < row; ++k, at += one) {
        const std::int64_t n = integer(l, at);
        if (n < 1 || static_cast<std::uint64_t>(n) > size()) return false;
        if (k < axes) {
          d[k] = static_cast<std::size_t>(n), points *= static_cast<std::uint64_t>(n);
          if (points > size()) return false;
        } else {
          l.functions.push_back(static_cast<std::size_t>(n));
        }
      }
      l.dims.push_back(d);
      all += points;
      if (all > size()) return false;
    }
    return mark(l, at, row * grids * one);
  }

  /// Whether there are numbers of l.real bytes for all grids, with l.iblank, from `at` on.
  bool body(P3dContent content, P3dLayout& l, std::size_t at) const {
    const std::size_t one = l.text ? 1 : 4, axes = l.flat ? 2 : 3;
    l.at.clear();
    for (std::size_t g = 0; g < l.dims.size(); ++g) {
      const std::uint64_t n = l.points(g);
      if (content == P3dContent::solution) {
        // Mach number, angle of attack, Reynolds number and time form a separate record.
        if (!mark(l, at, 4 * l.real) || 4 * l.real > size() - at) return false;
        at += 4 * l.real;
        if (!mark(l, at, 4 * l.real)) return false;
      }
      const std::uint64_t numbers = content == P3dContent::grid       ? axes
                                    : content == P3dContent::solution ? axes + 2
                                                                      : l.functions[g];
      if (numbers > size() / n) return false;
      const std::uint64_t bytes = n * (numbers * l.real + (l.iblank ? one : 0));
      if (!mark(l, at, bytes)) return false;
      l.at.push_back(at);
      if (bytes > size() - at) return false;
      at += bytes;
      if (!mark(l, at, bytes)) return false;
    }
    l.end = at;
    return true;
  }

  void fit_bodies(P3dContent content, P3dLayout l, bool whole, std::vector<P3dLayout>& found) const {
    std::size_t at = 0;
    if (!header(content, l, at)) return;
    const bool grid = content == P3dContent::grid;
    for (const std::size_t real : {std::size_t{4}, std::size_t{8}}) {
      if (text_ && real == 8) break;
      l.real = text_ ? 1 : real;
      for (const bool iblank : {false, true}) {
        if (iblank && !grid) break;
        l.iblank = iblank;
        if (body(content, l, at) && (!whole || l.end == size())) found.push_back(l);
      }
    }
  }

  std::string_view bytes_;
  std::optional<std::vector<double>> text_;
};

/// The only matching layout; FileError if there is none or several.
P3dLayout p3d_layout(const Input& in, const P3dFile& file, P3dContent content, std::string_view what) {
  const std::vector<P3dLayout> found = file.layouts(content);
  if (found.size() == 1) return found[0];
  if (found.empty()) {
    in.fail(fmt::format("its size of {} bytes fits no layout of a PLOT3D {} file: truncated, or something else",
                        grouped(in.bytes.size()), what));
  }
  in.fail(fmt::format("is ambiguous: its size fits {} layouts of a PLOT3D {} file ({}; {}; …)", found.size(), what,
                      found[0].words(), found[1].words()));
}

double p3d_number(const AttributeValues& values, std::size_t i) {
  return std::visit([i](const auto& v) { return static_cast<double>(v[i]); }, values);
}

/// Arrays of the same real type as `like`.
AttributeValues p3d_reals(const AttributeValues& like, std::vector<double> numbers) {
  if (std::holds_alternative<std::vector<double>>(like)) return numbers;
  std::vector<float> narrow(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) narrow[i] = static_cast<float>(numbers[i]);
  return narrow;
}

void add_solution(const P3dFile& file, const P3dLayout& l, std::size_t g, GridBlock& block, bool& no_energy) {
  const std::size_t n = l.points(g), axes = l.flat ? 2 : 3;
  const AttributeValues q = file.reals(l, l.at[g], n * (axes + 2));
  std::vector<double> density(n), energy(n), pressure(n), momentum(3 * n), velocity(3 * n);
  bool any_energy = false;
  for (std::size_t i = 0; i < n; ++i) {
    density[i] = p3d_number(q, i);
    energy[i] = p3d_number(q, (axes + 1) * n + i);
    any_energy = any_energy || energy[i] != 0;
    const double divisor = density[i] == 0 ? 1.0 : density[i];
    double square = 0;
    for (std::size_t k = 0; k < axes; ++k) {
      const double m = p3d_number(q, (k + 1) * n + i);
      momentum[3 * i + k] = m, velocity[3 * i + k] = m / divisor;
      square += m * m / divisor;
    }
    pressure[i] = (1.4 - 1.0) * (energy[i] - 0.5 * square);
  }
  block.point_arrays.set({"Density", p3d_reals(q, std::move(density)), 1});
  block.point_arrays.set({"Momentum", p3d_reals(q, std::move(momentum)), 3});
  block.point_arrays.set({"StagnationEnergy", p3d_reals(q, std::move(energy)), 1});
  block.point_arrays.set({"Velocity", p3d_reals(q, std::move(velocity)), 3});
  if (any_energy)
    block.point_arrays.set({"Pressure", p3d_reals(q, std::move(pressure)), 1});
  else
    no_energy = true;
}

void add_functions(const P3dFile& file, const P3dLayout& l, std::size_t g, GridBlock& block) {
  const std::size_t n = l.points(g);
  for (std::size_t f = 0; f < l.functions[g]; ++f) {
    const std::size_t at = l.at[g] + f * n * l.real;
    block.point_arrays.set({fmt::format("Function_{}", f + 1), file.reals(l, at, n), 1});
  }
}

std::string p3d_dims(const P3dLayout& l) {
  return l.dims.size() > 1 ? fmt::format("{} grids", l.dims.size())
                           : fmt::format("{} x {} x {} points", l.dims[0][0], l.dims[0][1], l.dims[0][2]);
}

/// Layout of the values of a grid. Some programs append further bytes; the layout is still unique if it matches the
/// grid's.
P3dLayout p3d_value_layout(const Input& in, const P3dFile& file, P3dContent content, std::string_view what,
                           const std::string& grid_file, const P3dLayout& grid) {
  if (file.layouts(content).empty()) {
    for (const P3dLayout& l : file.layouts(content, false)) {
      if (l.dims != grid.dims || l.text != grid.text || l.marks != grid.marks || l.big != grid.big ||
          l.real != grid.real || l.multi != grid.multi || l.flat != grid.flat)
        continue;
      if (!l.text) in.warn(fmt::format("{} bytes after the numbers are ignored", grouped(in.bytes.size() - l.end)));
      return l;
    }
  }
  const P3dLayout l = p3d_layout(in, file, content, what);
  if (l.dims == grid.dims) return l;
  in.fail(fmt::format("does not belong to the grid {}: it has {}, the grid {}", grid_file, p3d_dims(l),
                      p3d_dims(l) == p3d_dims(grid) ? "others" : p3d_dims(grid)));
}

}  // namespace

bool is_plot3d(const Input& in) { return !P3dFile(in.bytes).layouts(P3dContent::grid).empty(); }

std::string plot3d_solution_of(const std::string& grid) {
  const std::filesystem::path path(grid);
  const std::string name = path.filename().string(), small = lower_case(name);
  std::vector<std::string> candidates;
  if (const std::size_t at = small.rfind("xyz"); at != std::string::npos) {
    for (const char* q : {"q", "Q"}) candidates.push_back(name.substr(0, at) + q + name.substr(at + 3));
  }
  if (const std::size_t dot = name.rfind('.'); dot != std::string::npos) {
    const std::string stem = name.substr(0, dot), ending_of_grid = small.substr(dot + 1);
    if (ending_of_grid != "q" && ending_of_grid != "f") {
      for (const char* q : {".q", ".Q", ".sol", ".f", ".fun"}) candidates.push_back(stem + q);
    }
  }
  std::error_code ignored;
  for (const std::string& c : candidates) {
    if (const auto file = path.parent_path() / c; c != name && std::filesystem::is_regular_file(file, ignored))
      return file.string();
  }
  return {};
}

GridData read_plot3d(const Input& in, const std::string& solution) {
  const P3dFile file(in.bytes);
  if (file.layouts(P3dContent::grid).empty() && !file.layouts(P3dContent::solution).empty())
    in.fail("is the solution of a PLOT3D grid: name the file of the grid, for example flowxyz.bin for flowq.bin");
  const P3dLayout l = p3d_layout(in, file, P3dContent::grid, "grid");
  const std::string values = solution.empty() ? plot3d_solution_of(in.file) : solution;

  GridData data;
  data.format = "PLOT3D, " + l.words();
  for (std::size_t g = 0; g < l.dims.size(); ++g) {
    GridBlock& block = data.blocks.emplace_back();
    if (l.multi) block.name = fmt::format("grid {}", g + 1);
    block.kind = GridKind::curvilinear;
    block.dims = l.dims[g];
    const std::size_t n = l.points(g), axes = l.flat ? 2 : 3;
    const AttributeValues xyz = file.reals(l, l.at[g], axes * n);
    block.points.resize(n);
    std::visit(
        [&](const auto& v) {
          for (std::size_t k = 0; k < axes; ++k) {
            for (std::size_t i = 0; i < n; ++i) block.points[i][k] = static_cast<double>(v[k * n + i]);
          }
        },
        xyz);
    if (!l.iblank) continue;
    const std::vector<std::int32_t> iblank = file.wholes(l, l.at[g] + axes * n * l.real, n);
    block.hidden_points.resize(n);
    bool any = false;
    for (std::size_t i = 0; i < n; ++i) any |= (block.hidden_points[i] = iblank[i] == 0) != 0;
    if (!any) block.hidden_points.clear();
  }
  if (values.empty()) {
    data.notes.push_back(
        "holds no values, and no solution file (flowq.bin beside flowxyz.bin, flow.q beside flow.xyz) "
        "is beside it");
    return data;
  }

  const FileContent content(values);
  const Input of_values{values, content.bytes(), in.report};
  const P3dFile value_file(of_values.bytes);
  const bool functions =
      value_file.layouts(P3dContent::solution).empty() && !value_file.layouts(P3dContent::functions).empty();
  const P3dLayout v = p3d_value_layout(of_values, value_file, functions ? P3dContent::functions : P3dContent::solution,
                                       functions ? "function" : "solution", in.file, l);
  bool no_energy = false;
  for (std::size_t g = 0; g < l.dims.size(); ++g) {
    if (functions)
      add_functions(value_file, v, g, data.blocks[g]);
    else
      add_solution(value_file, v, g, data.blocks[g], no_energy);
  }
  if (no_energy) data.notes.push_back("the stagnation energy is 0 everywhere, so there is no pressure");
  return data;
}

}  // namespace sansmesh::inline v1::io
