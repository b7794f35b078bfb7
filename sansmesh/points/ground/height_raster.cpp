#include "sansmesh/points/ground/height_raster.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr float kNone = std::numeric_limits<float>::infinity();
/// Lines that are processed together, element by element.
constexpr std::size_t kLanes = 16;

/// Running minimum over 2·half + 1 elements of kLanes lines: blocks of the length of the window have minima from the
/// left and from the right, and each window consists of parts of two blocks [vanherk1992].
class LineMinimum {
 public:
  explicit LineMinimum(std::size_t half) : half_(half), window_(2 * half + 1) {}

  /// Space for lines of n elements; returns element 0 of all lanes, followed by the others.
  float* start(std::size_t n) {
    n_ = n;
    padded_ = (n + 2 * half_ + window_ - 1) / window_ * window_;
    line_.assign(padded_ * kLanes, kNone);
    ahead_.resize(padded_ * kLanes);
    return line_.data() + half_ * kLanes;
  }

  /// Minima around element i of all lanes, n elements from the returned address.
  const float* finish() {
    for (std::size_t block = 0; block < padded_; block += window_) {
      copy_lanes(block);
      for (std::size_t i = block + 1; i < block + window_; ++i) extend(ahead_, i - 1, line_, i, ahead_, i);
      for (std::size_t i = block + window_ - 1; i-- > block;) extend(line_, i + 1, line_, i, line_, i);
    }
    for (std::size_t i = 0; i < n_; ++i) extend(line_, i, ahead_, i + 2 * half_, line_, i);
    return line_.data();
  }

 private:
  void copy_lanes(std::size_t i) { std::copy_n(line_.data() + i * kLanes, kLanes, ahead_.data() + i * kLanes); }
  static void extend(const std::vector<float>& a, std::size_t at_a, const std::vector<float>& b, std::size_t at_b,
                     std::vector<float>& to, std::size_t at) {
    const float *x = a.data() + at_a * kLanes, *y = b.data() + at_b * kLanes;
    float* z = to.data() + at * kLanes;
    for (std::size_t k = 0; k < kLanes; ++k) z[k] = x[k] < y[k] ? x[k] : y[k];
  }

  std::size_t half_, window_, n_ = 0, padded_ = 0;
  std::vector<float> line_, ahead_;
};

/// Minimum along rows.
void minimum_of_rows(std::vector<float>& z, std::size_t columns, std::size_t rows, std::size_t half) {
  parallel_ranges(0, (rows + kLanes - 1) / kLanes, 4, [&](std::size_t begin, std::size_t end) {
    LineMinimum minimum(half);
    for (std::size_t block = begin; block < end; ++block) {
      const std::size_t first = block * kLanes, lanes = std::min(kLanes, rows - first);
      float* const to = minimum.start(columns);
      for (std::size_t k = 0; k < lanes; ++k)
        for (std::size_t c = 0; c < columns; ++c) to[c * kLanes + k] = z[(first + k) * columns + c];
      const float* const from = minimum.finish();
      for (std::size_t k = 0; k < lanes; ++k)
        for (std::size_t c = 0; c < columns; ++c) z[(first + k) * columns + c] = from[c * kLanes + k];
    }
  });
}

/// Minimum along lines that advance by one row and by `slant` columns: −1, 0 or 1.
void minimum_of_lines(std::vector<float>& z, std::size_t columns, std::size_t rows, int slant, std::size_t half) {
  const auto width = static_cast<std::ptrdiff_t>(columns), height = static_cast<std::ptrdiff_t>(rows);
  const std::ptrdiff_t least = slant > 0 ? 1 - height : 0, most = slant < 0 ? width + height - 1 : width;
  constexpr auto kWide = static_cast<std::ptrdiff_t>(kLanes);
  const auto blocks = static_cast<std::size_t>((most - least + kWide - 1) / kWide);
  parallel_ranges(0, blocks, 4, [&](std::size_t begin, std::size_t end) {
    LineMinimum minimum(half);
    for (std::size_t block = begin; block < end; ++block) {
      const std::ptrdiff_t start = least + static_cast<std::ptrdiff_t>(block) * kWide;  // column of lane 0 in row 0
      // Rows in which some lane is inside.
      std::ptrdiff_t first = 0, last = height;
      if (slant > 0) first = std::max<std::ptrdiff_t>(0, 1 - kWide - start), last = std::min(height, width - start);
      if (slant < 0) first = std::max<std::ptrdiff_t>(0, start - width + 1), last = std::min(height, start + kWide);
      if (first >= last) continue;
      const auto inside = [&](std::ptrdiff_t r) {
        const std::ptrdiff_t c = start + slant * r;
        return std::pair{std::max<std::ptrdiff_t>(0, -c), std::min(kWide, width - c)};
      };
      float* const to = minimum.start(static_cast<std::size_t>(last - first));
      for (std::ptrdiff_t r = first; r < last; ++r) {
        const auto [lower, upper] = inside(r);
        const float* const row = z.data() + r * width + start + slant * r;
        float* const line = to + (r - first) * kWide;
        if (lower == 0 && upper == kWide)
          std::copy_n(row, kWide, line);
        else
          std::copy(row + lower, row + upper, line + lower);
      }
      const float* const from = minimum.finish();
      for (std::ptrdiff_t r = first; r < last; ++r) {
        const auto [lower, upper] = inside(r);
        float* const row = z.data() + r * width + start + slant * r;
        const float* const line = from + (r - first) * kWide;
        if (lower == 0 && upper == kWide)
          std::copy_n(line, kWide, row);
        else
          std::copy(line + lower, line + upper, row + lower);
      }
    }
  });
}

/// Minimum over an octagon: the sum of a square and of a square turned by 45°.
void erode(std::vector<float>& z, std::size_t columns, std::size_t rows, std::size_t radius) {
  const std::size_t turned =
      std::min(static_cast<std::size_t>(std::lround(0.29 * static_cast<double>(radius))), (radius - 1) / 2);
  const std::size_t straight = radius - 2 * turned;
  minimum_of_rows(z, columns, rows, straight);
  minimum_of_lines(z, columns, rows, 0, straight);
  if (turned == 0) return;
  minimum_of_lines(z, columns, rows, 1, turned);
  minimum_of_lines(z, columns, rows, -1, turned);
}

}  // namespace

HeightRaster opened(const HeightRaster& raster, std::size_t radius, const std::vector<std::uint8_t>& centers) {
  HeightRaster result = raster;
  std::vector<float>& z = result.heights;
  for (float& h : z)
    if (std::isnan(h)) h = kNone;
  erode(z, raster.columns, raster.rows, radius);
  for (std::size_t i = 0; i < z.size(); ++i) z[i] = centers[i] ? -z[i] : kNone;
  erode(z, raster.columns, raster.rows, radius);
  for (float& h : z) h = -h;
  return result;
}

HeightRaster halved(const HeightRaster& raster) {
  HeightRaster half{(raster.columns + 1) / 2, (raster.rows + 1) / 2, {}};
  half.heights.assign(half.columns * half.rows, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t r = 0; r < raster.rows; ++r)
    for (std::size_t c = 0; c < raster.columns; ++c) {
      const float h = raster.heights[r * raster.columns + c];
      float& least = half.heights[r / 2 * half.columns + c / 2];
      if (!(least <= h)) least = std::isnan(h) ? least : h;
    }
  return half;
}

}  // namespace sansmesh::inline v1
