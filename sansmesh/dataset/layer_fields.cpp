#include "sansmesh/dataset/layer_fields.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/search/ball_tree.h"

namespace sansmesh::inline v1 {
namespace {

/// Borders of materials end with the inner part of the balls, since feet farther out may be undefined.
constexpr double kInner = 0.8;
/// Rays test whether points are in the volume where the field is smaller than this, over the largest radius of a ball.
constexpr double kCutThickness = 0.3;

/// The side of points too far from the surface for the projection. Values are approximate distances of the right sign;
/// gradients are meaningless.
class LayerSide : public ScalarField {
 public:
  explicit LayerSide(Box3 bounds) : bounds_(bounds) {}
  Box3 bounds() const override { return bounds_; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const override {
    parallel_for(0, x.size(), 256, [&](std::size_t i) {
      values[i] = side(x[i]);
      if (!gradients.empty()) gradients[i] = {0, 0, 1};
    });
  }

 private:
  virtual double side(const Vec3& x) const = 0;
  Box3 bounds_;
};

/// For isosurfaces: the side of the nearest sample of the volume.
class ValueSide final : public LayerSide {
 public:
  ValueSide(const SampledVolume& volume, std::span<const double> values, double value, const LocalFrame& frame,
            Box3 bounds)
      : LayerSide(bounds), volume_(volume), frame_(frame), far_(bounds.diagonal()), above_(values.size()) {
    for (std::size_t i = 0; i < values.size(); ++i) above_[i] = values[i] > value;
    if (volume.lattice) return;
    std::vector<Vec3f> positions(volume.size());
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = Vec3f(frame.from_input(volume.positions[i]));
    tree_ = KdTree(positions);
  }

 private:
  double side(const Vec3& x) const override {
    std::size_t nearest = 0;
    if (volume_.lattice) {
      const Lattice& l = *volume_.lattice;
      const Vec3 a = l.to_axes(frame_.to_input(x));
      std::size_t stride = 1;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::vector<double>& axis = l.axes[k];
        auto i = static_cast<std::size_t>(std::lower_bound(axis.begin(), axis.end(), a[k]) - axis.begin());
        if (i == axis.size() || (i > 0 && a[k] - axis[i - 1] < axis[i] - a[k])) --i;
        nearest += i * stride;
        stride *= axis.size();
      }
    } else if (const auto found = tree_.nearest(Vec3f(x))) {
      nearest = found->index;
    }
    return above_[nearest] ? -far_ : far_;
  }

  const SampledVolume& volume_;
  LocalFrame frame_;
  double far_;
  std::vector<std::uint8_t> above_;
  KdTree tree_;  ///< samples that are not on a lattice
};

/// For borders of materials: the side of the tangent plane of the nearest foot.
class PlaneSide final : public LayerSide {
 public:
  PlaneSide(const SurfaceFeet& feet, Box3 bounds) : LayerSide(bounds) {
    std::vector<Vec3f> positions;
    positions.reserve(feet.feet.size());
    normals_.reserve(feet.feet.size());
    for (const FootPoint& foot : feet.feet) {
      positions.push_back(Vec3f(foot.position));
      normals_.push_back(Vec3f(foot.normal));
    }
    tree_ = KdTree(positions);
    positions_ = std::move(positions);
  }

 private:
  double side(const Vec3& x) const override {
    const auto found = tree_.nearest(Vec3f(x));
    return found ? dot(x - Vec3(positions_[found->index]), Vec3(normals_[found->index])) : 1;
  }

  std::vector<Vec3f> positions_, normals_;
  KdTree tree_;
};

/// Only points on the surface are located, and among these only those
/// in balls that extend beyond the volume.
class CutField final : public ScalarField {
 public:
  CutField(std::unique_ptr<const ScalarField> field, const VolumeDomain& volume, const BallUnion& balls)
      : field_(std::move(field)), volume_(volume) {
    std::vector<Vec3> centers(balls.centers.begin(), balls.centers.end());
    std::vector<double> depth(centers.size());
    volume.evaluate(centers, depth);
    std::vector<Vec3f> kept;
    std::vector<float> radii;
    for (std::size_t i = 0; i < centers.size(); ++i) {
      if (depth[i] < -static_cast<double>(balls.radii[i])) continue;
      kept.push_back(balls.centers[i]);
      radii.push_back(balls.radii[i]);
    }
    rim_ = BallTree(kept, radii);
    if (!radii.empty()) thickness_ = kCutThickness * static_cast<double>(*std::max_element(radii.begin(), radii.end()));
  }
  Box3 bounds() const override { return field_->bounds(); }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const override {
    field_->evaluate(x, values, gradients);
  }
  void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                          std::span<std::uint8_t> inside) const override {
    field_->evaluate_in_domain(x, values, gradients, inside);
    if (inside.empty() || rim_.size() == 0) return;
    std::vector<std::uint32_t> asked, touched;
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (inside[i] == 0 || std::abs(values[i]) > thickness_) continue;
      const Vec3f p(x[i]);
      rim_.touching({p, p}, touched);
      if (touched.empty()) continue;
      asked.push_back(static_cast<std::uint32_t>(i));
      points.push_back(x[i]);
    }
    std::vector<std::uint8_t> within(points.size());
    volume_.locate(points, within);
    for (std::size_t k = 0; k < asked.size(); ++k) inside[asked[k]] = within[k];
  }

 private:
  std::unique_ptr<const ScalarField> field_;
  const VolumeDomain& volume_;
  BallTree rim_;  ///< balls that extend beyond the volume
  double thickness_ = 0;
};

}  // namespace

std::unique_ptr<const ScalarField> value_side(const SampledVolume& volume, std::span<const double> values, double value,
                                              const LocalFrame& frame, const Box3& bounds) {
  return std::make_unique<const ValueSide>(volume, values, value, frame, bounds);
}

std::unique_ptr<const ScalarField> plane_side(const SurfaceFeet& feet, const Box3& bounds) {
  return std::make_unique<const PlaneSide>(feet, bounds);
}

std::unique_ptr<const ScalarField> cut_at_volume(std::unique_ptr<const ScalarField> field, const VolumeDomain& volume,
                                                 const BallUnion& balls) {
  return std::make_unique<const CutField>(std::move(field), volume, balls);
}

void LayerDomain::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  volume_.evaluate(x, values, gradients);
  if (!balls_) return;
  parallel_for(0, x.size(), 256, [&](std::size_t i) {
    const auto found = tree_.nearest(Vec3f(x[i]));
    if (!found) return;
    const Vec3 d = x[i] - Vec3(balls_->centers[found->index]);
    const double outside = norm(d) - kInner * static_cast<double>(balls_->radii[found->index]);
    if (outside <= values[i]) return;
    values[i] = outside;
    if (!gradients.empty()) gradients[i] = normalized(d);
  });
}

void LayerDomain::ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const {
  detail::ranges_by_slope(*this, 1, x, radius, found);
}

}  // namespace sansmesh::inline v1
