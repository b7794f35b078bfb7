// A volume reconstruction: the mean of all samples everywhere.
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "sansmesh/volume/reconstruction_input.h"
#include "sansmesh/volume/volume_method.h"

namespace sansmesh::inline v1 {
namespace {

class MeanField : public VolumeField {
 public:
  MeanField(std::shared_ptr<const SampledVolume> volume, const VolumeValues& samples)
      : volume_(std::move(volume)), box_(volume_->bounds()), means_(samples.components) {
    const std::size_t n = means_.size(), rows = samples.values.size() / n;
    for (std::size_t i = 0; i < rows; ++i)
      for (std::size_t k = 0; k < n; ++k) means_[k] += samples.values[i * n + k] / static_cast<double>(rows);
  }

  Box3 bounds() const override { return box_; }
  std::size_t components() const override { return means_.size(); }
  void evaluate(std::span<const Vec3> x, const VolumeFieldValues& found) const override {
    const std::size_t n = means_.size();
    for (std::size_t i = 0; i < x.size(); ++i) {
      const bool inside = box_.contains(x[i]);
      for (std::size_t k = 0; k < n && !found.values.empty(); ++k) found.values[i * n + k] = means_[k];
      if (!found.inside.empty()) found.inside[i] = inside;
    }
    std::fill(found.gradients.begin(), found.gradients.end(), Vec3{});
  }
  void spacing(std::span<const Vec3> x, std::span<double> found) const override {
    std::fill_n(found.begin(), x.size(), box_.diagonal() / 100);
  }

 private:
  std::shared_ptr<const SampledVolume> volume_;
  Box3 box_;
  std::vector<double> means_;
};

std::unique_ptr<VolumeField> make_mean(ReconstructionInput input) {
  return std::make_unique<MeanField>(std::move(input.volume), input.values);
}

const Registered<VolumeMethod> mean(
    {.name = "mean", .summary = "the mean of all samples", .grids = "all", .make = make_mean});

}  // namespace
}  // namespace sansmesh::inline v1
