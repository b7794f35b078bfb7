// sansmesh measure: area, volume, centre of mass, moments and size of a solid and of its parts.
#include "sansmesh/inspect.h"

#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <string>

#include "commands.h"
#include "mesh_words.h"
#include "option_groups.h"
#include "surface_input.h"

namespace sansmesh::cli {
namespace {

constexpr std::size_t kPrintedComponents = 20;  // components
constexpr std::size_t kListed = 1000;           // components in JSON

Json to_json(const Vec3& v) { return {v.x, v.y, v.z}; }

Json to_json(const BodyMeasures& b) {
  Json json = {{"triangles", b.triangles},
               {"closed", b.closed()},
               {"boundary_edges", b.boundary_edges},
               {"open_edges", b.open_edges},
               {"nonmanifold_edges", b.nonmanifold_edges},
               {"area", b.area},
               {"surface_center", to_json(b.surface_center)},
               {"box", {{"lower", to_json(b.box.lower)}, {"upper", to_json(b.box.upper)}}},
               {"volume", b.mass ? Json(b.mass->volume) : Json()},
               {"center_of_mass", b.mass ? to_json(b.mass->center) : Json()},
               {"principal_moments", b.mass ? Json(b.mass->moments) : Json()},
               {"principal_axes", Json()},
               {"surrounding_winding_number", b.surrounding}};
  if (b.mass) json["principal_axes"] = {to_json(b.mass->axes[0]), to_json(b.mass->axes[1]), to_json(b.mass->axes[2])};
  return json;
}

/// Adding 0 turns -0 into 0.
std::string place(const Vec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x + 0.0, p.y + 0.0, p.z + 0.0); }

std::string sides(double a, double b, double c) { return fmt::format("{:.6g} × {:.6g} × {:.6g}", a, b, c); }

void run_measure(const CloudInput& input, Console& console) {
  const SurfaceInput opened = open_surface(input, console);
  const std::string& file = opened.surface.name();
  const MeasureResult made = measure(opened.surface, console.progress());
  const SolidMeasures& m = made.measures;
  console.progress().finish();
  console.note(file, made.notes);

  const BodyMeasures& w = m.whole;
  console.say(fmt::format("{}: {} vertices, {}", file, grouped(m.topology.vertices), counted(w.triangles, "triangle")));
  console.say(fmt::format("{:<18}{}", "topology", topology_words(m.topology)));
  console.say(fmt::format("{:<18}{:.8g}", "area", w.area));
  if (w.mass) {
    const MassMeasures& mass = *w.mass;
    console.say(fmt::format("{:<18}{:.8g}", "volume", mass.volume));
    console.say(fmt::format("{:<18}{}", "centre of mass", place(mass.center)));
    for (std::size_t k = 0; k < 3; ++k)
      console.say(fmt::format("{:<18}{:.6g} about {}", k == 0 ? "principal moments" : "", mass.moments[k],
                              place(mass.axes[k])));
  } else {
    console.say(fmt::format("{:<18}{}", "centre of surface", place(w.surface_center)));
  }
  const Vec3 size = w.box.size();
  console.say(fmt::format("{:<18}{} from {} to {}", "box", sides(size.x, size.y, size.z), place(w.box.lower),
                          place(w.box.upper)));
  const auto& box = m.smallest_box;
  console.say(fmt::format("{:<18}{} along {}, {}, {}", "smallest box", sides(box.sizes[0], box.sizes[1], box.sizes[2]),
                          place(box.axes[0]), place(box.axes[1]), place(box.axes[2])));
  if (m.components.size() > 1) {
    console.say(fmt::format("{:<10} {:>12} {:>14} {:>14}  {}", "component", "triangles", "area", "volume", "centre"));
    for (std::size_t i = 0; i < std::min(kPrintedComponents, m.components.size()); ++i) {
      const BodyMeasures& b = m.components[i];
      console.say(fmt::format("{:<10} {:>12} {:>14.6g} {:>14}  {}", i, grouped(b.triangles), b.area,
                              b.mass ? fmt::format("{:.6g}", b.mass->volume) : "not closed",
                              place(b.mass ? b.mass->center : b.surface_center)));
    }
    if (m.components.size() > kPrintedComponents)
      console.say(fmt::format("… {} more", grouped(m.components.size() - kPrintedComponents)));
  }
  console.say("(lengths in the unit of the input; moments about the centre of mass, for density 1)");

  Json json = {{"input", opened.json}, {"topology", topology_json(m.topology)}, {"whole", to_json(w)}};
  json["smallest_box"] = {{"sizes", box.sizes},
                          {"axes", {to_json(box.axes[0]), to_json(box.axes[1]), to_json(box.axes[2])}},
                          {"center", to_json(box.center)}};
  json["left_out_triangles"] = m.left_out;
  json["crossing_pairs"] = m.crossing_pairs;
  json["crossing_components"] = m.crossing_components;
  json["component_count"] = m.components.size();
  json["components"] = Json::array();
  for (std::size_t i = 0; i < std::min(kListed, m.components.size()); ++i)
    json["components"].push_back(to_json(m.components[i]));
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_measure(CommandLine& app) {
  CommandLine& c = app.add_subcommand("measure", "Mesh or function → area, volume, centre of mass, moments, size");
  auto input = std::make_shared<CloudInput>();
  c.add_option(
       "input", input->files,
       "Mesh, function (.smf) or DATA[NAME=VALUE] of a volume (their mesh is measured); several meshes are one body")
      .type_name("FILE")
      .required();
  c.footer(
      "Volumes need a closed surface. Borders that lie on each other, edge on edge, count as joined. Components are\n"
      "listed with --json, up to a thousand of them.\n\n"
      "Examples:\n"
      "  sansmesh measure part.ply\n"
      "  sansmesh measure part.stl --json");
  return {&c, [input](Console& console) { run_measure(*input, console); }};
}

}  // namespace sansmesh::cli
