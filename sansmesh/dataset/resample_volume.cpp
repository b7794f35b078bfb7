#include "sansmesh/dataset/resample_volume.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh {
namespace {

constexpr std::size_t kUsualSize = 128, kMostSize = 4096, kMostAxis = 65536;
/// Points asked for at a time.
constexpr std::size_t kBatch = std::size_t{1} << 19;

std::array<std::size_t, 3> sizes_of(const Vec3& extent, const ResampleOptions& options) {
  if (options.sizes) return *options.sizes;
  const double longest = std::max({extent.x, extent.y, extent.z});
  const std::size_t size = options.size.value_or(kUsualSize);
  const double step = longest / static_cast<double>(size - 1);
  std::array<std::size_t, 3> sizes{};
  for (std::size_t k = 0; k < 3; ++k)
    sizes[k] = step > 0 ? 1 + static_cast<std::size_t>(std::lround(extent[k] / step)) : 1;
  return sizes;
}

}  // namespace

void ResampleOptions::validate() const {
  if (size && sizes) throw ArgumentError("`size` is one number or three");
  if (size && (*size < 2 || *size > kMostSize))
    throw ArgumentError(fmt::format("`size` must lie in 2..{}, not be {}", kMostSize, *size));
  if (sizes)
    for (const std::size_t n : *sizes)
      if (n < 1 || n > kMostAxis)
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
  // Bricks of a few layers, so that what is asked for together lies together.
  const std::size_t rows = std::max<std::size_t>(1, kBatch / n[0]);
  const std::size_t all_rows = n[1] * n[2];
  std::vector<Vec3> x, g;
  std::vector<double> v;
  for (std::size_t first = 0; first < all_rows; first += rows) {
    const std::size_t last = std::min(first + rows, all_rows), count = (last - first) * n[0], at = first * n[0];
    x.resize(count), v.resize(count * c), g.resize(options.gradients ? count * c : 0);
    parallel_for(first, last, 16, [&](std::size_t row) {
      for (std::size_t i = 0; i < n[0]; ++i)
        x[(row - first) * n[0] + i] = {block.axes[0][i], block.axes[1][row % n[1]], block.axes[2][row / n[1]]};
    });
    field.evaluate(x, {v, g, std::span(inside).subspan(at, count), {}});
    parallel_for(0, count, 4096, [&](std::size_t i) {
      const bool in = inside[at + i] != 0;
      for (std::size_t k = 0; k < c; ++k) {
        values[(at + i) * c + k] = static_cast<float>(in ? v[i * c + k] : options.outside);
        if (g.empty()) continue;
        for (std::size_t d = 0; d < 3; ++d)
          gradients[3 * ((at + i) * c + k) + d] = static_cast<float>(in ? g[i * c + k][d] : options.outside);
      }
    });
    progress.advance(count);
  }
  block.point_arrays.set(name, std::move(values), c);
  if (options.gradients) block.point_arrays.set(name + "_gradient", std::move(gradients), 3 * c);
  block.point_arrays.set(name == "inside" ? "inside_volume" : "inside", std::move(inside));
  return block;
}

}  // namespace sansmesh
