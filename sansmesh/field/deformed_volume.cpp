#include "sansmesh/field/deformed_volume.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kVolumeGrain = 4096;
constexpr std::size_t kTogether = 4096;  // points mapped before the source is evaluated: their data stays in cache

}  // namespace

DeformedVolume::DeformedVolume(std::shared_ptr<const VolumeField> source, std::shared_ptr<const SpaceMap> map,
                               std::optional<Box3> near, std::optional<Box3> bounds)
    : source_(std::move(source)),
      map_(std::move(map)),
      gaps_(map_->has_gaps()),
      bounds_(bounds ? *bounds : preimage_box(*map_, source_->bounds(), near)),
      stretch_(*map_, bounds_) {}

void DeformedVolume::evaluate(std::span<const Vec3> all, const VolumeFieldValues& wanted) const {
  const std::size_t c = components();
  parallel_ranges(0, all.size(), kTogether, [&](std::size_t first, std::size_t last) {
    const std::size_t n = last - first;
    const auto part = [&](auto span, std::size_t each) {
      return span.empty() ? span : span.subspan(first * each, n * each);
    };
    const VolumeFieldValues now{part(wanted.values, c), part(wanted.gradients, c), part(wanted.inside, 1)};
    std::vector<Vec3> source(n);
    std::vector<Jacobian> jacobians(now.gradients.empty() ? 0 : n);
    std::vector<double> gaps(gaps_ && !now.inside.empty() ? n : 0);
    map_->map(all.subspan(first, n), {source, jacobians, gaps, {}});
    source_->evaluate(source, now);  // zero for positions that are not finite
    for (std::size_t i = 0; i < n; ++i) {
      if (!now.inside.empty() && (!is_finite(source[i]) || (!gaps.empty() && gaps[i] > 0))) now.inside[i] = 0;
      if (now.gradients.empty()) continue;
      const Jacobian& j = jacobians[i];
      for (std::size_t k = 0; k < c; ++k) {
        Vec3& g = now.gradients[i * c + k];
        g = is_finite(source[i]) ? Vec3{dot(j[0], g), dot(j[1], g), dot(j[2], g)} : Vec3{};
      }
    }
  });
}

void DeformedVolume::spacing(std::span<const Vec3> x, std::span<double> found) const {
  std::vector<Vec3> source(x.size());
  map_->map(x, {source, {}, {}, {}});
  const Vec3 middle = source_->bounds().center();
  for (Vec3& u : source)
    if (!is_finite(u)) u = middle;
  source_->spacing(source, found);
  parallel_for(0, x.size(), kVolumeGrain, [&](std::size_t i) { found[i] /= stretch_.at(x[i]); });
}

void DeformedVolume::ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const {
  std::vector<Box3> images(boxes.size());
  map_->images(boxes, images);
  // Outside its box the source takes values of points inside.
  const Box3 all = source_->bounds();
  for (Box3& b : images) {
    if (b.empty()) b = all;
    for (std::size_t k = 0; k < 3; ++k) {
      b.lower[k] = std::isfinite(b.lower[k]) ? b.lower[k] : std::min(all.lower[k], b.upper[k]);
      b.upper[k] = std::isfinite(b.upper[k]) ? b.upper[k] : std::max(all.upper[k], b.lower[k]);
    }
  }
  source_->ranges(images, found);
}

}  // namespace sansmesh::inline v1
