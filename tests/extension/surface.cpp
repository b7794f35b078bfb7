// A surface of a new family: mean of the tangent planes of the nearest samples (shepard1968).
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/model/own_option.h"
#include "sansmesh/model/surface_method.h"
#include "sansmesh/surface_options.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kMostNeighbours = 50;
constexpr OwnOption<"shepard_neighbours", 10> kNeighbours({.text = "Nearest samples whose planes count",
                                                           .range = {3, kMostNeighbours}});
/// Least squared distance, since a sample may coincide with the query point.
constexpr double kLeastSquare = 1e-12;

class ShepardPlanes : public ScalarField {
 public:
  ShepardPlanes(std::shared_ptr<const SurfaceSamples> samples, int neighbours)
      : samples_(std::move(samples)), neighbours_(static_cast<std::size_t>(neighbours)) {}

  Box3 bounds() const override {
    Box3 box;
    for (const Vec3f& p : samples_->positions) box.extend(Vec3(p));
    const double margin = 4 * samples_->median_spacing;
    return {box.lower - Vec3{margin, margin, margin}, box.upper + Vec3{margin, margin, margin}};
  }

  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const override {
    parallel_for(0, x.size(), 256, [&](std::size_t i) {
      std::array<Neighbour, kMostNeighbours> near;
      const std::size_t n = samples_->tree.nearest(Vec3f(x[i]), std::span(near).first(neighbours_));
      double weights = 0, value = 0;
      Vec3 normal;
      for (std::size_t k = 0; k < n; ++k) {
        const double w = 1 / std::max(static_cast<double>(near[k].squared_distance), kLeastSquare);
        const Vec3 own(samples_->normals[near[k].index]);
        weights += w, value += w * dot(own, x[i] - Vec3(samples_->positions[near[k].index])), normal += own * w;
      }
      values[i] = value / weights;
      if (!gradients.empty()) gradients[i] = normal / weights;
    });
  }

 private:
  std::shared_ptr<const SurfaceSamples> samples_;
  std::size_t neighbours_;
};

SurfaceParts make_shepard(PreparedCloud& cloud, const SurfaceOptions& options, Progress& progress) {
  const auto samples = std::make_shared<const SurfaceSamples>(prepare_samples(cloud.points, progress, cloud.noise));
  SurfaceParts parts;
  parts.field = std::make_shared<const ShepardPlanes>(samples, kNeighbours.of(options));
  parts.samples = samples;
  parts.spacings = samples->spacing;
  parts.support.centers = samples->positions;
  for (const float s : samples->spacing) parts.support.radii.push_back(static_cast<float>(default_reach(*samples)) * s);
  parts.spacing = samples->median_spacing, parts.noise = samples->noise;
  return parts;
}

constexpr std::string_view kUses[] = {"sharp"};
constexpr OptionRow kOwn[] = {kNeighbours};

const Registered<SurfaceMethod> shepard({.name = "shepard",
                                         .summary = "tangent planes of the nearest samples, weighted by their distance",
                                         .page = "implicit-surfaces.md",
                                         .make = make_shepard,
                                         .uses = kUses,
                                         .own = kOwn});

}  // namespace
}  // namespace sansmesh::inline v1
