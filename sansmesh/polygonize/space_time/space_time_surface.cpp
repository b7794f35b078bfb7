#include "sansmesh/polygonize/space_time/space_time_surface.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "sansmesh/error.h"
#include "sansmesh/polygonize/space_time/space_time_lattice.h"
#include "sansmesh/triangulation/simplex_cut.h"

namespace sansmesh::inline v1 {

namespace {

/// Moments closer to a lattice moment, in durations of the smallest blocks, are moved to it, for the same reasons as
/// values close to zero (space_time_lattice.cpp).
constexpr double kNearMoment = 2.5e-3;

struct PairHash {
  std::size_t operator()(const std::pair<std::uint32_t, std::uint32_t>& p) const {
    const std::uint64_t h = (std::uint64_t{p.first} << 32 | p.second) * 0x9e3779b97f4a7c15u;
    return static_cast<std::size_t>(h ^ h >> 31);
  }
};

/// Numbers pairs of indices in order of first use.
class PairNumbers {
 public:
  /// Returns the number, and whether it is new.
  std::pair<std::uint32_t, bool> of(std::uint32_t a, std::uint32_t b) {
    const auto [it, fresh] = numbers_.try_emplace({a, b}, static_cast<std::uint32_t>(numbers_.size()));
    return {it->second, fresh};
  }

 private:
  std::unordered_map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t, PairHash> numbers_;
};

/// The section of a lattice at a moment.
class SpaceTimeSlice {
 public:
  SpaceTimeSlice(const SpaceTimeLattice& lattice, double t, const Vec3& origin)
      : lattice_(lattice), moment_((t - lattice.times.first) / lattice.quarter_time()) {
    if (std::abs(moment_ - std::round(moment_)) < 4 * kNearMoment) moment_ = std::round(moment_);
    mesh_.origin = origin;
    found_ = lattice.crossed(blocks());
  }

  TriangleMesh make() {
    for (std::size_t n = 0; n < found_.blocks.size(); ++n) cut_block(n);
    return std::move(mesh_);
  }

 private:
  /// A point where a lattice edge crosses the moment, with the function there.
  struct Crossing {
    Vec3 x;
    double value;
  };

  /// Vertices exactly at the moment count as after it (at the first moment, as before it), so that each face in that
  /// moment is cut out of one simplex.
  bool after(std::int64_t time) const {
    return moment_ > 0 ? static_cast<double>(time) >= moment_ : static_cast<double>(time) > moment_;
  }

  /// Leaves that contain the moment.
  std::vector<std::uint32_t> blocks() const {
    std::vector<std::uint32_t> found, stack{0};
    while (!stack.empty()) {
      const std::uint32_t b = stack.back();
      stack.pop_back();
      const auto& block = lattice_.tree[b];
      const std::int64_t begin = 4 * std::int64_t{block.cell[3]} << (lattice_.depth - block.level);
      const std::int64_t end = begin + (std::int64_t{4} << (lattice_.depth - block.level));
      if (after(begin) || !after(end)) continue;
      if (lattice_.tree.is_leaf(b)) {
        found.push_back(b);
      } else {
        for (std::uint32_t c = BlockTreeN<4>::kChildren; c-- > 0;)
          stack.push_back(static_cast<std::uint32_t>(block.first_child) + c);
      }
    }
    return found;
  }

  void cut_block(std::size_t n) {
    const SpaceTimePattern& pattern = *found_.patterns[n];
    numbers_.clear(), is_later_.clear(), is_out_.clear();
    bool some_in = false, some_out = false;
    for (const std::uint16_t slot : pattern.slots) {
      numbers_.push_back(found_.find(lattice_.key_at(found_.blocks[n], slot)));
      const bool in = found_.values[numbers_.back()] < 0;
      is_out_.push_back(!in);
      is_later_.push_back(after(coordinate(found_.keys[numbers_.back()], 3)));
      some_in = some_in || in, some_out = some_out || !in;
    }
    if (!some_in || !some_out) return;
    for (const SpaceTimePattern::Simplex& simplex : pattern.simplices) {
      unsigned later = 0, out = 0;
      for (std::size_t i = 0; i < 5; ++i) {
        later |= static_cast<unsigned>(is_later_[simplex.corner[i]]) << i;
        out |= static_cast<unsigned>(is_out_[simplex.corner[i]]) << i;
      }
      if (later == 0 || later == 31 || out == 0 || out == 31) continue;
      for (const CutPiece<4>& piece : simplex_cut<4>(later)) cut_tetrahedron(simplex, piece);
    }
  }

  void cut_tetrahedron(const SpaceTimePattern::Simplex& simplex, const CutPiece<4>& piece) {
    std::array<std::uint32_t, 4> tet{};
    unsigned positive = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      tet[i] = crossing_of(numbers_[simplex.corner[piece[i].first]], numbers_[simplex.corner[piece[i].second]]);
      positive |= static_cast<unsigned>(crossings_[tet[i]].value >= 0) << i;
    }
    // A polyhedron that ends in vertices exactly at the moment may have degenerated.
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = 0; k < i; ++k)
        if (tet[i] == tet[k]) return;
    for (const CutPiece<3>& face : simplex_cut<3>(positive)) {
      Triangle triangle{};
      for (std::size_t i = 0; i < 3; ++i) triangle[i] = vertex_of(tet[face[i].first], tet[face[i].second]);
      if (simplex.turned) std::swap(triangle[1], triangle[2]);
      mesh_.triangles.push_back(triangle);
    }
  }

  std::uint32_t crossing_of(std::uint32_t before, std::uint32_t later) {
    const LatticeKey a = found_.keys[before], b = found_.keys[later];
    const auto ta = static_cast<double>(coordinate(a, 3)), tb = static_cast<double>(coordinate(b, 3));
    if (tb == moment_) before = later;  // identifies all edges that end there
    if (ta == moment_) later = before;
    const auto [number, fresh] = crossing_numbers_.of(before, later);
    if (!fresh) return number;
    if (before == later) {
      crossings_.push_back({lattice_.position(found_.keys[before]), found_.values[before]});
    } else {
      const double u = (moment_ - ta) / (tb - ta);
      crossings_.push_back({lattice_.position(a) * (1 - u) + lattice_.position(b) * u,
                            lattice_.off_zero(found_.values[before] * (1 - u) + found_.values[later] * u)});
    }
    return number;
  }

  /// The surface vertex between two crossings.
  std::uint32_t vertex_of(std::uint32_t in, std::uint32_t out) {
    const auto [number, fresh] = vertex_numbers_.of(in, out);
    if (fresh) {
      const Crossing &a = crossings_[in], &b = crossings_[out];
      const double u = a.value / (a.value - b.value);
      mesh_.vertices.push_back(Vec3f(a.x * (1 - u) + b.x * u - mesh_.origin));
    }
    return number;
  }

  const SpaceTimeLattice& lattice_;
  double moment_;  ///< in quarters of the smallest blocks
  SpaceTimeBlocks found_;
  PairNumbers crossing_numbers_, vertex_numbers_;
  std::vector<Crossing> crossings_;
  std::vector<std::uint32_t> numbers_;
  std::vector<std::uint8_t> is_later_, is_out_;  ///< per slot
  TriangleMesh mesh_;
};

}  // namespace

void SpaceTimeOptions::validate() const {
  if (!(cell > 0 && std::isfinite(cell))) throw ArgumentError(fmt::format("`cell` must be positive, not {}", cell));
  if (!(time_cell > 0 && std::isfinite(time_cell)))
    throw ArgumentError(fmt::format("`time_cell` must be positive, not {}", time_cell));
  if (!(mesh_error >= 0 && std::isfinite(mesh_error)))
    throw ArgumentError(fmt::format("`mesh_error` must be at least 0, not {}", mesh_error));
}

SpaceTimeSurface::SpaceTimeSurface(const TimeField& field, const SpaceTimeOptions& options, Progress& progress) {
  options.validate();
  lattice_ = std::make_unique<SpaceTimeLattice>(field, options.cell, options.time_cell, options.mesh_error, progress);
}

SpaceTimeSurface::~SpaceTimeSurface() = default;
SpaceTimeSurface::SpaceTimeSurface(SpaceTimeSurface&&) noexcept = default;
SpaceTimeSurface& SpaceTimeSurface::operator=(SpaceTimeSurface&&) noexcept = default;

std::size_t SpaceTimeSurface::blocks() const {
  // Each division replaces one leaf by sixteen.
  return lattice_->tree.size() - (lattice_->tree.size() - 1) / BlockTreeN<4>::kChildren;
}
double SpaceTimeSurface::cell() const { return 4 * lattice_->quarter(); }
double SpaceTimeSurface::time_cell() const { return 4 * lattice_->quarter_time(); }

TriangleMesh SpaceTimeSurface::slice(double t, const Vec3& origin) const {
  const TimeRange& times = lattice_->times;
  if (!times.contains(t))
    throw ArgumentError(
        fmt::format("the moment {:.9g} does not lie between {:.9g} and {:.9g}", t, times.first, times.last));
  return SpaceTimeSlice(*lattice_, t, origin).make();
}

SpaceTimeMesh SpaceTimeSurface::mesh() const {
  const SpaceTimeLattice& s = *lattice_;
  const SpaceTimeBlocks lattice = s.crossed(s.tree.leaves());
  SpaceTimeMesh mesh;
  PairNumbers vertex_numbers;
  std::vector<std::uint32_t> numbers;
  for (std::size_t n = 0; n < lattice.blocks.size(); ++n) {
    numbers.clear();
    for (const std::uint16_t slot : lattice.patterns[n]->slots)
      numbers.push_back(lattice.find(s.key_at(lattice.blocks[n], slot)));
    for (const SpaceTimePattern::Simplex& simplex : lattice.patterns[n]->simplices) {
      unsigned out = 0;
      for (std::size_t i = 0; i < 5; ++i)
        out |= static_cast<unsigned>(lattice.values[numbers[simplex.corner[i]]] >= 0) << i;
      for (const CutPiece<4>& piece : simplex_cut<4>(out)) {
        std::array<std::uint32_t, 4> tet{};
        for (std::size_t i = 0; i < 4; ++i) {
          const std::uint32_t a = numbers[simplex.corner[piece[i].first]], b = numbers[simplex.corner[piece[i].second]];
          const auto [number, fresh] = vertex_numbers.of(a, b);
          tet[i] = number;
          if (!fresh) continue;
          const double u = lattice.values[a] / (lattice.values[a] - lattice.values[b]);
          const LatticeKey p = lattice.keys[a], q = lattice.keys[b];
          const Vec3 x = s.position(p) * (1 - u) + s.position(q) * u;
          const double time =
              (1 - u) * static_cast<double>(coordinate(p, 3)) + u * static_cast<double>(coordinate(q, 3));
          mesh.vertices.push_back({x.x, x.y, x.z, s.times.first + time * s.quarter_time()});
        }
        if (simplex.turned) std::swap(tet[2], tet[3]);
        mesh.tetrahedra.push_back(tet);
      }
    }
  }
  return mesh;
}

}  // namespace sansmesh::inline v1
