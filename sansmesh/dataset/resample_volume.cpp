#include "sansmesh/dataset/resample_volume.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kMostSize = 4096, kMostAxis = 65536;
/// Points per batch.
constexpr std::size_t kBatch = std::size_t{1} << 19;
/// Points along an edge of a brick.
constexpr std::size_t kTogether = 12;

std::array<std::size_t, 3> sizes_of(const Vec3& extent, const ResampleOptions& options) {
  if (options.size.size() == 3) return {options.size[0], options.size[1], options.size[2]};
  const double longest = std::max({extent.x, extent.y, extent.z});
  const std::size_t size = options.size[0];
  const double step = longest / static_cast<double>(size - 1);
  std::array<std::size_t, 3> sizes{};
  for (std::size_t k = 0; k < 3; ++k)
    sizes[k] = step > 0 ? 1 + index_in<std::size_t>(std::round(extent[k] / step), 0, size - 1) : 1;
  return sizes;
}

struct CountWords {
  static constexpr auto kind = OptionKind::numbers;
  static constexpr int count = 0;
  static OptionValue get(const std::vector<std::size_t>& sizes) {
    return std::vector<double>(sizes.begin(), sizes.end());
  }
  static std::vector<std::size_t> from(const OptionValue& value) {
    std::vector<std::size_t> sizes;
    for (const double n : std::get<std::vector<double>>(value)) {
      if (!(n >= 1 && n <= kMostAxis && n == std::floor(n)))
        throw ArgumentError(ArgumentFault{.field = {},
                                          .value = fmt::format("{}", n),
                                          .allowed = fmt::format("whole numbers from 1 to {}", kMostAxis),
                                          .remedy = {}});
      sizes.push_back(static_cast<std::size_t>(n));
    }
    return sizes;
  }
};

struct OutsideWords {
  static constexpr auto kind = OptionKind::text;
  static OptionValue get(double v) { return std::isnan(v) ? std::string("nan") : fmt::format("{}", v); }
  static double from(const OptionValue& value) {
    const auto& word = std::get<std::string>(value);
    if (word == "nan") return std::numeric_limits<double>::quiet_NaN();
    const auto number = number_in(word);
    if (!number)
      throw ArgumentError(
          ArgumentFault{.field = {}, .value = printable(word, 60), .allowed = "a number, or nan", .remedy = {}});
    return *number;
  }
};

/// Results are floats. Throws DataError if finite numbers overflow or all of them underflow.
void check_floats(const std::string& name, double largest) {
  constexpr double kMost = std::numeric_limits<float>::max(), kLeast = std::numeric_limits<float>::denorm_min();
  if (largest > kMost || (largest > 0 && largest < kLeast))
    throw DataError(fmt::format("array '{}': values of up to {:.4g} do not fit into the floats of the result",
                                printable(name, 60), largest));
}

}  // namespace

const OptionSchema& ResampleOptions::schema() {
  using O = ResampleOptions;
  static constexpr OptionRow rows[] = {
      option<&O::size, CountWords>({.text = "Points along the longest side, or along x, y and z", .unit = "n [n n]"}),
      option<&O::box>({.text = "Only this box: x0,y0,z0,x1,y1,z1", .unit = "box", .from_data = "that of the volume"}),
      option<&O::gradients>({.text = "Also the gradients, as NAME_gradient (.vti)"}),
      option<&O::outside, OutsideWords>({.text = "Values outside the volume: a number, or nan", .unit = "value"}),
  };
  static constexpr OptionSchema schema{rows};
  return schema;
}

void ResampleOptions::validate() const {
  validate_options(*this);
  if (size.size() != 1 && size.size() != 3) throw ArgumentError("`size` must be one number or three");
  for (const std::size_t n : size)
    if (size.size() == 1 && (n < 2 || n > kMostSize))
      throw ArgumentError(fmt::format("`size` must lie in 2..{}, not be {}", kMostSize, n));
    else if (n < 1 || n > kMostAxis)
      throw ArgumentError(fmt::format("`size` along an axis must lie in 1..{}, not be {}", kMostAxis, n));
  if (box && (!is_finite(box->lower) || !is_finite(box->upper) || box->empty()))
    throw ArgumentError("`box`: its lower corner must lie below its upper one");
}

GridBlock resample_volume(const VolumeField& field, const std::string& name, const ResampleOptions& options,
                          Progress& progress) {
  options.validate();
  const Box3 box = options.box.value_or(field.bounds());
  const Vec3 extent = box.size();
  const std::array<std::size_t, 3> n = sizes_of(extent, options);
  GridBlock block;
  block.kind = GridKind::lattice;
  for (std::size_t k = 0; k < 3; ++k) {
    block.axes[k].resize(n[k]);
    const double step = n[k] > 1 ? extent[k] / static_cast<double>(n[k] - 1) : 0;
    const double first = n[k] > 1 ? box.lower[k] : 0.5 * (box.lower[k] + box.upper[k]);
    for (std::size_t i = 0; i < n[k]; ++i) block.axes[k][i] = first + static_cast<double>(i) * step;
  }
  const std::size_t points = n[0] * n[1] * n[2], c = field.components();
  std::vector<float> values(points * c), gradients(options.gradients ? 3 * points * c : 0);
  std::vector<std::uint8_t> inside(points);

  progress.begin("resample", points);
  // Bricks: points of a batch are close together in all three directions.
  std::array<std::size_t, 3> bricks;
  for (std::size_t k = 0; k < 3; ++k) bricks[k] = (n[k] + kTogether - 1) / kTogether;
  const std::size_t all = bricks[0] * bricks[1] * bricks[2];
  std::vector<Vec3> x, g;
  std::vector<double> v;
  std::vector<std::uint8_t> in;
  std::vector<std::size_t> to;
  double largest = 0, steepest = 0;
  for (std::size_t brick = 0; brick < all;) {
    x.clear(), to.clear();
    for (; brick < all && x.size() < kBatch; ++brick) {
      const std::array<std::size_t, 3> first{brick % bricks[0] * kTogether, brick / bricks[0] % bricks[1] * kTogether,
                                             brick / bricks[0] / bricks[1] * kTogether};
      for (std::size_t l = first[2]; l < std::min(n[2], first[2] + kTogether); ++l)
        for (std::size_t j = first[1]; j < std::min(n[1], first[1] + kTogether); ++j)
          for (std::size_t i = first[0]; i < std::min(n[0], first[0] + kTogether); ++i) {
            x.push_back({block.axes[0][i], block.axes[1][j], block.axes[2][l]});
            to.push_back(i + n[0] * (j + n[1] * l));
          }
    }
    const std::size_t count = x.size();
    v.resize(count * c), g.resize(options.gradients ? count * c : 0), in.resize(count);
    field.evaluate(x, {v, g, in});
    for (std::size_t i = 0; i < v.size(); ++i)
      if (in[i / c] != 0) largest = std::max(largest, std::abs(v[i]));
    for (std::size_t i = 0; i < g.size(); ++i)
      if (in[i / c] != 0) steepest = std::max({steepest, std::abs(g[i].x), std::abs(g[i].y), std::abs(g[i].z)});
    parallel_for(0, count, 4096, [&](std::size_t i) {
      inside[to[i]] = in[i];
      for (std::size_t k = 0; k < c; ++k) {
        values[to[i] * c + k] = static_cast<float>(in[i] != 0 ? v[i * c + k] : options.outside);
        if (g.empty()) continue;
        for (std::size_t d = 0; d < 3; ++d)
          gradients[3 * (to[i] * c + k) + d] = static_cast<float>(in[i] != 0 ? g[i * c + k][d] : options.outside);
      }
    });
    progress.advance(count);
  }
  check_floats(name, largest);
  if (options.gradients) check_floats(name + "_gradient", steepest);
  block.point_arrays.set(name, std::move(values), c);
  if (options.gradients) block.point_arrays.set(name + "_gradient", std::move(gradients), 3 * c);
  block.point_arrays.set(name == "inside" ? "inside_volume" : "inside", std::move(inside));
  return block;
}

}  // namespace sansmesh::inline v1
