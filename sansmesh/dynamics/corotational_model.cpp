#include "sansmesh/dynamics/corotational_model.h"

#include <cmath>
#include <utility>

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kTetRange = 512, kVertexRange = 512, kEdgeRange = 1024;  ///< items per task

Vec3 times(const Matrix3& m, const Vec3& v) { return m.a * v.x + m.b * v.y + m.c * v.z; }
Vec3 transposed_times(const Matrix3& m, const Vec3& v) { return {dot(m.a, v), dot(m.b, v), dot(m.c, v)}; }

/// A symmetric strain.
struct Strain {
  double xx, yy, zz, xy, xz, yz;
  double trace() const { return xx + yy + zz; }
};

/// The symmetric part of Rᵀ F.
Strain strain_in(const Matrix3& r, const Matrix3& f) {
  const Vec3 a = transposed_times(r, f.a), b = transposed_times(r, f.b), c = transposed_times(r, f.c);
  return {a.x, b.y, c.z, 0.5 * (a.y + b.x), 0.5 * (a.z + c.x), 0.5 * (b.z + c.y)};
}

}  // namespace

CorotationalModel::CorotationalModel(std::vector<Tet> tets, std::span<const Vec3> rest, double young, double poisson,
                                     double damping)
    : tets_(std::move(tets)),
      shapes_(tets_.size()),
      turns_(tets_.size()),
      carried_(tets_.size()),
      pulls_(tets_.size()),
      graph_(vertex_graph(tets_, rest.size())),
      corners_(corners_of_vertices(tets_, rest.size())),
      around_(tets_of_edges(tets_, graph_)),
      mu_(young / (2 * (1 + poisson))),
      lambda_(young * poisson / ((1 + poisson) * (1 - 2 * poisson))),
      damping_(damping) {
  parallel_for(0, tets_.size(), kTetRange, [&](std::size_t t) { shapes_[t] = tet_gradients(tets_[t], rest); });
}

Matrix3 CorotationalModel::gradient(std::size_t t, std::span<const Vec3> x) const {
  return tet_jacobian(tets_[t], shapes_[t].of, x);
}

bool CorotationalModel::forces(std::span<const Vec3> x, std::span<const Vec3> v, std::span<Vec3> f) {
  const bool damped = !v.empty() && damping_ > 0;
  const bool sane = parallel_reduce(
      tets_.size(), kTetRange, true,
      [&](std::size_t first, std::size_t last) {
        bool all = true;
        for (std::size_t t = first; t < last; ++t) {
          const Matrix3 m = gradient(t, x);
          all &= squared_norm(m.a) + squared_norm(m.b) + squared_norm(m.c) <= kMostStretch * kMostStretch;
          turns_[t] = nearest_turn(m, turns_[t]);
          const Matrix3 r = turns_[t].matrix();
          Strain s = strain_in(r, m);
          s.xx -= 1, s.yy -= 1, s.zz -= 1;
          if (damped) {
            const Strain d = strain_in(r, gradient(t, v));
            s.xx += damping_ * d.xx, s.yy += damping_ * d.yy, s.zz += damping_ * d.zz;
            s.xy += damping_ * d.xy, s.xz += damping_ * d.xz, s.yz += damping_ * d.yz;
          }
          const double pressure = lambda_ * s.trace(), two = 2 * mu_;
          for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 g = shapes_[t].of[k];
            const Vec3 stress{two * (s.xx * g.x + s.xy * g.y + s.xz * g.z) + pressure * g.x,
                              two * (s.xy * g.x + s.yy * g.y + s.yz * g.z) + pressure * g.y,
                              two * (s.xz * g.x + s.yz * g.y + s.zz * g.z) + pressure * g.z};
            pulls_[t][k] = times(r, stress) * -shapes_[t].volume;
            carried_[t][k] = times(r, g);
          }
        }
        return all;
      },
      [](bool a, bool b) { return a && b; });
  parallel_for(0, x.size(), kVertexRange, [&](std::size_t i) {
    Vec3 sum;
    for (std::size_t c = corners_.first[i]; c < corners_.first[i + 1]; ++c) {
      const std::uint32_t corner = corners_.entries[c];
      const auto& pull = pulls_[corner / 4];
      sum += corner % 4 ? pull[corner % 4 - 1] : -(pull[0] + pull[1] + pull[2]);
    }
    f[i] = sum;
  });
  return sane;
}

/// −K_ij of an edge, by rows: the sum of −V (λ g_i g_jᵀ + μ (g_i · g_j I + g_j g_iᵀ)) over the surrounding tetrahedra.
CorotationalModel::Block CorotationalModel::edge_block(std::size_t edge) const {
  Block sum;
  for (std::size_t k = around_.first[edge]; k < around_.first[edge + 1]; ++k) {
    const std::uint32_t item = around_.entries[k];
    const std::size_t t = item / 16, a = item / 4 % 4, b = item % 4;
    const auto& g = carried_[t];
    const Vec3 none = -(g[0] + g[1] + g[2]);
    const Vec3 gi = a ? g[a - 1] : none, gj = b ? g[b - 1] : none;
    const double l = -shapes_[t].volume * lambda_, m = -shapes_[t].volume * mu_, both = m * dot(gi, gj);
    for (std::size_t r = 0; r < 3; ++r) sum[r] += gj * (l * gi[r]) + gi * (m * gj[r]);
    sum[0].x += both, sum[1].y += both, sum[2].z += both;
  }
  return sum;
}

bool CorotationalModel::linearize(std::span<const Vec3> x, double h, std::span<Vec3> f) {
  const bool sane = forces(x, {}, f);
  blocks_.resize(graph_.edges.size());
  const double scale = h * h + h * damping_;
  parallel_for(0, blocks_.size(), kEdgeRange, [&](std::size_t e) {
    blocks_[e] = edge_block(e);
    for (Vec3& row : blocks_[e]) row *= scale;
  });
  return sane;
}

void CorotationalModel::add_rows(std::size_t first, std::size_t last, std::span<const Vec3> p,
                                 std::span<Vec3> q) const {
  for (std::size_t i = first; i < last; ++i) {
    const Vec3 own = p[i];
    Vec3 sum;
    for (std::size_t e = graph_.begin[i]; e < graph_.begin[i + 1]; ++e) {
      const std::uint32_t j = graph_.neighbours[e];
      const Block& m = blocks_[graph_.edge_of[e]];
      const Vec3 d = own - p[j];
      if (j < i) {
        sum += m[0] * d.x + m[1] * d.y + m[2] * d.z;
      } else {
        sum += Vec3{dot(m[0], d), dot(m[1], d), dot(m[2], d)};
      }
    }
    q[i] += sum;
  }
}

SymmetricBlock CorotationalModel::diagonal(std::size_t i) const {
  SymmetricBlock sum;
  for (std::size_t e = graph_.begin[i]; e < graph_.begin[i + 1]; ++e) {
    const Block& m = blocks_[graph_.edge_of[e]];
    sum.xx += m[0].x, sum.yy += m[1].y, sum.zz += m[2].z;
    sum.xy += 0.5 * (m[0].y + m[1].x), sum.xz += 0.5 * (m[0].z + m[2].x), sum.yz += 0.5 * (m[1].z + m[2].y);
  }
  return sum;
}

double CorotationalModel::energy(std::span<const Vec3> x) const {
  return parallel_reduce(
      tets_.size(), kTetRange, 0.0,
      [&](std::size_t first, std::size_t last) {
        double sum = 0;
        for (std::size_t t = first; t < last; ++t) {
          const Matrix3 m = gradient(t, x), r = nearest_turn(m, turns_[t]).matrix();
          const double trace = dot(r.a, m.a) + dot(r.b, m.b) + dot(r.c, m.c) - 3;
          const double distance = squared_norm(m.a - r.a) + squared_norm(m.b - r.b) + squared_norm(m.c - r.c);
          sum += shapes_[t].volume * (mu_ * distance + 0.5 * lambda_ * trace * trace);
        }
        return sum;
      },
      [](double a, double b) { return a + b; });
}

std::string CorotationalModel::worst(std::span<const Vec3> x, std::span<const std::uint32_t> names) const {
  double most = -1;
  std::size_t found = 0;
  for (std::size_t t = 0; t < tets_.size() && !std::isnan(most); ++t) {
    const Matrix3 m = gradient(t, x);
    const double stretch = squared_norm(m.a) + squared_norm(m.b) + squared_norm(m.c);
    if (!(stretch <= most)) most = stretch, found = t;
  }
  std::string text = "the tetrahedron of vertices ";
  for (std::size_t k = 0; k < 4; ++k)
    text += (k ? k < 3 ? ", " : " and " : "") + std::to_string(names[tets_[found][k]]);
  return text + " (counted from 0)";
}

}  // namespace sansmesh::inline v1
