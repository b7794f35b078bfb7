// From samples to a surface that is never meshed, by name: what pictures are taken of, points are projected onto and,
// where a mesh is wanted after all, it is cut out of.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/core/progress.h"
#include "sansmesh/data/placement.h"
#include "sansmesh/data/point_set.h"
#include "sansmesh/field/ball_union.h"
#include "sansmesh/field/color_field.h"
#include "sansmesh/field/normal_field.h"
#include "sansmesh/field/projection.h"
#include "sansmesh/field/scalar_field.h"
#include "sansmesh/function/surface_function.h"
#include "sansmesh/model/surface_methods.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/surface/bilateral_normals.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh {

/// All optional values follow from the data where absent. Lengths are in the unit of the input. Which of them mean
/// something to a method is in the table of surface_methods.h.
struct SurfaceOptions {
  using Normal = ImplicitOptions::Normal;
  using Plane = ProjectionOptions::Plane;
  using Polynomial = ProjectionOptions::Polynomial;
  using Flow = ProjectionOptions::Flow;
  using Diffusion = ProjectionOptions::Diffusion;
  using SharpFormula = BilateralOptions::Formula;
  SurfaceMethod method = SurfaceMethod::apss;
  std::optional<double> smoothing = {};  ///< width of the weights over the local spacing, 0.5..20
  std::optional<double> bandwidth = {};  ///< the same as one length for the whole cloud
  SurfaceWeights weights = SurfaceWeights::compact;
  std::optional<int> order = {};       ///< of the approximation: 2, 4 or 6
  std::optional<int> iterations = {};  ///< of the approximation, 0..100: 0 smooths most
  std::optional<double> epsilon = {};  ///< shape parameter of the approximation, 0.05..20
  Normal normal = Normal::standard;    ///< of mean planes, or beside the gradient
  Plane plane = Plane::iterated;       ///< under the polynomials
  Polynomial polynomial = Polynomial::quadratic;
  Flow flow = Flow::fit;                  ///< how points get onto the surface
  Diffusion diffusion = Diffusion::none;  ///< whether samples off the surface count less
  std::optional<double> threshold = {};   ///< of diffusion: λ over the inverse of the width, > 0; default 1
  std::optional<int> tau = {};            ///< exponent of the M-like weights, 1..3; default 2
  bool separate_sheets = true;            ///< samples that look the other way than those nearby do not count
  bool sharp = false;                     ///< normals turn sharply at edges and corners
  SharpFormula sharp_formula = SharpFormula::bilateral;
  std::optional<double> error = {};   ///< accepted distance of samples from the shape of their cell (length)
  std::optional<int> max_depth = {};  ///< deepest level of the octree, 2..14
  bool smooth = false;                ///< no edges and corners

  /// Whether an option is other than it is by itself.
  bool is_set(SurfaceOption option) const;
  /// Throws ArgumentError naming the field: for values out of range, and for those that mean nothing to the method.
  void validate() const;
};

struct SurfaceReport {
  SurfaceMethod method = SurfaceMethod::partition;
  double spacing = 0, noise = 0;  ///< of the samples (length, unit of the input)
  double smoothing = 0;           ///< median width over the local spacing; 0 for partition
  int order = 0, iterations = 0;  ///< amls
  std::size_t samples = 0;
};

class SurfaceModel {
 public:
  ~SurfaceModel();
  SurfaceModel(SurfaceModel&&) noexcept;
  SurfaceModel& operator=(SurfaceModel&&) noexcept;

  // Everything below but the report is in coordinates of the model's own.
  const Placement& place() const;

  /// The surface as a field; for projections, the signed distance to the foot point. These make it when it is first
  /// asked for, which pictures never do: that is what the progress tells of, and may be cancelled.
  const ScalarField& field(Progress& progress) const;
  /// Better normals than those of the field; null unless sharp or iterated ones were asked for.
  const NormalField* normals() const;
  /// Whether the field has creases that a mesh should follow.
  bool creases() const;
  /// Whether the surface goes on where there are no samples: it is closed there, unless it bounds no solid.
  bool closes_holes() const;
  /// For placing the vertices of a mesh, where another field than field() is better; else null. Makes field().
  const ScalarField* placement(Progress& progress) const;
  /// Null unless the surface is defined by a projection.
  const Projection* projection() const;
  /// Where the surface can be: first a ball for each of the samples, then what closes holes (not of the partition).
  const BallUnion& balls() const;
  /// How far from zero the field may be on either side of a jump that is part of the surface, over the radius of the
  /// ball there: patches of planes that do not meet (hoppe), or nearly nothing.
  double jump() const;
  const PointSet& points() const;
  /// The samples' colours, interpolated; null where they have none.
  const ColorField* colors() const;
  const SurfaceReport& report() const;
  const std::vector<std::string>& warnings() const;

  /// Blocks for polygonisation: as fine as the samples near them, times `coarseness` (> 0).
  BlockTree blocks(double coarseness) const;
  /// The points of the surface next to the balls' centres, with its normals there (zero where the field has no slope).
  /// Makes field().
  PointSet feet(Progress& progress) const;
  /// Blocks, but larger where the surface is a single sheet and so flat there that triangles as large as the blocks
  /// would be less than `mesh_error` (length, > 0) off on average; and no finer than the weights are wide. Of the
  /// partition, as blocks(1). `feet`: feet().
  BlockTree blocks_for(const PointSet& feet, double mesh_error) const;
  /// Points near the surface from which it can be followed.
  std::vector<Vec3> seeds() const;

  struct State;  ///< internal

 private:
  friend SurfaceModel make_surface_model(PreparedCloud, const SurfaceOptions&, Progress&);
  friend SurfaceModel make_surface_model(SurfaceFunction);
  explicit SurfaceModel(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The surface of samples that are clean and oriented. Throws ArgumentError for bad options, DataError where the points
/// do not make a surface.
SurfaceModel make_surface_model(PreparedCloud cloud, const SurfaceOptions& options, Progress& progress);

/// The same of samples as they come: they are cleaned and oriented before (prepare_cloud, as it does by itself).
SurfaceModel make_surface_model(PointSet points, const SurfaceOptions& options, Progress& progress);

/// The same of a function that was fitted before: the surface "partition".
SurfaceModel make_surface_model(SurfaceFunction function);

}  // namespace sansmesh
