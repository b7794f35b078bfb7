#include "sansmesh/function/update_mesh.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/function/function_cut.h"
#include "sansmesh/function/function_domain.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/mesh/edit/replace_region.h"
#include "sansmesh/meshing/mesh_steps.h"
#include "sansmesh/meshing/narrow_handles.h"

namespace sansmesh::inline v1 {
namespace {

/// Width of the remeshed region around a change, in edges of the largest block of the surface there: initially, and at
/// most after retries.
constexpr double kMargin = 2, kMostMargin = 64;
/// With a larger share of the surface, remeshing all of it is less work than patches, which may fail to fit.
constexpr double kMostWork = 0.5;
/// Regions are merged if their union is at most this many times larger.
constexpr double kGrowth = 1.2;
/// Vertices of old and new mesh are equal within this share of a triangle's edge.
constexpr double kSame = 0.1;
/// Least share of the triangles off the changes that must agree; otherwise the patches were not made like the mesh.
constexpr double kAgreement = 0.5;
/// Number of tested vertices of a mesh.
constexpr std::size_t kLookedAt = 30000;
/// Largest share of the vertices off the changes that may be off the surface in a mesh of the function, where it is
/// steep.
constexpr double kOff = 0.01;
/// Extent of a patch beyond its region, in blocks.
constexpr double kBeyond = 8;

/// Colours of the vertices of patches in some boxes, from the samples around these.
void color_patch(TriangleMesh& patch, const PointSet& samples, const std::vector<Box3f>& boxes) {
  PointSet near;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (any_contains(boxes, samples.positions[i])) {
      near.positions.push_back(samples.positions[i]);
      near.colors.push_back(samples.colors[i]);
    }
  if (near.size() > 0) detail::carry_colors(patch, near, KdTree(near.positions));
}

/// Edge of the largest block in a box through which the surface may pass.
double largest_block(const detail::FunctionCut& cut, const Box3& box) {
  const BlockTree& tree = cut.blocks;
  const double scale = static_cast<double>(1u << tree.depth()) / tree.edge();
  double largest = tree.edge() / static_cast<double>(1u << tree.depth());
  for (const Vec3& seed : cut.meshing.seeds) {
    if (!box.contains(seed)) continue;
    const Vec3 p = (seed - tree.lower()) * scale;
    const std::int64_t at = tree.find(tree.depth(), whole_part<std::int64_t>(p.x), whole_part<std::int64_t>(p.y),
                                      whole_part<std::int64_t>(p.z));
    if (at >= 0) largest = std::max(largest, tree.block_edge(static_cast<std::size_t>(at)));
  }
  return largest;
}

double mean_edge(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) sum += norm(Vec3(mesh.vertices[t[0]] - mesh.vertices[t[1]]));
  return mesh.triangles.empty() ? 0 : sum / static_cast<double>(mesh.triangles.size());
}

/// "34 %"; "100 %" only if it is exactly all.
std::string percent_of(double share) {
  const double percent = std::floor(1000 * share) / 10;
  return percent >= 10 || percent == 0 ? fmt::format("{:.0f} %", std::floor(percent))
                                       : fmt::format("{:.1f} %", percent);
}

/// A change, and the width of the remeshed region around it.
struct Pending {
  Box3 change;
  double edge;    ///< edge of the largest block there
  double margin;  ///< width, in such edges
  Box3 region() const { return widened(change, margin * edge); }
};

std::vector<Box3f> in_float(const std::vector<Box3>& boxes) {
  std::vector<Box3f> result;
  result.reserve(boxes.size());
  for (const Box3& b : boxes) result.push_back({Vec3f(b.lower), Vec3f(b.upper)});
  return result;
}

/// One update, in the coordinates of the field.
class Updating {
 public:
  Updating(const FittedFunction& function, const MeshOptions& options, TriangleMesh& mesh, Progress& progress,
           MeshUpdate& update)
      : function_(function),
        mesh_(mesh),
        progress_(progress),
        update_(update),
        cut_(detail::prepare_cut(function, options, default_mesh_error(function.field.report()))),
        ways_{cut_.meshing.simplify > 0} {
    // If it is unknown whether the mesh was simplified, both ways are tried and the agreeing one is kept.
    if (ways_[0] && detail::may_skip_simplification(cut_.blocks.leaves().size(), options)) ways_ = {false, true};
    cut_.blocks.balance();
  }

  /// False: the update failed (update.why), and the mesh is invalid.
  bool run(std::span<const Box3> changed) {
    std::vector<Pending> pending;
    pending.reserve(changed.size());
    for (const Box3& c : changed) pending.push_back({c, largest_block(cut_, c), kMargin});
    while (!pending.empty()) {
      std::vector<Box3> regions;
      regions.reserve(pending.size());
      for (const Pending& p : pending) regions.push_back(p.region());
      unite(regions, kGrowth);
      if (update_.regions == 0) update_.regions = separate_sets(regions);
      const std::vector<std::uint8_t> spoiled = exchange(regions, pending);
      std::vector<Pending> left;
      for (std::size_t k = 0; k < pending.size(); ++k)
        if (spoiled[k]) left.push_back(pending[k]);
      pending = std::move(left);
      for (Pending& p : pending) p.margin *= 2;
      if (!pending.empty() && (pending[0].margin > kMostMargin || share_of(pending) > kMostWork))
        return no_way(pending[0]);
    }
    return true;
  }

 private:
  /// Share of the surface, 0..1.
  double share_of(const std::vector<Pending>& pending) const {
    std::vector<Box3> regions;
    regions.reserve(pending.size());
    for (const Pending& p : pending) regions.push_back(p.region());
    const auto& seeds = cut_.meshing.seeds;
    const auto in = std::count_if(seeds.begin(), seeds.end(), [&](const Vec3& x) { return any_contains(regions, x); });
    return static_cast<double>(in) / static_cast<double>(std::max<std::size_t>(1, seeds.size()));
  }

  std::string no_agreement() const {
    return fmt::format("of the triangles around the changes only {} are as meshing without options makes them",
                       percent_of(agreement_));
  }

  bool no_way(const Pending& p) {
    update_.why = agreement_ < kAgreement ? no_agreement()
                                          : "no border was found along which old and new triangles meet, around " +
                                                point_words(function_.frame.to_input(p.change.center()), 9);
    return false;
  }

  /// Remeshes the surface in the regions, and joins it to the mesh where possible. Returns 1 for each change where it
  /// is not.
  std::vector<std::uint8_t> exchange(const std::vector<Box3>& regions, const std::vector<Pending>& pending) {
    std::vector<Box3f> changes;
    double widest = 0;
    for (const Pending& p : pending) {
      changes.push_back({Vec3f(p.change.lower), Vec3f(p.change.upper)});
      widest = std::max(widest, p.edge);
    }
    const std::vector<Box3f> sound = in_float(regions);
    std::vector<std::uint8_t> spoiled(pending.size(), 1);
    agreement_ = 0;
    for (const bool simplify : ways_) {
      PolygonizeOptions meshing = cut_.meshing;
      meshing.regions = regions;
      if (!simplify) meshing.simplify = 0;
      TriangleMesh patch = polygonize(function_.field, cut_.blocks, {}, meshing, progress_);
      const double spacing = function_.field.report().spacing;
      if (!mesh_.colors.empty() && function_.samples->has_colors()) {
        std::vector<Box3f> around;
        for (const Box3& r : regions) {
          const Box3 wide = widened(r, kBeyond * (widest + spacing));
          around.push_back({Vec3f(wide.lower), Vec3f(wide.upper)});
        }
        color_patch(patch, *function_.samples, around);
      }
      progress_.begin("join");
      const RegionReplacement r =
          replace_region(mesh_, patch, sound, changes, static_cast<float>(kSame * mean_edge(patch)), kAgreement);
      agreement_ = std::max(agreement_, r.agreement);
      if (r.agreement < kAgreement) continue;
      ways_ = {simplify};
      update_.removed += r.removed, update_.added += r.added;
      spoiled = r.spoiled;
      break;
    }
    return spoiled;
  }

  const FittedFunction& function_;
  TriangleMesh& mesh_;
  Progress& progress_;
  MeshUpdate& update_;
  detail::FunctionCut cut_;
  std::vector<bool> ways_;  ///< whether to simplify
  double agreement_ = 1;    ///< agreement of the last patches
};

/// False: the update failed (u.why), and the mesh is unchanged.
bool update_in_place(const FittedFunction& function, TriangleMesh& mesh, std::span<const Box3> changed,
                     const MeshOptions& options, Progress& progress, MeshUpdate& u) {
  const MeshMatch match = match_mesh(function, mesh, changed);
  const std::size_t off = match.vertices - match.on;
  if (static_cast<double>(off) > kOff * static_cast<double>(match.vertices)) {
    u.why = fmt::format("{} of {} vertices off the changes are not on the surface, the farthest at {}", grouped(off),
                        grouped(match.vertices), point_words(match.farthest_at, 9));
    return false;
  }
  // In the coordinates of the field.
  TriangleMesh moved = mesh;
  move_from_input(moved, function.frame);
  std::vector<Box3> changes;
  for (const Box3& c : changed) changes.push_back(function.frame.from_input(c));
  for (const Vec3& p : match.off) changes.push_back(function.frame.from_input(widened(Box3{p, p}, match.near)));
  unite(changes, kGrowth);
  if (!Updating(function, options, moved, progress, u).run(changes)) return false;
  if (moved.triangles.empty()) {
    u.why = "the result would be empty";
    return false;
  }
  MeshReport report;
  const PartitionReport& fit = function.field.report();
  detail::choose_components(moved, options.components, *function.samples, fit.spacing, report);
  detail::close_handles(moved, *function.samples, fit.spacing, fit.noise, options.close_handles);
  move_to_input(moved, function.frame);
  mesh = std::move(moved);
  return true;
}

/// Reason of the options or the function for remeshing everything; empty: none.
std::string why_whole(const FittedFunction& function, const MeshOptions& options) {
  if (is_walked(function, options)) return "it is meshed by a walk from all samples";
  if (options.triangles) return "a number of triangles applies to the whole mesh";
  if (options.trim || options.box) return "trimming and boxes apply to the whole mesh";
  if (options.measure_quality || options.confidence.value_or(false)) return "measurements apply to the whole mesh";
  if (FunctionDomain::needed(function, {})) return "the surface is open, and its border depends on all samples";
  return {};
}

}  // namespace

MeshMatch match_mesh(const FittedFunction& function, const TriangleMesh& mesh, std::span<const Box3> except) {
  const std::vector<Box3> left_out(except.begin(), except.end());
  std::vector<Vec3> x;
  const std::size_t stride = 1 + mesh.vertices.size() / kLookedAt;
  for (std::size_t v = 0; v < mesh.vertices.size(); v += stride) {
    const Vec3 p = mesh.origin + Vec3(mesh.vertices[v]);
    if (is_finite(p) && !any_contains(left_out, p)) x.push_back(function.frame.from_input(p));
  }
  MeshMatch match;
  match.vertices = x.size();
  const PartitionReport& report = function.field.report();
  const double near = std::max(report.spacing, 2 * report.noise);
  match.near = function.frame.to_input(near);
  if (x.empty()) return match;
  std::vector<double> f(x.size());
  std::vector<Vec3> g(x.size());
  function.field.evaluate(x, f, g);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double distance = std::abs(f[i]) / std::max(1.0, norm(g[i]));
    if (distance <= near)
      ++match.on;
    else
      match.off.push_back(function.frame.to_input(x[i]));
    if (distance <= match.farthest) continue;
    match.farthest = distance;
    match.farthest_at = function.frame.to_input(x[i]);
  }
  match.farthest = function.frame.to_input(match.farthest);
  return match;
}

TriangleMesh update_mesh(const FittedFunction& function, TriangleMesh before, std::span<const Box3> changed,
                         const MeshOptions& options, Progress& progress, MeshUpdate* update) {
  options.validate();
  MeshUpdate local;
  MeshUpdate& u = update ? *update : local;
  u = {};
  if (changed.empty()) {
    u.local = true;
    return before;
  }
  // Properties of the whole mesh can only be computed from the whole.
  u.why = why_whole(function, options);
  u.local = u.why.empty() && update_in_place(function, before, changed, options, progress, u);
  if (u.local) return before;
  u.removed = u.added = u.regions = 0;
  return mesh_function(function, options, progress);
}

namespace {

constexpr ReportRow kMeshUpdateRows[] = {
    reported<&MeshUpdate::local>({.text = "Whether only parts were remeshed"}),
    reported<&MeshUpdate::removed>({.text = "Triangles that were removed"}),
    reported<&MeshUpdate::added>({.text = "Triangles that were added"}),
    reported<&MeshUpdate::regions>({.text = "Separate regions that were remeshed"}),
    reported<[](const MeshUpdate& r) { return value_if(!r.why.empty(), r.why); }>(
        {.name = "why", .text = "Reason for remeshing all of it"})};

}  // namespace

const ReportSchema& MeshUpdate::schema() {
  static constexpr ReportSchema schema{kMeshUpdateRows};
  return schema;
}

}  // namespace sansmesh::inline v1
