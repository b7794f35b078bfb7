// The grid's own interpolation, and the nearest sample.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "sansmesh/volume/box_tree.h"
#include "sansmesh/volume/cell_interpolant.h"
#include "sansmesh/volume/pointwise_field.h"
#include "sansmesh/volume/reconstruction_makers.h"

namespace sansmesh {
namespace {

class LinearField final : public detail::LocatedField {
 public:
  explicit LinearField(ReconstructionInput& input) : LocatedField(std::move(input.volume), std::move(input.values)) {
    if (volume().in_cells && !volume().lattice) between_cells_.emplace(volume(), samples());
  }

 private:
  void answer_at(std::size_t i, const Vec3& x, const VolumePlace& place, const VolumeAnswers& wanted) const override {
    if (!wanted.inside.empty()) wanted.inside[i] = place.inside;
    if (!wanted.degrees.empty()) wanted.degrees[i] = 1;
    if (wanted.values.empty() && wanted.gradients.empty()) return;
    const std::size_t n = samples().components;
    // Outside the place that counts is the nearest one, from where the function goes on a little.
    Vec3 beyond, at = x;
    if (!place.inside) {
      at = position_of(place);
      beyond = x - at;
      const double length = norm(beyond), most = shortest_edge(place) / 2;
      if (length > most) beyond *= std::isfinite(length) ? most / length : 0;
    }
    const std::span<double> values = wanted.values.empty() ? std::span<double>() : wanted.values.subspan(i * n, n);
    const std::span<Vec3> gradients = wanted.gradients.empty() ? std::span<Vec3>() : wanted.gradients.subspan(i * n, n);
    constexpr std::size_t kSome = 16;
    std::array<double, kSome> value_store;
    std::array<Vec3, kSome> slope_store;
    std::vector<double> more_values;
    std::vector<Vec3> more_slopes;
    std::span<double> v = values;
    std::span<Vec3> g = gradients;
    if (n <= kSome) {
      if (v.empty()) v = std::span(value_store).first(n);
      if (g.empty() && !place.inside) g = std::span(slope_store).first(n);
    } else {
      if (v.empty()) v = more_values = std::vector<double>(n);
      if (g.empty() && !place.inside) g = more_slopes = std::vector<Vec3>(n);
    }
    if (between_cells_) {
      between_cells_->evaluate(place, at, v, g);
    } else {
      std::fill(v.begin(), v.end(), 0.0);
      for (std::size_t c = 0; c < place.corner_count; ++c) {
        const auto of = samples().of(place.corners[c]);
        for (std::size_t k = 0; k < n; ++k) v[k] += place.weights[c] * of[k];
      }
      if (!g.empty()) {
        std::array<Vec3, 8> slopes;
        shape_gradients(volume(), place, x, slopes);
        std::fill(g.begin(), g.end(), Vec3{});
        for (std::size_t c = 0; c < place.corner_count; ++c) {
          const auto of = samples().of(place.corners[c]);
          for (std::size_t k = 0; k < n; ++k) g[k] += slopes[c] * of[k];
        }
      }
    }
    if (!place.inside)
      for (std::size_t k = 0; k < n; ++k)
        if (const double more = dot(g[k], beyond); std::isfinite(more)) v[k] += more;
  }

  Vec3 corner(const VolumePlace& place, std::size_t c) const {
    return volume().lattice ? volume().lattice->position(place.corners[c]) : volume().corner(place.corners[c]);
  }

  double shortest_edge(const VolumePlace& place) const {
    double least = std::numeric_limits<double>::infinity();
    const CellShape shape = volume().lattice ? CellShape::hexahedron : volume().cells.shapes[place.cell];
    for (const auto& edge : cell_edges(shape))
      least = std::min(least, squared_norm(corner(place, edge[0]) - corner(place, edge[1])));
    return std::sqrt(least);
  }

  std::optional<CellInterpolant> between_cells_;
};

class NearestField final : public detail::LocatedField {
 public:
  explicit NearestField(ReconstructionInput& input) : LocatedField(std::move(input.volume), std::move(input.values)) {
    if (volume().lattice) return;
    tree_ = BoxTree(volume().size(), [this](std::size_t i) {
      return Box3{volume().positions[i], volume().positions[i]};
    });
  }

 private:
  void answer_at(std::size_t i, const Vec3& x, const VolumePlace& place, const VolumeAnswers& wanted) const override {
    if (!wanted.inside.empty()) wanted.inside[i] = place.inside;
    if (!wanted.degrees.empty()) wanted.degrees[i] = 0;
    const std::size_t n = samples().components;
    if (!wanted.gradients.empty())
      std::fill_n(wanted.gradients.begin() + static_cast<std::ptrdiff_t>(i * n), n, Vec3{});
    if (wanted.values.empty()) return;
    const auto of = samples().of(nearest(x, place));
    std::copy(of.begin(), of.end(), wanted.values.begin() + static_cast<std::ptrdiff_t>(i * n));
  }

  std::uint32_t nearest(const Vec3& x, const VolumePlace& place) const {
    std::uint32_t best = place.corners[0];
    const auto distance = [&](std::uint32_t s) { return squared_norm(volume().position(s) - x); };
    if (volume().lattice) {
      for (std::size_t c = 1; c < place.corner_count; ++c)
        if (distance(place.corners[c]) < distance(best)) best = place.corners[c];
      return best;
    }
    const std::uint32_t found = tree_.nearest(x, distance, std::numeric_limits<double>::infinity());
    return found == BoxTree::kNone ? 0 : found;
  }

  BoxTree tree_;
};

}  // namespace

std::unique_ptr<VolumeField> make_nearest_field(ReconstructionInput input) {
  return std::make_unique<NearestField>(input);
}
std::unique_ptr<VolumeField> make_linear_field(ReconstructionInput input) {
  return std::make_unique<LinearField>(input);
}

}  // namespace sansmesh
