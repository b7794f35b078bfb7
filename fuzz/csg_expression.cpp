// Fuzz target: parsing any solid expression yields a consistent field, or a one-line error. Expressions of a few
// primitives are meshed too.
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/csg/parse_csg.h"
#include "sansmesh/field/piece_expression.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "target.h"

using namespace sansmesh;
using fuzz::demand;

namespace {

/// A field that is no primitive: a wavy ball, like a field from a file.
class WavyBall : public ScalarField {
 public:
  Box3 bounds() const override { return {{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}}; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double r = norm(x[i]);
      values[i] = r - 1 + 0.1 * std::sin(4 * x[i].x);
      if (!gradients.empty()) gradients[i] = (r > 0 ? x[i] / r : Vec3{}) + Vec3{0.4 * std::cos(4 * x[i].x), 0, 0};
    }
  }
};

Solid load(const std::string& name) {
  if (name.starts_with('f')) return csg::leaf(std::make_shared<WavyBall>());
  throw FileError(name, "no such file");
}

std::vector<Vec3> places_of(const Box3& box) {
  std::vector<Vec3> places{{0, 0, 0}, {1, 2, 3}, {-0.5, 0.25, 1e-9}, {1e6, -1e6, 1e6}, {1e150, 0, 0}};
  if (box.empty()) return places;
  for (const Vec3& corner : {box.lower, box.upper, box.center(), box.lower * 0.75 + box.upper * 0.25})
    if (is_finite(corner)) places.push_back(corner);
  return places;
}

/// Values and gradients are finite and independent of the batch; pieces and ranges agree with them.
void check_values(const Solid& solid) {
  const std::vector<Vec3> places = places_of(solid.bounds());
  const std::size_t n = places.size();
  std::vector<double> values(n);
  std::vector<Vec3> gradients(n);
  std::vector<std::uint32_t> active(n);
  std::vector<ValueRange> ranges(n);
  solid.evaluate(places, values, gradients);
  solid.active(places, active);
  solid.ranges(places, 0.5, ranges);
  const std::optional<double> slope = solid.slope_bound();
  const std::uint32_t pieces = solid.pieces();
  for (std::size_t i = 0; i < n; ++i) {
    const std::span<const Vec3> place(&places[i], 1);
    double value = 0, of_piece = 0;
    Vec3 gradient;
    solid.evaluate(place, {&value, 1}, {&gradient, 1});
    demand(std::isfinite(values[i]) && is_finite(gradients[i]), "a value or gradient is not finite");
    demand(value == values[i] && gradient == gradients[i], "a value depends on the batch");
    demand(!slope || norm(gradients[i]) <= *slope * (1 + 1e-9), "a gradient is steeper than the bound");
    demand(active[i] < pieces, "the active piece is none");
    solid.evaluate_piece(active[i], place, {&of_piece, 1}, {});
    const double rounding = 1e-9 * (std::abs(value) + norm(places[i]) + 1);
    demand(std::abs(of_piece - value) <= rounding, "the active piece has another value");
    demand(ranges[i].least <= value + rounding && ranges[i].most >= value - rounding, "a value is beyond its range");
  }
  std::vector<Surroundings> around(n);
  solid.survey(places, {1, 1}, values, around);
  demand(!(solid.thickness() < 0), "a thickness is negative");
}

void mesh(const Solid& solid) {
  CsgMeshOptions options;
  options.resolution = 8;
  const Box3 box = solid.bounds();
  if (box.empty() || !is_finite(box.lower) || !is_finite(box.upper)) options.box = Box3{{-2, -2, -2}, {2, 2, 2}};
  Progress progress;
  CsgMeshReport report;
  const TriangleMesh made = mesh_csg(solid, options, progress, &report);
  for (const Vec3f& v : made.vertices) demand(is_finite(v), "a vertex is not finite");
  demand(std::isfinite(report.area) && std::isfinite(report.volume), "area or volume are not finite");
  demand(report.closed == measure_topology(made).closed(), "the report calls an open mesh closed");
  for (const Note& note : report.notes) fuzz::check_message(note_line(note));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 2000) return 0;
  const ThreadScope one(1);
  const std::string text(reinterpret_cast<const char*>(data), size);
  fuzz::ends_well([&] {
    const Solid solid = parse_csg(text, load);
    if (solid.pieces() > 200) return;
    check_values(solid);
    if (const auto expression = solid.expression(1e-9)) demand(!expression->nodes().empty(), "an empty expression");
    if (size <= 60 && solid.pieces() <= 12) mesh(solid);
  });
  return 0;
}
