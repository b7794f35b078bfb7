// Local inverse squared distance weighting (shepard1968, franke1980; tejada2008, 3.2).
#include <algorithm>
#include <cmath>
#include <utility>

#include "sansmesh/volume/methods/pointwise_field.h"
#include "sansmesh/volume/reconstruction_input.h"
#include "sansmesh/volume/samples/sample_supports.h"
#include "sansmesh/volume/volume_method.h"

namespace sansmesh::inline v1 {
namespace detail {
namespace {

constexpr double kFillWeight = 1e-8;
constexpr double kAtSample = 1e-7;  ///< in units of the support

/// f(x) = Σ w_i f_i / Σ w_i, w_i = ((R − t_i)₊ / (R t_i))² with the distances t_i of SampleSupports
/// (docs/methods/volume-baselines.md). `radius` R in spacings, 1..10; at least √3 is needed to cover the cells around a
/// sample, and smaller values count as √3. Linear interpolation in the cell fills gaps of the supports: it is part of
/// the sum everywhere, with the weight 1e-8.
class ShepardField final : public WeightedField {
 public:
  ShepardField(std::shared_ptr<const SampledVolume> sampled, VolumeValues values, double reach)
      : WeightedField(std::move(sampled), std::move(values)), supports_(volume(), reach) {}

 protected:
  void weights(const Vec3& x, const CellLocation& location, bool /*slopes*/,
               std::vector<SampleWeight>& out) const override {
    static thread_local std::vector<SampleSupports::Cover> covers;
    supports_.covering(x, covers);
    out.clear();
    double sum = 0;
    Vec3 slope;
    for (const auto& cover : covers) {
      if (cover.squared < kAtSample * kAtSample) {
        out.assign(1, {cover.sample, 1, {}});
        return;
      }
      // w = (1/t − 1/R)², its gradient −2 (1/t − 1/R) / t³ times half the gradient of t².
      const double over = 1 / std::sqrt(cover.squared), root = over - 1 / supports_.reach();
      out.push_back({cover.sample, root * root, cover.slope * (-2 * root * over * over * over)});
      sum += out.back().weight;
      slope += out.back().slope;
    }
    if (!volume().lattice && volume().cell_sample.empty()) {  // supports of the others cover their own cells
      std::array<Vec3, 8> gradients{};
      shape_gradients(volume(), location, x, gradients);
      for (std::size_t c = 0; c < location.corner_count; ++c) {
        out.push_back({location.corners[c], kFillWeight * location.weights[c], gradients[c] * kFillWeight});
        sum += out.back().weight;
        slope += out.back().slope;
      }
    }
    if (!(sum > 0)) return out.assign(1, {nearest(location), 1, {}});
    for (SampleWeight& w : out) {
      w.weight /= sum;
      w.slope = (w.slope - slope * w.weight) / sum;
    }
  }

 private:
  std::uint32_t nearest(const CellLocation& location) const {
    return volume().cell_sample.empty() ? 0 : volume().cell_sample[location.cell];
  }

  SampleSupports supports_;
};

}  // namespace

}  // namespace detail

static std::unique_ptr<VolumeField> make_shepard_field(ReconstructionInput input) {
  constexpr double kRadius = 2;
  const double radius = input.report.options.radius.emplace(input.options.radius.value_or(kRadius));
  return std::make_unique<detail::ShepardField>(std::move(input.volume), std::move(input.values),
                                                detail::reach_of_radius(radius));
}

namespace {

constexpr std::string_view kShepardUses[] = {"radius"};
constexpr VolumeMethod kShepardMethods[] = {{.name = "shepard",
                                             .summary = "inverse squared distances of the samples around",
                                             .grids = "all",
                                             .make = make_shepard_field,
                                             .uses = kShepardUses}};

}  // namespace

std::span<const VolumeMethod> shepard_field_methods() { return kShepardMethods; }

}  // namespace sansmesh::inline v1
