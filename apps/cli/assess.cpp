// sansmesh assess: how good is a mesh?
#include "sansmesh/inspect.h"

#include <fmt/core.h>

#include "cloud_input.h"
#include "commands.h"
#include "mesh_words.h"
#include "option_groups.h"
#include "sansmesh/io.h"
#include "schema_options.h"

namespace sansmesh::cli {
namespace {

struct AssessArguments {
  std::string surface;
  CloudInput reference;  ///< without files: none
  AssessOptions options;
};

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

void run_assess(const AssessArguments& arguments, Console& console) {
  require(!arguments.reference.files.empty() || !arguments.reference.classes,
          "--class and --without-class choose among the points of the reference");
  arguments.options.validate();
  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  const TriangleMesh surface = to_mesh(read_points(arguments.surface, &read));
  console.warn(arguments.surface, read.warnings);
  const AssessResult made = arguments.reference.files.empty()
                                ? assess(surface, progress)
                                : assess(surface, arguments.reference.read(console, read), arguments.options, progress);
  progress.finish();
  console.note(arguments.surface, made.notes);

  const AssessReport& r = made.report;
  Json json;
  json["surface"] = {{"file", arguments.surface}};
  if (!r.topology) {
    console.say(fmt::format("{}: {} without faces", arguments.surface, counted(r.vertices, "point")));
    json["surface"]["points"] = r.vertices;
  } else {
    const MeshTopology& t = *r.topology;
    const MeshQuality& q = *r.quality;
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
  if (r.distance) {
    const SurfaceDistance& d = *r.distance;
    say_distance("to reference", d.to_reference, d, console);
    say_distance("from reference", d.from_reference, d, console);
    console.say("(in brackets: % of the diagonal of the reference's bounding box)");
    json["reference"] = arguments.reference.json();
    json["reference"]["diagonal"] = d.diagonal;
    json["to_reference"] = to_json(d.to_reference);
    json["from_reference"] = to_json(d.from_reference);
  }
  if (r.coverage) {
    const MeshCoverage& c = *r.coverage;
    say_coverage(c, console);
    json["coverage"] = {
        {"spacing", c.spacing}, {"noise", c.noise}, {"lost", to_json(c.lost)}, {"invented", to_json(c.invented)}};
  }
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_assess(CommandLine& app) {
  CommandLine& c = app.add_subcommand("assess", "Mesh → distances to a reference, topology, shape of triangles");
  c.once_called("evaluate");
  auto shared = std::make_shared<AssessArguments>();
  AssessArguments& a = *shared;
  c.add_option("mesh", a.surface, "Mesh or points").type_name("FILE").required();
  c.add_option("reference", a.reference.files, "Mesh or points to compare with; several (tiles) are read as one")
      .type_name("FILE");
  add_class_options(c, a.reference, " of the reference");
  add_schema(c, a.options);
  c.footer(
      "To the reference: accuracy. From the reference: completeness. Normal angles are between planes, 0..90°.\n"
      "Where a side is a set of points, distances do not fall below half their spacing.\n"
      "Of the samples of a cloud or a meshed scan: lost, the share of them without a surface, farther from it than "
      "two\n"
      "spacings and four times the noise; invented, the share of the mesh's area farther than four spacings from "
      "all.\n\n"
      "Examples:\n"
      "  sansmesh assess surface.ply\n"
      "  sansmesh assess surface.ply scan.ply");
  return {&c, [shared](Console& console) { run_assess(*shared, console); }};
}

}  // namespace sansmesh::cli
