#include "sansmesh/polygonize/creases/crease_zone.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sansmesh::inline v1 {
namespace {

// Fractions of the mean edge at a vertex.
constexpr double kSnapCrease = 0.3, kSnapCorner = 0.5;
constexpr double kForced = 0.8;    // larger reach for a vertex on neither side of a crease
constexpr double kOnPiece = 1e-4;  // tolerance for being on the surface, and for two pieces to agree

std::uint8_t rank_of(const PieceLabel& l) {
  const std::size_t n = l.pieces.count;
  if (n < 2) return static_cast<std::uint8_t>(n);
  std::uint8_t rank = 1;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j) {
      const Vec3f c = cross(l.normal[i], l.normal[j]);
      if (squared_norm(c) <= kTangentSine * kTangentSine) continue;
      rank = std::max<std::uint8_t>(rank, 2);
      for (std::size_t k = j + 1; k < n; ++k)
        if (std::abs(dot(c, l.normal[k])) > kFlatCorner) return 3;
    }
  return rank;
}

}  // namespace

CreaseZone::CreaseZone(const PiecewiseField& f, std::vector<Triangle> triangles, std::vector<Vec3> vertices)
    : field(f),
      surface(std::move(triangles), vertices.size()),
      x(std::move(vertices)),
      size(x.size(), 0),
      label(x.size()) {
  std::vector<std::uint32_t> count(x.size(), 0);
  for (std::size_t t = 0; t < surface.triangles(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = surface[t][k], b = surface[t][(k + 1) % 3];
      const double l = norm(x[b] - x[a]);
      size[a] += l, size[b] += l;
      ++count[a], ++count[b];
    }
  for (std::size_t v = 0; v < x.size(); ++v) size[v] /= std::max(1u, count[v]);
}

void CreaseZone::resolve() {
  move_onto_pieces();
  merge_coincident();
  snap();
  split();
  assign_pieces();
  improve();
}

void CreaseZone::settle(const std::vector<std::uint32_t>& vertices, bool look_around) {
  std::vector<PieceValue> queries;
  std::vector<std::size_t> first(vertices.size() + 1, 0);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const std::uint32_t v = vertices[i];
    PieceSet all = label[v].pieces;
    for (const std::uint32_t p : all) queries.push_back({p, x[v], 0, {}});
    if (look_around)
      surface.around(v, [&](std::uint32_t h) {
        for (const std::uint32_t p : label[surface.to(h)].pieces)
          if (!all.has(p) && all.add(p)) queries.push_back({p, x[v], 0, {}});
      });
    first[i + 1] = queries.size();
  }
  evaluate_pieces(field, queries);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    PieceLabel& l = label[vertices[i]];
    for (std::size_t q = first[i]; q < first[i + 1]; ++q)
      if (!l.pieces.has(queries[q].piece) &&
          std::abs(queries[q].value) <= 0.1 * kOnPiece * size[vertices[i]] * norm(queries[q].gradient))
        l.pieces.add(queries[q].piece);
    for (std::size_t q = first[i]; q < first[i + 1]; ++q)
      for (std::size_t k = 0; k < l.pieces.count; ++k)
        if (l.pieces.piece[k] == queries[q].piece) l.normal[k] = Vec3f(normalized(queries[q].gradient));
    l.rank = rank_of(l);
  }
}

bool CreaseZone::crosses(std::uint32_t a, std::uint32_t b) const {
  return label[a].rank > 0 && label[b].rank > 0 && common(label[a].pieces, label[b].pieces).count == 0;
}

void CreaseZone::move_onto_pieces() {
  const std::size_t n = x.size();
  std::vector<std::uint32_t> active(n), other(n);
  field.active(x, active);
  std::vector<Meeting> first(n);
  for (std::size_t v = 0; v < n; ++v) first[v] = {x[v], 0.6 * size[v], {active[v]}, 1, false, {}, {}};
  const auto newton = [&](std::vector<Meeting>& all) {  // without check_surface: tested below
    find_meetings(field, all);
  };
  newton(first);
  std::vector<Vec3> at(n);
  for (std::size_t v = 0; v < n; ++v) at[v] = first[v].x;
  field.active(at, other);
  // If another piece is active at the result, the vertex may belong to that piece, or to the crease between.
  std::vector<std::uint32_t> list;
  std::vector<Meeting> second;
  for (std::size_t v = 0; v < n; ++v) {
    if (first[v].found) {
      label[v].pieces = {active[v]};
      label[v].rank = 1;
      label[v].normal[0] = Vec3f(first[v].normal[0]);
      if (!surface.on_border(static_cast<std::uint32_t>(v))) x[v] = first[v].x;
    } else if (other[v] != active[v]) {
      list.push_back(static_cast<std::uint32_t>(v));
      second.push_back({x[v], 0.6 * size[v], {other[v]}, 1, false, {}, {}});
      second.push_back({x[v], kForced * size[v], {active[v], other[v]}, 2, false, {}, {}});
    }
  }
  newton(second);
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::uint32_t v = list[i];
    const Meeting &smooth = second[2 * i], &crease = second[2 * i + 1];
    if (!smooth.found && !crease.found) continue;
    const bool sharp = !smooth.found;
    const Meeting& m = sharp ? crease : smooth;
    if (surface.on_border(v)) continue;
    x[v] = m.x;
    label[v].pieces = sharp ? PieceSet{active[v], other[v]} : PieceSet{other[v]};
    label[v].rank = sharp ? 2 : 1;
    for (std::size_t k = 0; k < label[v].pieces.count; ++k)
      label[v].normal[k] = Vec3f(m.normal[label[v].pieces.piece[k] == m.piece[0] ? 0 : 1]);
  }
}

void CreaseZone::merge_coincident() {
  // Pieces that agree are one surface: a label with one of them receives both.
  std::vector<PieceValue> queries;
  std::vector<std::uint32_t> at;
  for (std::uint32_t h = 0; h < 3 * surface.triangles(); ++h) {
    const std::uint32_t a = surface.from(h), b = surface.to(h);
    if (!crosses(a, b)) continue;
    for (const std::uint32_t p : label[b].pieces) {
      queries.push_back({p, x[a], 0, {}});
      at.push_back(a);
    }
    if (surface.twin(h) != kNone) continue;
    for (const std::uint32_t p : label[a].pieces) {
      queries.push_back({p, x[b], 0, {}});
      at.push_back(b);
    }
  }
  evaluate_pieces(field, queries);
  std::vector<std::uint32_t> changed;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const PieceValue& q = queries[i];
    const double slope = norm(q.gradient);
    if (!(std::abs(q.value) <= kOnPiece * size[at[i]] * slope)) continue;
    PieceLabel& l = label[at[i]];
    bool tangent = false;
    for (std::size_t k = 0; k < l.pieces.count; ++k)
      tangent = tangent || (norm(cross(Vec3(l.normal[k]), q.gradient)) <= kTangentSine * slope &&
                            dot(Vec3(l.normal[k]), q.gradient) > 0);
    if (tangent && l.pieces.add(q.piece)) changed.push_back(at[i]);
  }
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  settle(changed, false);
}

bool CreaseZone::corner_near(std::uint32_t v, const Vec3& p, double distance) const {
  bool found = false;
  surface.around(v, [&](std::uint32_t h) {
    const std::uint32_t w = surface.to(h);
    found = found || (label[w].rank == 3 && norm(x[w] - p) < distance);
    surface.around(w, [&](std::uint32_t g) {
      const std::uint32_t u = surface.to(g);
      found = found || (label[u].rank == 3 && u != v && norm(x[u] - p) < distance);
    });
  });
  return found;
}

bool CreaseZone::may_snap(std::uint32_t v, const Meeting& m) const {
  bool fine = true;
  const PieceSet pieces =
      m.count == 3 ? PieceSet{m.piece[0], m.piece[1], m.piece[2]} : PieceSet{m.piece[0], m.piece[1]};
  surface.around(v, [&](std::uint32_t h) {
    const std::uint32_t b = surface.to(h), c = surface.apex(h);
    if (common(common(pieces, label[b].pieces), label[c].pieces).count > 1) fine = false;
    const Vec3 before = cross(x[b] - x[v], x[c] - x[v]), after = cross(x[b] - m.x, x[c] - m.x);
    const double sum_before = squared_norm(x[b] - x[v]) + squared_norm(x[c] - x[v]) + squared_norm(x[b] - x[c]);
    const double sum_after = squared_norm(x[b] - m.x) + squared_norm(x[c] - m.x) + squared_norm(x[b] - x[c]);
    const double shape_before = norm(before) / sum_before, shape_after = norm(after) / sum_after;
    if (shape_after < 0.05 && shape_after < 0.7 * shape_before) fine = false;
    if (dot(before, after) < 0.1 * norm(before) * norm(after)) fine = false;
  });
  return fine;
}

void CreaseZone::snap() {
  std::vector<Meeting> meetings;
  std::vector<std::uint32_t> at;
  for (std::uint32_t v = 0; v < x.size(); ++v) {
    if (label[v].rank != 1 || surface.on_border(v)) continue;
    PieceSet others;
    surface.around(v, [&](std::uint32_t h) {
      const std::uint32_t w = surface.to(h);
      if (label[w].rank > 0)
        for (const std::uint32_t p : label[w].pieces)
          if (!label[v].pieces.has(p)) others.add(p);
    });
    const std::uint32_t a = label[v].pieces.piece[0];
    for (std::size_t i = 0; i < others.count; ++i) {
      meetings.push_back({x[v], kSnapCrease * size[v], {a, others.piece[i]}, 2, false, {}, {}});
      at.push_back(v);
      for (std::size_t j = i + 1; j < others.count; ++j) {
        meetings.push_back({x[v], kSnapCorner * size[v], {a, others.piece[i], others.piece[j]}, 3, false, {}, {}});
        at.push_back(v);
      }
    }
  }
  find_meetings(field, meetings);
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < at.size(); ++i)
    if (meetings[i].found) order.push_back(i);
  const auto distance = [&](std::uint32_t i) { return norm(meetings[i].x - x[at[i]]) / size[at[i]]; };
  std::vector<double> key(at.size(), 0);
  for (const std::uint32_t i : order) key[i] = distance(i) - (meetings[i].count == 3 ? 10 : 0);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t i, std::uint32_t j) { return key[i] != key[j] ? key[i] < key[j] : i < j; });
  std::vector<std::uint32_t> moved;
  for (const std::uint32_t i : order) {
    const std::uint32_t v = at[i];
    const Meeting& m = meetings[i];
    if (label[v].rank != 1 || !may_snap(v, m)) continue;
    if (m.count == 3 && corner_near(v, m.x, 0.05 * size[v])) continue;
    x[v] = m.x;
    label[v].pieces = {};
    for (std::uint32_t k = 0; k < m.count; ++k) label[v].pieces.add(m.piece[k]);
    label[v].rank = static_cast<std::uint8_t>(m.count);
    moved.push_back(v);
  }
  std::sort(moved.begin(), moved.end());
  settle(moved, true);
}

}  // namespace sansmesh::inline v1
