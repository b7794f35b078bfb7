#include "sansmesh/meshing/mesh_steps.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/largest_first.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/mesh_coverage.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/meshing/narrow_handles.h"
#include "sansmesh/points/remedies.h"
#include "sansmesh/points/sampling/sample_colors.h"
#include "sansmesh/points/shape/cloud_shape.h"
#include "sansmesh/points/statistics/sample_confidence.h"

namespace sansmesh::inline v1::detail {
namespace {

/// Small components are removed, and those whose samples support less than this fraction of their area (a part may be
/// scanned more sparsely than others).
constexpr double kSupported = 0.02;
/// Number of samples that suffice to estimate the components' shares.
constexpr std::size_t kSupportSamples = 100000;
/// On open surfaces, a component with this many samples is kept.
constexpr double kSeen = 5;
/// A component is also kept if this many samples support at least this fraction of its area and would otherwise be far
/// from the surface: a small solid, or the tip of a thin one. In a cloud, fewer might be stray samples.
constexpr double kSolidOfFaces = 8, kSolidOfCloud = 50, kOfSamples = 0.25;
/// Area of the largest component in question, in squared spacings, below which it has too few samples for that.
constexpr double kLeastOfCloud = 10;
/// Fraction of samples without a surface above which a warning is given.
constexpr double kMuchLost = 0.01;
/// Quadric error of the simplification over the mesh error: by default, and for a requested mesh error.
constexpr double kSimplify = 0.22, kCoarseSimplify = 1.8;
/// By default, large meshes are not simplified if fewer than this fraction of the vertices could be removed initially:
/// they are fine because the surface is curved everywhere, and simplification would take as long as all other steps.
constexpr double kLeastGain = 0.35;
constexpr std::size_t kManyBlocks = 100000;

/// For each of n points the component nearest to it.
std::vector<std::uint32_t> nearest_components(const TriangleMesh& mesh, const MeshComponents& components, std::size_t n,
                                              const std::function<Vec3f(std::size_t)>& at) {
  std::vector<std::uint32_t> of_vertex(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const std::uint32_t v : mesh.triangles[i]) of_vertex[v] = components.of_triangle[i];
  const KdTree vertices(mesh.vertices);
  std::vector<std::uint32_t> nearest(n);
  parallel_for(0, n, 1024, [&](std::size_t i) {
    const auto found = vertices.nearest(at(i));
    nearest[i] = found ? of_vertex[found->index] : 0;
  });
  return nearest;
}

/// A regular subset of the samples, with the nearest component of each.
struct SampledComponents {
  std::size_t stride = 1;
  std::vector<std::uint32_t> nearest;
};

SampledComponents sample_components(const TriangleMesh& mesh, const MeshComponents& components,
                                    const PointSet& points) {
  const std::size_t stride = 1 + points.size() / kSupportSamples;
  const Vec3f shift(points.origin - mesh.origin);
  return {stride, nearest_components(mesh, components, (points.size() + stride - 1) / stride,
                                     [&](std::size_t i) { return points.positions[i * stride] + shift; })};
}

/// Supported area of each component: the number of samples nearest to it times the area that each represents.
std::vector<double> supported_area(const SampledComponents& samples, std::size_t components, double spacing) {
  std::vector<std::size_t> count(components, 0);
  for (const std::uint32_t c : samples.nearest) ++count[c];
  std::vector<double> area(components);
  for (std::size_t c = 0; c < components; ++c)
    area[c] = static_cast<double>(count[c] * samples.stride) * spacing * spacing;
  return area;
}

/// Adds components without which samples would have no surface.
void choose_solids(const TriangleMesh& mesh, const MeshComponents& components, const PointSet& points, double spacing,
                   const SampledComponents& samples, const std::vector<double>& supported,
                   std::vector<std::uint8_t>& chosen) {
  const double least = points.of_faces ? kSolidOfFaces : kSolidOfCloud;
  std::vector<std::uint8_t> asked(components.size(), 0);
  for (std::size_t k = 0; k < asked.size(); ++k)
    asked[k] =
        !chosen[k] && supported[k] >= least * spacing * spacing && supported[k] >= kOfSamples * components.area[k];
  if (std::find(asked.begin(), asked.end(), 1) == asked.end()) return;
  TriangleMesh kept;
  kept.origin = mesh.origin;
  kept.vertices = mesh.vertices;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (chosen[components.of_triangle[i]]) kept.triangles.push_back(mesh.triangles[i]);
  PointSet theirs;
  theirs.origin = points.origin;
  std::vector<std::uint32_t> of;
  for (std::size_t i = 0; i < samples.nearest.size(); ++i) {
    if (!asked[samples.nearest[i]]) continue;
    theirs.positions.push_back(points.positions[i * samples.stride]);
    of.push_back(samples.nearest[i]);
  }
  const std::vector<std::uint8_t> lost = far_samples(kept, theirs, lost_beyond(spacing, 0));
  std::vector<std::size_t> count(components.size(), 0);
  for (std::size_t i = 0; i < of.size(); ++i) count[of[i]] += lost[i];
  for (std::size_t k = 0; k < asked.size(); ++k)
    if (asked[k] && static_cast<double>(count[k] * samples.stride) >= least) chosen[k] = 1;
}

/// The triangles of two meshes with a common origin.
TriangleMesh both(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh mesh;
  mesh.origin = a.origin;
  mesh.reference = a.reference;
  mesh.vertices = a.vertices;
  mesh.vertices.insert(mesh.vertices.end(), b.vertices.begin(), b.vertices.end());
  mesh.triangles = a.triangles;
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  for (const auto& [u, v, w] : b.triangles) mesh.triangles.push_back({first + u, first + v, first + w});
  return mesh;
}

}  // namespace

std::vector<std::size_t> count_nearest(const TriangleMesh& mesh, const MeshComponents& components, std::size_t n,
                                       const std::function<Vec3f(std::size_t)>& at) {
  std::vector<std::size_t> count(components.size(), 0);
  for (const std::uint32_t c : nearest_components(mesh, components, n, at)) ++count[c];
  return count;
}

std::vector<std::uint8_t> chosen_components(const TriangleMesh& mesh, const MeshComponents& components,
                                            const ComponentChoice& choice, const PointSet& points, double spacing,
                                            bool open) {
  const std::size_t count = components.size();
  if (choice.kind == ComponentChoice::Kind::all || count < 2) return std::vector<std::uint8_t>(count, 1);
  std::vector<double> supported = components.area;
  const bool seen = open && points.size() > 0;
  const bool solids = points.size() > 0 && choice.kind == ComponentChoice::Kind::automatic &&
                      (points.of_faces || components.area[1] >= kLeastOfCloud * spacing * spacing);
  SampledComponents samples;
  if (seen || solids || (points.size() > 0 && components.area[1] >= kSmallComponent * components.area[0])) {
    samples = sample_components(mesh, components, points);
    supported = supported_area(samples, count, spacing);
  }
  std::size_t kept = 0;
  std::vector<std::uint8_t> chosen(count, 0);
  const std::vector<std::uint32_t> order = largest_first(supported);
  for (const std::uint32_t k : order) {
    const bool automatic = choice.kind == ComponentChoice::Kind::automatic;
    if (!automatic && kept == static_cast<std::size_t>(choice.count)) break;
    const double small = seen ? std::min(kSeen * spacing * spacing, kSmallComponent * supported[order[0]])
                              : kSmallComponent * supported[order[0]];
    if (automatic && kept > 0 && (supported[k] < small || supported[k] < kSupported * components.area[k])) continue;
    chosen[k] = 1;
    ++kept;
  }
  if (solids) choose_solids(mesh, components, points, spacing, samples, supported, chosen);
  return chosen;
}

void choose_components(TriangleMesh& mesh, const ComponentChoice& choice, const PointSet& points, double spacing,
                       MeshReport& report, TriangleMesh* left_out) {
  const MeshComponents components = find_components(mesh);
  const std::size_t count = components.size();
  const std::vector<std::uint8_t> chosen = chosen_components(mesh, components, choice, points, spacing, report.open);
  const auto kept = static_cast<std::size_t>(std::count(chosen.begin(), chosen.end(), 1));
  report.components = static_cast<int>(kept);
  if (kept == count) return;
  std::vector<std::uint8_t> keep(mesh.triangles.size());
  for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = chosen[components.of_triangle[i]];
  if (left_out) {
    std::vector<std::uint8_t> others(keep.size());
    for (std::size_t i = 0; i < keep.size(); ++i) others[i] = !keep[i];
    *left_out = mesh;
    keep_triangles(*left_out, others);
  }
  keep_triangles(mesh, keep);
  if (choice.kind == ComponentChoice::Kind::automatic)
    report.notes.push_back(
        with_remedy(remedy("parts_left_out", "components"),
                    counted(count - kept, "component") + " too small or too far from the samples left out"));
}

void carry_colors(TriangleMesh& mesh, const PointSet& points, const KdTree& samples) {
  mesh.colors.resize(mesh.vertices.size());
  parallel_for(0, mesh.vertices.size(), 2048, [&](std::size_t v) {
    const Vec3 color = mean_color(samples, points.colors, mesh.vertices[v]);
    for (std::size_t c = 0; c < 3; ++c) mesh.colors[v][c] = index_in<std::uint8_t>(color[c] + 0.5, 0, 255);
  });
}

PolygonizeOptions meshing_options(const MeshOptions& options, double mesh_error, bool creases) {
  PolygonizeOptions meshing;
  meshing.cluster = options.enhance;
  meshing.smoothing_rounds = options.enhance ? meshing.smoothing_rounds : 0;
  meshing.creases = creases;
  meshing.displacement = options.displacement;
  // Blocks have power-of-two sizes and isotropic triangles; only edge collapses adapt the triangles to the surface.
  // Elsewhere they cost more time than they save, so by default only the cheap ones run. A requested coarse mesh is
  // made from a finer one.
  if (options.enhance) {
    meshing.simplify = (options.mesh_error ? kCoarseSimplify : kSimplify) * mesh_error;
    meshing.triangles = options.triangles.value_or(0);
  }
  return meshing;
}

bool may_skip_simplification(std::size_t blocks, const MeshOptions& options) {
  return blocks > kManyBlocks && !options.mesh_error && !options.triangles;
}

TriangleMesh cut_out(const ScalarField& field, const BlockTree& blocks, const MeshOptions& options,
                     PolygonizeOptions meshing, Progress& progress, MeshReport& r) {
  r.blocks = blocks.leaves().size();
  if (may_skip_simplification(r.blocks, options)) meshing.least_gain = kLeastGain;
  if (options.measure_quality) {
    PolygonizeOptions plain = meshing;
    plain.cluster = false;
    plain.creases = false;
    plain.smoothing_rounds = 0;
    plain.simplify = 0;
    plain.triangles = 0;
    plain.displacement = 0;
    const MeshQuality before = measure_quality(polygonize(field, blocks, {}, plain, progress));
    r.aspect_mean_before = before.aspect_mean;
    r.aspect_deviation_before = before.aspect_deviation;
  }
  return polygonize(field, blocks, {}, meshing, progress);
}

void mark_confidence(TriangleMesh& mesh, const PointSet& points, double spacing, double noise, const LocalFrame& frame,
                     const MeshOptions& options, const MeshReport& r) {
  if (!options.confidence.value_or(r.open && points.size() > 0)) return;
  if (points.size() == 0) throw DataError("confidence needs the samples, which were not kept");
  std::vector<float> distance(mesh.vertices.size()), confidence(mesh.vertices.size());
  const Vec3f shift(mesh.origin - points.origin);
  std::vector<Vec3f> x = mesh.vertices;
  for (Vec3f& p : x) p += shift;
  SampleConfidence(points, spacing, noise).evaluate(x, distance, confidence);
  for (float& d : distance) d = static_cast<float>(frame.to_input(static_cast<double>(d)));
  mesh.attributes.set("distance", std::move(distance));
  mesh.attributes.set("confidence", std::move(confidence));
}

void report_lost(const TriangleMesh& mesh, const TriangleMesh& left_out, const PointSet& points, double spacing,
                 double noise, const LocalFrame& frame, MeshReport& report) {
  if (points.size() == 0) return;
  const FarPoints lost = find_lost(mesh, points, spacing, noise, kSupportSamples);
  report.lost = lost.share;
  if (report.lost <= kMuchLost) return;
  const Vec3 at = frame.to_input(*lost.densest);
  report.most_lost = at;
  const std::string text =
      fmt::format("{:.1f} % of the samples are far from the mesh, most of them around ({:.6g}, {:.6g}, {:.6g})",
                  100 * lost.share, at.x, at.y, at.z);
  const bool small_parts = !left_out.triangles.empty() &&
                           find_lost(both(mesh, left_out), points, spacing, noise, kSupportSamples).share <= kMuchLost;
  report.notes.push_back(small_parts ? with_remedy(remedy("lost_samples", "components"), text)
                                     : Note{.code = std::string(kLostSamples), .text = text});
}

Note* lost_samples(MeshReport& report) {
  for (Note& note : report.notes)
    if (note.code == kLostSamples) return &note;
  return nullptr;
}

Note too_many_triangles(std::size_t made, std::size_t requested) {
  return {.code = "more_triangles",
          .text = counted(made, "triangle") + " instead of " + grouped(requested) +
                  ": each part, hole and handle needs some"};
}

void report_handles(const NarrowHandles& handles, const LocalFrame& frame, MeshReport& report) {
  report.genus = handles.genus;
  report.closed_handles = handles.closed;
  report.narrow_handles = handles.narrow;
  if (handles.narrow == 0) return;
  const Vec3 at = frame.to_input(handles.narrowest);
  report.narrowest_handle = at;
  const bool one = handles.narrow == 1;
  report.notes.push_back(
      {.code = "narrow_handles",
       .text = fmt::format("{} {} narrower than two spacings or {} no samples around (genus {}), the narrowest around "
                           "({:.6g}, {:.6g}, {:.6g})",
                           counted(handles.narrow, "handle"), one ? "is" : "are", one ? "has" : "have", handles.genus,
                           at.x, at.y, at.z)});
}

void finish_mesh(TriangleMesh& mesh, const PointSet& points, double spacing, double noise, double mesh_error,
                 const LocalFrame& frame, const MeshOptions& options, MeshReport& r) {
  TriangleMesh left_out;
  choose_components(mesh, options.components, points, spacing, r, &left_out);
  report_handles(close_handles(mesh, points, spacing, noise, options.close_handles), frame, r);
  if (options.carry_colors && points.has_colors()) carry_colors(mesh, points, KdTree(points.positions));
  if (mesh.triangles.empty())
    throw DataError(
        classify_shape(points) == CloudShape::plane
            ? "all points lie in one plane: it bounds no solid, and only the open surface `partition` represents it"
            : "no surface was found near the samples");
  // A deliberately coarse mesh is far from its samples everywhere.
  if (!options.box && !options.triangles && !options.block_depth && !options.trim)
    report_lost(mesh, left_out, points, spacing, std::max(noise, mesh_error), frame, r);
  if (options.measure_quality) {
    const MeshQuality after = measure_quality(mesh);
    r.aspect_mean = after.aspect_mean;
    r.aspect_deviation = after.aspect_deviation;
  }
}

}  // namespace sansmesh::inline v1::detail
