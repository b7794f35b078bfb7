#include "sansmesh/io/grids/image_block.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sansmesh/core/length_limits.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/io/binary.h"
#include "sansmesh/io/inflate.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {
namespace {

/// Deviation from perpendicular axes, as a cosine, that text with few digits may cause.
constexpr double perpendicular = 1e-4;
constexpr std::size_t most_on_axis = std::size_t{1} << 24;

void complete_steps(const Input& in, const ImageLayout& layout, std::array<Vec3, 3>& step) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (!is_finite(step[k])) in.fail("its header gives a spacing or direction that is not a number");
    const double longest = std::max({std::abs(step[k].x), std::abs(step[k].y), std::abs(step[k].z)});
    if (longest > kLargestOfVolume || (longest > 0 && longest < 1e-9 * kSmallestOfVolume))
      in.fail(fmt::format("its header gives a spacing of {:g}: write it in another unit", longest));
    if (norm(step[k]) > 0) continue;
    if (layout.dims[k] > 1) in.fail("its header gives an axis no spacing");
    const Vec3 across = normalized(cross(step[(k + 1) % 3], step[(k + 2) % 3]));
    const double length = std::max(norm(step[(k + 1) % 3]), norm(step[(k + 2) % 3]));
    step[k] = across * (length > 0 ? length : 1.0);
  }
  const Vec3 n[3] = {normalized(step[0]), normalized(step[1]), normalized(step[2])};
  if (!(std::abs(dot(cross(n[0], n[1]), n[2])) > 1e-6)) in.fail("its header gives axes that lie in a plane");
}

}  // namespace

std::uint64_t checked_product(const Input& in, std::initializer_list<std::uint64_t> factors) {
  std::uint64_t product = 1;
  for (const std::uint64_t f : factors) {
    if (f != 0 && product > (std::uint64_t{1} << 48) / f) in.fail("its header gives an impossible size");
    product *= f;
  }
  return product;
}

GridBlock image_block(const Input& in, const ImageLayout& layout) {
  std::array<Vec3, 3> step = layout.steps;
  complete_steps(in, layout, step);
  if (!is_finite(layout.origin)) in.fail("its header gives an origin that is not a number");
  // Axes are stored as lists of numbers: a damaged header must not request longer ones than possible.
  for (const std::size_t n : layout.dims)
    if (n > most_on_axis) in.fail(fmt::format("its header gives {} points along an axis", grouped(n)));
  GridBlock block;
  block.dims = layout.dims;
  const Vec3 n[3] = {normalized(step[0]), normalized(step[1]), normalized(step[2])};
  const bool straight = std::abs(dot(n[0], n[1])) < perpendicular && std::abs(dot(n[1], n[2])) < perpendicular &&
                        std::abs(dot(n[2], n[0])) < perpendicular;
  if (!straight) {
    block.kind = GridKind::curvilinear;
    block.points.reserve(checked_product(in, {layout.dims[0], layout.dims[1], layout.dims[2]}));
    for (std::size_t k = 0; k < layout.dims[2]; ++k) {
      for (std::size_t j = 0; j < layout.dims[1]; ++j) {
        for (std::size_t i = 0; i < layout.dims[0]; ++i) {
          block.points.push_back(layout.origin + step[0] * static_cast<double>(i) + step[1] * static_cast<double>(j) +
                                 step[2] * static_cast<double>(k));
        }
      }
    }
    return block;
  }
  block.kind = GridKind::lattice;
  block.origin = layout.origin;
  block.directions[0] = n[0];
  block.directions[1] = normalized(n[1] - n[0] * dot(n[0], n[1]));
  const Vec3 third = cross(block.directions[0], block.directions[1]);
  block.directions[2] = dot(third, n[2]) < 0 ? -third : third;
  for (std::size_t k = 0; k < 3; ++k) {
    // Axes parallel to the coordinate axes keep their exact values.
    for (std::size_t c = 0; c < 3; ++c) {
      if (block.directions[k][c] == 0) block.directions[k][c] = 0;  // no negative zero
    }
    const double length = norm(step[k]);
    block.axes[k].resize(layout.dims[k]);
    for (std::size_t i = 0; i < layout.dims[k]; ++i) block.axes[k][i] = static_cast<double>(i) * length;
  }
  return block;
}

AttributeValues decode_values(const char* bytes, std::size_t count, NumberType type, bool big_endian) {
  return with_loader(type, big_endian, [&](auto at) {
    using T = typename decltype(at)::Value;
    std::vector<T> values(count);
    for (std::size_t i = 0; i < count; ++i) values[i] = at(bytes + i * sizeof(T));
    return AttributeValues(std::move(values));
  });
}

std::vector<char> unpack_values(const Input& data, std::uint64_t needed, std::uint64_t most) {
  const std::uint64_t there = data.bytes.size() * kMostExpansion;
  if (needed > there)
    data.fail(fmt::format("truncated: its header announces {} bytes of numbers, but its {} packed ones hold {} at most",
                          grouped(needed), grouped(data.bytes.size()), grouped(there)));
  Inflated inflated = inflate_bytes(data.file, data.bytes, needed, most);
  if (!inflated.complete) data.fail("truncated: its compressed numbers end early");
  return std::move(inflated.bytes);
}

AttributeValues parse_values(const Input& in, std::string_view text, std::size_t count, NumberType type) {
  // A number takes at least one character, and a separator follows.
  if (count > text.size() / 2 + 1)
    in.fail(fmt::format("truncated: has no room for the {} numbers of its header in {} characters", grouped(count),
                        grouped(text.size())));
  return with_loader(type, false, [&](auto at) {
    using T = typename decltype(at)::Value;
    std::vector<T> values(count);
    TextScanner s(text);
    for (std::size_t i = 0; i < count; ++i) {
      s.skip_space();
      while (!s.at_end() && s.rest().front() == ',') {
        s = TextScanner(s.rest().substr(1));
        s.skip_space();
      }
      if (s.at_end()) in.fail(fmt::format("truncated: holds {} of {} numbers", grouped(i), grouped(count)));
      if constexpr (std::is_integral_v<T>) {
        // Characters are written as numbers, and integers sometimes as reals.
        double v = 0;
        const TextScanner before = s;
        std::int64_t whole = 0;
        if (s.number(whole) && (s.at_end() || s.rest().find_first_of(".eE") != 0)) {
          if constexpr (sizeof(T) < 8) {
            if (whole < std::numeric_limits<T>::min() || whole > std::numeric_limits<T>::max())
              in.fail(fmt::format("number {} is beyond its type: {}", grouped(i + 1), whole));
          }
          values[i] = static_cast<T>(whole);
        } else {
          s = before;
          if (!s.number(v) || !(v >= static_cast<double>(std::numeric_limits<T>::min())) ||
              !(v < static_cast<double>(std::numeric_limits<T>::max()) + 1.0))
            in.fail(fmt::format("'{}' is not a number of its type", s.word().substr(0, 40)));
          values[i] = static_cast<T>(v);
        }
      } else if (!s.number(values[i])) {
        in.fail(fmt::format("'{}' is not a number", s.word().substr(0, 40)));
      }
    }
    return AttributeValues(std::move(values));
  });
}

}  // namespace sansmesh::inline v1::io
