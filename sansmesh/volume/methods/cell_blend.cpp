#include "sansmesh/volume/methods/cell_blend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sansmesh/volume/cells/cell_corners.h"
#include "sansmesh/volume/cells/higher_order_functions.h"
#include "sansmesh/volume/methods/grouped_field.h"

namespace sansmesh::inline v1 {
namespace {

using detail::CellCorner;
using detail::CellTile;

class CellBlend final : public GroupedField {
 public:
  CellBlend(std::shared_ptr<const SampledVolume> volume, std::shared_ptr<const VolumeLocator> locator,
            std::unique_ptr<CornerPolynomials> polynomials)
      : GroupedField(std::move(volume), std::move(locator), polynomials->components()),
        polynomials_(std::move(polynomials)),
        higher_(this->volume()) {}

 private:
  struct Tile final : Memory {
    CellTile tile;
    NodeWeights nodes;
    std::vector<double> own;  // interpolation by cells of higher order: all components, point by point
    std::vector<Vec3> own_slopes;
  };

  std::unique_ptr<Memory> memory() const override { return std::make_unique<Tile>(); }

  void evaluate_group(const Group& group, Memory& memory, const PolynomialValues& wanted) const override {
    static_assert(CellTile::kTile == kMostPoints);
    CellTile& tile = static_cast<Tile&>(memory).tile;
    const std::size_t n = group.size, c = components(), count = group.cell.corner_count;
    const std::span<const std::uint32_t> samples = std::span(group.cell.corners).first(count);
    const CellShape shape = shape_of_cell(volume(), group.cell.cell);
    const bool gradient = !wanted.gradients.empty();
    std::array<CellCorner, 8> corners;
    std::array<Vec3, 8> positions;
    for (std::size_t v = 0; v < count; ++v) positions[v] = corner_position(volume(), samples[v]);
    double base = polynomials_->corners(samples, 0, corners);

    constexpr std::size_t kRow = 16;  // read by the widest vectors
    const std::size_t filled = (n + kRow - 1) / kRow * kRow;
    for (std::size_t i = 0; i < filled; ++i) {
      const std::size_t p = std::min(i, n - 1);
      const CellLocation& location = *group.locations[p];
      const Vec3 at = group.x[p] + held(group.out[p], corners[0].metric);
      for (std::size_t v = 0; v < count; ++v) {
        const Vec3 d = at - positions[v];
        tile.weights[v][i] = static_cast<float>(location.weights[v]);
        for (std::size_t k = 0; k < 3; ++k) tile.offsets[v][k][i] = static_cast<float>(d[k]);
      }
      if (!gradient) continue;
      std::array<Vec3, 8> slopes;
      shape_gradients(volume(), location, at, slopes);
      for (std::size_t v = 0; v < count; ++v)
        for (std::size_t k = 0; k < 3; ++k) tile.slopes[v][k][i] = static_cast<float>(slopes[v][k]);
    }
    detail::blend_weights(shape, filled, gradient, tile);
    const bool trusted = std::all_of(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(count),
                                     [](const CellCorner& corner) { return corner.trust >= 1; });
    const bool own = !trusted && higher_.has(group.cell.cell);
    if (own) interpolate(group, corners[0].metric, gradient, static_cast<Tile&>(memory));
    for (std::size_t m = 0; m < c; ++m) {
      if (m > 0) base = polynomials_->corners(samples, m, corners);
      if (own) fill_own(static_cast<Tile&>(memory), n, filled, m, base);
      detail::blend_corners(corners.data(), count, filled, gradient, own, tile);
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t to = group.to[i] * c + m;
        if (!wanted.values.empty()) wanted.values[to] = base + static_cast<double>(tile.value[i]);
        if (gradient) wanted.gradients[to] = Vec3(Vec3f{tile.gradient[0][i], tile.gradient[1][i], tile.gradient[2][i]});
      }
    }
    if (wanted.degrees.empty()) return;
    for (std::size_t i = 0; i < n; ++i) {
      std::size_t most = 0;
      for (std::size_t v = 1; v < count; ++v)
        if (tile.blend[v][i] > tile.blend[most][i]) most = v;
      wanted.degrees[group.to[i]] = static_cast<std::uint8_t>(corners[most].trust > 0 ? corners[most].degree : 1);
    }
  }

  // The functions of a cell of higher order; outside the volume they continue linearly.
  void interpolate(const Group& group, const StarMetric& metric, bool gradient, Tile& to) const {
    const std::size_t n = group.size, c = components();
    const VolumeValues& values = polynomials_->values();
    to.own.resize(n * c), to.own_slopes.resize(gradient ? n * c : 0);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 out = held(group.out[i], metric);
      const bool beyond = squared_norm(out) > 0;
      higher_.find(*group.locations[i], group.x[i], gradient || beyond, to.nodes);
      for (std::size_t m = 0; m < c; ++m) {
        const Vec3 slope = gradient || beyond ? to.nodes.gradient(values, m) : Vec3{};
        to.own[i * c + m] = to.nodes.value(values, m) + (beyond ? dot(slope, out) : 0);
        if (gradient) to.own_slopes[i * c + m] = slope;
      }
    }
  }
  void fill_own(Tile& from, std::size_t n, std::size_t filled, std::size_t m, double base) const {
    const std::size_t c = components();
    for (std::size_t i = 0; i < filled; ++i) {
      const std::size_t at = std::min(i, n - 1) * c + m;
      from.tile.own[i] = static_cast<float>(from.own[at] - base);
      for (std::size_t k = 0; k < 3 && !from.own_slopes.empty(); ++k)
        from.tile.own_slopes[k][i] = static_cast<float>(from.own_slopes[at][k]);
    }
  }

  // Limits the offset outside the volume to half a local length.
  static Vec3 held(const Vec3& out, const StarMetric& metric) {
    const double length = norm(metric(out));
    if (!std::isfinite(length)) return {};
    return length > 0.5 ? out * (0.5 / length) : out;
  }

  std::unique_ptr<CornerPolynomials> polynomials_;
  HigherOrderFunctions higher_;
};

}  // namespace

std::unique_ptr<VolumeField> make_cell_blend(std::shared_ptr<const SampledVolume> volume,
                                             std::shared_ptr<const VolumeLocator> locator,
                                             std::unique_ptr<CornerPolynomials> polynomials) {
  return std::make_unique<CellBlend>(std::move(volume), std::move(locator), std::move(polynomials));
}

}  // namespace sansmesh::inline v1
