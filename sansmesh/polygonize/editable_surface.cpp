#include "sansmesh/polygonize/editable_surface.h"

#include "sansmesh/core/parallel.h"
#include "sansmesh/mesh/vertex_corners.h"

namespace sansmesh::inline v1 {

EditableSurface::EditableSurface(std::vector<Triangle> triangles, std::size_t vertices)
    : triangle_(std::move(triangles)), twin_(3 * triangle_.size(), kNone), out_(vertices, kNone), border_(vertices, 0) {
  const VertexCorners corners(triangle_, vertices);
  parallel_for(0, triangle_.size(), 4096, [&](std::size_t t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto h = static_cast<std::uint32_t>(3 * t + k);
      const std::uint32_t a = from(h), b = to(h);
      for (std::uint32_t i = corners.first[b]; i < corners.first[b + 1]; ++i)
        if (to(corners.entries[i]) == a) twin_[h] = corners.entries[i];
    }
  });
  for (std::uint32_t h = 0; h < twin_.size(); ++h) {
    out_[from(h)] = h;
    if (twin_[h] == kNone) border_[from(h)] = border_[to(h)] = 1;
  }
}

std::uint32_t EditableSurface::add_vertex() {
  out_.push_back(kNone);
  border_.push_back(0);
  return static_cast<std::uint32_t>(out_.size() - 1);
}

std::uint32_t EditableSurface::add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  triangle_.push_back({a, b, c});
  twin_.insert(twin_.end(), 3, kNone);
  return static_cast<std::uint32_t>(3 * (triangle_.size() - 1));
}

std::uint32_t EditableSurface::split_edge(std::uint32_t h) {
  const std::uint32_t g = twin_[h];
  const std::uint32_t a = from(h), b = to(h), c = apex(h), d = apex(g), m = add_vertex();
  const std::uint32_t h1 = next(h), g1 = next(g), behind_h1 = twin_[h1], behind_g1 = twin_[g1];
  const std::uint32_t p = add_triangle(m, b, c), q = add_triangle(m, a, d);
  triangle_[h1 / 3][h1 % 3] = m;
  triangle_[g1 / 3][g1 % 3] = m;
  join(h1, p + 2);
  join_outer(p + 1, behind_h1);
  join(g1, q + 2);
  join_outer(q + 1, behind_g1);
  join(h, q);
  join(p, g);
  out_[m] = p;
  out_[a] = h;
  out_[b] = g;
  return m;
}

std::uint32_t EditableSurface::split_triangle(std::uint32_t t) {
  const auto [a, b, c] = triangle_[t];
  const std::uint32_t m = add_vertex(), behind_bc = twin_[3 * t + 1], behind_ca = twin_[3 * t + 2];
  const std::uint32_t p = add_triangle(b, c, m), q = add_triangle(c, a, m);
  triangle_[t][2] = m;
  join_outer(p, behind_bc);
  join_outer(q, behind_ca);
  join(3 * t + 1, p + 2);
  join(p + 1, q + 2);
  join(q + 1, 3 * t + 2);
  out_[m] = p + 2;
  out_[a] = 3 * t;
  out_[b] = p;
  out_[c] = q;
  return m;
}

bool EditableSurface::can_flip(std::uint32_t h) const {
  const std::uint32_t g = twin_[h];
  if (g == kNone) return false;
  const std::uint32_t c = apex(h), d = apex(g);
  if (c == d || (border_[c] && border_[d])) return false;  // an edge between them may exist outside
  for (const std::uint32_t v : {from(h), to(h)})
    if (!border_[v] && valence(v) < 4) return false;
  return border_[c] ? !adjacent(d, c) : !adjacent(c, d);
}

void EditableSurface::flip(std::uint32_t h) {
  const std::uint32_t g = twin_[h];
  const std::uint32_t a = from(h), b = to(h), c = apex(h), d = apex(g);
  const std::uint32_t bc = twin_[next(h)], ca = twin_[previous(h)], ad = twin_[next(g)], db = twin_[previous(g)];
  const std::uint32_t p = h / 3 * 3, q = g / 3 * 3;
  triangle_[p / 3] = {a, d, c};
  triangle_[q / 3] = {d, b, c};
  join_outer(p, ad);
  join_outer(p + 2, ca);
  join_outer(q, db);
  join_outer(q + 1, bc);
  join(p + 1, q + 2);
  out_[a] = p;
  out_[d] = q;
  out_[b] = q + 1;
  out_[c] = p + 2;
}

bool EditableSurface::can_collapse(std::uint32_t h) const {
  const std::uint32_t g = twin_[h];
  if (g == kNone) return false;
  const std::uint32_t a = from(h), b = to(h), c = apex(h), d = apex(g);
  if (border_[a] || border_[b] || c == d) return false;
  for (const std::uint32_t v : {c, d})
    if (!border_[v] && valence(v) < 4) return false;
  std::uint32_t common = 0;
  around(a, [&](std::uint32_t k) { common += adjacent(b, to(k)); });
  return common == 2;
}

void EditableSurface::collapse(std::uint32_t h) {
  const std::uint32_t g = twin_[h];
  const std::uint32_t a = from(h), b = to(h), c = apex(h), d = apex(g);
  std::uint32_t k = h;
  do {
    const std::uint32_t following = twin_[previous(k)];
    triangle_[k / 3][k % 3] = b;
    k = following;
  } while (k != h);
  const std::uint32_t cb = twin_[next(h)], ac = twin_[previous(h)], da = twin_[next(g)], bd = twin_[previous(g)];
  join(cb, ac);
  join(da, bd);
  out_[b] = ac;
  out_[c] = cb;
  out_[d] = da;
  out_[a] = kNone;
  triangle_[h / 3] = {b, b, b};
  triangle_[g / 3] = {b, b, b};
}

}  // namespace sansmesh::inline v1
