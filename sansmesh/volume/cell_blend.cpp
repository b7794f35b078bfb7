#include "sansmesh/volume/cell_blend.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/point_order.h"

namespace sansmesh {
namespace {

using detail::CellCorner;
using detail::CellTile;

// Below the number from which on the locator sorts.
constexpr std::size_t kBlendBlock = 2000;

class CellBlend final : public VolumeField {
 public:
  CellBlend(std::shared_ptr<const SampledVolume> volume, std::shared_ptr<const VolumeLocator> locator,
            std::unique_ptr<CornerPolynomials> polynomials)
      : volume_(std::move(volume)), locator_(std::move(locator)), polynomials_(std::move(polynomials)) {}

  Box3 bounds() const override { return volume_->bounds(); }
  std::size_t components() const override { return polynomials_->components(); }

  void evaluate(std::span<const Vec3> x, const VolumeAnswers& wanted) const override {
    const std::size_t n = x.size(), c = components();
    const auto fits = [n](std::size_t size, std::size_t each) { return size == 0 || size == n * each; };
    if (!fits(wanted.values.size(), c) || !fits(wanted.gradients.size(), c) || !fits(wanted.inside.size(), 1) ||
        !fits(wanted.degrees.size(), 1))
      throw ArgumentError("volume field: room for the answers at all points is needed");
    const auto order = locality_order(x);
    parallel_ranges(0, (n + kBlendBlock - 1) / kBlendBlock, 1, [&](std::size_t begin, std::size_t end) {
      Scratch scratch;
      for (std::size_t b = begin; b < end; ++b)
        evaluate_block(x, order, b * kBlendBlock, std::min(n, (b + 1) * kBlendBlock), wanted, scratch);
    });
  }

  void spacing(std::span<const Vec3> x, std::span<double> found) const override {
    if (found.size() != x.size()) throw ArgumentError("volume field: room for the answers at all points is needed");
    std::vector<VolumePlace> places(x.size());
    locator_->locate(x, places);
    parallel_for(0, x.size(), 1024, [&](std::size_t i) { found[i] = local_spacing(*volume_, places[i]); });
  }

 private:
  struct Scratch {
    std::vector<Vec3> x;
    std::vector<std::uint32_t> at;
    std::vector<VolumePlace> places;
    std::vector<std::uint64_t> keys;
    CellTile tile;
  };

  Vec3 corner(std::uint32_t c) const { return volume_->lattice ? volume_->lattice->position(c) : volume_->corner(c); }

  void evaluate_block(std::span<const Vec3> x, std::span<const std::uint32_t> order, std::size_t first,
                      std::size_t last, const VolumeAnswers& wanted, Scratch& s) const {
    const std::size_t m = last - first;
    s.x.resize(m), s.at.resize(m), s.places.resize(m), s.keys.clear();
    for (std::size_t i = 0; i < m; ++i) {
      s.at[i] = order.empty() ? static_cast<std::uint32_t>(first + i) : order[first + i];
      s.x[i] = x[s.at[i]];
    }
    locator_->locate(s.x, s.places);
    for (std::size_t i = 0; i < m; ++i) {
      if (!wanted.inside.empty()) wanted.inside[s.at[i]] = s.places[i].inside;
      if (is_finite(s.x[i])) {
        s.keys.push_back(static_cast<std::uint64_t>(s.places[i].cell) << 32 | i);
        continue;
      }
      for (std::size_t k = 0; k < components(); ++k) {
        if (!wanted.values.empty()) wanted.values[s.at[i] * components() + k] = 0;
        if (!wanted.gradients.empty()) wanted.gradients[s.at[i] * components() + k] = {};
      }
      if (!wanted.degrees.empty()) wanted.degrees[s.at[i]] = 0;
    }
    std::sort(s.keys.begin(), s.keys.end());
    for (std::size_t i = 0; i < s.keys.size();) {
      std::size_t j = i + 1;
      while (j < s.keys.size() && s.keys[j] >> 32 == s.keys[i] >> 32 && j - i < CellTile::kTile) ++j;
      evaluate_group(std::span(s.keys).subspan(i, j - i), wanted, s);
      i = j;
    }
  }

  // Points of one cell.
  void evaluate_group(std::span<const std::uint64_t> keys, const VolumeAnswers& wanted, Scratch& s) const {
    CellTile& tile = s.tile;
    const std::size_t n = keys.size(), c = components();
    const auto point = [&](std::size_t i) { return static_cast<std::uint32_t>(keys[i]); };
    const VolumePlace& cell = s.places[point(0)];
    const std::size_t count = cell.corner_count;
    const std::span<const std::uint32_t> samples = std::span(cell.corners).first(count);
    const CellShape shape = volume_->lattice ? CellShape::hexahedron : volume_->cells.shapes[cell.cell];
    const bool gradient = !wanted.gradients.empty();
    std::array<CellCorner, 8> corners;
    std::array<Vec3, 8> positions;
    for (std::size_t v = 0; v < count; ++v) positions[v] = corner(samples[v]);
    double base = polynomials_->corners(samples, 0, corners);

    constexpr std::size_t kRow = 16;  // what the widest vectors read
    const std::size_t filled = (n + kRow - 1) / kRow * kRow;
    for (std::size_t i = 0; i < filled; ++i) {
      const std::uint32_t p = point(std::min(i, n - 1));
      const VolumePlace& place = s.places[p];
      const Vec3 at = place.inside ? s.x[p] : held(s.x[p], place, positions, corners[0].metric);
      for (std::size_t v = 0; v < count; ++v) {
        const Vec3 d = at - positions[v];
        tile.weights[v][i] = static_cast<float>(place.weights[v]);
        for (std::size_t k = 0; k < 3; ++k) tile.offsets[v][k][i] = static_cast<float>(d[k]);
      }
      if (!gradient) continue;
      std::array<Vec3, 8> slopes;
      shape_gradients(*volume_, place, at, slopes);
      for (std::size_t v = 0; v < count; ++v)
        for (std::size_t k = 0; k < 3; ++k) tile.slopes[v][k][i] = static_cast<float>(slopes[v][k]);
    }
    detail::blend_weights(shape, filled, gradient, tile);
    for (std::size_t m = 0; m < c; ++m) {
      if (m > 0) base = polynomials_->corners(samples, m, corners);
      detail::blend_corners(corners.data(), count, filled, gradient, tile);
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t to = s.at[point(i)] * c + m;
        if (!wanted.values.empty()) wanted.values[to] = base + static_cast<double>(tile.value[i]);
        if (gradient) wanted.gradients[to] = Vec3(Vec3f{tile.gradient[0][i], tile.gradient[1][i], tile.gradient[2][i]});
      }
    }
    if (wanted.degrees.empty()) return;
    for (std::size_t i = 0; i < n; ++i) {
      std::size_t most = 0;
      for (std::size_t v = 1; v < count; ++v)
        if (tile.blend[v][i] > tile.blend[most][i]) most = v;
      wanted.degrees[s.at[point(i)]] = static_cast<std::uint8_t>(corners[most].trust > 0 ? corners[most].degree : 1);
    }
  }

  // A point outside is taken to the volume but for half a local length.
  static Vec3 held(const Vec3& x, const VolumePlace& place, std::span<const Vec3> corners, const StarMetric& metric) {
    Vec3 near;
    for (std::size_t v = 0; v < place.corner_count; ++v) near += corners[v] * place.weights[v];
    const Vec3 out = x - near;
    const double length = norm(metric(out));
    if (!std::isfinite(length)) return near;
    return length > 0.5 ? near + out * (0.5 / length) : x;
  }

  std::shared_ptr<const SampledVolume> volume_;
  std::shared_ptr<const VolumeLocator> locator_;
  std::unique_ptr<CornerPolynomials> polynomials_;
};

}  // namespace

std::unique_ptr<VolumeField> make_cell_blend(std::shared_ptr<const SampledVolume> volume,
                                             std::shared_ptr<const VolumeLocator> locator,
                                             std::unique_ptr<CornerPolynomials> polynomials) {
  return std::make_unique<CellBlend>(std::move(volume), std::move(locator), std::move(polynomials));
}

}  // namespace sansmesh
