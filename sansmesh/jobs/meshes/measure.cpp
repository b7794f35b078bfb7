#include "sansmesh/attribute_table.h"
#include "sansmesh/inspect.h"
#include "sansmesh/measure/body_measures.h"
#include "sansmesh/triangle_mesh.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/mesh/topology_words.h"

namespace sansmesh::inline v1 {
namespace {

/// Numbers of components that need a note.
struct OddComponents {
  std::size_t cavities = 0, inside_out = 0, nested = 0;

  explicit OddComponents(const SolidMeasures& m) {
    for (const BodyMeasures& b : m.components) {
      const bool inward = b.mass && b.mass->volume < 0;
      cavities += inward && !b.misplaced();
      inside_out += inward && b.misplaced();
      nested += !inward && b.misplaced();
    }
  }
};

std::string components_that(std::size_t count, const char* one, const char* several) {
  return count == 1 ? fmt::format("1 component {}", one) : fmt::format("{} components {}", grouped(count), several);
}

void add_measure_notes(const SolidMeasures& m, std::vector<Note>& notes) {
  const auto note = [&](const char* code, std::string text, std::string remedy = {}) {
    notes.push_back({.code = code, .text = std::move(text), .remedy = std::move(remedy)});
  };
  if (!m.whole.closed()) note("open", open_words(m.topology) + ": no volume, centre of mass and moments of the whole");
  // Compares with a sphere of the same area, whose volume is area^1.5 / 10.6.
  if (m.whole.mass && std::abs(m.whole.mass->volume) < 1e-9 * std::pow(m.whole.area, 1.5))
    note("encloses_nothing", "encloses nothing: opposite faces coincide and cancel out");
  else if (m.whole.mass && m.whole.mass->volume < 0)
    note("faces_inward", "the triangles face inward: the volume is negative");
  const OddComponents odd(m);
  if (odd.cavities > 0)
    note("cavities", components_that(odd.cavities, "faces", "face") + " inward: cavities, whose volume is subtracted");
  if (odd.inside_out > 0 && m.components.size() > 1)
    note("inside_out",
         components_that(odd.inside_out, "faces", "face") + " inward and bounds no cavity: the volume is subtracted",
         "reverse its faces if they are inside out");
  if (odd.nested > 0)
    note("nested", components_that(odd.nested, "is", "are") +
                       " within another that also faces outward: the volume there counts more than once");
  if (m.crossing_components > 0)
    note("crossing_components",
         components_that(m.crossing_components, "cuts", "cut") +
             " through another: their common volume counts more than once",
         "the union 'A | B' of closed meshes counts it once");
  else if (m.crossing_pairs > 0)
    note("crosses_itself", fmt::format("intersects itself at {} of triangles: overlapping volume counts more than once",
                                       counted(m.crossing_pairs, "pair")));
  if (m.whole.nonmanifold_edges > 0)
    note("nonmanifold", fmt::format("{} with more than two triangles", counted(m.whole.nonmanifold_edges, "edge")));
  if (m.left_out > 0) note("bad_corners", fmt::format("{} with bad corners dropped", counted(m.left_out, "triangle")));
}

}  // namespace

MeasureResult measure(const AnySurface& surface, Progress& progress) {
  MeasureResult result;
  const std::shared_ptr<const TriangleMesh> mesh = surface.mesh(progress, result.notes);
  if (mesh->triangles.empty())
    throw DataError(surface.name() + ": has no faces to measure: reconstruct a surface first");
  progress.begin("measure");
  result.measures = with_name(surface.name(), [&] { return measure_solid(*mesh); });
  add_measure_notes(result.measures, result.notes);
  return result;
}

namespace {

constexpr std::size_t kPrintedComponents = 20;

std::string sides(double a, double b, double c) { return fmt::format("{:.6g} × {:.6g} × {:.6g}", a, b, c); }

void add_components(const std::vector<BodyMeasures>& components, std::vector<std::string>& lines) {
  if (components.size() < 2) return;
  lines.push_back(fmt::format("{:<10} {:>12} {:>14} {:>14}  {}", "component", "triangles", "area", "volume", "centre"));
  for (std::size_t i = 0; i < std::min(kPrintedComponents, components.size()); ++i) {
    const BodyMeasures& b = components[i];
    lines.push_back(fmt::format("{:<10} {:>12} {:>14.6g} {:>14}  {}", i, grouped(b.triangles), b.area,
                                b.mass ? fmt::format("{:.6g}", b.mass->volume) : "not closed",
                                point_words(b.mass ? b.mass->center : b.surface_center)));
  }
  if (components.size() > kPrintedComponents)
    lines.push_back(fmt::format("… {} more", grouped(components.size() - kPrintedComponents)));
}

}  // namespace

std::vector<std::string> summary_of(const SolidMeasures& m) {
  const BodyMeasures& w = m.whole;
  std::vector<std::string> lines;
  const auto line = [&](const char* title, const std::string& text) { lines.push_back(titled(title, text, 18)); };
  line("topology", topology_words(m.topology));
  line("area", fmt::format("{:.8g}", w.area));
  if (w.mass) {
    line("volume", fmt::format("{:.8g}", w.mass->volume));
    line("centre of mass", point_words(w.mass->center));
    for (std::size_t k = 0; k < 3; ++k)
      line(k == 0 ? "principal moments" : "",
           fmt::format("{:.6g} about {}", w.mass->moments[k], point_words(w.mass->axes[k])));
  } else {
    line("centre of surface", point_words(w.surface_center));
  }
  const Vec3 size = w.box.size();
  line("box", fmt::format("{} from {} to {}", sides(size.x, size.y, size.z), point_words(w.box.lower),
                          point_words(w.box.upper)));
  const OrientedBox& box = m.smallest_box;
  line("smallest box", fmt::format("{} along {}, {}, {}", sides(box.sizes[0], box.sizes[1], box.sizes[2]),
                                   point_words(box.axes[0]), point_words(box.axes[1]), point_words(box.axes[2])));
  add_components(m.components, lines);
  return lines;
}

}  // namespace sansmesh::inline v1
