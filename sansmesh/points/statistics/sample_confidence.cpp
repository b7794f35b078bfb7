#include "sansmesh/points/statistics/sample_confidence.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sansmesh/core/diverging_color.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/points/statistics/spacing.h"

namespace sansmesh::inline v1 {
namespace {

/// Factor of the noise within which samples are near, and further spacings until they are out of reach.
constexpr double kUsualNoises = 3, kOutOfReach = 2;

}  // namespace

SampleConfidence::SampleConfidence(const PointSet& samples, double spacing, double noise)
    : tree_(samples.positions), positions_(samples.positions), spacing_(spacing), noise_(noise) {
  if (tree_.size() == 0) throw DataError("confidence needs samples");
}

double SampleConfidence::reach_spacing(std::uint32_t sample) const {
  std::array<Neighbour, kLocalNeighbours + 1> found;
  const std::size_t n = tree_.nearest(positions_[sample], found);
  return local_spacing(static_cast<double>(found[n - 1].squared_distance), spacing_);
}

void SampleConfidence::evaluate(std::span<const Vec3f> x, std::span<float> distances,
                                std::span<float> confidences) const {
  parallel_for(0, x.size(), 512, [&](std::size_t i) {
    const auto nearest = tree_.nearest(x[i]);
    const double d = nearest ? std::sqrt(static_cast<double>(nearest->squared_distance)) : 0;
    distances[i] = static_cast<float>(d);
    confidences[i] = nearest ? 1 : 0;
    // Close enough for confidence 1 at any local spacing.
    if (!nearest || d <= std::max(kLeastLocal * spacing_, kUsualNoises * noise_)) return;
    const double s = reach_spacing(nearest->index), usual = std::max(s, kUsualNoises * noise_);
    confidences[i] = static_cast<float>(std::clamp(1 - (d - usual) / (kOutOfReach * s), 0.0, 1.0));
  });
}

Vec3f confidence_color(float confidence) { return diverging_color(1 - confidence); }

void ConfidenceColors::evaluate(std::span<const Vec3> x, std::span<Vec3f> colors) const {
  const std::vector<Vec3f> at(x.begin(), x.end());
  std::vector<float> distance(at.size()), confidence(at.size());
  confidence_.evaluate(at, distance, confidence);
  for (std::size_t i = 0; i < at.size(); ++i) colors[i] = confidence_color(confidence[i]);
}

}  // namespace sansmesh::inline v1
