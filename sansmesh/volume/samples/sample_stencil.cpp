#include "sansmesh/volume/samples/sample_stencil.h"

#include <algorithm>
#include <utility>

namespace sansmesh::inline v1 {

void SampleStencil::gather(std::uint32_t sample, const StarMetric& metric, std::size_t enough, std::size_t most,
                           int max_rings) {
  seen_.clear();
  samples_.assign(1, sample);
  seen_.insert(sample);
  const Vec3 center = volume_.positions[sample];
  std::size_t first = 0;
  for (rings_ = 0; rings_ < max_rings && samples_.size() < enough && first < samples_.size(); ++rings_) {
    const std::size_t last = samples_.size();
    for (std::size_t i = first; i < last; ++i)
      for (const std::uint32_t j : volume_.stars[samples_[i]])
        if (seen_.insert(j)) samples_.push_back(j);
    first = last;
    if (samples_.size() <= most) continue;
    ring_.clear();
    for (std::size_t i = last; i < samples_.size(); ++i)
      ring_.emplace_back(squared_norm(metric(volume_.positions[samples_[i]] - center)), samples_[i]);
    const auto keep = static_cast<std::ptrdiff_t>(most > last ? most - last : 0);
    std::nth_element(ring_.begin(), ring_.begin() + keep, ring_.end());
    samples_.resize(last + static_cast<std::size_t>(keep));
    for (std::size_t i = last; i < samples_.size(); ++i) samples_[i] = ring_[i - last].second;
    std::sort(samples_.begin() + static_cast<std::ptrdiff_t>(last), samples_.end());
  }
  local_.clear();
  for (const std::uint32_t j : samples_) local_.push_back(metric(volume_.positions[j] - center));
}

}  // namespace sansmesh::inline v1
