// Projection operators that move points onto a surface: an alternative to zero sets of fields.
#pragma once

#include <cstdint>
#include <span>

#include "sansmesh/box.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Projected point, and the surface around it: its height along `normal` over the tangent plane at `position` is ½ (xx
/// u² + 2 xy u v + yy v²), where (u, v) are coordinates along the vectors t, b of tangent_frame(normal, t, b). xx, xy,
/// yy: curvatures (1 / length), positive where the surface curves towards the normal.
struct FootPoint {
  Vec3 position;
  Vec3 normal;  ///< outward unit normal
  double xx = 0, xy = 0, yy = 0;
  bool defined = false;  ///< false if too far from the samples; then position is the given point and the rest is zero
};

/// The surface is the set of fixed points (tejada2008, 4.2). Distributes large batches over threads, as ScalarField
/// does.
class Projection {
 public:
  virtual ~Projection() = default;

  /// Box that contains the domain of the operator.
  virtual Box3 bounds() const = 0;

  /// Applies the operator once to each of x. Evaluation is fastest if neighbouring points are adjacent. Sizes must
  /// agree. Thread-safe.
  virtual void project(std::span<const Vec3> x, std::span<FootPoint> feet) const = 0;
};

/// Applies the operator until a step is shorter than `tolerance` (length), at most `steps` times: the results are on
/// the surface within the tolerance. Points that leave the domain become undefined.
void project_to_fixed_point(const Projection& projection, std::span<const Vec3> x, double tolerance, int steps,
                            std::span<FootPoint> feet);

/// Signed distance to the foot point, ⟨x − p(x), n(x)⟩, with gradient n: polygonisers and ray casters use a projection
/// as a field. Undefined points are outside the domain; they have the values of another field, or the diagonal of the
/// box.
class ProjectionField : public ScalarField {
 public:
  /// `projection` and `beyond` must outlive this object.
  explicit ProjectionField(const Projection& projection, const ScalarField* beyond = nullptr)
      : projection_(projection), beyond_(beyond) {}
  Box3 bounds() const override { return projection_.bounds(); }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                          std::span<std::uint8_t> inside) const override;

 private:
  const Projection& projection_;
  const ScalarField* beyond_;
};

}  // namespace sansmesh::inline v1
