// Field deformed by a map of space, without resampling (tejada2008, 6.4; docs/methods/deformation.md).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "sansmesh/field/map_stretch.h"
#include "sansmesh/field/piecewise_field.h"
#include "sansmesh/space_map.h"

namespace sansmesh::inline v1 {

/// f(T(x)) / s(x) for a backward map T: the deformed surface {f = 0}. s is the local stretch of T (MapStretch), so that
/// values approximate lengths and never exceed the distance bound of f. Gradients are those of the quotient, with Jᵀ
/// ∇f. Pieces and creases are preserved. Inside a gap opened by a cut the value is the maximum of this and the gap
/// value, so that a solid ends at the faces of the cut, which form one more piece. Where the map is undefined, the
/// value is the size of the field's box.
class DeformedField final : public PiecewiseField {
 public:
  /// `near`: an approximate box of the deformed field (preimage_box). Throws DataError as preimage_box, if the source's
  /// bounds are finite.
  DeformedField(std::shared_ptr<const ScalarField> source, std::shared_ptr<const SpaceMap> map,
                std::optional<Box3> near = {});

  /// Infinite in all directions if the source's box is infinite in one.
  Box3 bounds() const override { return bounds_; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  /// Inside where T is defined and the source is defined at T(x). Gaps count as inside.
  void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                          std::span<std::uint8_t> inside) const override;
  /// Ranges of the source in balls scaled by the stretch. Assumptions: in and around the ball, T stretches at most a
  /// quarter more than at the nodes of the lattice (33 along the longest side); gaps change no faster than
  /// kAssumedSlope; and a ball contains no gap if none is found at its centre and 14 points around it. If a cut may
  /// pass through the ball, or these points have sources farther apart than the stretch allows, the ranges cover the
  /// sources of all 15 points, which is exact for locally flat cuts.
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override;

  std::uint32_t pieces() const override { return source_pieces() + (gaps_ ? 1 : 0); }
  void active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const override;
  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override;
  double thickness() const override;
  void survey(std::span<const Vec3> x, const SurveyReach& reach, std::span<double> values,
              std::span<Surroundings> around) const override;

 private:
  struct Sources;
  struct Around;
  std::uint32_t source_pieces() const { return pieces_ ? pieces_->pieces() : 1; }
  Sources sources(std::span<const Vec3> x, bool jacobians) const;
  Around look_around(std::span<const Vec3> x, double radius, const Sources& sources,
                     std::span<const MapStretch::Range> stretch) const;
  /// Computes the quotient from the source's results, and the maximum with the gap value.
  void finish(const Sources& sources, std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
              bool with_gaps) const;

  std::shared_ptr<const ScalarField> source_;
  const PiecewiseField* pieces_;  // the source, if it is piecewise
  std::shared_ptr<const SpaceMap> map_;
  bool gaps_;
  Box3 bounds_;
  MapStretch stretch_;
  double nothing_;  // value where the map is undefined
};

}  // namespace sansmesh::inline v1
