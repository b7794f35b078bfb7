// Normal field that reproduces the creases in the samples' normals (tejada2008, 4.3.2).
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "sansmesh/field/normal_field.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/surface/surface_samples.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct BilateralOptions {
  /// σ: samples farther than this from the tangent plane at the point have low weight (length); default: a third of the
  /// local spacing, plus the noise.
  std::optional<double> height = {};
  /// Width of the radial weights over the local spacing, 0.5..20; default: 1.2, more with noise.
  std::optional<double> smoothing = {};
  /// Samples whose normals differ from that at the point by more than this have low weight (length of the difference of
  /// unit vectors, 0.4: 23°). An addition to the source: next to an edge the heights alone leave a tilt.
  double turn = 0.4;
  int iterations = 4;  ///< 0..20
  SharpFormula formula = SharpFormula::bilateral;
  double epsilon = 1;                                ///< laguerre only: ε, 0.05..20
  std::optional<double> bandwidth = {};              ///< h as one length, replaces `smoothing`
  SurfaceWeights weights = SurfaceWeights::compact;  ///< bilateral only: radial weights
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// n⁽ᵏ⁺¹⁾(x) = normalise Σ n_i φ_i(x) exp(−⟨n⁽ᵏ⁾(x), x_i − x⟩² / (2σ²)) exp(−‖n⁽ᵏ⁾(x) − n_i‖² / (2τ²)). Samples on the
/// tangent plane dominate, so that next to an edge those of the other side lose influence. Valid on or next to the
/// surface only; the samples' own normals should be robust (denoise_normals).
class BilateralNormals : public NormalField {
 public:
  /// Throws ArgumentError for invalid options.
  BilateralNormals(const SurfaceSamples& samples, const BilateralOptions& options);

  void refine(std::span<const Vec3> x, std::span<Vec3> normals) const override { refine(x, normals, {}); }
  /// `heights`, if not empty: heights of x over the weighted mean of the tangent planes of the contributing samples
  /// (length; oztireli2009); 0 where no sample is near or iterations = 0.
  void refine(std::span<const Vec3> x, std::span<Vec3> normals, std::span<double> heights) const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

/// Heights over the planes of each face as values, refined normals as gradients. Moves points next to the surface of
/// another field, such as vertices of its mesh, back to the faces that the field rounds off. The heights continue
/// beyond the edges of faces: not suitable for ray casting or polygonisation.
class FaceField : public ScalarField {
 public:
  /// Both must outlive the field. Where no sample is near, values are those of `field`.
  FaceField(const ScalarField& field, const BilateralNormals& normals) : field_(field), normals_(normals) {}
  Box3 bounds() const override { return field_.bounds(); }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;

 private:
  const ScalarField& field_;
  const BilateralNormals& normals_;
};

}  // namespace sansmesh::inline v1
