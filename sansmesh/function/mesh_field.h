// Signed distance to the faces of a closed mesh.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "sansmesh/field/piecewise_field.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Exact signed distance to the faces of a closed mesh. Its pieces are the smooth patches of the mesh, bounded by
/// creases (edges of more than 20 degrees), each continued beyond them along its faces' planes; and, with `rounded`,
/// the regions closest to a crease or a corner: the rounded edges of offsets. At the surface itself creases are sharp
/// in both cases.
///
/// The side is that of the closest face, edge or vertex (Bærentzen and Aanæs 2005).
class MeshField final : public PiecewiseField {
 public:
  struct Options {
    bool rounded = false;
    /// The mesh approximates a smooth surface: gradients within patches are means of its faces' normals.
    bool smooth = false;
    double crease_angle = 20;  ///< degrees
    double least_crease = 0;   ///< see MeshPatches (length)
  };

  /// Throws DataError if there is no triangle.
  MeshField(TriangleMesh mesh, const Options& options);

  Box3 bounds() const override;
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  std::uint32_t pieces() const override;
  void active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const override;
  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override;
  std::optional<double> slope_bound() const override { return 1; }
  void survey(std::span<const Vec3> x, const SurveyReach& reach, std::span<double> values,
              std::span<Surroundings> around) const override;

  struct Parts;

 private:
  std::shared_ptr<const Parts> parts_;
};

}  // namespace sansmesh::inline v1
