// Mass-spring model: every edge is a spring (tejada2008, 6.4.5, equations 6.35 to 6.39).
#pragma once

#include <vector>

#include "sansmesh/dynamics/elastic_model.h"
#include "sansmesh/dynamics/vertex_graph.h"

namespace sansmesh::inline v1 {

/// E = ½ k_s (‖x_ij‖ − L)² of each edge; damping −k_d (v_i − v_j). In the derivative k_s [x̂ x̂ᵀ + (1 − L/‖x_ij‖) (I −
/// x̂ x̂ᵀ)] the factor 1 − L/‖x_ij‖ is clamped at 0: compressed springs would make the matrix indefinite.
class SpringModel final : public ElasticModel {
 public:
  /// Rest lengths L are those of the edges at `rest`.
  SpringModel(VertexGraph graph, std::span<const Vec3> rest, double stiffness, double damping);

  bool forces(std::span<const Vec3> x, std::span<const Vec3> v, std::span<Vec3> f) override;
  bool linearize(std::span<const Vec3> x, double h, std::span<Vec3> f) override;
  void add_rows(std::size_t first, std::size_t last, std::span<const Vec3> p, std::span<Vec3> q) const override;
  SymmetricBlock diagonal(std::size_t i) const override;
  double energy(std::span<const Vec3> x) const override;
  std::string worst(std::span<const Vec3> x, std::span<const std::uint32_t> names) const override;

 private:
  /// The block of an edge is a I + u uᵀ. In single precision it is still exactly symmetric and exactly zero on
  /// translations, because it multiplies only differences p_i − p_j.
  struct Link {
    float a = 0;
    Vec3f u;
  };

  VertexGraph graph_;
  std::vector<double> lengths_;  ///< L, per half-edge
  std::vector<Link> links_;      ///< per half-edge
  double stiffness_, damping_;
};

}  // namespace sansmesh::inline v1
