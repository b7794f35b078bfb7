// Short loops of a mesh that do not separate it: cross-sections of its handles and tunnels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "sansmesh/mesh/vertex_corners.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct LabelSearch;
struct LoopSearch;

/// A simple loop of edges.
struct HandleLoop {
  std::vector<std::uint32_t> vertices;  ///< along the loop
  double length = 0;
  std::uint32_t component = 0;  ///< component by shared edges
  std::uint64_t label = 0;      ///< equal for homologous loops, and XOR-linear in their classes; not 0
};

/// Homology classes of loops on an oriented manifold mesh, after a tree-cotree decomposition
/// (docs/methods/polygonisation.md): each edge has a label, and the XOR of the labels along a closed loop is 0 if the
/// loop separates its component, or a border does. Components with edges of three triangles, or vertices of several
/// fans, have no labels.
class HandleClasses {
 public:
  /// Linear time and memory. Corners of triangles must be different, existing vertices.
  explicit HandleClasses(const TriangleMesh& mesh);

  /// Total number of handles of all components.
  std::size_t genus() const { return genus_; }
  std::size_t genus(std::uint32_t component) const { return components_[component].genus(); }
  /// Whether a component has a border.
  bool open(std::uint32_t component) const { return components_[component].borders > 0; }

  /// For each vertex of some set that every loop with a label other than 0 passes, the shortest such loop through it,
  /// if not longer than longest(component, vertex); ascending by length. Parallel; `longest` must be thread-safe.
  std::vector<HandleLoop> short_loops(const std::function<double(std::uint32_t, std::uint32_t)>& longest) const;

  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::uint32_t previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  std::uint32_t from(std::uint32_t h) const { return mesh_.triangles[h / 3][h % 3]; }
  std::uint32_t to(std::uint32_t h) const { return from(next(h)); }
  std::uint32_t twin(std::uint32_t h) const { return twin_[h]; }  ///< kNone at borders
  const VertexCorners& corners() const { return corners_; }

 private:
  struct Component {
    std::uint32_t first = 0;      ///< a triangle
    long euler = 0, borders = 0;  ///< V − E + F; number of boundary loops
    bool is_surface = true;       ///< oriented manifold
    std::size_t genus() const { return is_surface ? static_cast<std::size_t>((2 - euler - borders) / 2) : 0; }
  };

  void join_twins();
  void find_components();
  void check_fans();
  void trace_borders();
  void label_edges();
  void label_component(std::uint32_t component, LabelSearch& search);
  void set_label(std::uint32_t h, std::uint64_t label);
  HandleLoop shortest_through(std::uint32_t v, double longest, LoopSearch& search) const;
  std::uint32_t component_at(std::uint32_t v) const { return component_of_[corners_.entries[corners_.first[v]] / 3]; }

  template <class Visit>
  void each_edge_at(std::uint32_t v, const Visit& visit) const;

  const TriangleMesh& mesh_;
  VertexCorners corners_;
  std::vector<std::uint32_t> twin_, component_of_, border_of_;
  std::vector<std::vector<std::uint32_t>> borders_;  ///< half-edges of each boundary loop
  std::vector<Component> components_;
  std::vector<std::uint64_t> label_;  ///< per half-edge; empty without handles
  std::size_t genus_ = 0;
};

}  // namespace sansmesh::inline v1
