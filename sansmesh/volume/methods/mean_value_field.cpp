// Mean value coordinates in the cell around a point (floater2005, ju2005).
#include <algorithm>
#include <array>
#include <utility>

#include "sansmesh/volume/cells/axis_interval.h"
#include "sansmesh/volume/cells/cell_corners.h"
#include "sansmesh/volume/cells/cell_tetrahedra.h"
#include "sansmesh/volume/cells/mean_value.h"
#include "sansmesh/volume/grid/corner_volume.h"
#include "sansmesh/volume/methods/pointwise_field.h"
#include "sansmesh/volume/reconstruction_input.h"
#include "sansmesh/volume/volume_method.h"

namespace sansmesh::inline v1 {
namespace detail {
namespace {

/// f(x) = Σ λ_c(x) f_c over the corners of the cell around x, convex or not. Quadrilateral faces are split into two
/// triangles, which also decide which cell contains x. In tetrahedra it is linear interpolation. Cell data are
/// converted to corner values (corner_volume.h).
class MeanValueField final : public WeightedField {
 public:
  /// `cut`: the cells as tetrahedra; not needed for a lattice.
  MeanValueField(CornerSamples corners, const TetrahedralVolume& cut)
      : WeightedField(cut.volume ? cut.volume : corners.volume, std::move(corners.values)),
        cells_(std::move(corners.volume)),
        cell_of_(cut.cell_of) {}

 protected:
  void weights(const Vec3& x, const CellLocation& location, bool slopes,
               std::vector<SampleWeight>& out) const override {
    static thread_local std::vector<std::array<std::uint8_t, 3>> triangles;
    triangles.clear();
    out.clear();
    std::array<Vec3, 8> corners, gradients{};
    std::array<double, 8> found;
    if (cells_->lattice) {
      const Lattice& lattice = *cells_->lattice;
      Vec3 a = lattice.to_axes(x);
      std::array<std::size_t, 3> at;
      for (std::size_t k = 0; k < 3; ++k) {
        a[k] = std::clamp(a[k], lattice.axes[k].front(), lattice.axes[k].back());
        at[k] = interval_of(lattice.axes[k], lattice.uniform, a[k]);
      }
      constexpr std::array<std::array<std::size_t, 3>, 8> kRing{
          {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
      const std::array<std::uint32_t, 8> samples =
          corners_of_lattice_cell(lattice, at[0] + lattice.axes[0].size() * (at[1] + lattice.axes[1].size() * at[2]));
      for (std::size_t c = 0; c < 8; ++c) {
        const auto& [i, j, k] = kRing[c];
        corners[c] = {lattice.axes[0][at[0] + i], lattice.axes[1][at[1] + j], lattice.axes[2][at[2] + k]};
      }
      // On the unmirrored axes.
      face_triangles(CellShape::hexahedron, samples, triangles);
      mean_value_weights(corners, triangles, a, found, slopes ? std::span<Vec3>(gradients) : std::span<Vec3>());
      for (std::size_t c = 0; c < 8; ++c) {
        const Vec3 g = gradients[c];
        out.push_back({samples[c], found[c],
                       lattice.directions[0] * g.x + lattice.directions[1] * g.y + lattice.directions[2] * g.z});
      }
      return;
    }
    if (cell_of_.empty() || cells_->cells.shapes[cell_of_[location.cell]] == CellShape::tetrahedron) {
      std::array<Vec3, 8> linear{};
      if (slopes) shape_gradients(volume(), location, x, linear);
      for (std::size_t c = 0; c < location.corner_count; ++c)
        out.push_back({location.corners[c], location.weights[c], linear[c]});
      return;
    }
    const std::uint32_t cell = cell_of_[location.cell];
    const auto samples = cells_->cells[cell];
    for (std::size_t c = 0; c < samples.size(); ++c) corners[c] = cells_->positions[samples[c]];
    face_triangles(cells_->cells.shapes[cell], samples, triangles);
    mean_value_weights({corners.data(), samples.size()}, triangles, x, {found.data(), samples.size()},
                       slopes ? std::span<Vec3>(gradients.data(), samples.size()) : std::span<Vec3>());
    for (std::size_t c = 0; c < samples.size(); ++c) out.push_back({samples[c], found[c], gradients[c]});
  }

 private:
  std::shared_ptr<const SampledVolume> cells_;
  std::vector<std::uint32_t> cell_of_;  // per tetrahedron of volume()
};

}  // namespace

}  // namespace detail

static std::unique_ptr<VolumeField> make_mean_value_field(ReconstructionInput input) {
  detail::CornerSamples corners = detail::corner_samples(std::move(input.volume), std::move(input.values));
  const detail::TetrahedralVolume cut =
      corners.volume->lattice ? detail::TetrahedralVolume{} : detail::tetrahedra_of(corners.volume);
  return std::make_unique<detail::MeanValueField>(std::move(corners), cut);
}

namespace {

constexpr VolumeMethod kMeanValueMethods[] = {{.name = "mean-value",
                                               .summary = "mean value coordinates in the cell, convex or not",
                                               .grids = "all",
                                               .make = make_mean_value_field}};

}  // namespace

std::span<const VolumeMethod> mean_value_field_methods() { return kMeanValueMethods; }

}  // namespace sansmesh::inline v1
