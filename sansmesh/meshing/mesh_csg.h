// Front door to meshes of solids: a field of pieces in, a closed mesh with its creases as edges out.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/csg/solid.h"
#include "sansmesh/field/piecewise_field.h"
#include "sansmesh/meshing/mesh_options.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct CsgMeshOptions {
  /// Accepted mean distance between curved parts and their triangles (length); by default a 50,000th of the diagonal of
  /// the box. Of fields that are no PieceExpression: of that of simplification.
  std::optional<double> mesh_error = std::nullopt;
  /// At most this many triangles, at least 4: the mesh error then follows from it.
  std::optional<std::size_t> triangles = std::nullopt;
  /// Edge of the blocks along curved parts, whatever the error, and of the smallest ones (length). Balls, rods and
  /// tubes thinner than one of them can be lost; a warning says so of those that the field knows
  /// (PiecewiseField::thickness).
  std::optional<double> cell = std::nullopt;
  /// Instead: such blocks along the longest side of the box, 4..4096. With neither, blocks are as small as the error
  /// and thin parts ask for. Of fields that are no PieceExpression: the box's diagonal has 256, or up to 1024 where
  /// functions show more (function_solid.h) or parts are thin.
  std::optional<int> resolution = std::nullopt;
  /// The solid is cut off at this box. Needed if it has no end otherwise.
  std::optional<Box3> box = std::nullopt;
  /// Collapse edges while the quadric error stays below this (length): few triangles where the surface is flat, and no
  /// difference where it is exactly so. 0 = off; by default as the mesh error asks for, with `cell` about a thousandth
  /// of that.
  std::optional<double> simplify = std::nullopt;

  /// Parts to keep; automatic: those that have at least 1.5 % of the largest one's area. Default: all.
  std::optional<ComponentChoice> components = {};

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the option.
  void validate() const;
};

struct CsgMeshReport {
  Box3 box;         ///< in which the surface lies: tight to a thirty-second of the solid’s bounds()
  double cell = 0;  ///< edge of the smallest blocks
  int depth = 0;    ///< levels of the tree of blocks
  std::size_t blocks = 0;
  std::size_t components = 0;
  bool closed = false;          ///< and manifold and oriented
  double area = 0, volume = 0;  ///< of the mesh
  /// Distance of the triangles' middles from the surface: its mean over the area, and the largest (length).
  double mean_error = 0, largest_error = 0;
  std::vector<std::string> warnings;

  static const ReportSchema& schema();
};

/// The surface of a solid. What is minima and maxima of smooth functions (PiecewiseField::expression) has walls of any
/// thickness. Else `solid` is about a distance: blocks whose centre is farther from zero than half their
/// diagonal (one and a half times that if the field's gradients are not known to be 1 at most) are not cut finer, below
/// 32 blocks along the box, nor are those of which its survey() says that they need not be (crease_blocks.h). Its
/// bounds() must be finite, or `options.box` given: else ArgumentError. Throws DataError if no surface is found, and
/// where parts are too thin to be shown without a `cell`. Deterministic for any number of threads.
TriangleMesh mesh_csg(const PiecewiseField& solid, const CsgMeshOptions& options, Progress& progress,
                      CsgMeshReport* report = nullptr);
TriangleMesh mesh_csg(const Solid& solid, const CsgMeshOptions& options, Progress& progress,
                      CsgMeshReport* report = nullptr);

}  // namespace sansmesh::inline v1
