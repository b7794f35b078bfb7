#include "sansmesh/points/oriented_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "sansmesh/core/error.h"
#include "sansmesh/points/cell_sort.h"

namespace sansmesh {
namespace {

// A cube is cut in eight from here on: a plane meets about four of them, which leaves some five samples each.
constexpr std::size_t kSplit = 20;
// Mean of unit normals shorter than this: perhaps more than one sheet. Directions count as different beyond 53°.
constexpr double kCoherent = 0.92, kSameSheet = 0.6;
constexpr std::size_t kMaxSheets = 3;

struct Sheet {
  Vec3 position, normal;  // means of its samples; normal of length 1
  Vec3f lower, upper;     // box of its samples
  std::uint32_t count = 0;
};

struct Leaf {
  std::uint64_t begin, end;    // range of Morton keys
  std::uint32_t first, last;   // samples
  std::uint32_t parent_count;  // samples in the cube twice as large
  std::int32_t level;          // edge = cell · 2^level
};

struct Leaves {
  std::vector<Leaf> items;
  std::vector<std::array<Sheet, kMaxSheets>> sheets;  // count = 0: unused
  Vec3 origin;
  double cell = 0;
  int bits = 0;

  /// Leaves that overlap the cube of level `level` at `coordinates` (in units of that cube), as a range of `items`.
  std::pair<std::size_t, std::size_t> overlap(const std::array<std::int64_t, 3>& at, int level) const {
    const std::int64_t cubes = std::int64_t{1} << (bits - level);
    for (const std::int64_t a : at)
      if (a < 0 || a >= cubes) return {0, 0};
    const std::uint64_t key = detail::morton_key(at[0], at[1], at[2]);
    const std::uint64_t begin = key << 3 * level, end = (key + 1) << 3 * level;
    const auto low = std::partition_point(items.begin(), items.end(), [&](const Leaf& l) { return l.end <= begin; });
    auto high = low;
    while (high != items.end() && high->begin < end) ++high;
    return {static_cast<std::size_t>(low - items.begin()), static_cast<std::size_t>(high - items.begin())};
  }
};

/// Cuts [first, last) of the sorted samples, which fill the cube of `level` that starts at `key`, into leaves.
void cut(const std::vector<KeyIndex>& samples, std::uint64_t key, std::uint32_t first, std::uint32_t last, int level,
         std::uint32_t parent_count, std::vector<Leaf>& leaves) {
  if (first == last) return;
  if (level == 0 || last - first < kSplit) {
    leaves.push_back({key, key + (std::uint64_t{1} << 3 * level), first, last, parent_count, level});
    return;
  }
  const std::uint64_t step = std::uint64_t{1} << 3 * (level - 1);
  std::uint32_t begin = first;
  for (std::uint64_t child = 0; child < 8; ++child) {
    const std::uint64_t until = key + (child + 1) * step;
    const auto end = child == 7 ? samples.begin() + last
                                : std::partition_point(samples.begin() + begin, samples.begin() + last,
                                                       [&](const KeyIndex& s) { return s.key < until; });
    const auto at = static_cast<std::uint32_t>(end - samples.begin());
    cut(samples, key + child * step, begin, at, level - 1, last - first, leaves);
    begin = at;
  }
}

struct Sample {
  Vec3f position, normal;
};

Sheet summarise(std::span<const Sample> samples, const std::vector<std::uint8_t>& label, std::uint8_t wanted) {
  Sheet sheet;
  Box3f box;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (label[i] != wanted) continue;
    sheet.position += Vec3(samples[i].position);
    sheet.normal += Vec3(samples[i].normal);
    box.extend(samples[i].position);
    ++sheet.count;
  }
  if (sheet.count == 0) return sheet;
  sheet.position = sheet.position / double(sheet.count);
  sheet.normal = sheet.normal / double(sheet.count);  // not yet unit: its length says how coherent the sheet is
  sheet.lower = box.lower, sheet.upper = box.upper;
  return sheet;
}

/// Splits the samples of a leaf by the directions of their normals: farthest-point seeds, then k-means on the sphere.
std::array<Sheet, kMaxSheets> find_sheets(std::span<const Sample> samples, std::vector<std::uint8_t>& label) {
  label.assign(samples.size(), 0);
  std::array<Sheet, kMaxSheets> sheets{};
  sheets[0] = summarise(samples, label, 0);
  if (norm(sheets[0].normal) < kCoherent && samples.size() > 1) {
    const Vec3f mean(normalized(sheets[0].normal));
    std::array<Vec3f, kMaxSheets> center;
    std::size_t k = 0;
    // The next seed is the normal that is farthest from all seeds so far (the first: from the mean).
    for (; k < kMaxSheets; ++k) {
      float lowest = 2;
      for (const Sample& s : samples) {
        float nearest = k == 0 ? dot(s.normal, mean) : -2.0f;
        for (std::size_t c = 0; c < k; ++c) nearest = std::max(nearest, dot(s.normal, center[c]));
        if (nearest < lowest) lowest = nearest, center[k] = s.normal;
      }
      if (k > 0 && lowest > (k == 1 ? float(kSameSheet) : 0.3f)) break;
    }
    for (int round = 0; round < 4 && k > 1; ++round) {
      std::array<Vec3f, kMaxSheets> sum{};
      for (std::size_t i = 0; i < samples.size(); ++i) {
        std::size_t best = 0;
        for (std::size_t c = 1; c < k; ++c)
          if (dot(samples[i].normal, center[c]) > dot(samples[i].normal, center[best])) best = c;
        label[i] = static_cast<std::uint8_t>(best);
        sum[best] += samples[i].normal;
      }
      for (std::size_t c = 0; c < k; ++c) center[c] = normalized(sum[c]);
    }
    // Join what has turned out to be one sheet.
    for (std::size_t a = 0; a < k; ++a)
      for (std::size_t b = a + 1; b < k; ++b)
        if (dot(center[a], center[b]) > float(kSameSheet)) {
          for (std::uint8_t& l : label)
            if (l == b) l = static_cast<std::uint8_t>(a);
          center[b] = {};
        }
    for (std::size_t c = 0; c < k; ++c) {
      sheets[c] = summarise(samples, label, static_cast<std::uint8_t>(c));
      // A few strays among many are wrong normals, not a sheet.
      if (sheets[c].count * 16 < samples.size()) sheets[c].count = 0;
    }
  }
  for (Sheet& s : sheets) {
    const double length = norm(s.normal);
    if (!(length > 0.1)) s.count = 0;  // directions that cancel say nothing
    if (s.count > 0) s.normal = s.normal / length;
  }
  return sheets;
}

/// Convex polygon in space.
struct Polygon {
  std::array<Vec3, 16> corner;
  std::size_t n = 0;

  /// Keeps the part with ⟨direction, x⟩ ≤ offset.
  void clip(const Vec3& direction, double offset) {
    std::array<Vec3, 16> kept;
    std::size_t m = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 &p = corner[i], &q = corner[i + 1 < n ? i + 1 : 0];
      const double dp = offset - dot(direction, p), dq = offset - dot(direction, q);
      if (dp >= 0 && m < kept.size()) kept[m++] = p;
      if ((dp >= 0) != (dq >= 0) && m < kept.size()) kept[m++] = p + (q - p) * (dp / (dp - dq));
    }
    corner = kept;
    n = m;
  }
  void clip_axis(std::size_t axis, double side, double at) {
    Vec3 direction;
    direction[axis] = side;
    clip(direction, side * at);
  }
};

/// Mean of the sheet with those beyond the two faces that it is most parallel to: noise and misregistration may have
/// put part of the same sheet there, and only the plane of all of it cuts one cube of the two.
Sheet with_layers(const Leaves& leaves, const Leaf& leaf, const std::array<std::int64_t, 3>& at, const Sheet& sheet) {
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (std::abs(sheet.normal[k]) > std::abs(sheet.normal[axis])) axis = k;
  const double reach = 0.75 * std::ldexp(leaves.cell, leaf.level);
  Vec3 position = sheet.position * double(sheet.count), normal = sheet.normal * double(sheet.count);
  double count = sheet.count;
  for (const int side : {-1, 1}) {
    std::array<std::int64_t, 3> beyond = at;
    beyond[axis] += side;
    const auto [low, high] = leaves.overlap(beyond, leaf.level);
    for (std::size_t l = low; l < high; ++l) {
      if (leaves.items[l].level > leaf.level) continue;
      for (const Sheet& other : leaves.sheets[l]) {
        if (other.count == 0 || dot(other.normal, sheet.normal) < kSameSheet ||
            std::abs(dot(sheet.normal, other.position - sheet.position)) > reach)
          continue;
        position += other.position * double(other.count);
        normal += other.normal * double(other.count);
        count += other.count;
      }
    }
  }
  Sheet all = sheet;
  all.position = position / count;
  all.normal = normalized(normal);
  return all;
}

struct Piece {
  Vec3 position, normal;
  double area = 0;
};

/// The plane of sheet k of a leaf within the leaf's cube and up to the planes of the other sheets.
Piece make_piece(const Leaves& leaves, std::size_t index, std::size_t k) {
  const Leaf& leaf = leaves.items[index];
  const double edge = std::ldexp(leaves.cell, leaf.level);
  const std::uint64_t key = leaf.begin >> 3 * leaf.level;
  const std::array<std::int64_t, 3> at{detail::gather_bits(key), detail::gather_bits(key >> 1),
                                       detail::gather_bits(key >> 2)};
  const Vec3 lower = leaves.origin + Vec3(double(at[0]), double(at[1]), double(at[2])) * edge;
  const Sheet& own = leaves.sheets[index][k];
  const Sheet sheet = with_layers(leaves, leaf, at, own);
  const Vec3& n = sheet.normal;

  const Vec3 middle = lower + Vec3{edge, edge, edge} * 0.5;
  const Vec3 foot = middle - n * dot(middle - sheet.position, n);
  Vec3 t, b;
  tangent_frame(n, t, b);
  t *= 1.8 * edge, b *= 1.8 * edge;
  Polygon polygon;
  polygon.n = 4;
  polygon.corner[0] = foot - t - b, polygon.corner[1] = foot + t - b;
  polygon.corner[2] = foot + t + b, polygon.corner[3] = foot - t + b;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    polygon.clip_axis(axis, -1, lower[axis]);
    polygon.clip_axis(axis, 1, lower[axis] + edge);
  }
  for (std::size_t o = 0; o < kMaxSheets; ++o) {
    const Sheet& other = leaves.sheets[index][o];
    // Opposite sheets of a thin wall go side by side; their planes' meeting line means nothing.
    if (o == k || other.count == 0 || dot(other.normal, n) < -0.7) continue;
    const double side = dot(other.normal, own.position - other.position) > 0 ? -1 : 1;
    polygon.clip(other.normal * side, side * dot(other.normal, other.position));
  }
  if (polygon.n < 3) return {};

  // Where the piece would leave into an empty cube, the surface ends: stop at the samples.
  // One or two samples on their own are outliers, which must not grow with their cube.
  const double margin =
      own.count <= 2 ? 0.5 * std::min(0.7 * edge, leaves.cell) : 0.6 * edge / std::sqrt(double(own.count));
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int side : {-1, 1}) {
      const double face = side < 0 ? lower[axis] : lower[axis] + edge;
      std::size_t on_face = 0;
      for (std::size_t i = 0; i < polygon.n; ++i) on_face += std::abs(polygon.corner[i][axis] - face) < 1e-9 * edge;
      if (on_face < 2) continue;
      std::array<std::int64_t, 3> beyond = at;
      beyond[axis] += side;
      const auto [low, high] = leaves.overlap(beyond, leaf.level);
      if (low != high) continue;
      polygon.clip_axis(axis, side, (side < 0 ? own.lower[axis] : own.upper[axis]) + side * margin);
    }
  if (polygon.n < 3) return {};

  Piece piece{{}, n, 0};
  for (std::size_t i = 1; i + 1 < polygon.n; ++i) {
    const Vec3 u = polygon.corner[i] - polygon.corner[0], v = polygon.corner[i + 1] - polygon.corner[0];
    const double area = 0.5 * norm(cross(u, v));
    piece.area += area;
    piece.position += (u + v) * (area / 3);
  }
  if (!(piece.area > 1e-6 * edge * edge)) return {};
  piece.position = polygon.corner[0] + piece.position / piece.area;
  // One or two samples beside a well sampled part are strays: no more than their share of it.
  if (own.count <= 2 && leaf.parent_count >= kSplit)
    piece.area = std::min(piece.area, 16 * edge * edge * own.count / leaf.parent_count);
  return piece;
}

/// Samples that count, keyed by their cubes of edge `cell` and sorted.
std::vector<KeyIndex> sort_into_cubes(std::span<const Vec3f> positions, std::span<const Vec3f> normals, double cell,
                                      Leaves& leaves) {
  const auto counts = [&](std::size_t i) {
    const float length = squared_norm(normals[i]);
    return is_finite(positions[i]) && std::isfinite(length) && length > 0;
  };
  const Box3f box = parallel_reduce(
      positions.size(), std::size_t{1} << 16, Box3f{},
      [&](std::size_t first, std::size_t last) {
        Box3f part;
        for (std::size_t i = first; i < last; ++i)
          if (counts(i)) part.extend(positions[i]);
        return part;
      },
      [](Box3f a, const Box3f& b) { return a.extend(b), a; });
  if (box.empty()) return {};
  const Vec3 size = Vec3(box.upper) - Vec3(box.lower);
  const double extent = std::max({size.x, size.y, size.z});
  leaves.cell = std::max({cell, std::ldexp(extent, -20), 1e-30});
  // Faces of things like to lie on those of the box: cubes start elsewhere.
  leaves.origin = Vec3(box.lower) - Vec3{0.37, 0.41, 0.43} * leaves.cell;
  while (std::ldexp(leaves.cell, leaves.bits) <= extent + 0.5 * leaves.cell) ++leaves.bits;

  std::vector<KeyIndex> samples(positions.size());
  const double per_cell = 1 / leaves.cell;
  const std::uint64_t left_out = std::uint64_t{1} << 3 * leaves.bits;  // beyond all cubes
  parallel_for(0, positions.size(), 1 << 14, [&](std::size_t i) {
    std::uint64_t key = left_out;
    if (counts(i)) {
      const Vec3 p = (Vec3(positions[i]) - leaves.origin) * per_cell;
      key = detail::morton_key(static_cast<std::uint64_t>(p.x), static_cast<std::uint64_t>(p.y),
                               static_cast<std::uint64_t>(p.z));
    }
    samples[i] = {key, static_cast<unsigned>(i)};
  });
  detail::sort_by_key(samples, 3 * leaves.bits + 1);
  while (!samples.empty() && samples.back().key >= left_out) samples.pop_back();
  return samples;
}

}  // namespace

OrientedPatches make_patches(std::span<const Vec3f> positions, std::span<const Vec3f> normals, double cell) {
  if (positions.size() != normals.size())
    throw ArgumentError("make_patches: " + std::to_string(positions.size()) + " positions but " +
                        std::to_string(normals.size()) + " normals; estimate normals first");
  if (!(cell > 0) || !std::isfinite(cell))
    throw ArgumentError("make_patches: cell = " + std::to_string(cell) + " must be positive and finite");

  Leaves leaves;
  const std::vector<KeyIndex> samples = sort_into_cubes(positions, normals, cell, leaves);
  const auto count = static_cast<std::uint32_t>(samples.size());
  cut(samples, 0, 0, count, leaves.bits, count, leaves.items);

  const std::size_t n = leaves.items.size();
  leaves.sheets.resize(n);
  parallel_ranges(0, n, 64, [&](std::size_t first, std::size_t last) {
    std::vector<Sample> buffer;
    std::vector<std::uint8_t> label;
    for (std::size_t l = first; l < last; ++l) {
      const Leaf& leaf = leaves.items[l];
      buffer.resize(leaf.last - leaf.first);
      for (std::size_t i = leaf.first; i < leaf.last; ++i)
        buffer[i - leaf.first] = {positions[samples[i].index], normalized(normals[samples[i].index])};
      leaves.sheets[l] = find_sheets(buffer, label);
    }
  });
  std::vector<std::array<Piece, kMaxSheets>> pieces(n);
  parallel_for(0, n, 64, [&](std::size_t l) {
    for (std::size_t k = 0; k < kMaxSheets; ++k)
      if (leaves.sheets[l][k].count > 0) pieces[l][k] = make_piece(leaves, l, k);
  });

  OrientedPatches patches;
  for (std::size_t l = 0; l < n; ++l)
    for (const Piece& piece : pieces[l]) {
      const auto area = static_cast<float>(piece.area);
      if (!(area > 0)) continue;
      patches.positions.push_back(Vec3f(piece.position));
      patches.normals.push_back(Vec3f(piece.normal));
      patches.areas.push_back(area);
      patches.sizes.push_back(static_cast<float>(std::ldexp(leaves.cell, leaves.items[l].level)));
    }
  return patches;
}

double suggest_cell(const Box3& box, double spacing, double noise) {
  const Vec3 size = box.empty() ? Vec3{} : box.size();
  const double longest = std::max({size.x, size.y, size.z});
  if (!(longest > 0)) return 1;
  // A surface of area A meets about 1.5 A / cell² cubes.
  const double box_area = 2 * (size.x * size.y + size.y * size.z + size.z * size.x);
  double cell = std::max(std::sqrt(1.5 * 0.5 * box_area / 16000), longest / 256);
  if (noise > 0) cell = std::max(cell, 4 * noise);
  if (spacing > 0) cell = std::max(cell, 2.5 * spacing);
  return std::min(cell, longest / 8);
}

}  // namespace sansmesh
