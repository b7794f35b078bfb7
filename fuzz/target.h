// Common parts of fuzz targets: assertions, conversion of bytes to numbers, checks of errors and data.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>

#include "sansmesh/error.h"
#include "sansmesh/grid_data.h"
#include "sansmesh/io.h"
#include "sansmesh/point_set.h"
#include "sansmesh/vec.h"
#include "support/clean_text.h"

namespace sansmesh::fuzz {

/// Aborts the process, which the fuzzer counts as a crash.
inline void demand(bool ok, std::string_view what) {
  if (ok) return;
  std::fprintf(stderr, "fuzz: %.*s\n", static_cast<int>(what.size()), what.data());
  std::abort();
}

/// Checks that a message is one printable line of limited length.
inline void check_message(std::string_view what) {
  if (!what.empty() && what.size() < 5000 && test::is_clean(what)) return;
  std::fprintf(stderr, "the message: %.*s\n", static_cast<int>(what.size()), what.data());
  demand(false, "a message that is not one printable line");
}

inline void check_report(const ReadReport& report) {
  for (const std::string& warning : report.warnings) check_message(warning);
  for (const std::string& what : report.unread) check_message(what);
}

/// Calls `run`; returns false if it threw an error of this library, whose message is checked.
template <class Run>
bool ends_well(Run&& run) {
  try {
    run();
    return true;
  } catch (const Error& error) {
    check_message(error.what());
    return false;
  }
}

/// A copy of exact length, so that the address sanitizer detects reads beyond the end.
class ExactBytes {
 public:
  ExactBytes(const std::uint8_t* data, std::size_t size) : bytes_(new char[size]), size_(size) {
    std::copy_n(data, size, bytes_.get());
  }
  std::string_view view() const { return {bytes_.get(), size_}; }

 private:
  std::unique_ptr<char[]> bytes_;
  std::size_t size_;
};

/// Reads numbers from an input; zeros beyond its end.
class ByteReader {
 public:
  ByteReader(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}

  bool at_end() const { return left_ == 0; }
  template <class T>
  T take() {
    static_assert(std::is_trivially_copyable_v<T>);
    T value{};
    const std::size_t n = std::min(left_, sizeof(T));
    std::memcpy(&value, data_, n);
    data_ += n, left_ -= n;
    return value;
  }
  /// A number in 0..count−1.
  std::size_t below(std::size_t count) { return take<std::uint8_t>() % count; }
  bool flag() { return take<std::uint8_t>() % 2 == 1; }
  /// A positive length of any magnitude, often usual ones, and some whose squares overflow or vanish.
  double scale() {
    constexpr int exponents[] = {0, 0,  0,  0,   0,  0,   1,  -1,  3,   -3,   6,   -6,
                                 9, -9, 15, -15, 30, -30, 37, -40, 150, -150, 307, -307};
    return std::pow(10.0, exponents[below(std::size(exponents))]);
  }
  /// A number from one, two, four or eight bytes, so that all kinds of numbers are a few byte changes apart.
  double number() {
    switch (below(6)) {
      case 0:
        return take<std::int8_t>();
      case 1:
        return take<std::int8_t>() / 16.0;
      case 2:
        return take<std::int16_t>() / 256.0;
      case 3:
        return static_cast<double>(take<float>());
      case 4:
        return take<double>();
      default: {
        constexpr double special[] = {0,    -0.0,     1e-45,    1e-310,    3.4e38, -3.4e38, 1.7e308, -1.7e308,
                                      1e18, 16777217, HUGE_VAL, -HUGE_VAL, NAN,    1,       -1,      0.5};
        return special[below(std::size(special))];
      }
    }
  }
  Vec3 place() {
    const double x = number(), y = number();
    return {x, y, number()};
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

/// Checks a cloud or mesh from a reader.
inline void check_points(const PointSet& p) {
  const std::size_t n = p.size();
  const auto fits = [n](std::size_t size) { return size == 0 || size == n; };
  demand(n > 0 && is_finite(p.origin), "no points, or no origin");
  demand(fits(p.normals.size()) && fits(p.colors.size()) && fits(p.scan_of_point.size()) && fits(p.grid_normals.size()),
         "arrays of different lengths");
  for (const Attribute& a : p.attributes)
    demand(a.components > 0 && !a.name.empty() && a.size() == n * a.components, "an attribute of other points");
  for (const Attribute& a : p.triangle_attributes)
    demand(a.components > 0 && !a.name.empty() && a.size() == p.triangles.size() * a.components,
           "an attribute of other triangles");
  for (const Vec3f& x : p.positions) demand(is_finite(x), "a position is not finite");
  for (const Vec3f& x : p.normals) demand(is_finite(x), "a normal is not finite");
  for (const auto& t : p.triangles)
    for (const std::uint32_t v : t) demand(v < n, "a triangle of points that are not there");
}

/// Checks blocks from a reader.
inline void check_grid(const GridData& data) {
  demand(!data.blocks.empty(), "no blocks");
  for (const GridBlock& b : data.blocks) {
    const bool lattice = b.kind == GridKind::lattice;
    const std::size_t n = lattice ? b.axes[0].size() * b.axes[1].size() * b.axes[2].size() : b.points.size();
    demand(n > 0, "no points");
    demand(lattice || b.kind != GridKind::curvilinear || n == b.dims[0] * b.dims[1] * b.dims[2],
           "other points than its size says");
    demand(b.hidden_points.empty() || b.hidden_points.size() == n, "hidden ones of other points");
    for (const std::uint32_t p : b.cells.corners) demand(p < n, "a cell of points that are not there");
    for (const auto& ring : b.flat_cells)
      for (std::size_t k = 0; k < 4; ++k)
        demand(ring[k] < n || (k == 3 && ring[k] == GridBlock::kNone), "a flat cell of points that are not there");
    for (const auto& axis : b.axes)
      demand(std::is_sorted(axis.begin(), axis.end(), std::less_equal<>()), "an axis that does not increase");
    demand(b.point_numbers.empty() || b.point_numbers.size() == n, "numbers of other points");
    for (const Attribute& a : b.cell_arrays)
      demand(a.rows() == (b.cells.empty() ? b.flat_cells.size() : b.cells.size()), "an array of other cells");
    for (const Attribute& a : b.point_arrays)
      demand(a.components > 0 && !a.name.empty() && a.size() == n * a.components, "an array of other points");
  }
}

}  // namespace sansmesh::fuzz
