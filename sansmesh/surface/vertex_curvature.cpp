#include "sansmesh/surface/vertex_curvature.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>

#include "sansmesh/core/parallel.h"
#include "sansmesh/data/triangles.h"
#include "sansmesh/error.h"
#include "sansmesh/points/noise.h"
#include "sansmesh/points/sample_faces.h"
#include "sansmesh/search/equal_positions.h"
#include "sansmesh/surface/curvature_fit.h"

namespace sansmesh::inline v1 {
namespace {

using detail::CurvatureFitter;

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
  const std::vector<std::uint32_t>& around(std::uint32_t v, std::size_t enough, const Keep& keep) {
    if (++round_ == 0) std::fill(seen_.begin(), seen_.end(), 0), round_ = 1;
    found_.clear();
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
    for (int ring = 1; from < found_.size() && (ring < kLeastRings || found_.size() < enough); ++ring) {
      const std::size_t to = found_.size();
      for (; from < to; ++from) visit(found_[from]);
    }
    return found_;
  }

 private:
  const PositionGraph& graph_;
  std::vector<std::uint32_t> seen_, found_;
  std::uint32_t round_ = 0;
};

/// Fits all unknowns, and fewer if the neighbours do not determine them.
FittedCurvatures fit_fewer_and_fewer(std::span<CurvatureFitter* const> fitters, const Vec3& normal,
                                     std::span<const Vec3> offsets, double radius) {
  for (CurvatureFitter* const fitter : fitters) {
    fitter->start(normal);
    for (const Vec3& d : offsets) fitter->add(d);
    if (!fitter->fit(offsets.size(), radius)) continue;
    if (const FittedCurvatures found = fitter->curvatures(); found.defined) return found;
  }
  return {};
}

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
  std::size_t enough = 0;
  if (!options.bandwidth) {
    PointSet distinct;  // copies of a vertex would be all of its nearest neighbours
    for (std::size_t v = 0; v < mesh.size(); ++v)
      if (graph.representative[v] == v)
        distinct.positions.push_back(mesh.positions[v]), distinct.normals.push_back(Vec3f(graph.normal[v]));
    const int wanted = options.neighbours ? *options.neighbours
                                          : choose_curvature_neighbours(
                                                distinct, options.noise ? *options.noise : known_noise(distinct));
    enough = static_cast<std::size_t>(kMostOfNeighbours * wanted);
  }
  const double within = options.bandwidth ? detail::kReachOverWidth * *options.bandwidth : 0;
  CurvatureOptions through = options, given = options;
  through.offset = given.offset = given.refit_normal = false;
  std::vector<FittedCurvatures> result(mesh.size());
  progress.begin("curvatures", mesh.size());
  parallel_ranges(0, mesh.size(), kLeastShare + mesh.size() / kShares, [&](std::size_t begin, std::size_t end) {
    RingWalk walk(graph);
    CurvatureFitter all(options), no_offset(through), no_slopes(given);
    CurvatureFitter* const fitters[] = {&all, &no_offset, &no_slopes};
    std::vector<Vec3> offsets;
    for (std::size_t v = begin; v < end; ++v) {
      const Vec3 normal = graph.normal[v];
      if (graph.representative[v] != v || !(squared_norm(normal) > 0)) continue;
      const Vec3 x(mesh.positions[v]);
      const auto& around = walk.around(
          static_cast<std::uint32_t>(v), options.bandwidth ? mesh.size() : enough,
          [&](std::uint32_t w) { return !options.bandwidth || norm(Vec3(mesh.positions[w]) - x) <= within; });
      offsets.clear();
      double reach = 0;
      for (const std::uint32_t w : around) {
        if (dot(normal, graph.normal[w]) < kRoundTheRim) continue;
        offsets.push_back(Vec3(mesh.positions[w]) - x);
        reach = std::max(reach, norm(offsets.back()));
      }
      result[v] = fit_fewer_and_fewer(fitters, normal, offsets, options.bandwidth ? within : reach);
    }
    progress.advance(end - begin);
  });
  for (std::size_t v = 0; v < mesh.size(); ++v) result[v] = result[graph.representative[v]];
  progress.finish();
  return result;
}

}  // namespace sansmesh::inline v1
