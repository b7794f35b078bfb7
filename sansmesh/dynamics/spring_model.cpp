#include "sansmesh/dynamics/spring_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kSpringRows = 1024;  ///< vertices per task

/// Whether check(first, last) holds for all ranges of vertices.
template <class Check>
bool all_rows(std::size_t n, const Check& check) {
  return parallel_reduce(n, kSpringRows, true, check, [](bool a, bool b) { return a && b; });
}

}  // namespace

SpringModel::SpringModel(VertexGraph graph, std::span<const Vec3> rest, double stiffness, double damping)
    : graph_(std::move(graph)), stiffness_(stiffness), damping_(damping) {
  lengths_.resize(graph_.neighbours.size());
  for (std::size_t i = 0; i < rest.size(); ++i) {
    for (std::size_t e = graph_.begin[i]; e < graph_.begin[i + 1]; ++e) {
      lengths_[e] = norm(rest[i] - rest[graph_.neighbours[e]]);
    }
  }
}

bool SpringModel::forces(std::span<const Vec3> x, std::span<const Vec3> v, std::span<Vec3> f) {
  const auto part = [&]<bool damped>(std::size_t first, std::size_t last) {
    bool sane = true;
    for (std::size_t i = first; i < last; ++i) {
      Vec3 sum, drag;
      for (std::size_t e = graph_.begin[i]; e < graph_.begin[i + 1]; ++e) {
        const std::uint32_t j = graph_.neighbours[e];
        const Vec3 d = x[i] - x[j];
        const double length = norm(d), rest = lengths_[e];
        sane &= length <= kMostStretch * rest;
        sum += d * (length > 0 ? 1 - rest / length : 0);
        if constexpr (damped) drag += v[i] - v[j];
      }
      f[i] = sum * -stiffness_;
      if constexpr (damped) f[i] -= drag * damping_;
    }
    return sane;
  };
  const bool damped = !v.empty() && damping_ > 0;
  return all_rows(x.size(), [&](std::size_t first, std::size_t last) {
    return damped ? part.operator()<true>(first, last) : part.operator()<false>(first, last);
  });
}

bool SpringModel::linearize(std::span<const Vec3> x, double h, std::span<Vec3> f) {
  links_.resize(lengths_.size());
  const double k = h * h * stiffness_, d = h * damping_;
  return all_rows(x.size(), [&](std::size_t first, std::size_t last) {
    bool sane = true;
    for (std::size_t i = first; i < last; ++i) {
      Vec3 sum;
      for (std::size_t e = graph_.begin[i]; e < graph_.begin[i + 1]; ++e) {
        const Vec3 along = x[i] - x[graph_.neighbours[e]];
        const double length = norm(along), rest = lengths_[e];
        sane &= length <= kMostStretch * rest;
        if (length > 0) {
          const double inverse = 1 / length, tension = 1 - rest * inverse, across = std::max(tension, 0.0);
          sum += along * tension;
          links_[e] = {static_cast<float>(k * across + d), Vec3f(along * (std::sqrt(k * (1 - across)) * inverse))};
        } else {
          links_[e] = {static_cast<float>(k + d), {}};  // no direction: stiff in all directions
        }
      }
      f[i] = sum * -stiffness_;
    }
    return sane;
  });
}

void SpringModel::add_rows(std::size_t first, std::size_t last, std::span<const Vec3> p, std::span<Vec3> q) const {
  const Vec3* all = p.data();
  const Link* links = links_.data();
  const std::uint32_t* neighbours = graph_.neighbours.data();
  for (std::size_t i = first; i < last; ++i) {
    const Vec3 own = all[i];
    Vec3 sum;
    for (std::size_t e = graph_.begin[i], end = graph_.begin[i + 1]; e < end; ++e) {
      const Vec3 d = own - all[neighbours[e]];
      const Vec3 u(links[e].u);
      sum += d * static_cast<double>(links[e].a) + u * dot(u, d);
    }
    q[i] += sum;
  }
}

SymmetricBlock SpringModel::diagonal(std::size_t i) const {
  SymmetricBlock sum;
  double a = 0;
  for (std::size_t e = graph_.begin[i]; e < graph_.begin[i + 1]; ++e) {
    const Vec3 u(links_[e].u);
    a += static_cast<double>(links_[e].a);
    sum.xx += u.x * u.x, sum.xy += u.x * u.y, sum.xz += u.x * u.z;
    sum.yy += u.y * u.y, sum.yz += u.y * u.z, sum.zz += u.z * u.z;
  }
  sum.xx += a, sum.yy += a, sum.zz += a;
  return sum;
}

double SpringModel::energy(std::span<const Vec3> x) const {
  const double squares = parallel_reduce(
      x.size(), kSpringRows, 0.0,
      [&](std::size_t first, std::size_t last) {
        double sum = 0;
        for (std::size_t i = first; i < last; ++i) {
          for (std::size_t e = graph_.begin[i]; e < graph_.begin[i + 1]; ++e) {
            const std::uint32_t j = graph_.neighbours[e];
            if (j < i) continue;
            const double stretch = norm(x[i] - x[j]) - lengths_[e];
            sum += stretch * stretch;
          }
        }
        return sum;
      },
      [](double a, double b) { return a + b; });
  return 0.5 * stiffness_ * squares;
}

std::string SpringModel::worst(std::span<const Vec3> x, std::span<const std::uint32_t> names) const {
  double most = -1;
  std::size_t from = 0, to = 0;
  for (std::size_t i = 0; i < x.size() && !std::isnan(most); ++i) {
    for (std::size_t e = graph_.begin[i]; e < graph_.begin[i + 1] && !std::isnan(most); ++e) {
      const double stretch = norm(x[i] - x[graph_.neighbours[e]]) / lengths_[e];
      if (!(stretch <= most)) most = stretch, from = i, to = graph_.neighbours[e];
    }
  }
  return "the edge between vertices " + std::to_string(names[from]) + " and " + std::to_string(names[to]) +
         " (counted from 0)";
}

}  // namespace sansmesh::inline v1
