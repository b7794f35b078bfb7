#include "sansmesh/volume/detail_field.h"

#include <utility>

#include "sansmesh/volume/cell_blend.h"
#include "sansmesh/volume/local_polynomials.h"

namespace sansmesh {
namespace {

class StoredCornerPolynomials final : public CornerPolynomials {
 public:
  StoredCornerPolynomials(LocalPolynomials polynomials, VolumeValues values)
      : polynomials_(std::move(polynomials)), values_(std::move(values)) {}

  std::size_t components() const override { return polynomials_.components; }
  double corners(std::span<const std::uint32_t> samples, std::size_t component, Memory* /*memory*/,
                 std::span<detail::CellCorner> out) const override {
    const std::size_t c = polynomials_.components;
    const double base = values_.values[samples[0] * c + component];
    for (std::size_t v = 0; v < samples.size(); ++v) {
      const std::size_t i = samples[v];
      detail::CellCorner& corner = out[v];
      corner.metric = polynomials_.metrics[i];
      corner.coefficients = polynomials_.of(i, component).data();
      corner.degree = polynomials_.degrees[i];
      corner.constant = static_cast<float>(polynomials_.constants[i * c + component] - base);
      corner.value = static_cast<float>(values_.values[i * c + component] - base);
      corner.trust = polynomials_.trust[i];
    }
    return base;
  }

 private:
  LocalPolynomials polynomials_;
  VolumeValues values_;
};

}  // namespace

std::unique_ptr<VolumeField> make_detail_field(std::shared_ptr<const SampledVolume> volume,
                                               std::shared_ptr<const VolumeLocator> locator, VolumeValues values,
                                               const ReconstructionOptions& options, Progress& progress,
                                               ReconstructionReport* report) {
  LocalPolynomialOptions local;
  local.fit.max_degree = options.degree.value_or(3);
  local.fit.robust = options.robust.value_or(true);
  LocalPolynomials polynomials = fit_local_polynomials(*volume, values, local, progress);
  if (report != nullptr) {
    report->options = options;
    report->by_degree.assign(LocalPolynomials::kMaxDegree + 1, 0);
    for (const std::uint8_t d : polynomials.degrees) ++report->by_degree[d];
  }
  return make_cell_blend(std::move(volume), std::move(locator),
                         std::make_unique<StoredCornerPolynomials>(std::move(polynomials), std::move(values)));
}

}  // namespace sansmesh
