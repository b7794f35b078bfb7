// From samples to a surface that is never meshed, by name: what pictures are taken of, points are projected onto and,
// where a mesh is wanted after all, it is cut out of.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/field/ball_union.h"
#include "sansmesh/field/color_field.h"
#include "sansmesh/field/normal_field.h"
#include "sansmesh/field/projection.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/model/surface_method.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/surface_options.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

class SurfaceModel {
 public:
  ~SurfaceModel();
  SurfaceModel(SurfaceModel&&) noexcept;
  SurfaceModel& operator=(SurfaceModel&&) noexcept;

  // Everything below but the report is in coordinates of the model's own.
  const LocalFrame& frame() const;

  /// The surface as a field; for projections, the signed distance to the foot point. These make it when it is first
  /// asked for, which pictures never do: that is what the progress tells of, and may be cancelled.
  const ScalarField& field(Progress& progress) const;
  /// Better normals than those of the field; null unless sharp or iterated ones were asked for.
  const NormalField* normals() const;
  /// What consumers of the field need to know; sharp normals are creases, too.
  SurfaceTraits traits() const;
  /// For placing the vertices of a mesh, where another field than field() is better; else null. Makes field().
  const ScalarField* placement(Progress& progress) const;
  /// Null unless the surface is defined by a projection.
  const Projection* projection() const;
  /// Where the surface can be: first a ball for each of the samples, then what closes holes; of a fitted function, its
  /// supports.
  const BallUnion& balls() const;
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
  friend SurfaceModel make_surface_model(FittedFunction);
  explicit SurfaceModel(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The surface of samples that are clean and oriented. Throws ArgumentError for bad options, DataError where the points
/// do not make a surface.
SurfaceModel make_surface_model(PreparedCloud cloud, const SurfaceOptions& options, Progress& progress);

/// The same of samples as they come: they are cleaned and oriented before (prepare_cloud, as it does by itself).
SurfaceModel make_surface_model(PointSet points, const SurfaceOptions& options, Progress& progress);

/// The same of a function that was fitted before: the surface "partition".
SurfaceModel make_surface_model(FittedFunction function);

}  // namespace sansmesh::inline v1
