#include "sansmesh/mesh/edit/smooth_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/matrix3.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/data/triangles.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/edit/mesh_noise.h"
#include "sansmesh/mesh/repair/position_edges.h"
#include "sansmesh/mesh/vertex_corners.h"
#include "sansmesh/mesh_measures.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kMostIterations = 10000;
/// Amounts for noise of n edge lengths: shortest remaining wave in edges; rounds of the filter before the normals are
/// filtered, and of this.
double wave_for(double n) { return 2.7 + 12 * std::min(n, 1.0); }
int rounds_before_normals(double n) { return index_in<int>(std::round(50 * (n - 0.08)), 0, 40); }
int rounds_of_normals(double n) { return index_in<int>(std::round(22 * n), 1, 9); }
constexpr double kNoNoise = 0.06;  // below this noise in edges, fewer rounds
/// With longer steps the filter would amplify waves of two edges.
constexpr double kMostStrength = 0.65;
/// Pass band: lower frequencies (of at most 2) are kept.
constexpr double kPassBand = 0.1;
/// Ratio of the pass-band limit to the halved frequency, and exponent that halves it.
constexpr double kPassOverHalf = 1.0 / 3;
constexpr double kHalving = 0.6931 / 6;
/// Bounds of a cotangent: limit the influence of slivers.
constexpr double kLeastCotangent = 0.05, kMostCotangent = 5;
/// Rounds in which vertices are fitted to the normals of their triangles.
constexpr int kFollowRounds = 20;
/// Ratio of the crease angle to the noise of angles between triangles, and its bounds in degrees.
constexpr double kCreaseOverNoise = 2.5, kLeastCrease = 12, kMostCrease = 35;
/// Volume correction: repeated if this share is missing, until this tolerance, up to a limit of rounds.
constexpr double kFewPercent = 0.03, kKeptVolume = 1e-6;
constexpr int kMostCorrections = 60;
/// Least mean squared sine between a direction and the planes around a vertex for moving the vertex in that direction.
constexpr double kLeastTurn = 0.02;
constexpr double kRadians = std::numbers::pi / 180;

double cotangent_at(const Vec3& corner, const Vec3& a, const Vec3& b) {
  const Vec3 u = a - corner, v = b - corner;
  const double sine = norm(cross(u, v));
  return sine > 0 ? std::clamp(dot(u, v) / sine, kLeastCotangent, kMostCotangent) : kLeastCotangent;
}

/// Mesh with coincident vertices identified, and data common to all filters.
struct SmoothState {
  TriangleMesh& mesh;
  PositionEdges edges;
  Vec3 middle;
  std::vector<Vec3> x, start;  // positions of the representatives, relative to `middle`
  std::vector<std::uint8_t> used, border, stays;
  // Neighbours of each representative with weights; for moving borders only those on the border.
  std::vector<std::uint32_t> first, neighbour;
  std::vector<double> weight;

  explicit SmoothState(TriangleMesh& m) : mesh(m), edges(edges_by_position(m)), middle(bounds(m).center()) {
    const std::size_t n = mesh.vertices.size();
    x.resize(n), used.resize(n), border.resize(n), stays.resize(n);
    for (std::size_t v = 0; v < n; ++v) x[v] = Vec3(mesh.vertices[v]) - middle;
    start = x;
  }

  void find_borders(bool move_borders) {
    std::vector<std::uint8_t> border_edges(x.size());
    for (const PositionEdges::Edge& e : edges.edges) {
      used[e.a] = used[e.b] = 1;
      if (e.count == 2) continue;
      for (const std::uint32_t v : {e.a, e.b}) {
        border[v] = 1;
        if (e.count > 2) stays[v] = 1;
        if (border_edges[v] < 3) ++border_edges[v];
      }
    }
    for (std::size_t v = 0; v < x.size(); ++v)
      if (border[v] && (!move_borders || border_edges[v] != 2)) stays[v] = 1;
  }

  double edge_weight(const PositionEdges::Edge& e) const {
    double sum = 0;
    for (std::uint32_t k = 0; k < e.count; ++k) {
      const std::uint32_t corner = edges.corners[e.first + k];
      const Triangle& t = mesh.triangles[corner / 3];
      sum += cotangent_at(x[edges.representative[t[(corner + 2) % 3]]], x[e.a], x[e.b]);
    }
    return sum;
  }

  void find_neighbours() {
    first.assign(x.size() + 1, 0);
    const auto counts = [&](std::uint32_t v, std::uint32_t w, const PositionEdges::Edge& e) {
      return !stays[v] && (!border[v] || (e.count == 1 && border[w]));
    };
    for (const PositionEdges::Edge& e : edges.edges) {
      if (counts(e.a, e.b, e)) ++first[e.a + 1];
      if (counts(e.b, e.a, e)) ++first[e.b + 1];
    }
    for (std::size_t v = 0; v < x.size(); ++v) first[v + 1] += first[v];
    neighbour.resize(first.back()), weight.resize(first.back());
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (const PositionEdges::Edge& e : edges.edges) {
      const double w = edge_weight(e);
      for (const auto& [v, other] : {std::pair(e.a, e.b), std::pair(e.b, e.a)})
        if (counts(v, other, e)) neighbour[next[v]] = other, weight[next[v]++] = border[v] ? 1 : w;
    }
  }

  /// x + step (mean of the neighbours − x).
  void step(double size, std::vector<Vec3>& moved) {
    moved.resize(x.size());
    parallel_for(0, x.size(), 4096, [&](std::size_t v) {
      Vec3 sum;
      double all = 0;
      for (std::uint32_t k = first[v]; k < first[v + 1]; ++k) {
        sum += x[neighbour[k]] * weight[k];
        all += weight[k];
      }
      moved[v] = all > 0 ? x[v] + (sum / all - x[v]) * size : x[v];
    });
    x.swap(moved);
  }

  Vec3 at(std::size_t triangle, std::size_t k) const { return x[edges.representative[mesh.triangles[triangle][k]]]; }
};

double mean_length(const SmoothState& s) {
  double sum = 0;
  for (const PositionEdges::Edge& e : s.edges.edges) sum += norm(s.x[e.a] - s.x[e.b]);
  return s.edges.edges.empty() ? 0 : sum / static_cast<double>(s.edges.edges.size());
}

/// Weighted mean square of the distances to the neighbours.
double mean_square_reach(const SmoothState& s) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t v = 0; v < s.x.size(); ++v) {
    double squares = 0, all = 0;
    for (std::uint32_t k = s.first[v]; k < s.first[v + 1]; ++k) {
      squares += s.weight[k] * squared_norm(s.x[s.neighbour[k]] - s.x[v]);
      all += s.weight[k];
    }
    if (all > 0) sum += squares / all, ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

/// Displacement of each vertex if the planes of its triangles move outward by one: along the normal, and farther at
/// creases. No displacement in directions that the planes do not determine.
std::vector<Vec3> steps_of_planes(const SmoothState& s) {
  struct Sums {
    Vec3 a, b, c, right;
    double area = 0;
  };
  std::vector<Sums> sums(s.x.size());
  for (std::size_t i = 0; i < s.mesh.triangles.size(); ++i) {
    if (!has_valid_corners(s.mesh.vertices, s.mesh.triangles[i])) continue;
    const Vec3 doubled = cross(s.at(i, 1) - s.at(i, 0), s.at(i, 2) - s.at(i, 0)), n = normalized(doubled);
    const double area = norm(doubled);
    for (const std::uint32_t corner : s.mesh.triangles[i]) {
      Sums& v = sums[s.edges.representative[corner]];
      v.a += n * (n.x * area), v.b += n * (n.y * area), v.c += n * (n.z * area);
      v.right += doubled;
      v.area += area;
    }
  }
  std::vector<Vec3> steps(s.x.size());
  for (std::size_t v = 0; v < steps.size(); ++v) {
    const Sums& of = sums[v];
    if (!(of.area > 0)) continue;
    const double least = kLeastTurn * of.area;
    steps[v] = Matrix3{of.a + Vec3{least, 0, 0}, of.b + Vec3{0, least, 0}, of.c + Vec3{0, 0, least}}.solve(of.right);
  }
  return steps;
}

/// Components of the mesh, and the components that still lack volume.
struct Bodies {
  std::vector<std::uint32_t> of;  // component of each representative
  std::vector<std::uint8_t> lacks;

  explicit Bodies(const SmoothState& s) : of(s.x.size()) {
    UnionFind joined(s.x.size());
    for (const PositionEdges::Edge& e : s.edges.edges) joined.join(e.a, e.b);
    std::vector<std::uint32_t> number(s.x.size(), 0);
    for (std::size_t v = 0; v < s.x.size(); ++v) {
      std::uint32_t& own = number[joined.find(static_cast<std::uint32_t>(v))];
      if (own == 0 && s.used[v]) lacks.push_back(1), own = static_cast<std::uint32_t>(lacks.size());
      of[v] = own;  // 0: not used by a triangle
    }
    lacks.insert(lacks.begin(), 0);
  }
};

/// Moves the vertices of each component that lacks volume by the same distance along the normals (with `creases`, along
/// the planes of its triangles), which restores the volume to first order. Components that lacked a smaller share than
/// `kept` are finished.
void restore_volumes_once(SmoothState& s, const std::vector<Vec3>& before, bool creases, double kept, Bodies& bodies) {
  std::vector<Vec3> gradient(s.x.size());
  std::vector<double> lost(bodies.lacks.size(), 0), wanted(lost), sum(lost);
  const auto volume = [&](const std::vector<Vec3>& x, const Triangle& t) {
    return dot(x[t[0]], cross(x[t[1]], x[t[2]])) / 6;
  };
  for (Triangle t : s.mesh.triangles) {
    if (!has_valid_corners(s.mesh.vertices, t)) continue;
    for (std::uint32_t& v : t) v = s.edges.representative[v];
    const std::uint32_t b = bodies.of[t[0]];
    const double there = volume(before, t);
    lost[b] += there - volume(s.x, t);
    wanted[b] += there;
    const Vec3 doubled = cross(s.x[t[1]] - s.x[t[0]], s.x[t[2]] - s.x[t[0]]);
    for (const std::uint32_t v : t) gradient[v] += doubled / 6;
  }
  std::vector<Vec3> steps;
  if (creases) steps = steps_of_planes(s);
  for (std::size_t v = 0; v < s.x.size(); ++v)
    sum[bodies.of[v]] += creases ? dot(gradient[v], steps[v]) : norm(gradient[v]);
  for (std::size_t b = 0; b < sum.size(); ++b)
    if (!(sum[b] > 0) || wanted[b] == 0) bodies.lacks[b] = 0;
  for (std::size_t v = 0; v < s.x.size(); ++v) {
    const std::uint32_t b = bodies.of[v];
    if (bodies.lacks[b]) s.x[v] += (creases ? steps[v] : normalized(gradient[v])) * (lost[b] / sum[b]);
  }
  for (std::size_t b = 0; b < sum.size(); ++b)
    if (bodies.lacks[b] && std::abs(lost[b] / wanted[b]) < kept) bodies.lacks[b] = 0;
}

/// Restores each component separately, since the loss depends on its noise. One step suffices for fine meshes; coarse
/// ones lose so much that the first step overshoots.
void restore_volume(SmoothState& s, const std::vector<Vec3>& before, bool creases) {
  Bodies bodies(s);
  restore_volumes_once(s, before, creases, kFewPercent, bodies);
  for (int k = 0; k < kMostCorrections; ++k) {
    if (std::find(bodies.lacks.begin(), bodies.lacks.end(), 1) == bodies.lacks.end()) return;
    restore_volumes_once(s, before, creases, kKeptVolume, bodies);
  }
}

/// Triangles of representatives; {0, 0, 0} for those without area.
std::vector<Triangle> triangles_by_position(const SmoothState& s) {
  std::vector<Triangle> by_position(s.mesh.triangles.size());
  for (std::size_t i = 0; i < by_position.size(); ++i) {
    if (!has_valid_corners(s.mesh.vertices, s.mesh.triangles[i])) continue;
    if (!(squared_norm(cross(s.at(i, 1) - s.at(i, 0), s.at(i, 2) - s.at(i, 0))) > 0)) continue;
    for (std::size_t k = 0; k < 3; ++k) by_position[i][k] = s.edges.representative[s.mesh.triangles[i][k]];
  }
  return by_position;
}

void alternate(SmoothState& s, double there, double pass, int rounds, Progress& progress) {
  const double back = 1 / (1 / there - pass);
  std::vector<Vec3> moved;
  for (int i = 0; i < rounds; ++i) {
    s.step(there, moved);
    s.step(-back, moved);
    progress.advance();
  }
}

void filter_waves(SmoothState& s, const SmoothOptions& options, bool closed, SmoothReport& report, Progress& progress) {
  double pass = kPassBand;
  int steps = options.iterations.value_or(1);
  const double there = options.strength;
  if (const double reach = mean_square_reach(s); !options.iterations && reach > 0) {
    const double noise = report.noise / std::max(report.mean_edge, 1e-300);
    const double length = options.shorter_than.value_or(wave_for(noise) * report.mean_edge);
    // Response of a wave: Σ w (1 − cos(ω·d)), averaged over all directions.
    const double half = std::min(std::pow(std::numbers::pi / length, 2) * reach, 0.9);
    pass = kPassOverHalf * half;
    const double back = 1 / (1 / there - pass);
    const double wanted = kHalving / (there * back * pass * pass);
    report.shortened = wanted > kMostIterations;
    const double share = options.shorter_than ? 1 : std::min(1.0, noise * noise / (kNoNoise * kNoNoise));
    steps = index_in<int>(std::round(share * wanted), 1, kMostIterations);
  }
  report.iterations = steps;
  progress.begin("smooth", static_cast<std::size_t>(steps));
  alternate(s, there, pass, steps, progress);
  if (closed) restore_volume(s, s.start, false);
}

/// Normals, centres and areas of the triangles.
struct FaceNormals {
  std::vector<Vec3> normal, center;
  std::vector<double> area;

  void measure(const SmoothState& s) {
    const std::size_t n = s.mesh.triangles.size();
    normal.resize(n), center.resize(n), area.resize(n);
    parallel_for(0, n, 4096, [&](std::size_t i) {
      if (!has_valid_corners(s.mesh.vertices, s.mesh.triangles[i])) return;
      const Vec3 a = s.at(i, 0), b = s.at(i, 1), c = s.at(i, 2), doubled = cross(b - a, c - a);
      center[i] = (a + b + c) / 3;
      area[i] = norm(doubled) / 2;
      normal[i] = normalized(doubled);
    });
  }
};

/// The median angle between triangles with a common edge is noise, as long as most edges are not creases.
double crease_from_noise(const SmoothState& s, const FaceNormals& faces) {
  std::vector<double> angles;
  for (const PositionEdges::Edge& e : s.edges.edges) {
    if (e.count != 2) continue;
    const Vec3 &a = faces.normal[s.edges.corners[e.first] / 3], &b = faces.normal[s.edges.corners[e.first + 1] / 3];
    angles.push_back(std::atan2(norm(cross(a, b)), dot(a, b)));
  }
  return std::clamp(kCreaseOverNoise * median(angles) / kRadians, kLeastCrease, kMostCrease);
}

void filter_normals(SmoothState& s, const SmoothOptions& options, bool closed, SmoothReport& report,
                    Progress& progress) {
  const std::size_t n = s.mesh.triangles.size();
  const double noise = report.noise / std::max(report.mean_edge, 1e-300);
  const int before = rounds_before_normals(noise);
  const int rounds = options.iterations.value_or(rounds_of_normals(noise));
  report.iterations = rounds;
  progress.begin("smooth", static_cast<std::size_t>(before + rounds) + kFollowRounds);
  alternate(s, options.strength, kPassBand, before, progress);  // noisy normals tell nothing about creases
  FaceNormals faces;
  faces.measure(s);
  report.crease_angle = options.crease_angle.value_or(crease_from_noise(s, faces));
  const double width = 2 * std::sin(report.crease_angle * kRadians / 2);
  const std::vector<Triangle> by_position = triangles_by_position(s);
  const VertexCorners corners(by_position, s.x.size());
  double apart = 0;
  std::size_t pairs = 0;
  for (const PositionEdges::Edge& e : s.edges.edges)
    if (e.count == 2) {
      apart += norm(faces.center[s.edges.corners[e.first] / 3] - faces.center[s.edges.corners[e.first + 1] / 3]);
      ++pairs;
    }
  const double reach = pairs > 0 && apart > 0 ? apart / static_cast<double>(pairs) : 1;

  std::vector<Vec3> next(n);
  for (int round = 0; round < rounds; ++round) {
    parallel_for(0, n, 1024, [&](std::size_t i) {
      Vec3 sum = faces.normal[i] * faces.area[i];
      if (faces.area[i] > 0)
        for (const std::uint32_t v : by_position[i])
          for (std::uint32_t c = corners.first[v]; c < corners.first[v + 1]; ++c) {
            const std::uint32_t j = corners.entries[c] / 3;
            // A triangle that shares an edge occurs twice, at both of its vertices, and so has a larger weight.
            if (j == i || faces.area[j] == 0) continue;
            const double there = squared_norm(faces.center[j] - faces.center[i]) / (2 * reach * reach);
            const double turned = squared_norm(faces.normal[j] - faces.normal[i]) / (2 * width * width);
            sum += faces.normal[j] * (faces.area[j] * std::exp(-there - turned));
          }
      next[i] = normalized(sum);
    });
    faces.normal.swap(next);
    progress.advance();
  }
  std::vector<Vec3> moved(s.x.size());
  for (int round = 0; round < kFollowRounds; ++round) {
    parallel_for(0, n, 4096, [&](std::size_t i) {
      if (faces.area[i] > 0) faces.center[i] = (s.at(i, 0) + s.at(i, 1) + s.at(i, 2)) / 3;
    });
    parallel_for(0, s.x.size(), 2048, [&](std::size_t v) {
      moved[v] = s.x[v];
      if (s.stays[v] || s.border[v]) return;
      Vec3 sum;
      double count = 0;
      for (std::uint32_t c = corners.first[v]; c < corners.first[v + 1]; ++c) {
        const std::uint32_t j = corners.entries[c] / 3;
        if (faces.area[j] == 0) continue;
        sum += faces.normal[j] * dot(faces.normal[j], faces.center[j] - s.x[v]);
        count += 1;
      }
      if (count > 0) moved[v] += sum / count;
    });
    s.x.swap(moved);
    progress.advance();
  }
  if (closed) restore_volume(s, s.start, true);
}

}  // namespace

const OptionSchema& SmoothOptions::schema() {
  using O = SmoothOptions;
  static constexpr OptionRow rows[] = {
      option<&O::iterations>({.text = "Rounds", .from_data = "from the noise", .range = {1, kMostIterations}}),
      option<&O::strength>({.text = "Step length of a round", .unit = "share", .range = positive(kMostStrength)}),
      option<&O::shorter_than>({.text = "Remove shorter wavelengths than this, instead of `iterations`",
                                .unit = "length",
                                .range = positive(),
                                .old_name = "length"}),
      option<&O::creases>({.text = "Preserve creases: smooth the face normals and fit the vertices to them"}),
      option<&O::crease_angle>({.text = "With `creases`: largest angle between faces that are smoothed together",
                                .unit = "degrees",
                                .from_data = "from the noise",
                                .range = {1, 90},
                                .needs = "creases"}),
      option<&O::borders>({.text = "Also smooth borders, along themselves; otherwise they stay fixed"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void SmoothOptions::validate() const {
  validate_options(*this);
  if (shorter_than && iterations) throw ArgumentError("`shorter_than` determines `iterations`: set only one of them");
  if (shorter_than && creases) throw ArgumentError("`shorter_than` has no effect with `creases`");
  if (borders && creases) throw ArgumentError("`borders` has no effect with `creases`: borders stay fixed");
}

SmoothReport smooth_mesh(TriangleMesh& mesh, const SmoothOptions& options, Progress& progress) {
  options.validate();
  progress.begin("prepare");
  SmoothReport report;
  SmoothState s(mesh);
  s.find_borders(options.borders);
  report.mean_edge = mean_length(s);
  // Seams are not boundaries: measures the mesh with coincident vertices joined.
  const auto measure = [&](double& area) {
    TriangleMesh joined;
    joined.vertices = mesh.vertices;
    for (std::size_t v = 0; v < s.x.size(); ++v) joined.vertices[v] = Vec3f(s.x[v]);
    for (const Triangle& t : mesh.triangles)
      if (has_valid_corners(mesh.vertices, t))
        joined.triangles.push_back(
            {s.edges.representative[t[0]], s.edges.representative[t[1]], s.edges.representative[t[2]]});
    std::erase_if(joined.triangles, [](const Triangle& t) { return !has_distinct_corners(t); });
    const MeshQuality q = measure_quality(joined);
    area = q.area;
    return measure_topology(joined).closed() ? std::optional(q.volume) : std::nullopt;
  };
  report.volume_before = measure(report.area_before);
  s.find_neighbours();
  report.noise = report.mean_edge * detail::noise_in_edges(s.x, triangles_by_position(s), s.first, s.neighbour);
  if (options.creases)
    filter_normals(s, options, report.volume_before.has_value(), report, progress);
  else
    filter_waves(s, options, report.volume_before.has_value(), report, progress);
  double squares = 0;
  for (std::size_t v = 0; v < s.x.size(); ++v) {
    if (!s.used[v]) continue;
    ++report.vertices;
    report.fixed += s.stays[v] || (options.creases && s.border[v]);
    const double move = norm(s.x[v] - s.start[v]);
    squares += move * move;
    report.largest_move = std::max(report.largest_move, move);
  }
  if (report.vertices > 0) report.rms_move = std::sqrt(squares / static_cast<double>(report.vertices));
  report.volume_after = measure(report.area_after);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (s.used[s.edges.representative[v]]) mesh.vertices[v] = Vec3f(s.x[s.edges.representative[v]] + s.middle);
  if (!mesh.normals.empty()) detail::renew_normals(mesh);
  progress.finish();
  return report;
}

namespace {

constexpr ReportRow kSmoothReportRows[] = {
    reported<&SmoothReport::vertices>(
        {.name = "input.vertices", .text = "Vertices that triangles use; coincident ones count once"}),
    reported<&SmoothReport::mean_edge>(
        {.name = "input.mean_edge", .text = "Mean length of the edges before", .unit = "length"}),
    reported<&SmoothReport::noise>(
        {.name = "input.noise", .text = "Estimated noise along the normals, before", .unit = "length"}),
    reported<&SmoothReport::iterations>({.text = "Rounds performed", .unit = "rounds"}),
    reported<&SmoothReport::rms_move>(
        {.name = "moved.rms", .text = "Displacement of the vertices, root mean square", .unit = "length"}),
    reported<&SmoothReport::largest_move>(
        {.name = "moved.max", .text = "Largest displacement of a vertex", .unit = "length"}),
    reported<&SmoothReport::fixed>(
        {.name = "moved.fixed", .text = "Fixed vertices, at borders and edges of three triangles"}),
    reported<&SmoothReport::area_before>({.name = "area.before", .text = "Area before", .unit = "length²"}),
    reported<&SmoothReport::area_after>({.name = "area.after", .text = "Area after", .unit = "length²"}),
    reported<&SmoothReport::volume_before>(
        {.name = "volume.before", .text = "Volume before, of closed meshes", .unit = "length³"}),
    reported<&SmoothReport::volume_after>(
        {.name = "volume.after", .text = "Volume after, of closed meshes", .unit = "length³"}),
    reported<[](const SmoothReport& r) { return value_if(r.crease_angle > 0, r.crease_angle); }>(
        {.name = "crease_angle_deg", .text = "Least angle of edges preserved as creases", .unit = "degrees"})};

}  // namespace

const ReportSchema& SmoothReport::schema() {
  static constexpr ReportSchema schema{kSmoothReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
