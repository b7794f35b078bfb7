// Second half of CreaseZone: assigns pieces to triangles and improves their shape.
#include <algorithm>
#include <cmath>
#include <utility>

#include "sansmesh/polygonize/creases/crease_zone.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kGood = 0.5;         // 4√3 A / Σ l²: better triangles are left alone
constexpr double kBad = 0.1;          // below, almost any change is an improvement
constexpr double kLeastCosine = 0.3;  // between a triangle and its piece; below it the triangle counts as nearly folded
constexpr double kGain = 0.004;       // least reduction of the penalties that justifies a change
constexpr int kPasses = 4, kMendPasses = 4;
constexpr double kLastResort = 0.05, kNever = -1e9;
constexpr double kSameCorner = 0.05;
constexpr double kInARow = 1e-3;  // shape of a degenerate triangle
constexpr double kLongest = 2.2;  // longest edge that a collapse may make, in mean edges

}  // namespace

double CreaseZone::shape(const std::array<Vec3, 3>& p, const Triangle& t, std::uint32_t on) const {
  const Vec3 area = cross(p[1] - p[0], p[2] - p[0]);
  const double sum = squared_norm(p[1] - p[0]) + squared_norm(p[2] - p[1]) + squared_norm(p[0] - p[2]);
  if (!(sum > 0)) return 0;
  const Vec3 normal = normalized(label[t[0]].normal_of(on) + label[t[1]].normal_of(on) + label[t[2]].normal_of(on));
  const double along = dot(area, normal);
  const double q = 2 * std::sqrt(3.0) * along / sum;
  return q > 0 && along < kLeastCosine * norm(area) ? 0.1 * q : q;
}

double CreaseZone::penalty(const Triangle& t, std::uint32_t on) const {
  const double q = on == kNone ? -1.5 : shape(t, on);
  const double low = std::max(0.0, kGood - q);
  return low * low + 10 * std::max(0.0, kBad - q);
}

bool CreaseZone::crease_edge(std::uint32_t h) const {
  const std::uint32_t g = surface.twin(h);
  return g != kNone && piece[h / 3] != piece[g / 3] && label[surface.from(h)].rank > 1 && label[surface.to(h)].rank > 1;
}

void CreaseZone::assign_pieces() {
  piece.assign(surface.triangles(), kNone);
  std::vector<std::uint32_t> unclear;
  for (std::uint32_t t = 0; t < surface.triangles(); ++t) {
    const PieceSet on = shared(surface[t]);
    if (on.count == 1 || (on.count > 1 && label[surface[t][0]].rank == 1)) piece[t] = on.piece[0];
    if (on.count > 1 && piece[t] == kNone) unclear.push_back(t);
  }
  for (const std::uint32_t t : unclear) {
    const PieceSet on = shared(surface[t]);
    double best = -2;
    for (const std::uint32_t p : on) {
      const double q = shape(surface[t], p);
      if (q > best + 1e-6) best = q, piece[t] = p;
    }
    if (best > 0.1) continue;
    // Three vertices in a row on a crease: the middle one belongs on the other side of the longest edge.
    std::uint32_t longest = 3 * t;
    for (const std::uint32_t h : {3 * t + 1, 3 * t + 2})
      if (norm(x[surface.to(h)] - x[surface.from(h)]) > norm(x[surface.to(longest)] - x[surface.from(longest)]))
        longest = h;
    const std::uint32_t other = surface.twin(longest);
    if (other != kNone && piece[other / 3] != kNone && on.has(piece[other / 3])) piece[t] = piece[other / 3];
  }
}

double CreaseZone::least_around(std::uint32_t v) const {
  double least = 1;
  surface.around(v, [&](std::uint32_t h) {
    least = piece[h / 3] == kNone ? -3 : std::min(least, shape(surface[h / 3], piece[h / 3]));
  });
  return least;
}

std::uint32_t CreaseZone::best_piece(const Triangle& t) const {
  std::uint32_t best = kNone;
  double most = -3;
  for (const std::uint32_t p : shared(t)) {
    const double q = shape(t, p);
    if (q > most + 1e-6) most = q, best = p;
  }
  return best;
}

double CreaseZone::flip_gain(std::uint32_t h, std::array<std::uint32_t, 2>& pieces) const {
  const std::uint32_t g = surface.twin(h);
  if (crease_edge(h) || !surface.can_flip(h)) return 0;
  const std::uint32_t a = surface.from(h), b = surface.to(h), c = surface.apex(h), d = surface.apex(g);
  const Triangle one{a, d, c}, two{d, b, c};
  const PieceSet on_one = shared(one), on_two = shared(two);
  if (on_one.count == 0 || on_two.count == 0) return 0;
  pieces[0] = on_one.has(piece[h / 3]) ? piece[h / 3] : best_piece(one);
  pieces[1] = on_two.has(piece[g / 3]) ? piece[g / 3] : best_piece(two);
  return penalty(surface[h / 3], piece[h / 3]) + penalty(surface[g / 3], piece[g / 3]) - penalty(one, pieces[0]) -
         penalty(two, pieces[1]);
}

bool CreaseZone::in_a_row(std::uint32_t t) const {
  const PieceSet on = shared(surface[t]);
  return on.count > 1 && std::abs(shape(surface[t], on.piece[0])) < kInARow &&
         std::abs(shape(surface[t], on.piece[1])) < kInARow;
}

double CreaseZone::collapse_gain(std::uint32_t h) const {
  const std::uint32_t from = surface.from(h), to = surface.to(h);
  const PieceLabel &l = label[from], &kept = label[to];
  if (l.rank == 0 || surface.on_border(from) || !surface.can_collapse(h)) return kNever;
  // Pieces of the surrounding triangles: fewer than the vertex's own where a corner or a crease was found twice.
  PieceSet used;
  std::uint32_t creases = 0;
  surface.around(from, [&](std::uint32_t e) {
    if (piece[e / 3] == kNone)
      for (const std::uint32_t p : l.pieces) used.add(p);
    else
      used.add(piece[e / 3]);
    creases += crease_edge(e);
  });
  if (common(used, kept.pieces).count != used.count) return kNever;
  if (l.rank == 3 && used.count > 2) {  // corners stay
    if (kept.rank < 3 || norm(x[from] - x[to]) > kSameCorner * size[to]) return kNever;
  } else if (l.rank > 1 && used.count > 1 && creases > 0) {  // creases only become straighter
    // …or lose a strip of triangles whose corners are all in a row on the crease.
    if ((creases % 2 != 0 || !crease_edge(h)) && !(in_a_row(h / 3) && in_a_row(surface.twin(h) / 3))) return kNever;
  }
  double gain = 0;
  bool possible = true;
  surface.around(from, [&](std::uint32_t e) {
    const Triangle& t = surface[e / 3];
    const std::uint32_t on = piece[e / 3], p = surface.to(e), q = surface.apex(e);
    if (on == kNone && (kept.rank < 2 || label[p].rank == 0 || label[q].rank == 0)) possible = false;
    gain += penalty(t, on);
    if (p == to || q == to || !possible) return;
    const Triangle moved{to, p, q};
    gain -= penalty(moved, on == kNone ? best_piece(moved) : on);
    if (norm(x[p] - x[to]) > kLongest * std::max(size[p], size[to])) possible = false;
  });
  return possible ? gain : kNever;
}

bool CreaseZone::repair(std::uint32_t t) {
  enum class Kind { kNothing, kFlip, kCollapse, kRename };
  Kind kind = Kind::kNothing;
  std::uint32_t chosen = 0;
  std::array<std::uint32_t, 2> pieces{};
  double best = kGain;
  // Several bad neighbouring triangles may need more than one collapse before the penalty falls.
  const double bonus = penalty(surface[t], piece[t]) > 1 ? kLastResort : 0;
  const std::uint32_t other_piece = best_piece(surface[t]);
  if (other_piece != kNone &&
      other_piece != piece[t]) {  // all corners on one crease: the triangle may be on either side
    const double gain = penalty(surface[t], piece[t]) - penalty(surface[t], other_piece);
    if (gain > best) {
      best = gain;
      kind = Kind::kRename;
      pieces[0] = other_piece;
    }
  }
  for (const std::uint32_t h : {3 * t, 3 * t + 1, 3 * t + 2}) {
    const std::uint32_t g = surface.twin(h);
    if (g == kNone) continue;
    std::array<std::uint32_t, 2> flipped{};
    if (const double gain = flip_gain(h, flipped); gain > best) {
      best = gain;
      kind = Kind::kFlip;
      chosen = h;
      pieces = flipped;
    }
    for (const std::uint32_t k : {h, g})
      if (const double gain = collapse_gain(k) + bonus; gain > best) {
        best = gain;
        kind = Kind::kCollapse;
        chosen = k;
      }
  }
  if (kind == Kind::kFlip) {
    const std::uint32_t g = surface.twin(chosen);
    for (const std::uint32_t v : surface[chosen / 3]) mark_around(v);
    mark_around(surface.apex(g));
    surface.flip(chosen);
    piece[chosen / 3] = pieces[0];
    piece[g / 3] = pieces[1];
  } else if (kind == Kind::kCollapse) {
    const std::uint32_t to = surface.to(chosen);
    surface.collapse(chosen);
    surface.around(to, [&](std::uint32_t h) {
      mark_around(surface.to(h));
      if (piece[h / 3] == kNone) piece[h / 3] = best_piece(surface[h / 3]);
    });
  } else if (kind == Kind::kRename) {
    piece[t] = pieces[0];
    for (const std::uint32_t v : surface[t]) mark_around(v);
  }
  return kind != Kind::kNothing;
}

void CreaseZone::relax() {
  std::vector<Meeting> meetings;
  std::vector<std::uint32_t> at;
  for (std::uint32_t v = 0; v < x.size(); ++v) {
    if (!surface.used(v) || surface.on_border(v) || label[v].rank == 0 || label[v].rank == 3) continue;
    const double least = least_around(v);
    if (least > (label[v].rank == 1 ? 0.65 : 0.75) || least <= -3) continue;
    const double reach = 0.5 * size[v];
    if (label[v].rank == 1) {
      Vec3 sum;
      double weight = 0;
      surface.around(v, [&](std::uint32_t h) {
        const auto [a, b, c] = surface[h / 3];
        const double area = norm(cross(x[b] - x[a], x[c] - x[a]));
        sum += (x[a] + x[b] + x[c]) * (area / 3);
        weight += area;
      });
      if (!(weight > 0)) continue;
      const Vec3 n(label[v].normal[0]);
      Vec3 move = sum / weight - x[v];
      move -= n * dot(move, n);
      meetings.push_back({x[v] + move, reach, {label[v].pieces.piece[0]}, 1, false, {}, {}});
    } else {
      std::array<std::uint32_t, 2> ends{};
      std::array<std::uint32_t, 2> pair{};
      std::uint32_t creases = 0;
      surface.around(v, [&](std::uint32_t h) {
        if (!crease_edge(h)) return;
        if (creases < 2) ends[creases] = surface.to(h);
        pair = {piece[h / 3], piece[surface.twin(h) / 3]};
        ++creases;
      });
      if (creases != 2) continue;
      const Vec3 middle = (x[ends[0]] + x[ends[1]]) * 0.5;
      meetings.push_back({x[v] + (middle - x[v]) * 0.5, reach, {pair[0], pair[1]}, 2, false, {}, {}});
    }
    at.push_back(v);
  }
  find_meetings(field, meetings);
  std::vector<std::uint32_t> moved;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Meeting& m = meetings[i];
    if (!m.found) continue;
    const std::uint32_t v = at[i];
    const Vec3 old = x[v];
    const PieceLabel before = label[v];
    const double least = least_around(v);
    x[v] = m.x;
    for (std::uint32_t k = 0; k < m.count; ++k)
      for (std::size_t j = 0; j < label[v].pieces.count; ++j)
        if (label[v].pieces.piece[j] == m.piece[k]) label[v].normal[j] = Vec3f(m.normal[k]);
    if (least_around(v) >= std::min(least, 0.6)) {
      moved.push_back(v);
      mark_around(v);
      continue;
    }
    x[v] = old;
    label[v] = before;
  }
  settle(moved, false);
}

void CreaseZone::mark_around(std::uint32_t v) {
  surface.around(v, [&](std::uint32_t h) { marked_[h / 3] = 1; });
}

void CreaseZone::improve() {
  marked_.assign(surface.triangles(), 1);
  for (int pass = 0; pass < kPasses; ++pass) {
    std::vector<std::uint32_t> corners;  // duplicates of one corner exchange their pieces
    for (std::uint32_t v = 0; v < x.size(); ++v)
      if (surface.used(v) && label[v].rank == 3) corners.push_back(v);
    settle(corners, true);
    for (int again = 0; again < kMendPasses; ++again) {
      bool any = false;
      for (std::uint32_t t = 0; t < surface.triangles(); ++t)
        if (std::exchange(marked_[t], std::uint8_t{0}) && surface.alive(t) && penalty(surface[t], piece[t]) > 0)
          any = repair(t) || any;
      if (!any) break;
    }
    relax();
  }
}

}  // namespace sansmesh::inline v1
