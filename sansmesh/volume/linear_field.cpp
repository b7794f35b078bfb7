// The grid's own interpolation, and the nearest sample.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/box_tree.h"
#include "sansmesh/volume/cell_interpolant.h"
#include "sansmesh/volume/point_order.h"
#include "sansmesh/volume/reconstruction_makers.h"
#include "sansmesh/volume/volume_locator.h"

namespace sansmesh {
namespace {

constexpr std::size_t kBatch = 256;

void check_sizes(std::span<const Vec3> x, const VolumeAnswers& wanted, std::size_t components) {
  const auto fits = [](std::size_t size, std::size_t want) { return size == 0 || size == want; };
  if (!fits(wanted.values.size(), components * x.size()) || !fits(wanted.gradients.size(), components * x.size()) ||
      !fits(wanted.inside.size(), x.size()) || !fits(wanted.degrees.size(), x.size()))
    throw ArgumentError("VolumeField: the answers are not as many as the points");
}

/// What fields have that ask the locator first: points in an order that suits it, cut into batches.
class LocatedField : public VolumeField {
 public:
  explicit LocatedField(ReconstructionInput& input)
      : volume_(std::move(input.volume)), values_(std::move(input.values)), locator_(*volume_) {}

  Box3 bounds() const override { return volume_->bounds(); }
  std::size_t components() const override { return values_.components; }

  void evaluate(std::span<const Vec3> x, const VolumeAnswers& wanted) const override {
    check_sizes(x, wanted, values_.components);
    for_each_place(x, [&](std::size_t i, const VolumePlace& place) { answer(i, x[i], place, wanted); });
  }

  void spacing(std::span<const Vec3> x, std::span<double> found) const override {
    if (x.size() != found.size()) throw ArgumentError("VolumeField: as many spacings as points are needed");
    for_each_place(x, [&](std::size_t i, const VolumePlace& place) { found[i] = local_spacing(*volume_, place); });
  }

 protected:
  virtual void answer(std::size_t i, const Vec3& x, const VolumePlace& place, const VolumeAnswers& wanted) const = 0;

  template <class Visit>
  void for_each_place(std::span<const Vec3> x, const Visit& visit) const {
    const auto order = locality_order(x);
    parallel_ranges(0, x.size(), kBatch, [&](std::size_t first, std::size_t last) {
      std::array<VolumePlace, kBatch> places;
      std::array<Vec3, kBatch> sorted;
      const std::size_t count = last - first;
      if (order.empty()) {
        locator_.locate(x.subspan(first, count), std::span(places).first(count));
      } else {
        for (std::size_t k = 0; k < count; ++k) sorted[k] = x[order[first + k]];
        locator_.locate(std::span(sorted).first(count), std::span(places).first(count));
      }
      for (std::size_t k = 0; k < count; ++k) visit(order.empty() ? first + k : order[first + k], places[k]);
    });
  }

  void answer_zero(std::size_t i, const VolumeAnswers& wanted) const {
    const std::size_t n = values_.components;
    for (std::size_t c = 0; c < n; ++c) {
      if (!wanted.values.empty()) wanted.values[i * n + c] = 0;
      if (!wanted.gradients.empty()) wanted.gradients[i * n + c] = {};
    }
    if (!wanted.inside.empty()) wanted.inside[i] = 0;
    if (!wanted.degrees.empty()) wanted.degrees[i] = 0;
  }

  std::shared_ptr<const SampledVolume> volume_;
  VolumeValues values_;
  VolumeLocator locator_;
};

class LinearField final : public LocatedField {
 public:
  explicit LinearField(ReconstructionInput& input) : LocatedField(input) {
    if (volume_->in_cells && !volume_->lattice) between_cells_.emplace(*volume_, values_);
  }

 private:
  void answer(std::size_t i, const Vec3& x, const VolumePlace& place, const VolumeAnswers& wanted) const override {
    if (!is_finite(x)) return answer_zero(i, wanted);
    if (!wanted.inside.empty()) wanted.inside[i] = place.inside;
    if (!wanted.degrees.empty()) wanted.degrees[i] = 1;
    if (wanted.values.empty() && wanted.gradients.empty()) return;
    const std::size_t n = values_.components;
    // Outside the place that counts is the nearest one, from where the function goes on a little.
    Vec3 beyond, at = x;
    if (!place.inside) {
      at = {};
      for (std::size_t c = 0; c < place.corner_count; ++c) at += corner(place, c) * place.weights[c];
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
        const auto of = values_.of(place.corners[c]);
        for (std::size_t k = 0; k < n; ++k) v[k] += place.weights[c] * of[k];
      }
      if (!g.empty()) {
        std::array<Vec3, 8> slopes;
        shape_gradients(*volume_, place, x, slopes);
        std::fill(g.begin(), g.end(), Vec3{});
        for (std::size_t c = 0; c < place.corner_count; ++c) {
          const auto of = values_.of(place.corners[c]);
          for (std::size_t k = 0; k < n; ++k) g[k] += slopes[c] * of[k];
        }
      }
    }
    if (!place.inside)
      for (std::size_t k = 0; k < n; ++k)
        if (const double more = dot(g[k], beyond); std::isfinite(more)) v[k] += more;
  }

  Vec3 corner(const VolumePlace& place, std::size_t c) const {
    return volume_->lattice ? volume_->lattice->position(place.corners[c]) : volume_->corner(place.corners[c]);
  }

  double shortest_edge(const VolumePlace& place) const {
    double least = std::numeric_limits<double>::infinity();
    const CellShape shape = volume_->lattice ? CellShape::hexahedron : volume_->cells.shapes[place.cell];
    for (const auto& edge : cell_edges(shape))
      least = std::min(least, squared_norm(corner(place, edge[0]) - corner(place, edge[1])));
    return std::sqrt(least);
  }

  std::optional<CellInterpolant> between_cells_;
};

class NearestField final : public LocatedField {
 public:
  explicit NearestField(ReconstructionInput& input) : LocatedField(input) {
    if (volume_->lattice) return;
    tree_ = BoxTree(volume_->size(), [this](std::size_t i) {
      return Box3{volume_->positions[i], volume_->positions[i]};
    });
  }

 private:
  void answer(std::size_t i, const Vec3& x, const VolumePlace& place, const VolumeAnswers& wanted) const override {
    if (!is_finite(x)) return answer_zero(i, wanted);
    if (!wanted.inside.empty()) wanted.inside[i] = place.inside;
    if (!wanted.degrees.empty()) wanted.degrees[i] = 0;
    const std::size_t n = values_.components;
    if (!wanted.gradients.empty())
      std::fill_n(wanted.gradients.begin() + static_cast<std::ptrdiff_t>(i * n), n, Vec3{});
    if (wanted.values.empty()) return;
    const auto of = values_.of(nearest(x, place));
    std::copy(of.begin(), of.end(), wanted.values.begin() + static_cast<std::ptrdiff_t>(i * n));
  }

  std::uint32_t nearest(const Vec3& x, const VolumePlace& place) const {
    std::uint32_t best = place.corners[0];
    const auto distance = [&](std::uint32_t s) { return squared_norm(volume_->position(s) - x); };
    if (volume_->lattice) {
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
