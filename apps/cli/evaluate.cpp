// sansmesh evaluate: how good is a mesh?
#include <fmt/core.h>

#include <cmath>
#include <optional>
#include <utility>

#include "cloud_input.h"
#include "commands.h"
#include "mesh_words.h"
#include "option_groups.h"
#include "sansmesh/io/io.h"
#include "sansmesh/mesh/mesh_coverage.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/mesh/mesh_quality.h"
#include "sansmesh/mesh/sewn_mesh.h"
#include "sansmesh/points/face_shape.h"

namespace sansmesh::cli {
namespace {

struct EvaluateArguments {
  std::string surface;
  CloudInput reference;  ///< without files: none
  std::optional<std::size_t> samples;
};

constexpr std::size_t kSamples = 300'000, kSamplesOfOthers = 5'000;
constexpr double kOtherUnit = 100;  ///< surfaces that differ in size by more than this are not of the same thing

/// As many as asked for. From the middle of a much larger surface all of it is about as near, so that each sample there
/// costs as much as all of its triangles: a few tell as much.
std::size_t samples_of(const EvaluateArguments& a, const TriangleMesh& surface, const TriangleMesh& reference,
                       Console& console) {
  const double own = bounds(surface).diagonal(), other = bounds(reference).diagonal();
  const bool larger = own > other;
  const double ratio = larger ? own / other : other / own;
  if (!(ratio > kOtherUnit) || !std::isfinite(ratio)) return a.samples.value_or(kSamples);
  console.warn(a.surface, {fmt::format("{:.4g} times as {} as the reference: are both in the same unit?", ratio,
                                       larger ? "large" : "small")});
  return a.samples.value_or(kSamplesOfOthers);
}

Json to_json(const OneWayDistance& d) {
  return {{"samples", d.samples},
          {"mean", d.mean},
          {"rms", d.rms},
          {"p95", d.p95},
          {"max", d.max},
          {"angle_deg", d.angle},
          {"signed_angle_deg", d.signed_angle}};
}

/// Of what is open the volume depends on where it is measured from: null.
Json to_json(const MeshQuality& q, bool closed) {
  return {{"aspect_mean", q.aspect_mean},
          {"aspect_deviation", q.aspect_deviation},
          {"aspect_max", q.aspect_max},
          {"smallest_angle_mean_deg", q.smallest_angle_mean},
          {"smallest_angle_deg", q.smallest_angle},
          {"below_10_deg", q.small_angle_share},
          {"edge_mean", q.edge_mean},
          {"area", q.area},
          {"volume", closed ? Json(q.volume) : Json()}};
}

Json to_json(const FarPlaces& f) {
  return {{"share", f.share},
          {"looked_at", f.looked_at},
          {"beyond", f.beyond},
          {"most_around", f.most ? Json{f.most->x, f.most->y, f.most->z} : Json()}};
}

std::string share_of(const FarPlaces& f) {
  return f.share > 0 && f.share < 5e-5 ? "less than 0.01 %" : fmt::format("{:.2f} %", 100 * f.share);
}

std::string most_around(const FarPlaces& f) {
  return f.most ? fmt::format(", most of it around ({:.6g}, {:.6g}, {:.6g})", f.most->x, f.most->y, f.most->z) : "";
}

void say_coverage(const MeshCoverage& c, Console& console) {
  console.say(fmt::format("{:<16}{} of the samples: farther than {} from the mesh{}", "lost", share_of(c.lost),
                          length(c.lost.beyond), most_around(c.lost)));
  console.say(fmt::format("{:<16}{} of the area: farther than {} from every sample{}", "invented", share_of(c.invented),
                          length(c.invented.beyond), most_around(c.invented)));
}

void say_distance(const char* name, const OneWayDistance& d, const SurfaceDistance& both, Console& console) {
  const auto percent = [&](double x) { return fmt::format("{} ({:.4f} %)", length(x), both.percent(x)); };
  console.say(fmt::format("{:<16}mean {}, rms {}, 95 % below {}, max {}{}", name, percent(d.mean), percent(d.rms),
                          percent(d.p95), percent(d.max),
                          d.angle ? fmt::format(", normals {:.2f}° off", *d.angle) : ""));
}

void run_evaluate(const EvaluateArguments& arguments, Console& console) {
  require(!arguments.reference.files.empty() || !arguments.reference.classes,
          "--class and --without-class choose among the points of the reference");
  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  const TriangleMesh surface = to_mesh(read_points(arguments.surface, &read));
  console.warn(arguments.surface, read.warnings);
  TriangleMesh reference;
  PointSet samples;  // of the reference, where that is a cloud or a meshed scan
  if (!arguments.reference.files.empty()) {
    PointSet points = arguments.reference.read(console, read);
    if (!surface.triangles.empty() && (points.triangles.empty() || vertices_are_dense(points))) {
      samples.origin = points.origin;
      samples.positions = points.positions;
    }
    reference = to_mesh(std::move(points));
  }

  Json json;
  json["surface"] = {{"file", arguments.surface}};
  if (surface.triangles.empty()) {
    console.say(fmt::format("{}: {} without faces", arguments.surface, counted(surface.vertices.size(), "point")));
    json["surface"]["points"] = surface.vertices.size();
  } else {
    progress.begin("topology and quality");
    const SewnMesh sewn = sewn_mesh(surface);
    const MeshTopology t = sewn_topology(sewn);
    const MeshQuality q = measure_quality(sewn.mesh);
    console.say(
        fmt::format("{}: {} vertices, {}", arguments.surface, grouped(t.vertices), counted(t.triangles, "triangle")));
    console.say(fmt::format("{:<16}{}", "topology", topology_words(t)));
    console.say(
        fmt::format("{:<16}aspect ratio {:.3f} ± {:.3f} (worst {:.3g}), mean smallest angle {:.1f}°, "
                    "{:.3f} % of triangles below 10°",
                    "triangles", q.aspect_mean, q.aspect_deviation, q.aspect_max, q.smallest_angle_mean,
                    100 * q.small_angle_share));
    console.say(
        fmt::format("{:<16}area {}{}", "size", length(q.area), t.encloses() ? ", volume " + length(q.volume) : ""));
    json["topology"] = topology_json(t);
    json["quality"] = to_json(q, t.encloses());
  }
  if (!arguments.reference.files.empty()) {
    DistanceOptions options;
    options.samples = samples_of(arguments, surface, reference, console);
    const SurfaceDistance d = measure_distance(surface, reference, options, progress);
    say_distance("to reference", d.to_reference, d, console);
    say_distance("from reference", d.from_reference, d, console);
    console.say("(in brackets: % of the diagonal of the reference's bounding box)");
    json["reference"] = arguments.reference.json();
    json["reference"]["diagonal"] = d.diagonal;
    json["to_reference"] = to_json(d.to_reference);
    json["from_reference"] = to_json(d.from_reference);
    if (samples.size() > 0) {
      const MeshCoverage c = measure_coverage(surface, samples, options.samples, progress);
      say_coverage(c, console);
      json["coverage"] = {
          {"spacing", c.spacing}, {"noise", c.noise}, {"lost", to_json(c.lost)}, {"invented", to_json(c.invented)}};
    }
  }
  progress.finish();
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_evaluate(CommandLine& app) {
  CommandLine& c = app.add_subcommand("evaluate", "Mesh → distances to a reference, topology, shape of triangles");
  auto shared = std::make_shared<EvaluateArguments>();
  EvaluateArguments& a = *shared;
  c.add_option("mesh", a.surface, "Mesh or points").type_name("FILE").required();
  c.add_option("reference", a.reference.files, "Mesh or points to compare with; several (tiles) are read as one")
      .type_name("FILE");
  add_class_options(c, a.reference, " of the reference");
  c.add_option("--samples", a.samples, "Samples on each mesh [300000]").type_name("COUNT").within(1, 2000000000);
  c.footer(
      "To the reference: accuracy. From the reference: completeness. Normal angles are between planes, 0..90°.\n"
      "Where a side is a set of points, distances do not fall below half their spacing.\n"
      "Of the samples of a cloud or a meshed scan: lost, the share of them without a surface, farther from it than "
      "two\n"
      "spacings and four times the noise; invented, the share of the mesh's area farther than four spacings from "
      "all.\n\n"
      "Examples:\n"
      "  sansmesh evaluate surface.ply\n"
      "  sansmesh evaluate surface.ply scan.ply");
  return {&c, [shared](Console& console) { run_evaluate(*shared, console); }};
}

}  // namespace sansmesh::cli
