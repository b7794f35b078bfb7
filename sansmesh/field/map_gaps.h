// Scalar field that is positive inside the gaps that cuts open in a deformed space.
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <utility>

#include "sansmesh/scalar_field.h"
#include "sansmesh/space_map.h"

namespace sansmesh::inline v1 {

/// MappedPoints::gaps in a box; far from all gaps it is minus the box's diagonal, with zero gradient.
class MapGaps final : public ScalarField {
 public:
  MapGaps(std::shared_ptr<const SpaceMap> map, const Box3& box) : map_(std::move(map)), box_(box) {}

  Box3 bounds() const override { return box_; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override {
    map_->map(x, {{}, {}, values, gradients});
    for (double& v : values) v = std::max(v, -box_.diagonal());
  }

 private:
  std::shared_ptr<const SpaceMap> map_;
  Box3 box_;
};

}  // namespace sansmesh::inline v1
