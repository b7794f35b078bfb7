#include "sansmesh/volume/gathered_cells.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <optional>
#include <string>

#include "sansmesh/core/error.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/morton.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/volume/box_tree.h"
#include "sansmesh/volume/cell_geometry.h"
#include "sansmesh/volume/delaunay.h"

namespace sansmesh {
namespace {

std::array<std::size_t, 3> dims_of(const GridBlock& b) {
  if (b.kind == GridKind::lattice) return {b.axes[0].size(), b.axes[1].size(), b.axes[2].size()};
  return b.dims;
}
bool is_structured(const GridBlock& b) { return b.kind == GridKind::lattice || b.kind == GridKind::curvilinear; }

std::size_t points_of(const GridBlock& b) {
  const auto n = dims_of(b);
  return is_structured(b) ? n[0] * n[1] * n[2] : b.points.size();
}
std::size_t cells_of(const GridBlock& b) {
  if (is_structured(b)) {
    if (points_of(b) == 0) return 0;
    std::size_t product = 1;
    for (const std::size_t n : dims_of(b)) product *= std::max<std::size_t>(1, n - 1);
    return product;
  }
  return b.cells.empty() ? b.flat_cells.size() : b.cells.size();
}
std::size_t layers_of(const GridBlock& b) {
  const auto n = dims_of(b);
  return static_cast<std::size_t>(std::count(n.begin(), n.end(), 1));
}
/// Whether it has cells with volume.
bool is_solid(const GridBlock& b) {
  return is_structured(b) ? points_of(b) > 0 && layers_of(b) == 0 : !b.cells.empty();
}

std::string name_of(const GridBlock& b, std::size_t number) {
  return b.name.empty() ? fmt::format("block {}", number) : fmt::format("block '{}'", printable(b.name, 60));
}

void check_block(const GridBlock& b, std::size_t number) {
  const std::size_t points = points_of(b);
  const auto fail = [&](const std::string& cause) { throw DataError(name_of(b, number) + ": " + cause); };
  if (b.kind == GridKind::curvilinear && b.points.size() != points)
    fail(fmt::format("{} points do not make a grid of {} x {} x {}", b.points.size(), b.dims[0], b.dims[1], b.dims[2]));
  if (b.kind == GridKind::lattice)
    for (const auto& axis : b.axes)
      for (std::size_t i = 0; i < axis.size(); ++i)
        if (!std::isfinite(axis[i]) || (i > 0 && !(axis[i] > axis[i - 1])))
          fail("the coordinates of an axis do not increase");
  for (const std::uint32_t p : b.cells.corners)
    if (p >= points) fail(fmt::format("a cell names point {} of {}", p, points));
  for (const auto& flat : b.flat_cells)
    for (std::size_t k = 0; k < 4; ++k)
      if (flat[k] >= points && !(k == 3 && flat[k] == GridBlock::kNone))
        fail(fmt::format("a cell names point {} of {}", flat[k], points));
  if (!b.hidden_points.empty() && b.hidden_points.size() != points) fail("flags of points are not one a point");
  if (!b.hidden_cells.empty() && b.hidden_cells.size() != cells_of(b)) fail("flags of cells are not one a cell");
  for (const Attribute& a : b.point_arrays)
    if (a.rows() != points) fail("array '" + printable(a.name, 60) + "' has not one row a point");
  for (const Attribute& a : b.cell_arrays)
    if (a.rows() != cells_of(b)) fail("array '" + printable(a.name, 60) + "' has not one row a cell");
}

Vec3 lattice_position(const GridBlock& b, std::size_t i) {
  const std::size_t nx = b.axes[0].size(), ny = b.axes[1].size();
  return b.origin + b.directions[0] * b.axes[0][i % nx] + b.directions[1] * b.axes[1][i / nx % ny] +
         b.directions[2] * b.axes[2][i / (nx * ny)];
}

/// Something like a hash of all bytes that go in.
struct Digest {
  std::uint64_t value = 0x9E3779B97F4A7C15u;
  void add(std::uint64_t v) {
    value = (value ^ v) * 0xff51afd7ed558ccdu;
    value ^= value >> 32;
  }
  template <class T>
  void add(const std::vector<T>& numbers) {
    add(numbers.size());
    const auto* bytes = reinterpret_cast<const unsigned char*>(numbers.data());
    const std::size_t size = numbers.size() * sizeof(T);
    std::size_t i = 0;
    for (; i + 8 <= size; i += 8) {
      std::uint64_t word;
      std::memcpy(&word, bytes + i, 8);
      add(word);
    }
    for (; i < size; ++i) add(std::uint64_t{bytes[i]});
  }
  void add(const AttributeTable& table) {
    for (const Attribute& a : table) {
      add(std::vector<char>(a.name.begin(), a.name.end()));
      add(a.components);
      std::visit([this](const auto& v) { add(v); }, a.values);
    }
  }
};

std::uint64_t digest_of(const GridBlock& b) {
  Digest d;
  d.add(static_cast<std::uint64_t>(b.kind));
  for (const auto& axis : b.axes) d.add(axis);
  std::vector<Vec3> frame(b.directions.begin(), b.directions.end());
  frame.push_back(b.origin);
  d.add(frame);
  for (const std::size_t n : b.dims) d.add(n);
  d.add(b.points);
  d.add(b.cells.corners);
  d.add(b.cells.shapes);
  d.add(b.flat_cells);
  d.add(b.point_arrays);
  d.add(b.cell_arrays);
  d.add(b.hidden_points);
  d.add(b.hidden_cells);
  return d.value;
}

/// What one block puts into the lists.
class BlockGatherer {
 public:
  BlockGatherer(const GridBlock& block, std::size_t number, bool many, bool centers, GatheredCells& out,
                VolumeFacts& facts)
      : b_(block),
        number_(static_cast<std::uint16_t>(number)),
        many_(many),
        centers_(centers),
        out_(out),
        facts_(facts) {}

  void run() {
    first_ = out_.points.size();
    const std::size_t n = points_of(b_);
    usable_.assign(n, 1);
    out_.points.reserve(first_ + n);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 p = b_.kind == GridKind::lattice ? lattice_position(b_, i) : b_.points[i];
      if (!is_finite(p))
        usable_[i] = 0, ++facts_.not_finite;
      else if (!b_.hidden_points.empty() && b_.hidden_points[i])
        usable_[i] = 0, ++facts_.hidden;
      add_point(usable_[i] ? p : Vec3{}, i, !is_structured(b_) || many_ || on_side(i));
    }
    if (is_solid(b_))
      is_structured(b_) ? add_structured() : add_cells();
    else
      add_slab();
  }

 private:
  void add_point(const Vec3& p, std::size_t row, bool joinable) {
    out_.points.push_back(p);
    out_.point_row.push_back(static_cast<std::uint32_t>(row));
    if (many_) out_.point_block.push_back(number_);
    out_.joinable.push_back(joinable);
  }

  bool on_side(std::size_t i) const {
    const auto n = dims_of(b_);
    const std::size_t at[] = {i % n[0], i / n[0] % n[1], i / (n[0] * n[1])};
    for (std::size_t k = 0; k < 3; ++k)
      if (at[k] == 0 || at[k] + 1 == n[k]) return true;
    return false;
  }

  bool visible(std::size_t row, std::span<const std::uint32_t> points) {
    if (!b_.hidden_cells.empty() && b_.hidden_cells[row]) {
      ++facts_.hidden;
      return false;
    }
    return std::all_of(points.begin(), points.end(), [this](std::uint32_t p) { return usable_[p] != 0; });
  }

  /// `points` of the block.
  void add_cell(CellShape shape, std::span<const std::uint32_t> points, std::size_t row) {
    std::array<std::uint32_t, 8> corners;
    Vec3 sum;
    for (std::size_t c = 0; c < points.size(); ++c) {
      corners[c] = static_cast<std::uint32_t>(first_ + points[c]);
      if (centers_) sum += out_.points[corners[c]];
    }
    out_.cells.add(shape, std::span(corners).first(points.size()));
    out_.cell_row.push_back(static_cast<std::uint32_t>(row));
    if (many_) out_.cell_block.push_back(number_);
    if (centers_) out_.centers.push_back(sum / static_cast<double>(points.size()));
  }

  void add_cells() {
    for (std::size_t c = 0; c < b_.cells.size(); ++c)
      if (visible(c, b_.cells[c])) add_cell(b_.cells.shapes[c], b_.cells[c], c);
  }

  void add_structured() {
    const auto n = dims_of(b_);
    std::size_t row = 0;
    out_.cells.shapes.reserve(out_.cells.size() + cells_of(b_));
    out_.cells.first.reserve(out_.cells.first.size() + cells_of(b_));
    out_.cells.corners.reserve(out_.cells.corners.size() + 8 * cells_of(b_));
    for (std::size_t k = 0; k + 1 < n[2]; ++k)
      for (std::size_t j = 0; j + 1 < n[1]; ++j)
        for (std::size_t i = 0; i + 1 < n[0]; ++i, ++row) {
          const auto p = static_cast<std::uint32_t>(i + n[0] * (j + n[1] * k));
          const auto x = std::uint32_t{1}, y = static_cast<std::uint32_t>(n[0]),
                     z = static_cast<std::uint32_t>(n[0] * n[1]);
          const std::array corners{p, p + x, p + x + y, p + y, p + z, p + z + x, p + z + x + y, p + z + y};
          if (visible(row, corners)) add_cell(CellShape::hexahedron, corners, row);
        }
  }

  /// One layer, or flat cells: both sides of a slab, whose middle the points are.
  void add_slab() {
    std::vector<std::array<std::uint32_t, 4>> flat;
    if (is_structured(b_)) {
      if (layers_of(b_) != 1) return;
      std::array<std::size_t, 2> m{}, stride{};
      std::size_t axes = 0, step = 1;
      const auto n = dims_of(b_);
      for (std::size_t k = 0; k < 3; step *= n[k++])
        if (n[k] > 1) m[axes] = n[k], stride[axes++] = step;
      for (std::size_t j = 0; j + 1 < m[1]; ++j)
        for (std::size_t i = 0; i + 1 < m[0]; ++i) {
          const std::size_t p = i * stride[0] + j * stride[1];
          flat.push_back({static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(p + stride[0]),
                          static_cast<std::uint32_t>(p + stride[0] + stride[1]),
                          static_cast<std::uint32_t>(p + stride[1])});
        }
    } else {
      flat = b_.flat_cells;
    }
    const auto corners = [](const std::array<std::uint32_t, 4>& cell) { return cell[3] == GridBlock::kNone ? 3u : 4u; };
    // Thickness: the median of the edges; directions: of the cells around each point, all on one side of the first.
    std::vector<Vec3> normals(usable_.size());
    std::vector<double> lengths;
    std::vector<std::uint8_t> shown(flat.size());
    for (std::size_t c = 0; c < flat.size(); ++c) {
      const std::size_t count = corners(flat[c]);
      shown[c] = visible(c, std::span(flat[c]).first(count));
      if (!shown[c]) continue;
      Vec3 normal;
      for (std::size_t k = 0; k < count; ++k) {
        const Vec3 &a = out_.points[first_ + flat[c][k]], &d = out_.points[first_ + flat[c][(k + 1) % count]];
        const Vec3& o = out_.points[first_ + flat[c][0]];
        normal += cross(a - o, d - o);
        if (norm(d - a) > 0) lengths.push_back(norm(d - a));
      }
      for (std::size_t k = 0; k < count; ++k) {
        Vec3& at = normals[flat[c][k]];
        at += dot(at, normal) < 0 ? -normal : normal;
      }
    }
    if (lengths.empty()) return;
    const double thickness = median(lengths);
    facts_.layer = std::max(facts_.layer, thickness);
    const auto n = static_cast<std::uint32_t>(usable_.size());
    for (std::uint32_t i = 0; i < n; ++i) {
      const Vec3 half = normalized(normals[i]) * (thickness / 2), middle = out_.points[first_ + i];
      out_.points[first_ + i] = middle - half;
      out_.joinable[first_ + i] = true;
      add_point(middle + half, i, true);
    }
    for (std::size_t c = 0; c < flat.size(); ++c) {
      if (!shown[c]) continue;
      const auto& f = flat[c];
      if (corners(f) == 3)
        add_cell(CellShape::wedge, std::array{f[0], f[2], f[1], f[0] + n, f[2] + n, f[1] + n}, c);
      else
        add_cell(CellShape::hexahedron, std::array{f[0], f[1], f[2], f[3], f[0] + n, f[1] + n, f[2] + n, f[3] + n}, c);
    }
  }

  const GridBlock& b_;
  std::uint16_t number_;
  bool many_, centers_;
  GatheredCells& out_;
  VolumeFacts& facts_;
  std::size_t first_ = 0;
  std::vector<std::uint8_t> usable_;
};

std::array<Vec3, 8> corner_places(const GatheredCells& g, std::span<const std::uint32_t> corners) {
  std::array<Vec3, 8> x;
  for (std::size_t c = 0; c < corners.size(); ++c) x[c] = g.points[corners[c]];
  return x;
}

}  // namespace

std::vector<std::size_t> canonical_order(const GridData& data) {
  std::vector<std::size_t> order(data.blocks.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (order.size() < 2) return order;
  std::vector<std::uint64_t> digests(order.size());
  parallel_for(0, order.size(), 1, [&](std::size_t b) { digests[b] = digest_of(data.blocks[b]); });
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const int la = data.blocks[a].level, lb = data.blocks[b].level;
    return la != lb ? la < lb : digests[a] < digests[b];
  });
  return order;
}

GatheredCells gather_cells(const GridData& data, const std::vector<std::size_t>& order, bool centers,
                           VolumeFacts& facts) {
  if (data.blocks.size() > 65536)
    throw DataError(fmt::format("{} blocks: at most 65536 can be used", data.blocks.size()));
  facts.blocks = data.blocks.size();
  std::size_t total = 0;
  bool solid = false;
  for (std::size_t b = 0; b < data.blocks.size(); ++b) {
    check_block(data.blocks[b], b);
    total += points_of(data.blocks[b]);
    facts.points += points_of(data.blocks[b]);
    facts.cells += cells_of(data.blocks[b]);
    solid = solid || is_solid(data.blocks[b]);
  }
  if (total > 0xfffffff0u / 2) throw DataError(fmt::format("{} points are more than can be used", total));
  GatheredCells gathered;
  for (const std::size_t b : order) {
    const GridBlock& block = data.blocks[b];
    if (block.kind == GridKind::scattered || points_of(block) == 0 || (solid && !is_solid(block))) continue;
    BlockGatherer(block, b, data.blocks.size() > 1, centers, gathered, facts).run();
  }
  return gathered;
}

GatheredCells gather_scattered(const GridData& data, const std::vector<std::size_t>& order, VolumeFacts& facts,
                               std::vector<std::uint32_t>& first) {
  struct Place {
    std::uint64_t code;
    Vec3 x;
    std::uint32_t row;
    std::uint16_t block;
  };
  std::vector<Place> places;
  Box3 box;
  for (const std::size_t b : order) {
    const GridBlock& block = data.blocks[b];
    if (block.kind != GridKind::scattered) continue;
    for (std::size_t i = 0; i < block.points.size(); ++i) {
      if (!is_finite(block.points[i])) {
        ++facts.not_finite;
      } else if (!block.hidden_points.empty() && block.hidden_points[i]) {
        ++facts.hidden;
      } else {
        places.push_back({0, block.points[i], static_cast<std::uint32_t>(i), static_cast<std::uint16_t>(b)});
        box.extend(block.points[i]);
      }
    }
  }
  if (places.empty()) throw DataError(facts.hidden > 0 ? "all points are hidden" : "no point has finite coordinates");
  const Vec3 size = box.size();
  const double scale = 2097151 / std::max({size.x, size.y, size.z, std::numeric_limits<double>::min()});
  parallel_for(0, places.size(), 8192, [&](std::size_t i) {
    const Vec3 q = (places[i].x - box.lower) * scale;
    places[i].code =
        morton_code(static_cast<std::uint32_t>(q.x), static_cast<std::uint32_t>(q.y), static_cast<std::uint32_t>(q.z));
  });
  std::stable_sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    if (a.code != b.code) return a.code < b.code;
    return a.x.x != b.x.x ? a.x.x < b.x.x : a.x.y != b.x.y ? a.x.y < b.x.y : a.x.z < b.x.z;
  });
  GatheredCells g;
  for (const Place& p : places) {
    g.points.push_back(p.x);
    g.point_row.push_back(p.row);
    if (data.blocks.size() > 1) g.point_block.push_back(p.block);
  }
  places = {};
  const double reach = 1e-9 * box.diagonal();
  const BoxTree tree(g.points.size(), [&](std::size_t i) {
    return Box3{g.points[i] - Vec3{reach, reach, reach}, g.points[i] + Vec3{reach, reach, reach}};
  });
  UnionFind sets(g.points.size());
  std::vector<std::uint32_t> near, distinct;
  for (std::size_t i = 0; i < g.points.size(); ++i) {
    tree.containing(g.points[i], near);
    for (const std::uint32_t j : near)
      if (squared_norm(g.points[j] - g.points[i]) <= reach * reach) sets.join(static_cast<std::uint32_t>(i), j);
  }
  std::vector<Vec3> apart;
  first.resize(g.points.size());
  for (std::size_t i = 0; i < g.points.size(); ++i) {
    first[i] = sets.find(static_cast<std::uint32_t>(i));
    if (first[i] == i) apart.push_back(g.points[i]), distinct.push_back(static_cast<std::uint32_t>(i));
  }
  if (distinct.size() == g.points.size()) first.clear();
  g.cells = delaunay_tetrahedra(apart);
  for (std::uint32_t& p : g.cells.corners) p = distinct[p];
  return g;
}

std::vector<std::uint32_t> join_coincident(GatheredCells& g) {
  const std::size_t n = g.points.size();
  // The shortest edge at each point that is one, rather than two corners at the same place.
  std::vector<double> longest(n, 0.0), reach(n, std::numeric_limits<double>::infinity());
  const auto each_edge = [&](const auto& visit) {
    for (std::size_t c = 0; c < g.cells.size(); ++c) {
      const auto corners = g.cells[c];
      for (const auto& edge : cell_edges(g.cells.shapes[c])) {
        const std::uint32_t a = corners[edge[0]], b = corners[edge[1]];
        visit(a, b, norm(g.points[a] - g.points[b]));
      }
    }
  };
  each_edge([&](std::uint32_t a, std::uint32_t b, double length) {
    longest[a] = std::max(longest[a], length), longest[b] = std::max(longest[b], length);
  });
  constexpr double kNoEdge = 1e-9;
  each_edge([&](std::uint32_t a, std::uint32_t b, double length) {
    for (const std::uint32_t p : {a, b}) {
      if (length > kNoEdge * longest[p])
        reach[p] = std::min(reach[p], length);
      else
        g.joinable[p] = 1;
    }
  });
  longest = {};
  Box3 whole;
  std::vector<std::uint32_t> some;
  for (std::size_t p = 0; p < n; ++p) {
    if (!std::isfinite(reach[p])) continue;  // no cell's corner
    whole.extend(g.points[p]);
    if (g.joinable[p]) some.push_back(static_cast<std::uint32_t>(p));
  }
  const double most = 1e-6 * whole.diagonal();
  const auto tolerance = [&](std::uint32_t p) { return std::min(0.01 * reach[p], most); };
  const BoxTree tree(some.size(), [&](std::size_t i) {
    const double t = tolerance(some[i]);
    return Box3{g.points[some[i]] - Vec3{t, t, t}, g.points[some[i]] + Vec3{t, t, t}};
  });
  constexpr std::size_t kChunk = 4096;
  std::vector<std::vector<std::uint64_t>> pairs((some.size() + kChunk - 1) / kChunk);
  parallel_for(0, pairs.size(), 1, [&](std::size_t chunk) {
    std::vector<std::uint32_t> near;
    for (std::size_t i = chunk * kChunk; i < std::min(some.size(), (chunk + 1) * kChunk); ++i) {
      const std::uint32_t p = some[i];
      tree.containing(g.points[p], near);
      for (const std::uint32_t k : near) {
        const std::uint32_t q = some[k];
        if (q <= p) continue;
        const double t = std::min(tolerance(p), tolerance(q));
        if (squared_norm(g.points[p] - g.points[q]) <= t * t)
          pairs[chunk].push_back(static_cast<std::uint64_t>(p) << 32 | q);
      }
    }
  });
  UnionFind sets(n);
  bool any = false;
  for (const auto& chunk : pairs)
    for (const std::uint64_t pair : chunk)
      any = sets.join(static_cast<std::uint32_t>(pair >> 32), static_cast<std::uint32_t>(pair)) || any;
  if (!any) return {};
  std::vector<std::uint32_t> first(n);
  for (std::size_t p = 0; p < n; ++p) first[p] = sets.find(static_cast<std::uint32_t>(p));
  for (std::uint32_t& p : g.cells.corners) p = first[p];
  return first;
}

namespace {

/// The faces of a cell some of whose corners are the same, as rings without repetitions.
struct Hull {
  std::array<std::array<std::uint32_t, 4>, 6> rings;
  std::array<std::size_t, 6> sizes;
  std::size_t faces = 0;

  Hull(CellShape shape, std::span<const std::uint32_t> corners) {
    for (const CellFace& face : cell_faces(shape)) {
      std::array<std::uint32_t, 4> ring{};
      std::size_t size = 0;
      for (std::size_t k = 0; k < face.count; ++k) {
        const std::uint32_t p = corners[face.corner[k]];
        if (std::find(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(size), p) ==
            ring.begin() + static_cast<std::ptrdiff_t>(size))
          ring[size++] = p;
      }
      if (size >= 3) rings[faces] = ring, sizes[faces++] = size;
    }
    cancel();
  }

  bool has(std::size_t face, std::uint32_t p) const {
    return std::find(rings[face].begin(), rings[face].begin() + static_cast<std::ptrdiff_t>(sizes[face]), p) !=
           rings[face].begin() + static_cast<std::ptrdiff_t>(sizes[face]);
  }

 private:
  /// Two faces with the same corners enclose nothing.
  void cancel() {
    for (std::size_t f = 0; f < faces; ++f)
      for (std::size_t g = f + 1; g < faces; ++g) {
        bool same = sizes[f] == sizes[g];
        for (std::size_t k = 0; same && k < sizes[f]; ++k) same = has(g, rings[f][k]);
        if (!same) continue;
        for (const std::size_t gone : {g, f}) {
          --faces;
          rings[gone] = rings[faces], sizes[gone] = sizes[faces];
        }
        return cancel();
      }
  }
};

struct Piece {
  CellShape shape;
  std::array<std::uint32_t, 8> corners;
};

/// A cell with repeated corners as cells without, if there is anything left of it.
void pieces_of(CellShape shape, std::span<const std::uint32_t> corners, std::vector<Piece>& pieces) {
  pieces.clear();
  const Hull hull(shape, corners);
  if (hull.faces < 4) return;
  std::array<std::uint32_t, 8> distinct{};
  std::size_t count = 0;
  for (const std::uint32_t p : corners)
    if (std::find(distinct.begin(), distinct.begin() + static_cast<std::ptrdiff_t>(count), p) ==
        distinct.begin() + static_cast<std::ptrdiff_t>(count))
      distinct[count++] = p;
  if (count < 4) return;
  std::array<std::size_t, 2> triangles{};
  std::size_t triangle_count = 0;
  for (std::size_t f = 0; f < hull.faces; ++f)
    if (hull.sizes[f] == 3) {
      if (triangle_count < 2) triangles[triangle_count] = f;
      ++triangle_count;
    }
  if (count == 6 && hull.faces == 5 && triangle_count == 2) {
    // A wedge, if each corner of one triangle has its partner on the other: the only other corner of the two
    // quadrilaterals around it, next to it in both.
    const auto& one = hull.rings[triangles[0]];
    Piece wedge{CellShape::wedge, {one[0], one[1], one[2]}};
    bool complete = true;
    for (std::size_t k = 0; k < 3; ++k) {
      std::optional<std::uint32_t> partner;
      for (const std::uint32_t p : std::span(distinct).first(6)) {
        if (!hull.has(triangles[1], p)) continue;
        std::size_t shared = 0;
        for (std::size_t f = 0; f < hull.faces; ++f)
          shared += hull.sizes[f] == 4 && hull.has(f, one[k]) && hull.has(f, p);
        if (shared == 2) partner = p;
      }
      complete = complete && partner;
      if (partner) wedge.corners[3 + k] = *partner;
    }
    if (complete) pieces.push_back(wedge);
  }
  if (!pieces.empty()) return;
  // Cones over all faces from a corner that repeats: of the faces around it none is cut but those.
  std::uint32_t tip = corners[0];
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (std::count(corners.begin(), corners.end(), corners[i]) > 1) {
      tip = corners[i];
      break;
    }
  for (std::size_t f = 0; f < hull.faces; ++f) {
    const auto& r = hull.rings[f];
    if (hull.has(f, tip)) continue;
    if (hull.sizes[f] == 3)
      pieces.push_back({CellShape::tetrahedron, {r[0], r[2], r[1], tip}});
    else
      pieces.push_back({CellShape::pyramid, {r[0], r[3], r[2], r[1], tip}});
  }
}

void turn(CellShape shape, std::span<std::uint32_t> c) {
  switch (shape) {
    case CellShape::tetrahedron:
      return std::swap(c[0], c[1]);
    case CellShape::pyramid:
      return std::swap(c[1], c[3]);
    case CellShape::wedge:
      for (std::size_t k = 0; k < 3; ++k) std::swap(c[k], c[k + 3]);
      return;
    case CellShape::hexahedron:
      for (std::size_t k = 0; k < 4; ++k) std::swap(c[k], c[k + 4]);
      return;
  }
}

enum class CellState : std::uint8_t { good, inverted, repeating, flat };

CellState state_of(const GatheredCells& g, CellShape shape, std::span<const std::uint32_t> corners) {
  for (std::size_t i = 1; i < corners.size(); ++i)
    if (std::find(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(i), corners[i]) !=
        corners.begin() + static_cast<std::ptrdiff_t>(i))
      return CellState::repeating;
  const auto x = corner_places(g, corners);
  const std::span<const Vec3> places = std::span(x).first(corners.size());
  const double volume = cell_volume(shape, places), edge = std::sqrt(squared_edges(shape, places).longest);
  // Layers 1e5 times thinner than long in two directions have 1e-10 of the cube of their longest edge.
  if (!(std::abs(volume) > 1e-15 * edge * edge * edge)) return CellState::flat;
  return volume > 0 ? CellState::good : CellState::inverted;
}

}  // namespace

std::vector<std::uint32_t> mend_cells(GatheredCells& g, VolumeFacts& facts) {
  const std::size_t n = g.cells.size();
  std::vector<CellState> states(n);
  parallel_for(0, n, 4096, [&](std::size_t c) { states[c] = state_of(g, g.cells.shapes[c], g.cells[c]); });
  // A block all of whose cells are inside out only has its indices the other way round.
  std::vector<std::size_t> right(65536, 0), wrong(65536, 0);
  const auto block = [&](std::size_t c) { return g.cell_block.empty() ? std::size_t{0} : g.cell_block[c]; };
  bool all_good = true;
  for (std::size_t c = 0; c < n; ++c) {
    if (states[c] == CellState::good) ++right[block(c)];
    if (states[c] == CellState::inverted) ++wrong[block(c)];
    all_good = all_good && states[c] == CellState::good;
  }
  for (std::size_t b = 0; b < right.size(); ++b) facts.inverted += std::min(right[b], wrong[b]);
  if (all_good) return {};
  CellList cells;
  std::vector<std::uint32_t> source;
  cells.shapes.reserve(n), cells.first.reserve(n + 1), cells.corners.reserve(g.cells.corners.size());
  source.reserve(n);
  std::vector<Piece> pieces;
  const auto keep = [&](CellShape shape, std::span<std::uint32_t> corners, CellState state, std::size_t c) {
    if (state == CellState::flat || state == CellState::repeating) return;
    if (state == CellState::inverted) turn(shape, corners);
    cells.add(shape, corners);
    source.push_back(static_cast<std::uint32_t>(c));
  };
  for (std::size_t c = 0; c < n; ++c) {
    if (states[c] == CellState::repeating) {
      ++facts.degenerate;
      pieces_of(g.cells.shapes[c], g.cells[c], pieces);
      for (Piece& piece : pieces) {
        const std::span<std::uint32_t> corners = std::span(piece.corners).first(corner_count(piece.shape));
        keep(piece.shape, corners, state_of(g, piece.shape, corners), c);
      }
      continue;
    }
    if (states[c] == CellState::flat) ++facts.degenerate;
    std::array<std::uint32_t, 8> corners;
    std::copy(g.cells[c].begin(), g.cells[c].end(), corners.begin());
    keep(g.cells.shapes[c], std::span(corners).first(g.cells[c].size()), states[c], c);
  }
  g.cells = std::move(cells);
  return source;
}

}  // namespace sansmesh
