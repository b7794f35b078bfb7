#include "sansmesh/surface/vertex_curvature.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <numeric>
#include <span>

#include "sansmesh/core/parallel.h"
#include "sansmesh/data/triangles.h"
#include "sansmesh/error.h"
#include "sansmesh/points/sampling/sample_faces.h"
#include "sansmesh/points/statistics/noise.h"
#include "sansmesh/search/equal_positions.h"
#include "sansmesh/surface/curvature_choice.h"

namespace sansmesh::inline v1 {
namespace {

using detail::CurvatureFitter, detail::CurvatureSurface, detail::CurvatureChoice, detail::TestedNeighbourhoods;

/// Whole rings are added until they hold this share of the requested neighbours.
constexpr double kMostOfNeighbours = 0.9;
constexpr int kLeastRings = 2;
/// Vertices with more neighbours than this, and than twice the requested number, are excluded as hubs. The hub of a cap
/// is far from its rim in terms of the spacing there, and through it the whole cap would belong to the neighbourhood of
/// each vertex of the rim.
constexpr std::size_t kMostSpokes = 64;
/// Below this cosine between normals a vertex along the edges is on the other side of a thin rim.
constexpr double kRoundTheRim = -0.25;
/// Each walk marks visited vertices of the whole mesh, so the mesh is divided into kShares shares of at least
/// kLeastShare vertices.
constexpr std::size_t kShares = 64, kLeastShare = 2048;

/// Coincident vertices of a mesh merged into nodes, with the edges between them.
struct PositionGraph {
  std::vector<std::uint32_t> representative;  ///< first coincident vertex of each vertex
  std::vector<std::uint32_t> first, beside;
  std::vector<Vec3> normal;  ///< normal of each node, unit or zero

  explicit PositionGraph(const PointSet& mesh)
      : representative(first_equal_positions(mesh.positions)), normal(mesh.size()) {
    join(mesh);
    std::vector<double> area(mesh.size(), 0);
    for (const auto& t : mesh.triangles) {
      const double doubled = norm(doubled_area(mesh.positions, t));
      if (doubled > 0)
        for (const std::uint32_t v : t) area[v] += doubled;
    }
    for (std::size_t v = 0; v < mesh.size(); ++v)
      if (is_finite(mesh.normals[v])) normal[representative[v]] += normalized(Vec3(mesh.normals[v])) * area[v];
    for (Vec3& n : normal) n = normalized(n);
  }

 private:
  void join(const PointSet& mesh) {
    std::vector<std::uint64_t> pairs;  // both directions
    for (const auto& t : mesh.triangles) {
      if (t[0] >= mesh.size() || t[1] >= mesh.size() || t[2] >= mesh.size()) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = representative[t[k]], b = representative[t[(k + 1) % 3]];
        if (a == b) continue;
        pairs.push_back(std::uint64_t{a} << 32 | b);
        pairs.push_back(std::uint64_t{b} << 32 | a);
      }
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    first.assign(mesh.size() + 1, 0);
    for (const std::uint64_t p : pairs) ++first[(p >> 32) + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    beside.resize(pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) beside[i] = static_cast<std::uint32_t>(pairs[i]);
  }
};

/// Computes the rings around one vertex after another.
class RingWalk {
 public:
  explicit RingWalk(const PositionGraph& graph) : graph_(graph), seen_(graph.representative.size(), 0) {}

  /// Neighbours of v from near to far, without v: whole rings until there are `enough`, of vertices that `keep(w)`
  /// accepts. Excludes hubs and the vertices behind them.
  template <class Keep>
  const std::vector<std::uint32_t>& around(std::uint32_t v, std::size_t enough, const Keep& keep,
                                           int least_rings = kLeastRings) {
    if (++round_ == 0) std::fill(seen_.begin(), seen_.end(), 0), round_ = 1;
    found_.clear();
    ends.clear();
    seen_[v] = round_;
    std::size_t from = 0;
    const std::size_t most = std::max(kMostSpokes, 2 * enough);
    const auto is_hub = [&](std::uint32_t w) { return graph_.first[w + 1] - graph_.first[w] > most; };
    const auto visit = [&](std::uint32_t of) {
      for (std::uint32_t k = graph_.first[of]; k < graph_.first[of + 1]; ++k) {
        const std::uint32_t w = graph_.beside[k];
        if (seen_[w] == round_ || is_hub(w) || !keep(w)) continue;
        seen_[w] = round_;
        found_.push_back(w);
      }
    };
    visit(v);
    ends.push_back(found_.size());
    for (int ring = 1; from < found_.size() && (ring < least_rings || found_.size() < enough); ++ring) {
      const std::size_t to = found_.size();
      for (; from < to; ++from) visit(found_[from]);
      ends.push_back(found_.size());
    }
    return found_;
  }

  std::vector<std::size_t> ends;  ///< number of neighbours in the first rings of the last walk

 private:
  const PositionGraph& graph_;
  std::vector<std::uint32_t> seen_, found_;
  std::uint32_t round_ = 0;
};

/// Whether a neighbour is on the same side of a thin rim.
bool beside(const PositionGraph& graph, const Vec3& normal, std::uint32_t neighbour) {
  return dot(normal, graph.normal[neighbour]) >= kRoundTheRim;
}

CurvatureChoice choose_on_mesh(const PointSet& mesh, const PositionGraph& graph, const CurvatureOptions& options) {
  PointSet distinct;  // copies of a vertex would be all of its nearest neighbours
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < mesh.size(); ++v) {
    if (graph.representative[v] != v) continue;
    vertices.push_back(v);
    distinct.positions.push_back(mesh.positions[v]), distinct.normals.push_back(Vec3f(graph.normal[v]));
  }
  const KdTree tree(distinct.positions);
  const std::size_t tested = std::min(detail::kTestedCurvatures, tree.size());
  const auto find = [&](std::size_t i, RingWalk& walk, TestedNeighbourhoods& to) {
    const std::uint32_t sample = tree.order()[i * tree.size() / tested], v = vertices[sample];
    if (!find_nearest(tree, distinct, sample, to)) return false;
    const auto& around = walk.around(v, 0, [](std::uint32_t) { return true; });
    TestedNeighbourhoods::Part part;
    for (std::size_t k = 0, ring = 0; ring < to.rings.size() && ring < walk.ends.size(); ++ring) {
      for (; k < walk.ends[ring]; ++k) {
        if (!beside(graph, to.normal, around[k])) continue;
        to.along_edges.push_back(Vec3(mesh.positions[around[k]]) - Vec3(mesh.positions[v]));
        part.radius = std::max(part.radius, norm(to.along_edges.back()));
      }
      part.count = to.along_edges.size();
      to.rings[ring] = part;
    }
    return true;
  };
  const auto make_finder = [&]() -> detail::FindNeighbourhoods {
    return [&, walk = std::make_shared<RingWalk>(graph)](std::size_t i, TestedNeighbourhoods& to) {
      return find(i, *walk, to);
    };
  };
  return detail::choose_curvature(tested, make_finder, options.noise ? *options.noise : known_noise(distinct),
                                  detail::only_quadrics(options));
}

/// Fits the chosen surface, or surfaces of fewer unknowns if the neighbours do not determine them.
class VertexFitter {
 public:
  explicit VertexFitter(const CurvatureOptions& options)
      : options_(options), through_(without_offset(options)), given_(without_slopes(options)) {}

  FittedCurvatures fit(const Vec3& normal, std::span<const Vec3> offsets, double radius, CurvatureSurface surface) {
    using Surface = CurvatureSurface;
    if (surface == Surface::directional || surface == Surface::quartic_through)
      return first_of({{&all_, surface}}, normal, offsets, radius);
    if (surface == Surface::quartic)
      if (const FittedCurvatures found =
              first_of({{&all_, surface}, {&all_, Surface::quartic_through}}, normal, offsets, radius);
          found.defined)
        return found;
    return first_of({{&all_, Surface::quadric}, {&no_offset_, Surface::quadric}, {&no_slopes_, Surface::quadric}},
                    normal, offsets, radius);
  }

 private:
  struct Attempt {
    CurvatureFitter* fitter;
    CurvatureSurface surface;
  };
  static CurvatureOptions without_offset(CurvatureOptions options) {
    options.offset = false;
    return options;
  }
  static CurvatureOptions without_slopes(CurvatureOptions options) {
    options.offset = options.refit_normal = false;
    return options;
  }
  static FittedCurvatures first_of(std::initializer_list<Attempt> attempts, const Vec3& normal,
                                   std::span<const Vec3> offsets, double radius) {
    for (const Attempt& attempt : attempts) {
      attempt.fitter->start(normal);
      for (const Vec3& d : offsets) attempt.fitter->add(d);
      if (!attempt.fitter->fit(offsets.size(), radius, attempt.surface)) continue;
      if (const FittedCurvatures found = attempt.fitter->curvatures(); found.defined) return found;
    }
    return {};
  }

  CurvatureOptions options_, through_, given_;
  CurvatureFitter all_{options_}, no_offset_{through_}, no_slopes_{given_};
};

}  // namespace

double known_noise(const PointSet& mesh) {
  const NoiseEstimate noise = measure_noise(mesh);
  return noise.known ? noise.deviation : 0;
}

std::vector<FittedCurvatures> estimate_vertex_curvatures(const PointSet& mesh, const CurvatureOptions& options,
                                                         Progress& progress) {
  options.validate();
  if (mesh.normals.size() != mesh.size()) throw DataError("curvatures need normals; the mesh has none");
  if (mesh.triangles.empty()) throw DataError("there are no triangles: estimate the curvatures of the cloud instead");
  const PositionGraph graph(mesh);
  CurvatureChoice choice{static_cast<std::size_t>(options.neighbours.value_or(0)), CurvatureSurface::quadric};
  if (!options.bandwidth && !options.neighbours) choice = choose_on_mesh(mesh, graph, options);
  const auto enough = static_cast<std::size_t>(kMostOfNeighbours * static_cast<double>(choice.neighbours));
  const double within = options.bandwidth ? detail::kReachOverWidth * *options.bandwidth : 0;
  std::vector<FittedCurvatures> result(mesh.size());
  progress.begin("curvatures", mesh.size());
  parallel_ranges(0, mesh.size(), kLeastShare + mesh.size() / kShares, [&](std::size_t begin, std::size_t end) {
    RingWalk walk(graph);
    VertexFitter fitter(options);
    std::vector<Vec3> offsets;
    for (std::size_t v = begin; v < end; ++v) {
      const Vec3 normal = graph.normal[v];
      if (graph.representative[v] != v || !(squared_norm(normal) > 0)) continue;
      const Vec3 x(mesh.positions[v]);
      const auto fit = [&](int rings, CurvatureSurface surface) {
        const auto& around = walk.around(
            static_cast<std::uint32_t>(v), options.bandwidth ? mesh.size() : enough,
            [&](std::uint32_t w) { return !options.bandwidth || norm(Vec3(mesh.positions[w]) - x) <= within; }, rings);
        offsets.clear();
        if (surface == CurvatureSurface::quartic) offsets.emplace_back();  // the vertex itself
        double reach = 0;
        for (const std::uint32_t w : around) {
          if (!beside(graph, normal, w)) continue;
          offsets.push_back(Vec3(mesh.positions[w]) - x);
          reach = std::max(reach, norm(offsets.back()));
        }
        return fitter.fit(normal, offsets, options.bandwidth ? within : reach, surface);
      };
      using Surface = CurvatureSurface;
      if (choice.surface == Surface::directional) result[v] = fit(1, choice.surface);
      if (choice.exact) result[v] = fit(kLeastRings, Surface::quartic_through);
      if (!result[v].defined)
        result[v] = fit(kLeastRings, choice.surface == Surface::quartic ? choice.surface : Surface::quadric);
    }
    progress.advance(end - begin);
  });
  for (std::size_t v = 0; v < mesh.size(); ++v) result[v] = result[graph.representative[v]];
  progress.finish();
  return result;
}

}  // namespace sansmesh::inline v1
