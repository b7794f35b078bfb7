// Middle part of CreaseZone: flips edges that cross a crease, or adds a vertex on it.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sansmesh/polygonize/creases/crease_zone.h"

namespace sansmesh::inline v1 {
namespace {

// Fractions of the mean edge at a vertex.
constexpr double kSplitReach = 0.8, kSplitCorner = 1.2, kSplitMost = 6;
constexpr double kApart = 1e-3;  // vertices closer than that coincide
constexpr int kSplitRounds = 6;
constexpr int kBisections = 7;

/// Largest distance from the midpoint of an edge to the crease that it cuts short: the edge is the base of a triangle
/// whose apex has the angle between the pieces.
double crease_reach(const Meeting& m, double edge) {
  const double cosine = std::clamp(dot(m.normal[0], m.normal[1]), -1.0, 1.0);
  const double depth = 0.5 * edge * std::sqrt((1 - cosine) / std::max(1e-9, 1 + cosine));
  return std::max(m.reach / kSplitMost * kSplitReach, 1.3 * depth + 0.3 * edge);
}

}  // namespace

std::uint32_t CreaseZone::add_vertex(const Vec3& p, double h, const Meeting& m) {
  x.push_back(p);
  size.push_back(h);
  PieceLabel& l = label.emplace_back();
  for (std::uint32_t k = 0; k < m.count; ++k) l.pieces.add(m.piece[k]);
  l.rank = static_cast<std::uint8_t>(m.count);
  return static_cast<std::uint32_t>(x.size() - 1);
}

void CreaseZone::split() {
  for (int round = 0; round < kSplitRounds; ++round) {
    const std::size_t flipped = flip_crossing();
    if (split_crossing(round) + flipped == 0 && round > 1) break;
  }
  flip_crossing();
  split_triangles();
}

std::size_t CreaseZone::flip_crossing() {
  std::size_t count = 0;
  for (std::uint32_t h = 0; h < 3 * surface.triangles(); ++h) {
    if (surface.twin(h) == kNone || surface.twin(h) < h || !crosses(surface.from(h), surface.to(h))) continue;
    const std::uint32_t a = surface.from(h), b = surface.to(h), c = surface.apex(h), d = surface.apex(surface.twin(h));
    const Triangle first{a, d, c}, second{d, b, c};
    const PieceSet on_first = shared(first), on_second = shared(second);
    if (on_first.count == 0 || on_second.count == 0 || !surface.can_flip(h)) continue;
    double least = 1;
    for (const auto& [t, on] : {std::pair(first, on_first), std::pair(second, on_second)}) {
      double best = -1;
      for (const std::uint32_t p : on) best = std::max(best, shape(t, p));
      least = std::min(least, best);
    }
    if (least < 0.1) continue;
    surface.flip(h);
    ++count;
  }
  return count;
}

std::vector<CreaseZone::Crossing> CreaseZone::find_crossings() const {
  std::vector<Crossing> crossings;
  for (std::uint32_t h = 0; h < 3 * surface.triangles(); ++h) {
    const std::uint32_t g = surface.twin(h);
    if (g == kNone || g < h || !crosses(surface.from(h), surface.to(h))) continue;
    crossings.push_back({surface.from(h), surface.to(h), 0, 1, label[surface.to(h)].pieces.piece[0], 0});
  }
  std::vector<Vec3> middle(crossings.size());
  std::vector<std::uint32_t> active(crossings.size());
  for (int step = 0; step < kBisections; ++step) {
    for (std::size_t i = 0; i < crossings.size(); ++i) {
      const Crossing& c = crossings[i];
      const Vec3 &p = x[c.from], &q = x[c.to];
      middle[i] = p + (q - p) * (0.5 * (c.low + c.high));
    }
    field.active(middle, active);
    for (std::size_t i = 0; i < crossings.size(); ++i) {
      Crossing& c = crossings[i];
      const double t = 0.5 * (c.low + c.high);
      if (label[c.from].pieces.has(active[i])) {
        c.low = t;
      } else {
        c.high = t;
        c.next = active[i];
      }
    }
  }
  return crossings;
}

std::vector<Meeting> CreaseZone::meetings_on(std::vector<Crossing>& crossings) const {
  std::vector<Meeting> meetings;
  for (Crossing& c : crossings) {
    c.first = meetings.size();
    const std::uint32_t u = c.from, v = c.to;
    const Vec3 start = x[u] + (x[v] - x[u]) * (0.5 * (c.low + c.high));
    const double local = std::max({norm(x[v] - x[u]), size[u], size[v]});
    PieceSet all = label[u].pieces;
    for (const std::uint32_t p : label[v].pieces) all.add(p);
    all.add(c.next);
    if (all.count > 2) {
      for (std::size_t i = 0; i < all.count; ++i)
        for (std::size_t j = i + 1; j < all.count; ++j)
          for (std::size_t k = j + 1; k < all.count; ++k)
            meetings.push_back(
                {start, kSplitCorner * local, {all.piece[i], all.piece[j], all.piece[k]}, 3, false, {}, {}});
    }
    for (const std::uint32_t p : label[u].pieces) {
      meetings.push_back({start, kSplitMost * local, {p, c.next}, 2, false, {}, {}});
      for (const std::uint32_t q : label[v].pieces)
        if (q != c.next) meetings.push_back({start, kSplitMost * local, {p, q}, 2, false, {}, {}});
    }
  }
  find_meetings(field, meetings);
  return meetings;
}

std::size_t CreaseZone::split_crossing(int round) {
  std::vector<Crossing> crossings = find_crossings();
  const std::vector<Meeting> meetings = meetings_on(crossings);
  std::vector<std::uint32_t> added;
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    const std::uint32_t h = surface.find(crossings[i].from, crossings[i].to), g = surface.twin(h);
    const std::array<std::uint32_t, 4> around{surface.from(h), surface.to(h), surface.apex(h), surface.apex(g)};
    const double local = 0.5 * (size[around[0]] + size[around[1]]);
    const std::size_t end = i + 1 < crossings.size() ? crossings[i + 1].first : meetings.size();
    const Meeting* best = nullptr;
    bool wait = false;
    for (std::size_t k = crossings[i].first; k < end; ++k) {
      const Meeting& m = meetings[k];
      if (!m.found || (best != nullptr && best->count > m.count)) continue;
      if (m.count == 2 && norm(m.x - m.start) > crease_reach(m, norm(x[around[0]] - x[around[1]]))) continue;
      bool taken = false;
      for (const std::uint32_t v : around) taken = taken || norm(x[v] - m.x) < kApart * local;
      if (m.count == 3 && round < kSplitRounds / 2)  // duplicates are tolerated in later rounds: improve() merges them
        for (const std::uint32_t v : around) taken = taken || corner_near(v, m.x, 0.05 * local);
      if (taken) {
        wait = wait || m.count == 3;
        continue;
      }
      if (best == nullptr || m.count > best->count || norm(m.x - m.start) < norm(best->x - best->start)) best = &m;
    }
    // The corner exists already: a flip may connect it once the adjacent edges are split.
    if (best == nullptr || (wait && best->count == 2 && round < 2)) continue;
    surface.split_edge(h);
    added.push_back(add_vertex(best->x, local, *best));
  }
  settle(added, true);
  return added.size();
}

std::size_t CreaseZone::split_triangles() {
  std::vector<Meeting> meetings;
  std::vector<std::uint32_t> at;
  for (std::uint32_t t = 0; t < surface.triangles(); ++t) {
    const auto [a, b, c] = surface[t];
    if (label[a].rank == 0 || label[b].rank == 0 || label[c].rank == 0 || shared(surface[t]).count > 0) continue;
    if (crosses(a, b) || crosses(b, c) || crosses(c, a)) continue;
    PieceSet all = label[a].pieces;
    for (const std::uint32_t v : {b, c})
      for (const std::uint32_t p : label[v].pieces) all.add(p);
    const double longest = std::max({norm(x[a] - x[b]), norm(x[b] - x[c]), norm(x[c] - x[a])});
    for (std::size_t i = 0; i < all.count; ++i)
      for (std::size_t j = i + 1; j < all.count; ++j)
        for (std::size_t k = j + 1; k < all.count; ++k) {
          meetings.push_back(
              {(x[a] + x[b] + x[c]) / 3, longest, {all.piece[i], all.piece[j], all.piece[k]}, 3, false, {}, {}});
          at.push_back(t);
        }
  }
  find_meetings(field, meetings);
  std::vector<std::uint32_t> added;
  std::uint32_t done = kNone;
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (!meetings[i].found || at[i] == done) continue;
    bool taken = false;
    double h = 0;
    for (const std::uint32_t v : surface[at[i]]) {
      taken = taken || norm(x[v] - meetings[i].x) < kApart * size[v];
      h += size[v] / 3;
    }
    if (taken) continue;
    surface.split_triangle(at[i]);
    added.push_back(add_vertex(meetings[i].x, h, meetings[i]));
    done = at[i];
  }
  settle(added, true);
  return added.size();
}

}  // namespace sansmesh::inline v1
