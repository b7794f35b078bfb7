#include "sansmesh/deform/cuts/cut_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/core/boxes.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/data/world_points.h"
#include "sansmesh/mesh/mesh_vertices.h"
#include "sansmesh/mesh/repair/planar_fill.h"

namespace sansmesh::inline v1 {
namespace {

using OnPlane = PlanarOccluder::Point;

/// A vertex of a curve that bounds faces, on both sides.
struct FaceCorner {
  std::uint32_t above = kNoVertex, below = kNoVertex;
  OnPlane point;
};
/// A point on the border of the cut.
struct BorderPoint {
  std::size_t border = 0;
  double at = 0;  ///< edge index plus fraction of the edge; on a line the length
};

class FaceMaker {
 public:
  FaceMaker(TriangleMesh& mesh, const PlanarOccluder& cut, double edge_length, bool inward)
      : mesh_(mesh), cut_(cut), length_(edge_length), inward_(inward) {
    box_ = with_margin(finite_bounds(mesh.origin, mesh.vertices), 1e-3);
  }

  std::size_t make(const Slit& slit) {
    if (!chains(slit) || !loops()) return 0;
    add_islands();
    return fill();
  }

 private:
  struct Piece {  // an edge of the slit, with the inside of the solid on its left
    FaceCorner from, to;
  };
  using Chain = std::vector<FaceCorner>;

  FaceCorner corner(std::uint32_t above, std::uint32_t below) const {
    return {above, below, cut_.in_plane(mesh_.origin + Vec3(mesh_.vertices[above]))};
  }

  /// Joins the edges of the slit into curves.
  bool chains(const Slit& slit) {
    std::vector<Piece> pieces;
    std::map<std::array<std::uint32_t, 2>, std::vector<std::size_t>> from;
    for (const SlitEdge& e : slit.edges) {
      if (e.beside_second == kNoVertex) return false;
      const auto height = [&](std::uint32_t v) { return cut_.height(mesh_.origin + Vec3(mesh_.vertices[v])); };
      // The triangle above the cut traverses the edge with the inside on the left, seen against the normal.
      const bool first_above = height(e.beside_first) > height(e.beside_second);
      if (first_above) {
        pieces.push_back({corner(e.first[0], e.second[0]), corner(e.first[1], e.second[1])});
      } else {
        pieces.push_back({corner(e.second[1], e.first[1]), corner(e.second[0], e.first[0])});
      }
    }
    if (inward_)
      for (Piece& p : pieces) std::swap(p.from, p.to);
    for (std::size_t i = 0; i < pieces.size(); ++i) from[{pieces[i].from.above, pieces[i].from.below}].push_back(i);
    std::map<std::array<std::uint32_t, 2>, int> into;
    for (const Piece& p : pieces) ++into[{p.to.above, p.to.below}];
    std::vector<std::uint8_t> used(pieces.size());
    const auto follow = [&](std::size_t i) {
      Chain chain = {pieces[i].from};
      for (;;) {
        used[i] = 1;
        chain.push_back(pieces[i].to);
        const auto next = from.find({pieces[i].to.above, pieces[i].to.below});
        if (next == from.end()) break;
        const auto free =
            std::find_if(next->second.begin(), next->second.end(), [&](std::size_t k) { return !used[k]; });
        if (free == next->second.end()) break;
        i = *free;
      }
      return chain;
    };
    // Curves that begin at the end of a slit come first.
    for (std::size_t i = 0; i < pieces.size(); ++i)
      if (!used[i] && into.count({pieces[i].from.above, pieces[i].from.below}) == 0) open_.push_back(follow(i));
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (used[i]) continue;
      Chain loop = follow(i);
      if (loop.front().above != loop.back().above) return false;
      loop.pop_back();
      loops_.push_back(std::move(loop));
    }
    return true;
  }

  BorderPoint on_border(const OnPlane& p) const {
    BorderPoint best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t b = 0; b < cut_.borders().size(); ++b)
      for (std::size_t i = 0; i < cut_.borders()[b].size(); ++i) {
        const PlanarOccluder::Edge& e = cut_.borders()[b][i];
        const double da = p.a - e.begin.a, db = p.b - e.begin.b;
        double t = da * e.along.a + db * e.along.b;
        const bool line = std::isinf(e.length);
        if (!line) t = std::clamp(t, 0.0, e.length);
        const double d = std::hypot(da - e.along.a * t, db - e.along.b * t);
        if (d < least) least = d, best = {b, line ? t : static_cast<double>(i) + std::min(t / e.length, 1 - 1e-12)};
      }
    return best;
  }

  OnPlane at_border(const BorderPoint& p) const {
    const auto& border = cut_.borders()[p.border];
    const bool line = std::isinf(border[0].length);
    const auto i = line ? std::size_t{0} : static_cast<std::size_t>(p.at) % border.size();
    const PlanarOccluder::Edge& e = border[i];
    const double t = line ? p.at : (p.at - std::floor(p.at)) * e.length;
    return {e.begin.a + e.along.a * t, e.begin.b + e.along.b * t};
  }

  /// A vertex shared by both sides: a copy of slit vertex `like` at another position.
  FaceCorner shared(const OnPlane& p, std::uint32_t like) {
    const std::uint32_t v = append_vertex_copy(mesh_, like);
    mesh_.vertices[v] = Vec3f(cut_.in_space(p) - mesh_.origin);
    still_.push_back(v);
    return {v, v, p};
  }

  /// Adds vertices along the border between two points of it.
  void along_border(Chain& chain, const BorderPoint& from, double to, std::uint32_t like) {
    const auto& border = cut_.borders()[from.border];
    const bool line = std::isinf(border[0].length);
    std::vector<double> corners = {from.at};
    if (!line)
      for (double k = std::floor(from.at) + 1; k < to - 1e-9; k += 1)
        if (k > from.at + 1e-9) corners.push_back(k);
    corners.push_back(to);
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
      const double a = corners[i], b = corners[i + 1];
      const double way = line ? b - a : (b - a) * border[static_cast<std::size_t>(a) % border.size()].length;
      const int n = std::max(1, whole_part<int>(std::ceil(way / length_)));
      for (int k = i == 0 ? 1 : 0; k < n; ++k)
        chain.push_back(shared(at_border({from.border, a + (b - a) * k / n}), like));
    }
  }

  /// Closes curves that begin and end at the cut's border along that border.
  bool loops() {
    struct Begin {
      double at;
      std::size_t chain;
    };
    std::map<std::size_t, std::vector<Begin>> begins;
    std::vector<BorderPoint> ends;
    for (std::size_t c = 0; c < open_.size(); ++c) {
      const BorderPoint begin = on_border(open_[c].front().point);
      begins[begin.border].push_back({begin.at, c});
      ends.push_back(on_border(open_[c].back().point));
      touched_.push_back(begin.border), touched_.push_back(ends.back().border);
    }
    std::vector<std::uint8_t> used(open_.size());
    for (std::size_t c = 0; c < open_.size(); ++c) {
      if (used[c]) continue;
      Chain loop;
      std::size_t at = c;
      for (;;) {
        if (used[at]) return false;
        used[at] = 1;
        loop.insert(loop.end(), open_[at].begin(), open_[at].end());
        const BorderPoint& end = ends[at];
        const auto found = begins.find(end.border);
        if (found == begins.end()) return false;
        const auto& border = cut_.borders()[end.border];
        const bool line = std::isinf(border[0].length);
        double least = std::numeric_limits<double>::infinity();
        std::size_t next = open_.size();
        for (const Begin& b : found->second) {
          double to = b.at;
          if (to < end.at) {
            if (line) continue;
            to += static_cast<double>(border.size());
          }
          if (to < least) least = to, next = b.chain;
        }
        if (next == open_.size()) return false;
        // Inside the solid the border stays in its box.
        if (least > end.at && !box_.contains(cut_.in_space(at_border({end.border, 0.5 * (end.at + least)}))))
          return false;
        along_border(loop, end, least, open_[at].back().above);
        at = next;
        if (at == c) break;
      }
      loops_.push_back(std::move(loop));
    }
    return !loops_.empty();
  }

  /// Adds the holes of the cut that are entirely inside the solid.
  void add_islands() {
    const std::vector<Chain> known = loops_;
    for (std::size_t b = 0; b < cut_.borders().size(); ++b) {
      if (std::find(touched_.begin(), touched_.end(), b) != touched_.end()) continue;
      if (std::isinf(cut_.borders()[b][0].length)) continue;
      bool within = false;
      const OnPlane p = at_border({b, 0});
      for (const Chain& loop : known)
        for (std::size_t i = 0; i < loop.size(); ++i) {
          const OnPlane &u = loop[i].point, &v = loop[(i + 1) % loop.size()].point;
          if ((u.b > p.b) == (v.b > p.b)) continue;
          if (u.a + (v.a - u.a) * (p.b - u.b) / (v.b - u.b) > p.a) within = !within;
        }
      if (!within) continue;
      Chain loop;
      const std::uint32_t like = known.front().front().above;
      loop.push_back(shared(p, like));
      along_border(loop, {b, 0}, static_cast<double>(cut_.borders()[b].size()), like);
      loops_.push_back(std::move(loop));
    }
  }

  std::size_t fill() {
    std::vector<std::vector<std::array<double, 2>>> curves;
    std::vector<FaceCorner> corners;
    for (const Chain& loop : loops_) {
      curves.emplace_back();
      for (const FaceCorner& c : loop) {
        curves.back().push_back({c.point.a, c.point.b});
        corners.push_back(c);
      }
    }
    // Edges between shared vertices would have four triangles.
    std::vector<std::uint8_t> shared;
    shared.reserve(corners.size());
    for (const FaceCorner& c : corners) shared.push_back(c.above == c.below);
    const PlanarFill fill = fill_planar(curves, length_, shared);
    if (fill.triangles.empty()) return 0;
    std::vector<std::uint32_t> aside;
    std::vector<Vec3f> offsets;
    const double beside = static_cast<double>(kAsideShare) * length_;
    const std::size_t known = corners.size();
    for (std::size_t i = known; i < fill.points.size(); ++i) {
      const OnPlane p{fill.points[i][0], fill.points[i][1]};
      std::size_t nearest = 0;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < known; ++k) {
        const double d = std::hypot(corners[k].point.a - p.a, corners[k].point.b - p.b);
        if (d < least) least = d, nearest = k;
      }
      FaceCorner c{append_vertex_copy(mesh_, corners[nearest].above), append_vertex_copy(mesh_, corners[nearest].below),
                   p};
      for (const std::uint32_t v : {c.above, c.below}) {
        mesh_.vertices[v] = Vec3f(cut_.in_space(p) - mesh_.origin);
        aside.push_back(v);
        const double rounded = cut_.height(mesh_.origin + Vec3(mesh_.vertices[v]));
        offsets.push_back(Vec3f(cut_.normal() * ((v == c.above ? beside : -beside) - rounded)));
      }
      corners.push_back(c);
    }
    for (const std::uint32_t v : still_) aside.push_back(v), offsets.push_back({});
    set_cut_sides(mesh_, aside, offsets);
    std::vector<std::uint32_t> rows(mesh_.triangles.size());
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<std::uint32_t>(i);
    for (Triangle t : fill.triangles) {
      if (inward_) std::swap(t[0], t[2]);
      mesh_.triangles.push_back({corners[t[0]].below, corners[t[1]].below, corners[t[2]].below});
      mesh_.triangles.push_back({corners[t[2]].above, corners[t[1]].above, corners[t[0]].above});
      rows.insert(rows.end(), 2, 0);
    }
    if (!mesh_.triangle_attributes.empty()) mesh_.triangle_attributes = mesh_.triangle_attributes.taken(rows);
    return 2 * fill.triangles.size();
  }

  TriangleMesh& mesh_;
  const PlanarOccluder& cut_;
  double length_;
  bool inward_;
  Box3 box_;  // bounds of the solid
  std::vector<Chain> open_, loops_;
  std::vector<std::size_t> touched_;  // borders of the cut at which slits end
  std::vector<std::uint32_t> still_;  // vertices shared by both sides
};

}  // namespace

std::size_t add_cut_faces(TriangleMesh& mesh, const Slit& slit, const PlanarOccluder& cut, double edge_length,
                          bool inward) {
  return FaceMaker(mesh, cut, edge_length, inward).make(slit);
}

}  // namespace sansmesh::inline v1
