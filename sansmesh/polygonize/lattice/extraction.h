// Extraction of the crossing simplices of a scalar field from the J₁ᴬ triangulation of a block tree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/polygonize/lattice/lattice.h"
#include "sansmesh/polygonize/surface_chain.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

/// A block whose simplices may cross the surface.
struct ActiveBlock {
  std::uint32_t block;
  const BlockPattern* pattern;
  std::size_t first;  ///< its lattice vertices: consecutive, in the order of pattern->slots
};

/// The blocks that the surface crosses, with their lattice vertices and field values.
class Extraction {
 public:
  /// `regions` restricts the extraction to blocks that meet one of them, and a few layers around; empty: no
  /// restriction.
  Extraction(const ScalarField& field, BlockTree tree, const Vec3& origin, const std::vector<Box3>& regions)
      : field_(field), tree_(std::move(tree)), origin_(origin), regions_(regions) {}

  /// Excludes leaves in which `domain` is positive everywhere.
  void leave_out(const ScalarField& domain);

  /// Activates the blocks at the seeds (without seeds, those with a small value at their centre), and from there across
  /// every face on which the sign changes: each crossing simplex is found from its neighbour.
  void activate(const std::vector<Vec3>& seeds);

  /// tejada2008, 4.4.3: lattice vertices near the surface move away from it along the gradient, by at most a quarter of
  /// the local block edge, so that fewer simplices are cut close to a corner.
  void displace(double alpha);

  /// The triangles of all crossing simplices. Vertices are named by lattice edges, or by lattice vertices where
  /// `merged` allows; triangles that merging makes degenerate are left out. If `near` is not empty, only blocks with a
  /// marked vertex are visited.
  std::vector<ChainTriangle> march(const ChainSource::Flags& merged, const ChainSource::Flags& near) const;
  /// Marks the vertices of all blocks that have a marked one.
  void widen(ChainSource::Flags& marked) const;

  std::size_t lattice_vertices() const { return values_.size(); }
  /// Field at a lattice vertex; positive on the cube's faces, which closes the mesh.
  float value(std::uint32_t v) const { return values_[v]; }
  /// Whether the vertex is on the cube's faces and the field is negative there.
  bool is_cap(std::uint32_t v) const { return caps_[v] != 0; }
  /// Position of a lattice vertex relative to origin.
  Vec3f position(std::uint32_t v) const {
    return moved_.empty() ? Vec3f(lattice_position(tree_, points_[v]) - origin_) : moved_[v];
  }

 private:
  bool on_border(const LatticePoint& p) const {
    const std::uint32_t last = 2u << tree_.depth();
    return p[0] == 0 || p[1] == 0 || p[2] == 0 || p[0] == last || p[1] == last || p[2] == last;
  }
  bool inside(std::uint32_t v) const { return values_[v] < 0; }
  /// Lattice vertices of a block, in the order of its pattern's slots.
  std::span<const std::uint32_t> vertices_of(const ActiveBlock& a) const {
    return std::span(numbers_).subspan(a.first, a.pattern->slots.size());
  }
  bool crosses(const ActiveBlock& a) const;
  bool has_any(const ActiveBlock& a, const ChainSource::Flags& flags) const;
  bool out_of_domain(std::size_t block) const { return !beyond_domain_.empty() && beyond_domain_[block]; }
  bool in_region(std::size_t block) const;

  /// The block of each seed that is in one, within the region.
  std::vector<std::uint32_t> blocks_at(const std::vector<Vec3>& seeds) const;
  std::vector<std::uint32_t> blocks_with_small_values() const;

  /// Numbers the blocks' lattice vertices in the order of the blocks, and of the slots of each.
  void add_blocks(const std::vector<std::uint32_t>& blocks);
  /// Adds the blocks that are not active yet.
  void add_new(std::vector<std::uint32_t> blocks, std::vector<std::uint8_t>& is_active);
  /// Evaluates the field at the lattice vertices numbered since the last call, of some only the sign.
  void evaluate_new();
  /// Stores the field's value at the lattice vertex v.
  void put_value(std::size_t v, const LatticePoint& p, double f) {
    caps_[v] = f < 0 && on_border(p);
    values_[v] = static_cast<float>(caps_[v] ? -f : f);
  }
  /// Evaluates what is known by its sign only at vertices of crossing simplices.
  void complete_values();
  /// Follows the surface from the active blocks from `done` on; neighbours outside the region are only recorded.
  void follow(std::vector<std::uint8_t>& is_active, std::size_t done, std::vector<std::uint32_t>& beyond);
  /// Appends the inactive blocks across the faces of a block on which the sign changes.
  void cross_faces(const ActiveBlock& a, const std::vector<std::uint8_t>& is_active,
                   std::vector<std::uint32_t>& found) const;
  void cross_face(const ActiveBlock& a, std::size_t face, const std::vector<std::uint8_t>& is_active,
                  std::vector<std::uint32_t>& found) const;
  /// Whether the sign changes among the vertices on a face whose slots are accepted.
  template <class Accept>
  bool changes_on(const ActiveBlock& a, std::size_t face, const Accept& accept) const {
    bool any_in = false, any_out = false;
    for (const std::uint8_t s : a.pattern->face[face])
      if (accept(a.pattern->slots[s])) (inside(numbers_[a.first + s]) ? any_in : any_out) = true;
    return any_in && any_out;
  }
  /// The surface is followed from many starting points concurrently, which scatters numbers and blocks. Sorts the
  /// crossed blocks into the tree's order, along a space-filling curve, and renumbers their lattice vertices in that
  /// order: neighbours in space become neighbours in memory, also in all derived data.
  void put_in_order();

  /// Name of the surface vertex on the lattice edge from `in` to `out`.
  ChainVertex crossing(std::uint32_t in, std::uint32_t out, const ChainSource::Flags& merged) const;
  void march_block(const ActiveBlock& a, const ChainSource::Flags& merged, std::vector<ChainTriangle>& out) const;

  const ScalarField& field_;
  BlockTree tree_;
  Vec3 origin_;
  const std::vector<Box3>& regions_;
  std::vector<std::uint8_t> beyond_domain_;  ///< per block; empty: none is
  LatticeNumbering numbering_;               ///< used while the surface is followed
  PatternTable patterns_;
  std::vector<ActiveBlock> active_;
  std::vector<std::uint32_t> numbers_;
  std::vector<LatticePoint> points_;  ///< per lattice vertex, once the surface has been followed
  std::vector<float> values_;         ///< per lattice vertex
  std::vector<Vec3f> moved_;          ///< displaced positions relative to origin; empty without displacement
  std::vector<std::uint8_t> caps_;    ///< per lattice vertex
  std::vector<std::uint8_t>
      sized_;  ///< per lattice vertex: whether more than the sign of its value is known; empty: all are
};

}  // namespace sansmesh::inline v1
