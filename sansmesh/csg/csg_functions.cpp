#include "sansmesh/csg/csg_functions.h"

#include <limits>
#include <utility>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

using Kind = CsgParameter::Kind;
using Arguments = CsgArguments;

constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();
constexpr Vec3 kZ{0, 0, 1};

Solid make_box(const Arguments& a) {
  const bool corners = a["from"].given || a["to"].given;
  if (corners == a["size"].given || (corners && (!a["from"].given || !a["to"].given || a["center"].given)))
    throw ArgumentError("box: needs size= and optionally center=, or both from= and to=");
  const double r = a.number("r", 0);
  if (corners) return csg::box(a.vector("from"), a.vector("to"), r);
  const Vec3 center = a.vector("center"), half = a.vector("size") * 0.5;
  return csg::box(center - half, center + half, r);
}

Solid make_cylinder(const Arguments& a) {
  const Vec3 center = a.vector("center"), axis = a.vector("axis", kZ);
  if (!a["h"].given) return csg::cylinder(center, axis, a.number("r", 0));
  return csg::cylinder(center, axis, a.number("r", 0), a.number("h", 0));
}

Solid make_plane(const Arguments& a) {
  const Vec3 normal = a.vector("normal", kZ);
  if (!a["through"].given) return csg::half_space(normal, a.number("offset", 0));
  if (a["offset"].given) throw ArgumentError("plane: give offset= or through=, not both");
  return csg::half_space(normal, dot(a.vector("through"), normalized(normal)));
}

/// Blends depend slightly on the order: the first two are combined first, then the third with the result, and so on.
Solid combined(const Arguments& a, Solid (*pair)(const Solid&, const Solid&, double)) {
  const double r = a.number("r", 0);
  Solid result = a.solids[0];
  for (std::size_t i = 1; i < a.solids.size(); ++i) result = pair(result, a.solids[i], r);
  return result;
}

Solid make_union(const Arguments& a) {
  return a.number("r", 0) == 0 ? combine_all(a.solids, false) : combined(a, csg::unite);
}

Solid make_intersection(const Arguments& a) {
  return a.number("r", 0) == 0 ? combine_all(a.solids, true) : combined(a, csg::intersect);
}

Solid make_difference(const Arguments& a) {
  if (a.number("r", 0) == 0) return csg::subtract(a.solids[0], combine_all(std::span(a.solids).subspan(1), false));
  return combined(a, csg::subtract);
}

using Make = Solid (*)(const Arguments&);

CsgFunction primitive(const char* name, std::vector<CsgParameter> parameters, Make make) {
  return {name, 0, 0, std::move(parameters), make};
}

/// A function of one solid. `distances`: CsgFunction::distances.
CsgFunction of_one(const char* name, std::vector<CsgParameter> parameters, Make make, bool distances = false) {
  return {name, 1, 1, std::move(parameters), make, distances};
}

std::vector<CsgFunction> table() {
  const CsgParameter center{"center", Kind::vector}, axis{"axis", Kind::direction}, blend{"r"};
  const CsgParameter radius{"r", Kind::number, true};
  return {
      primitive("sphere", {radius, center},
                [](const Arguments& a) { return csg::sphere(a.vector("center"), a.number("r", 0)); }),
      primitive("box", {{"size", Kind::size}, center, blend, {"from", Kind::vector}, {"to", Kind::vector}}, make_box),
      primitive("cylinder", {radius, {"h"}, axis, center}, make_cylinder),
      primitive("cone", {radius, {"h", Kind::number, true}, {"top"}, axis, center},
                [](const Arguments& a) {
                  return csg::cone(a.vector("center"), a.vector("axis", kZ), a.number("r", 0), a.number("top", 0),
                                   a.number("h", 0));
                }),
      primitive("torus", {{"R", Kind::number, true}, radius, axis, center},
                [](const Arguments& a) {
                  return csg::torus(a.vector("center"), a.vector("axis", kZ), a.number("R", 0), a.number("r", 0));
                }),
      primitive("capsule", {radius, {"from", Kind::vector, true}, {"to", Kind::vector, true}},
                [](const Arguments& a) { return csg::capsule(a.vector("from"), a.vector("to"), a.number("r", 0)); }),
      primitive("plane", {{"normal", Kind::direction}, {"offset"}, {"through", Kind::vector}}, make_plane),
      {"union", 1, kAny, {blend}, make_union},
      {"intersection", 1, kAny, {blend}, make_intersection},
      {"difference", 2, kAny, {blend}, make_difference},
      of_one("complement", {}, [](const Arguments& a) { return csg::complement(a.solids[0]); }),
      of_one(
          "offset", {{"d", Kind::number, true}},
          [](const Arguments& a) { return csg::offset(a.solids[0], a.number("d", 0)); }, true),
      of_one(
          "shell", {{"t", Kind::number, true}, {"side", Kind::side}},
          [](const Arguments& a) { return csg::shell(a.solids[0], a.number("t", 0), a["side"].side); }, true),
      of_one("translate", {{"by", Kind::vector, true}},
             [](const Arguments& a) { return csg::translate(a.solids[0], a.vector("by")); }),
      of_one("rotate", {{"angle", Kind::number, true}, axis, center},
             [](const Arguments& a) {
               return csg::rotate(a.solids[0], a.vector("axis", kZ), a.number("angle", 0), a.vector("center"));
             }),
      of_one("scale", {{"factor", Kind::number, true}, center},
             [](const Arguments& a) { return csg::scale(a.solids[0], a.number("factor", 1), a.vector("center")); }),
      of_one("mirror", {{"normal", Kind::direction, true}, {"offset"}},
             [](const Arguments& a) { return csg::mirror(a.solids[0], a.vector("normal"), a.number("offset", 0)); })};
}

}  // namespace

const CsgArgument& CsgArguments::operator[](std::string_view name) const {
  std::size_t i = 0;
  while (i + 1 < values_.size() && name != function_.parameters[i].name) ++i;
  return values_[i];
}

double CsgArguments::number(std::string_view name, double otherwise) const {
  const CsgArgument& a = (*this)[name];
  return a.given ? a.number : otherwise;
}

Vec3 CsgArguments::vector(std::string_view name, const Vec3& otherwise) const {
  const CsgArgument& a = (*this)[name];
  return a.given ? a.vector : otherwise;
}

std::span<const CsgFunction> csg_functions() {
  static const std::vector<CsgFunction> all = table();
  return all;
}

Solid combine_all(std::span<const Solid> solids, bool intersection) {
  if (solids.size() == 1) return solids[0];
  const std::size_t half = solids.size() / 2;
  const Solid a = combine_all(solids.first(half), intersection), b = combine_all(solids.subspan(half), intersection);
  return intersection ? csg::intersect(a, b) : csg::unite(a, b);
}

}  // namespace sansmesh::inline v1
