// Options of surfaces of samples that are never meshed.
#pragma once

#include <optional>
#include <string>

#include "sansmesh/option.h"
#include "sansmesh/surface/bilateral_normals.h"
#include "sansmesh/surface/implicit_surface.h"
#include "sansmesh/surface/projection_surface.h"

namespace sansmesh::inline v1 {

/// All optional values follow from the data where absent. Lengths are in the unit of the input. A method uses some of
/// them only (SurfaceMethod::uses).
struct SurfaceOptions {
  using Normal = ImplicitOptions::Normal;
  using Plane = ProjectionOptions::Plane;
  using Polynomial = ProjectionOptions::Polynomial;
  using Flow = ProjectionOptions::Flow;
  using Diffusion = ProjectionOptions::Diffusion;
  using SharpFormula = BilateralOptions::Formula;
  std::string method = "apss";             ///< a name of SurfaceMethod::registry()
  std::optional<SharpFormula> sharp = {};  ///< normals turn sharply at edges and corners, by these weights
  std::optional<double> smoothing = {};    ///< width of the weights over the local spacing, 0.5..20
  std::optional<double> bandwidth = {};    ///< the same as one length for the whole cloud
  SurfaceWeights weights = SurfaceWeights::compact;
  std::optional<int> order = {};            ///< of the approximation: 2, 4 or 6
  std::optional<int> iterations = {};       ///< of the approximation, 0..100: 0 smooths most
  std::optional<double> epsilon = {};       ///< shape parameter of the approximation, 0.05..20
  Normal normal = Normal::standard;         ///< of mean planes, or beside the gradient
  Plane reference_plane = Plane::iterated;  ///< under the polynomials
  Polynomial polynomial = Polynomial::quadratic;
  Flow flow = Flow::fit;                           ///< how points get onto the surface
  Diffusion diffusion = Diffusion::none;           ///< whether samples off the surface count less
  std::optional<double> diffusion_threshold = {};  ///< of diffusion: λ over the inverse of the width, > 0; default 1
  std::optional<int> tau = {};                     ///< exponent of the M-like weights, 1..3; default 2
  bool separate_sheets = true;                     ///< samples that look the other way than those nearby do not count
  std::optional<double> error = {};  ///< accepted distance of samples from the shape of their cell (length)
  std::optional<int> depth = {};     ///< deepest level of the octree, 2..14
  bool smooth = false;               ///< no edges and corners

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field: for values out of range, and for those that mean nothing to the method.
  void validate() const;
};

}  // namespace sansmesh::inline v1
