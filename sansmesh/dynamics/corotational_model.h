// Linear elasticity in the rotated frame of each tetrahedron (mueller2004).
#pragma once

#include <array>
#include <vector>

#include "sansmesh/dynamics/elastic_model.h"
#include "sansmesh/dynamics/polar_rotation.h"
#include "sansmesh/dynamics/tet_geometry.h"
#include "sansmesh/dynamics/vertex_graph.h"
#include "sansmesh/tet_mesh.h"

namespace sansmesh::inline v1 {

/// E = V (μ ‖Rᵀ F − I‖² + λ/2 tr²(Rᵀ F − I)) of each tetrahedron with its deformation gradient F and the rotation R of
/// F, which never reflects: inverted tetrahedra return to their orientation. The matrix is that of linear elasticity in
/// the rotated frames, positive semidefinite for any deformation. Damping is β K v.
class CorotationalModel final : public ElasticModel {
 public:
  /// Tetrahedra of positive volume. Young's modulus in pascals, Poisson's ratio below 0.5, β in seconds.
  CorotationalModel(std::vector<Tet> tets, std::span<const Vec3> rest, double young, double poisson, double damping);

  bool forces(std::span<const Vec3> x, std::span<const Vec3> v, std::span<Vec3> f) override;
  bool linearize(std::span<const Vec3> x, double h, std::span<Vec3> f) override;
  void add_rows(std::size_t first, std::size_t last, std::span<const Vec3> p, std::span<Vec3> q) const override;
  SymmetricBlock diagonal(std::size_t i) const override;
  double energy(std::span<const Vec3> x) const override;
  std::string worst(std::span<const Vec3> x, std::span<const std::uint32_t> names) const override;

 private:
  using Block = std::array<Vec3, 3>;  ///< by rows

  /// Columns ∂x/∂X_k.
  Matrix3 gradient(std::size_t t, std::span<const Vec3> x) const;
  Block edge_block(std::size_t edge) const;

  std::vector<Tet> tets_;
  std::vector<TetGradients> shapes_;          ///< at rest
  std::vector<Turn> turns_;                   ///< initial guess of the next rotation
  std::vector<std::array<Vec3, 3>> carried_;  ///< gradients in the rotated frame
  std::vector<std::array<Vec3, 3>> pulls_;    ///< forces on corners 1 to 3; the force on corner 0 is minus their sum
  VertexGraph graph_;
  Adjacency32 corners_, around_;
  std::vector<Block> blocks_;  ///< per edge: factor of p_i − p_j in row i, transposed in row j
  double mu_, lambda_, damping_;
};

}  // namespace sansmesh::inline v1
