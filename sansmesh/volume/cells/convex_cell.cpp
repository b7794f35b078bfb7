#include "sansmesh/volume/cells/convex_cell.h"

#include <algorithm>
#include <utility>

#include "sansmesh/cell_list.h"

namespace sansmesh::inline v1::detail {

void ConvexCell::assign_box(const Vec3& lower, const Vec3& upper) {
  vertices_.clear(), loops_.clear(), faces_.clear();
  for (int z = 0; z < 2; ++z)
    for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}})
      vertices_.emplace_back(x ? upper.x : lower.x, y ? upper.y : lower.y, z ? upper.z : lower.z);
  for (const CellFace& face : cell_faces(CellShape::hexahedron)) {
    faces_.push_back({kBox, static_cast<std::uint32_t>(loops_.size()), 4});
    loops_.insert(loops_.end(), face.corner.begin(), face.corner.end());
  }
}

bool ConvexCell::cut(const Vec3& normal, double offset, std::uint32_t label) {
  side_.resize(vertices_.size());
  bool any_out = false, any_in = false;
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    side_[v] = dot(normal, vertices_[v]) - offset;
    (side_[v] > 0 ? any_out : any_in) = true;
  }
  if (!any_out) return false;
  if (!any_in) {
    vertices_.clear(), loops_.clear(), faces_.clear();
    return true;
  }
  std::swap(vertices_, old_vertices_), std::swap(loops_, old_loops_), std::swap(faces_, old_faces_);
  vertices_.clear(), loops_.clear(), faces_.clear(), segments_.clear(), cut_edges_.clear();
  renamed_.assign(old_vertices_.size(), kGone);
  for (std::size_t v = 0; v < old_vertices_.size(); ++v)
    if (!(side_[v] > 0)) {
      renamed_[v] = static_cast<std::uint32_t>(vertices_.size());
      vertices_.push_back(old_vertices_[v]);
    }
  for (const Face& face : old_faces_) cut_face(face);
  close_cut(label);
  return true;
}

std::uint32_t ConvexCell::crossing(std::uint32_t a, std::uint32_t b) {
  if (a > b) std::swap(a, b);
  const std::uint64_t key = std::uint64_t{a} << 32 | b;
  for (const CutEdge& e : cut_edges_)
    if (e.key == key) return e.vertex;
  const double t = side_[a] / (side_[a] - side_[b]);
  const auto vertex = static_cast<std::uint32_t>(vertices_.size());
  vertices_.push_back(old_vertices_[a] + (old_vertices_[b] - old_vertices_[a]) * t);
  cut_edges_.push_back({key, vertex});
  return vertex;
}

void ConvexCell::add_face(std::uint32_t label, std::uint32_t begin) {
  const auto count = static_cast<std::uint32_t>(loops_.size()) - begin;
  if (count >= 3)
    faces_.push_back({label, begin, count});
  else
    loops_.resize(begin);
}

void ConvexCell::cut_face(const Face& face) {
  const auto begin = static_cast<std::uint32_t>(loops_.size());
  const std::uint32_t* const ring = old_loops_.data() + face.begin;
  // Vertices where the ring leaves the half-space, and where it first returned without having left.
  std::uint32_t leaving = kGone, pending = kGone;
  for (std::uint32_t k = 0; k < face.count; ++k) {
    const std::uint32_t a = ring[k], b = ring[k + 1 < face.count ? k + 1 : 0];
    const bool a_in = renamed_[a] != kGone, b_in = renamed_[b] != kGone;
    if (a_in) loops_.push_back(renamed_[a]);
    if (a_in == b_in) continue;
    const std::uint32_t v = crossing(a, b);
    loops_.push_back(v);
    if (a_in) {
      leaving = v;
    } else if (leaving != kGone) {
      segments_.push_back({leaving, v});
      leaving = kGone;
    } else {
      pending = v;
    }
  }
  if (leaving != kGone && pending != kGone) segments_.push_back({leaving, pending});
  add_face(face.label, begin);
}

void ConvexCell::close_cut(std::uint32_t label) {
  while (!segments_.empty()) {
    const auto begin = static_cast<std::uint32_t>(loops_.size());
    const std::uint32_t start = segments_.back().to;
    std::uint32_t at = segments_.back().from;
    loops_.push_back(start);
    segments_.pop_back();
    while (at != start) {
      loops_.push_back(at);
      const auto next = std::find_if(segments_.begin(), segments_.end(), [&](const Segment& s) { return s.to == at; });
      if (next == segments_.end()) break;
      at = next->from;
      *next = segments_.back();
      segments_.pop_back();
    }
    add_face(label, begin);
  }
}

double ConvexCell::volume() const {
  if (faces_.empty()) return 0;
  const Vec3 o = vertices_[loops_[faces_[0].begin]];
  double sum = 0;
  for (const Face& face : faces_) {
    const std::uint32_t* const ring = loops_.data() + face.begin;
    const Vec3 a = vertices_[ring[0]] - o;
    for (std::uint32_t k = 1; k + 1 < face.count; ++k)
      sum += dot(a, cross(vertices_[ring[k]] - o, vertices_[ring[k + 1]] - o));
  }
  return sum / 6;
}

void ConvexCell::moments(std::vector<FaceMoment>& out) const {
  out.clear();
  for (const Face& face : faces_) {
    const std::uint32_t* const ring = loops_.data() + face.begin;
    const Vec3 a = vertices_[ring[0]];
    Vec3 whole;
    for (std::uint32_t k = 1; k + 1 < face.count; ++k)
      whole += cross(vertices_[ring[k]] - a, vertices_[ring[k + 1]] - a);
    const Vec3 n = normalized(whole);
    FaceMoment moment{face.label, 0, {}};
    for (std::uint32_t k = 1; k + 1 < face.count; ++k) {
      const Vec3 b = vertices_[ring[k]], c = vertices_[ring[k + 1]];
      const double area = dot(n, cross(b - a, c - a)) / 2;
      moment.area += area;
      moment.first += (a + b + c) * (area / 3);
    }
    out.push_back(moment);
  }
}

}  // namespace sansmesh::inline v1::detail
