// A meshless surface of samples made by a named method: input of pictures, of projections and of meshing.
#pragma once

#include <memory>
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

  // All members except the report are in the model's local coordinates.
  const LocalFrame& frame() const;

  /// The surface as a field; for projections, the signed distance to the foot point. The first call may create it, with
  /// progress and cancellation; pictures never need it.
  const ScalarField& field(Progress& progress) const;
  /// Normals better than the field's; null unless sharp or iterated ones were requested.
  const NormalField* normals() const;
  /// Properties that consumers of the field need; sharp normals count as creases.
  SurfaceTraits traits() const;
  /// Field for placing the vertices of a mesh if field() is not the best one; else null. Creates field().
  const ScalarField* placement(Progress& progress) const;
  /// Null unless the surface is defined by a projection.
  const Projection* projection() const;
  /// Balls that contain the surface: one for each sample, then those that close holes; for a fitted function, its
  /// supports.
  const BallUnion& balls() const;
  const PointSet& points() const;
  /// Interpolated colours of the samples; null if they have none.
  const ColorField* colors() const;
  const SurfaceReport& report() const;
  const std::vector<Note>& notes() const;

  /// Blocks for polygonization: as fine as the local samples, times `coarseness` (> 0).
  BlockTree blocks(double coarseness) const;
  /// Projections of the ball centres onto the surface, with normals (zero where the gradient vanishes). Creates
  /// field().
  PointSet feet(Progress& progress) const;
  /// Blocks that are larger where the surface is a single sheet so flat that triangles of the block size deviate by
  /// less than `mesh_error` (length, > 0) on average, and no finer than the width of the weight functions. For the
  /// partition equal to blocks(1). `feet`: feet().
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

/// Makes the surface of clean, oriented samples. Throws ArgumentError for bad options, DataError where the points do
/// not form a surface.
SurfaceModel make_surface_model(PreparedCloud cloud, const SurfaceOptions& options, Progress& progress);

/// As above for raw samples, which prepare_cloud cleans and orients with its defaults.
SurfaceModel make_surface_model(PointSet points, const SurfaceOptions& options, Progress& progress);

/// As above for a function that was fitted before: the surface "partition".
SurfaceModel make_surface_model(FittedFunction function);

}  // namespace sansmesh::inline v1
