// Fuzz target: for any cloud from a reader, the steps of `info`, `normals` and `reconstruct` end with finite numbers
// and a valid mesh, or with a one-line error. The input is a shape with a few hundred samples and changes of single
// samples, so that few bytes make clouds that are not noise.
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/io/points/assemble_points.h"
#include "sansmesh/mesh/repair/sewn_mesh.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/model/surface_method.h"
#include "sansmesh/points/cleaning/duplicates.h"
#include "sansmesh/points/normals/normals.h"
#include "sansmesh/points/normals/sensor_directions.h"
#include "sansmesh/points/orientation/orientation.h"
#include "sansmesh/points/shape/cloud_shape.h"
#include "sansmesh/points/statistics/noise.h"
#include "sansmesh/points/statistics/spacing.h"
#include "sansmesh/reconstruct.h"
#include "sansmesh/triangulation/block_tree.h"
#include "target.h"

using namespace sansmesh;
using fuzz::ByteReader;
using fuzz::demand;

namespace {

constexpr std::size_t kMostPoints = 400, kMostChanges = 200;

struct Sample {
  Vec3 place, normal;
};

/// Sample `i` of `n` of one of several shapes of size about 1.
Sample sample_of(std::size_t shape, std::size_t i, std::size_t n) {
  constexpr double kGolden = 2.399963229728653;
  const double t = (static_cast<double>(i) + 0.5) / static_cast<double>(n);
  const double angle = kGolden * static_cast<double>(i), z = 1 - 2 * t, r = std::sqrt(1 - z * z);
  const Vec3 round{r * std::cos(angle), r * std::sin(angle), z};
  const auto row = static_cast<double>(i / 16), column = static_cast<double>(i % 16);
  switch (shape) {
    case 0:
      return {round, round};
    case 1:  // a sheet
      return {{column / 16, row / 16, 0}, {0, 0, 1}};
    case 2:  // terrain
      return {{column / 16, row / 16, 0.2 * std::sin(column) * std::cos(row)}, {0, 0, 1}};
    case 3: {  // a cube
      const double most = std::max({std::abs(round.x), std::abs(round.y), std::abs(round.z)});
      const Vec3 normal = most == std::abs(round.x)   ? Vec3{round.x, 0, 0}
                          : most == std::abs(round.y) ? Vec3{0, round.y, 0}
                                                      : Vec3{0, 0, round.z};
      return {round / most, normalized(normal)};
    }
    case 4:  // two balls
      return {round * (i % 2 == 0 ? 1.0 : 0.1) + Vec3{i % 2 == 0 ? 0.0 : 3.0, 0, 0}, round};
    case 5:  // two sheets close together
      return {{column / 16, row / 16, i % 2 == 0 ? 0.0 : 1e-3}, {0, 0, i % 2 == 0 ? -1.0 : 1.0}};
    case 6:  // a line
      return {{t, 2 * t, -t}, {0, 1, 0}};
    default:
      return {{}, {}};
  }
}

/// The cloud as a reader makes it of arbitrary positions. Throws FileError.
PointSet read_cloud(ByteReader& in, const std::string& name, ReadReport& report) {
  const std::size_t shape = in.below(9), n = 1 + in.take<std::uint16_t>() % kMostPoints;
  const std::size_t normals = in.below(5);
  const double scale = in.scale(), off = in.scale(), noise = in.below(32) / 256.0, steps = in.below(8);
  const bool far = in.flag();
  std::vector<Sample> samples(n);
  std::uint32_t random = 1;
  const auto jitter = [&] {
    random = random * 1664525u + 1013904223u;
    return noise * (static_cast<double>(random >> 8) / (1 << 24) - 0.5);
  };
  for (std::size_t i = 0; i < n; ++i) {
    samples[i] = sample_of(shape, i, n);
    Vec3& p = samples[i].place;
    p = p + Vec3{jitter(), jitter(), jitter()};
    if (steps > 0)
      for (std::size_t k = 0; k < 3; ++k) p[k] = std::round(p[k] * 4 * steps) / (4 * steps);
    p = p * scale + (far ? Vec3{off, -off, off} : Vec3{});
  }
  for (std::size_t k = 0; k < kMostChanges && !in.at_end(); ++k) {
    Sample& s = samples[in.take<std::uint16_t>() % n];
    switch (in.below(4)) {
      case 0:
        s.place = in.place();
        break;
      case 1:
        s.place = s.place + in.place() * scale;
        break;
      case 2:
        s.place = samples[in.take<std::uint16_t>() % n].place;
        break;
      default:
        s.normal = in.place();
    }
  }
  PointSet points;
  const io::Input input{name, {}, report};
  io::store_positions(input, points, n, [&](std::size_t i) { return samples[i].place; });
  if (normals > 0)
    for (std::size_t i = 0; i < n; ++i) {
      const double sign = normals == 2 || (normals == 3 && i % 3 == 0) ? -1 : 1;
      points.normals.push_back(normals == 4 && i % 5 != 0 ? Vec3f{} : Vec3f(samples[i].normal * sign));
    }
  io::finish(input, points);
  return points;
}

/// Runs the steps of `info`, which must not throw.
void inform(const PointSet& points) {
  demand(count_unique(points) <= points.size(), "more different points than points");
  classify_shape(points);
  const double spacing = estimate_spacing(points);
  const NoiseEstimate noise = measure_noise(points);
  demand(std::isfinite(spacing) && spacing >= 0, "the spacing is not finite");
  demand(std::isfinite(noise.deviation) && noise.deviation >= 0, "the noise is not finite");
  demand(std::isfinite(noise.most) && std::isfinite(noise.step), "what is known of the noise is not finite");
  fuzz::check_message(noise_words(noise, spacing));
  const OrientationReport o = measure_orientation(points, noise.deviation);
  for (const double share : {o.agreement, o.related, o.outward, o.inward, o.open})
    demand(share >= 0 && share <= 1 + 1e-9, "a share of the normals is no share");
  first_known_orientation(points, noise.deviation);
  for (const OrientBy by : kOrientationOrder)
    for (const Vec3f& sight : find_own_sensor_directions(points, by, noise.deviation))
      demand(is_finite(sight), "a direction to where a sample was seen from is not finite");
}

void estimate(PointSet points, NormalOptions options) {
  if (count_unique(points) < 3) return;
  options.spacing = estimate_spacing(points);
  options.noise = measure_noise(points).deviation;
  Progress progress;
  estimate_normals(points, options, progress);
  fuzz::ends_well([&] { orient_normals(points, {}, progress); });
  fuzz::check_points(points);
  for (const Vec3f& normal : points.normals)
    demand(normal == Vec3f{} || std::abs(norm(Vec3(normal)) - 1) < 1e-4, "a normal is not unit");
}

void check_mesh(const TriangleMesh& mesh, bool closed) {
  const std::size_t n = mesh.vertices.size();
  demand(is_finite(mesh.origin), "the origin of a mesh is not finite");
  for (const Vec3f& v : mesh.vertices) demand(is_finite(v), "a vertex is not finite");
  for (const Vec3f& v : mesh.normals) demand(is_finite(v), "a normal of a mesh is not finite");
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) demand(v < n, "a triangle of vertices that are not there");
  const MeshTopology topology = measure_topology(mesh);
  demand(topology.manifold() && topology.oriented(), "a mesh is not manifold");
  demand(!closed || topology.closed(), "a mesh that is to be closed is not");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string name = "fuzz.file";
  const ThreadScope one(1);
  ByteReader in(data, size);
  const std::vector<const SurfaceMethod*> methods = SurfaceMethod::registry().all();
  const std::size_t step = in.below(8), method = in.below(methods.size());
  const std::uint8_t bits = in.take<std::uint8_t>();
  ReadReport report;
  PointSet points;
  if (!fuzz::ends_well([&] { points = read_cloud(in, name, report); })) return 0;
  fuzz::check_points(points);
  if (step == 0) {
    inform(points);
  } else if (step == 1) {
    NormalOptions options;
    options.method = bits & 1 ? NormalOptions::Method::covariance : NormalOptions::Method::jet;
    options.reweightings = bits & 2 ? 2 : 0;
    if (bits & 4) options.neighbours = 6 + bits % 32;
    estimate(std::move(points), options);
  } else {
    ReconstructOptions options;
    options.mesh.block_depth = kLeastDepth + bits % 3;
    if (step == 7) options.surface = {.method = std::string(methods[method]->name)};
    if (!options.other_surface()) options.fit.depth = kLeastDepth + bits / 4 % 3;
    if (!options.other_surface() && (bits & 16) != 0) options.fit.open = (bits & 32) != 0;
    options.cloud.remove_outliers = (bits & 64) != 0;
    options.mesh.components.kind = (bits & 128) != 0 ? ComponentChoice::Kind::all : ComponentChoice::Kind::automatic;
    fuzz::ends_well([&] {
      Progress progress;
      const auto [mesh, made, notes] = reconstruct(std::move(points), options, progress);
      check_mesh(mesh, !options.other_surface() && !made.open);
      demand(std::isfinite(made.spacing) && std::isfinite(made.noise) && std::isfinite(made.mesh_error) &&
                 std::isfinite(made.mean_winding_number) && std::isfinite(made.open_share) && std::isfinite(made.lost),
             "a number of the report is not finite");
      for (const Note& note : notes) fuzz::check_message(note.text);
    });
  }
  return 0;
}
