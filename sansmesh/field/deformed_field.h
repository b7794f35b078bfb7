// A function deformed: seen through a map of space, without resampling (METHODS §7.1).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/field/map_stretch.h"
#include "sansmesh/field/piecewise_field.h"
#include "sansmesh/space_map.h"

namespace sansmesh::inline v1 {

/// f(T(x)) / s(x) for a backward map T: the surface {f = 0} of before the deformation as it is after it. s is the local
/// stretch of T (MapStretch), so that values are roughly lengths again, and never more than f says about the distance.
/// Gradients are those of the quotient, with Jᵀ ∇f. Pieces stay pieces, and creases creases. Where a cut has opened a
/// gap the value is the gap's, as far as that is larger: a solid then ends at the faces of the cut, which are one more
/// piece. Where the map is not defined there is nothing: the value is the size of the field's box.
class DeformedField final : public PiecewiseField {
 public:
  /// `near`: a box about where the deformed field lies (box_before). Throws DataError as box_before where the source's
  /// bounds are finite.
  DeformedField(std::shared_ptr<const ScalarField> source, std::shared_ptr<const SpaceMap> map,
                std::optional<Box3> near = {});

  /// Infinite in all directions where that of the source is in one.
  Box3 bounds() const override { return bounds_; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  /// Where T is defined, and the source is at T(x). Gaps belong to it.
  void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                          std::span<std::uint8_t> inside) const override;
  /// Those of the source in balls as large as the stretch makes them. Taken for granted is that T stretches no more
  /// than a quarter more than at the nodes of the lattice (33 along the longest side) in and beside the ball, that
  /// gaps change no faster than kAssumedSlope, and that no gap lies in a ball whose middle and 14 points about it know
  /// of none. Where the gaps say that a cut may pass the ball, or these points come from farther apart than the stretch
  /// allows, the ranges are those of what comes from all 15, as of cuts that are flat there.
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override;

  std::uint32_t pieces() const override { return source_pieces() + (gaps_ ? 1 : 0); }
  void active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const override;
  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override;
  double thickness() const override;
  void survey(std::span<const Vec3> x, const SurveyReach& reach, std::span<double> values,
              std::span<Surroundings> around) const override;

 private:
  struct Places;
  struct Around;
  std::uint32_t source_pieces() const { return pieces_ ? pieces_->pieces() : 1; }
  Places places(std::span<const Vec3> x, bool jacobians) const;
  Around look_around(std::span<const Vec3> x, double radius, const Places& places,
                     std::span<const MapStretch::Range> stretch) const;
  /// From the source's answers to the quotient, and the gap where that is larger.
  void finish(const Places& places, std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
              bool with_gaps) const;

  std::shared_ptr<const ScalarField> source_;
  const PiecewiseField* pieces_;  // the same, if it is one
  std::shared_ptr<const SpaceMap> map_;
  bool gaps_;
  Box3 bounds_;
  MapStretch stretch_;
  double nothing_;  // value where there is nothing
};

}  // namespace sansmesh::inline v1
