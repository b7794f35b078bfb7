#include "sansmesh/mesh/booleans/triangle_pairs.h"

#include <algorithm>

namespace sansmesh::inline v1 {
namespace {

using Signs = std::array<int, 3>;

bool all_of(const Signs& s, int value) { return s[0] == value && s[1] == value && s[2] == value; }

/// No two of opposite sign.
bool one_side(const Signs& s) {
  const auto [least, most] = std::minmax({s[0], s[1], s[2]});
  return least * most >= 0;
}

/// Up to a few points of one pair, each once.
class PairPoints {
 public:
  explicit PairPoints(TriangleCuts& found) : found_(found), first_(found.points.size()) {}

  void add(const ExactPoint& p) {
    for (std::size_t i = first_; i < found_.points.size(); ++i)
      if (found_.points[i].same_position(p)) return note(i);
    found_.points.push_back(p);
    note(found_.points.size() - 1);
  }
  /// Begins a new segment, which may use the points known so far.
  void begin() { ends_.clear(); }
  void cut(std::uint32_t triangle, const FacePlane& plane) const {
    if (ends_.empty()) return;
    found_.cuts.push_back({triangle, ends_.front(), ends_.back(), plane});
  }

 private:
  void note(std::size_t i) {
    const auto index = static_cast<std::uint32_t>(i);
    if (std::find(ends_.begin(), ends_.end(), index) == ends_.end()) ends_.push_back(index);
  }

  TriangleCuts& found_;
  std::size_t first_;
  std::vector<std::uint32_t> ends_;
};

/// Points of the edges and corners of triangle s on triangle t. `above`: sides of the plane of t, on which the corners
/// of s are.
void points_on(const ExactSpace& space, const Triangle& s, const Signs& above, const Triangle& t, PairPoints& points) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (above[i] * above[j] >= 0) continue;
    Signs around{};
    for (std::size_t k = 0; k < 3; ++k) around[k] = space.side(s[i], s[j], t[k], t[(k + 1) % 3]);
    if (!one_side(around)) continue;
    std::size_t corner = 3;
    for (std::size_t k = 0; k < 3; ++k)
      if (around[k] == 0 && around[(k + 1) % 3] == 0) corner = (k + 1) % 3;
    points.add(corner < 3 ? space.corner(t[corner]) : space.crossing(s[i], s[j], {t}));
  }
  if (above[0] != 0 && above[1] != 0 && above[2] != 0) return;
  const int axis = space.main_axis(t[0], t[1], t[2]);
  for (std::size_t i = 0; i < 3; ++i) {
    if (above[i] != 0) continue;
    Signs around{};
    for (std::size_t k = 0; k < 3; ++k) around[k] = space.turn(t[k], t[(k + 1) % 3], s[i], axis);
    if (one_side(around)) points.add(space.corner(s[i]));
  }
}

/// The part of edge a b of a coplanar triangle that lies in triangle t; `t_turn` is the orientation of t.
void edge_in_plane(const ExactSpace& space, std::uint32_t a, std::uint32_t b, const Triangle& t, int axis,
                   PairPoints& points) {
  const int t_turn = space.turn(t[0], t[1], t[2], axis);
  Signs of_a{}, of_b{}, of_line{};  // sides of the edges of t, and of the line a b
  for (std::size_t k = 0; k < 3; ++k) {
    of_a[k] = t_turn * space.turn(t[k], t[(k + 1) % 3], a, axis);
    of_b[k] = t_turn * space.turn(t[k], t[(k + 1) % 3], b, axis);
    of_line[k] = space.turn(a, b, t[k], axis);
  }
  if (std::min({of_a[0], of_a[1], of_a[2]}) >= 0) points.add(space.corner(a));
  if (std::min({of_b[0], of_b[1], of_b[2]}) >= 0) points.add(space.corner(b));
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
    // A corner of t between the ends: they are on opposite sides of one of its edges that is not along the line.
    if (of_line[k] == 0 && (of_a[k] * of_b[k] < 0 || of_a[m] * of_b[m] < 0)) points.add(space.corner(t[k]));
    if (of_line[k] * of_line[l] < 0 && of_a[k] * of_b[k] < 0)
      points.add(space.crossing(a, b, {{t[k], t[l], t[l]}, axis}));
  }
}

void cut_coplanar(const ExactSpace& space, const Triangle& s, std::uint32_t of_s, const Triangle& t, std::uint32_t of_t,
                  PairPoints& points) {
  const int axis = space.main_axis(t[0], t[1], t[2]);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t a = s[k], b = s[(k + 1) % 3], c = t[k], d = t[(k + 1) % 3];
    points.begin();
    edge_in_plane(space, a, b, t, axis, points);
    points.cut(of_t, {{a, b, b}, axis});
    points.begin();
    edge_in_plane(space, c, d, s, axis, points);
    points.cut(of_s, {{c, d, d}, axis});
  }
}

}  // namespace

void cut_pair(const ExactSpace& space, std::span<const Triangle> triangles, std::uint32_t s, std::uint32_t t,
              TriangleCuts& found) {
  const Triangle &a = triangles[s], &b = triangles[t];
  Signs of_a{}, of_b{};
  for (std::size_t k = 0; k < 3; ++k) of_a[k] = space.side(b[0], b[1], b[2], a[k]);
  if (all_of(of_a, 1) || all_of(of_a, -1)) return;
  PairPoints points(found);
  if (all_of(of_a, 0)) return cut_coplanar(space, a, s, b, t, points);
  for (std::size_t k = 0; k < 3; ++k) of_b[k] = space.side(a[0], a[1], a[2], b[k]);
  if (all_of(of_b, 1) || all_of(of_b, -1)) return;
  points_on(space, a, of_a, b, points);
  points_on(space, b, of_b, a, points);
  points.cut(s, {b});
  points.cut(t, {a});
}

}  // namespace sansmesh::inline v1
