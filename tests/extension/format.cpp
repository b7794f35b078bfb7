// A format of points: a line "triples", then one line "point X Y Z" per point.
#include <fmt/format.h>

#include <iterator>
#include <sstream>
#include <string>
#include <utility>

#include "sansmesh/io/formats.h"
#include "sansmesh/io/input.h"

namespace sansmesh::inline v1 {
namespace {

PointSet read_triples(const io::Input& in) {
  std::istringstream text{std::string(in.bytes)};
  std::string word;
  text >> word;
  if (word != "triples") in.fail("does not begin with 'triples'");
  PointSet points;
  while (text >> word) {
    Vec3f p;
    if (word != "point" || !(text >> p.x >> p.y >> p.z)) in.fail("a line is not 'point X Y Z'");
    points.positions.push_back(p);
  }
  if (points.positions.empty()) in.fail("holds no points");
  in.report.format = "triples";
  return points;
}

FileParts write_triples(const PointSet& points, const WriteOptions&) {
  std::string text = "triples\n";
  for (const Vec3f& p : points.positions) {
    const Vec3 at = points.origin + Vec3(p);
    fmt::format_to(std::back_inserter(text), "point {} {} {}\n", at.x, at.y, at.z);
  }
  return {std::move(text)};
}

const Registered<FormatInfo> triples({.name = "triples",
                                      .endings = "triples",
                                      .reads = kPoints,
                                      .written = {{{"triples", kPoints}}},
                                      .read_points = read_triples,
                                      .write_points = write_triples,
                                      .points_capacity = FormatCapacity::positions,
                                      .recognizes = [](std::string_view bytes) {
                                        return bytes.starts_with("triples");
                                      }});

}  // namespace
}  // namespace sansmesh::inline v1
