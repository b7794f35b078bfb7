#include "sansmesh/mesh/booleans/arrangement.h"

#include <algorithm>
#include <utility>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/scramble.h"
#include "sansmesh/mesh/booleans/triangle_cutter.h"
#include "sansmesh/mesh/booleans/triangle_pairs.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kPairChunk = 64, kCutChunk = 32;

int common_corners(const Triangle& a, const Triangle& b) {
  int common = 0;
  for (const std::uint32_t v : a) common += v == b[0] || v == b[1] || v == b[2];
  return common;
}

void append(TriangleCuts& all, const TriangleCuts& more) {
  const auto shift = static_cast<std::uint32_t>(all.points.size());
  all.points.insert(all.points.end(), more.points.begin(), more.points.end());
  for (TriangleCut c : more.cuts) {
    c.from += shift, c.to += shift;
    all.cuts.push_back(c);
  }
}

/// Runs find(first, last, cuts) on chunks of 0..n and joins the results in order.
template <class Find>
TriangleCuts collected_cuts(std::size_t n, const Find& find) {
  std::vector<TriangleCuts> parts((n + kPairChunk - 1) / kPairChunk);
  parallel_for(0, parts.size(), 1,
               [&](std::size_t c) { find(c * kPairChunk, std::min(n, (c + 1) * kPairChunk), parts[c]); });
  TriangleCuts all;
  std::size_t points = 0, cuts = 0;
  for (const TriangleCuts& p : parts) points += p.points.size(), cuts += p.cuts.size();
  all.points.reserve(points);
  all.cuts.reserve(cuts);
  for (const TriangleCuts& p : parts) append(all, p);
  return all;
}

/// Triangles whose boxes touch those of other solids.
std::vector<std::uint32_t> near_others(const SolidTriangles& in, std::span<const Box3f> boxes) {
  std::vector<Box3f> of_solid(in.solids);
  for (std::size_t t = 0; t < boxes.size(); ++t) of_solid[in.solid_of[t]].extend(boxes[t]);
  const FaceBoxTree solids(of_solid);
  std::vector<std::uint8_t> near(boxes.size(), 0);
  parallel_for(0, boxes.size(), 2048, [&](std::size_t t) {
    near[t] = solids.visit(boxes[t], [&](std::uint32_t s) { return s == in.solid_of[t]; }) ? 0 : 1;
  });
  std::vector<std::uint32_t> found;
  for (std::uint32_t t = 0; t < near.size(); ++t)
    if (near[t] != 0) found.push_back(t);
  return found;
}

TriangleCuts all_cuts(const SolidTriangles& in, const ExactSpace& space, const FaceBoxTree& tree,
                      std::span<const Box3f> boxes) {
  const std::vector<std::uint32_t> near = near_others(in, boxes);
  // The triangles of small solids search for those of larger ones.
  std::vector<std::uint32_t> size(in.solids, 0);
  for (const std::uint32_t t : near) ++size[in.solid_of[t]];
  const auto searches = [&](std::uint32_t s, std::uint32_t t) {
    const std::uint32_t a = in.solid_of[s], b = in.solid_of[t];
    return size[a] != size[b] ? size[a] < size[b] : a < b;
  };
  std::vector<Box3f> near_boxes;
  std::uint32_t largest = near.empty() ? 0 : near[0];
  for (const std::uint32_t t : near) {
    near_boxes.push_back(boxes[t]);
    if (searches(largest, t)) largest = t;
  }
  const FaceBoxTree near_tree(near_boxes);
  TriangleCuts all = collected_cuts(near.size(), [&](std::size_t first, std::size_t last, TriangleCuts& cuts) {
    for (std::size_t i = first; i < last; ++i) {
      const std::uint32_t s = near[i];
      if (in.solid_of[s] == in.solid_of[largest]) continue;
      near_tree.visit(boxes[s], [&](std::uint32_t j) {
        const std::uint32_t t = near[j];
        if (searches(s, t)) cut_pair(space, in.triangles, std::min(s, t), std::max(s, t), cuts);
        return true;
      });
    }
  });
  // Cut triangles are also cut by their own solid, so that all see the same vertices on a seam.
  std::vector<std::uint8_t> seen(in.triangles.size(), 0);
  std::vector<std::uint32_t> fresh;
  for (std::uint32_t t = 0; t < in.triangles.size(); ++t)
    if (in.resolved[in.solid_of[t]] != 0) seen[t] = 1, fresh.push_back(t);
  std::size_t read = 0;
  while (read < all.cuts.size() || !fresh.empty()) {
    for (; read < all.cuts.size(); ++read)
      if (std::uint8_t& s = seen[all.cuts[read].triangle]; s == 0) s = 1, fresh.push_back(all.cuts[read].triangle);
    std::sort(fresh.begin(), fresh.end());
    for (const std::uint32_t t : fresh) seen[t] = 2;
    append(all, collected_cuts(fresh.size(), [&](std::size_t first, std::size_t last, TriangleCuts& cuts) {
             for (std::size_t i = first; i < last; ++i) {
               const std::uint32_t s = fresh[i];
               tree.visit(boxes[s], [&](std::uint32_t t) {
                 // Pairs of two fresh ones are met twice.
                 if (t == s || in.solid_of[t] != in.solid_of[s] || (seen[t] != 0 && (seen[t] != 2 || t < s)))
                   return true;
                 const int common = common_corners(in.triangles[s], in.triangles[t]);
                 if (common > 1) return true;
                 const std::size_t points = cuts.points.size(), before = cuts.cuts.size();
                 cut_pair(space, in.triangles, std::min(s, t), std::max(s, t), cuts);
                 if (common == 0) return true;
                 std::size_t end = before;
                 for (std::size_t c = before; c < cuts.cuts.size(); ++c)
                   if (cuts.cuts[c].from != cuts.cuts[c].to) cuts.cuts[end++] = cuts.cuts[c];
                 cuts.cuts.resize(end);
                 if (end == before) cuts.points.resize(points);
                 return true;
               });
             }
           }));
    for (const std::uint32_t t : fresh) seen[t] = 1;
    fresh.clear();
  }
  return all;
}

/// A vertex of a piece, as a corner or as a point of the lists.
struct PointReference {
  std::uint32_t index = 0;
  bool corner = false;
};

/// Pieces of one chunk of cut triangles, and points that cutting added.
struct CutChunk {
  std::vector<ExactPoint> points;
  std::vector<Piece> pieces;  ///< vertices: index among corners, all cuts' points and own points, in this order
};

std::uint64_t key_of(const ExactPoint& p) {
  std::uint64_t key = 0;
  for (const Residue& r : p.residue) key = scrambled(key ^ r.bits());
  return key;
}

class Cutting {
 public:
  Cutting(const SolidTriangles& in, const ExactSpace& space, TriangleCuts&& cuts)
      : in_(in), space_(space), cuts_(std::move(cuts)) {
    std::stable_sort(cuts_.cuts.begin(), cuts_.cuts.end(),
                     [](const TriangleCut& a, const TriangleCut& b) { return a.triangle < b.triangle; });
    for (std::size_t i = 0; i < cuts_.cuts.size(); ++i)
      if (i == 0 || cuts_.cuts[i].triangle != cuts_.cuts[i - 1].triangle) first_.push_back(i);
  }

  Arrangement run() {
    chunks_.resize((first_.size() + kCutChunk - 1) / kCutChunk);
    parallel_for(0, chunks_.size(), 1, [&](std::size_t c) {
      for (std::size_t i = c * kCutChunk; i < std::min(first_.size(), (c + 1) * kCutChunk); ++i) cut(i, chunks_[c]);
    });
    return assembled();
  }

 private:
  void cut(std::size_t which, CutChunk& chunk) const {
    const std::size_t begin = first_[which], end = which + 1 < first_.size() ? first_[which + 1] : cuts_.cuts.size();
    const std::uint32_t triangle = cuts_.cuts[begin].triangle;
    const Triangle& corners = in_.triangles[triangle];
    // Equal points are those with equal keys.
    std::vector<std::pair<std::uint64_t, std::uint32_t>> known;
    std::vector<ExactPoint> points;
    std::vector<std::uint32_t> origin;  // index as in CutChunk
    for (const std::uint32_t v : corners) {
      points.push_back(space_.corner(v));
      origin.push_back(v);
    }
    std::vector<std::uint32_t> used;
    for (std::size_t i = begin; i < end; ++i)
      for (const std::uint32_t p : {cuts_.cuts[i].from, cuts_.cuts[i].to}) used.push_back(p);
    known.reserve(used.size() + 3);
    for (std::uint32_t i = 0; i < 3; ++i) known.emplace_back(key_of(points[i]), i);
    for (std::size_t i = 0; i < used.size(); ++i)
      known.emplace_back(key_of(cuts_.points[used[i]]), static_cast<std::uint32_t>(i + 3));
    std::sort(known.begin(), known.end());
    std::vector<std::uint32_t> local(used.size() + 3);
    std::vector<std::uint32_t> same(used.size() + 3);  // first entry with an equal key
    for (std::size_t i = 0, group = 0; i < known.size(); ++i) {
      if (known[i].first != known[group].first) group = i;
      same[known[i].second] = known[group].second;
    }
    for (std::uint32_t i = 0; i < local.size(); ++i) {
      if (same[i] != i) {
        local[i] = local[same[i]];
      } else if (i < 3) {
        local[i] = i;
      } else {
        local[i] = static_cast<std::uint32_t>(points.size());
        points.push_back(cuts_.points[used[i - 3]]);
        origin.push_back(static_cast<std::uint32_t>(in_.corners.size()) + used[i - 3]);
      }
    }
    TriangleCutter cutter(space_, corners, std::move(points));
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t from = local[3 + 2 * (i - begin)], to = local[4 + 2 * (i - begin)];
      if (from != to) cutter.add({from, to, cuts_.cuts[i].plane});
    }
    const auto own = static_cast<std::uint32_t>(in_.corners.size() + cuts_.points.size() + chunk.points.size());
    const std::size_t given = origin.size();
    for (std::size_t i = given; i < cutter.points().size(); ++i) chunk.points.push_back(cutter.points()[i]);
    const auto index = [&](std::uint32_t v) {
      return v < given ? origin[v] : own + static_cast<std::uint32_t>(v - given);
    };
    for (const TriangleCutter::Part& part : cutter.parts())
      chunk.pieces.push_back(
          {{index(part.vertex[0]), index(part.vertex[1]), index(part.vertex[2])}, triangle, part.seam, true});
  }

  Arrangement assembled() {
    // All points in one list; those that chunks added follow those of the cuts.
    std::vector<std::uint32_t> shift(chunks_.size());
    const std::size_t shared = cuts_.points.size();
    for (std::size_t c = 0; c < chunks_.size(); ++c) {
      shift[c] = static_cast<std::uint32_t>(cuts_.points.size() - shared);
      cuts_.points.insert(cuts_.points.end(), chunks_[c].points.begin(), chunks_[c].points.end());
    }
    const std::vector<std::uint32_t> vertex = merged_vertices();
    Arrangement out;
    out.corners = in_.corners.size();
    out.seam = std::move(seam_);
    out.pieces.reserve(in_.triangles.size() + 4 * first_.size());
    std::size_t next = 0, chunk = 0, piece = 0;
    const auto first_shared = static_cast<std::uint32_t>(in_.corners.size() + shared);
    for (std::uint32_t t = 0; t < in_.triangles.size(); ++t) {
      if (next == first_.size() || cuts_.cuts[first_[next]].triangle != t) {
        const auto [a, b, c] = in_.triangles[t];
        out.pieces.push_back({{vertex[a], vertex[b], vertex[c]}, t, {}, false});
        continue;
      }
      while (piece == chunks_[chunk].pieces.size()) ++chunk, piece = 0;
      for (; piece < chunks_[chunk].pieces.size() && chunks_[chunk].pieces[piece].triangle == t; ++piece) {
        Piece p = chunks_[chunk].pieces[piece];
        for (std::uint32_t& v : p.vertex) v = vertex[v >= first_shared ? v + shift[chunk] : v];
        out.pieces.push_back(p);
      }
      ++next;
    }
    return out;
  }

  /// Vertex of each corner and each point: equal ones have the same. Fills seam_.
  std::vector<std::uint32_t> merged_vertices() {
    const std::size_t corners = in_.corners.size();
    std::vector<std::uint32_t> vertex(corners + cuts_.points.size(), 0);
    for (std::uint32_t v = 0; v < corners; ++v) vertex[v] = v;
    std::vector<std::uint32_t> touched;
    for (const std::size_t i : first_)
      for (const std::uint32_t v : in_.triangles[cuts_.cuts[i].triangle]) touched.push_back(v);
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    const std::size_t n = touched.size() + cuts_.points.size();
    std::vector<KeyIndex> keys(n);
    parallel_for(0, n, 4096, [&](std::size_t i) {
      keys[i] = {i < touched.size() ? key_of(space_.corner(touched[i])) : key_of(cuts_.points[i - touched.size()]),
                 static_cast<unsigned>(i)};
    });
    parallel_sort(keys);
    std::vector<std::uint32_t> first(n);
    for (std::size_t i = 0, group = 0; i < n; ++i) {
      if (keys[i].key != keys[group].key) group = i;
      first[keys[i].index] = keys[group].index;
    }
    for (std::size_t i = 0; i < n; ++i) {
      const auto entry = [&](std::size_t e) {
        return e < touched.size() ? touched[e] : corners + (e - touched.size());
      };
      if (first[i] != i) {
        vertex[entry(i)] = vertex[entry(first[i])];
      } else if (i >= touched.size()) {
        vertex[entry(i)] = static_cast<std::uint32_t>(corners + seam_.size());
        seam_.push_back(cuts_.points[i - touched.size()]);
      }
    }
    return vertex;
  }

  const SolidTriangles& in_;
  const ExactSpace& space_;
  TriangleCuts cuts_;
  std::vector<std::size_t> first_;  ///< cut of each cut triangle
  std::vector<CutChunk> chunks_;
  std::vector<ExactPoint> seam_;
};

}  // namespace

Box3f triangle_box(const SolidTriangles& in, std::size_t triangle) {
  Box3 box;
  for (const std::uint32_t v : in.triangles[triangle]) box.extend(in.corners[v]);
  return rounded_outward(box);
}

std::vector<Box3f> triangle_boxes(const SolidTriangles& in) {
  std::vector<Box3f> boxes(in.triangles.size());
  parallel_for(0, boxes.size(), 8192, [&](std::size_t t) { boxes[t] = triangle_box(in, t); });
  return boxes;
}

Arrangement arrange(const SolidTriangles& in, const ExactSpace& space, const FaceBoxTree& tree,
                    std::span<const Box3f> boxes) {
  return Cutting(in, space, all_cuts(in, space, tree, boxes)).run();
}

}  // namespace sansmesh::inline v1
