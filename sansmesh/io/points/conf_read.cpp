// Stanford .conf: range scans and the rigid motions that align them.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "sansmesh/io/names.h"
#include "sansmesh/io/points/assemble_points.h"
#include "sansmesh/io/points/columns.h"
#include "sansmesh/io/readers.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {
namespace {

struct Scan {
  std::string file;
  Vec3 translation;
  double q[4] = {0, 0, 0, 1};  ///< x y z w, unit
  PointSet points;
  ReadReport report;
  std::string error;
  bool missing = false;  ///< the file does not exist

  /// R(q)ᵀ v: these files store the inverse of the rotation to be applied.
  Vec3 rotate(const Vec3& v) const {
    const Vec3 u{-q[0], -q[1], -q[2]};  // transposed: conjugate
    const Vec3 t = cross(u, v) * 2.0;
    return v + t * q[3] + cross(u, t);
  }
};

std::vector<Scan> parse(const Input& in) {
  std::vector<Scan> scans;
  TextScanner text(in.bytes);
  std::uint64_t number = 0;
  while (!text.at_end()) {
    TextScanner words(text.line());
    ++number;
    const std::string_view key = words.word();
    if (key != "bmesh" && key != "mesh") continue;  // camera and other lines
    Scan scan;
    scan.file = std::string(words.word());
    bool good = !scan.file.empty() && scan.file.size() < 4096;
    for (std::size_t k = 0; k < 3; ++k)
      good = good && words.number(scan.translation[k]) && std::isfinite(scan.translation[k]);
    double length = 0;
    for (double& c : scan.q) good = good && words.number(c) && std::isfinite(c), length += c * c;
    if (!good || !(length > 1e-12)) {
      in.fail(fmt::format("line {}: '{}' needs a file, a translation (3 numbers) and a quaternion (4)", number, key));
    }
    for (double& c : scan.q) c /= std::sqrt(length);
    scans.push_back(std::move(scan));
    if (scans.size() > 65535) in.fail("more than 65,535 scans");
  }
  if (scans.empty()) in.fail("names no scans (no line 'bmesh file …')");
  return scans;
}

/// Alignments name scans that were never published: existing ones are read.
void leave_out_missing(const Input& in, std::vector<Scan>& scans) {
  if (std::all_of(scans.begin(), scans.end(), [](const Scan& s) { return s.missing; })) return;
  for (const Scan& s : scans)
    if (s.missing) in.warn(fmt::format("names the scan {}, which does not exist: left out", printable(s.file, 200)));
  std::erase_if(scans, [](const Scan& s) { return s.missing; });
}

}  // namespace

PointSet read_conf(const Input& in) {
  std::vector<Scan> scans = parse(in);
  const std::filesystem::path folder = std::filesystem::path(in.file).parent_path();
  parallel_for(0, scans.size(), 1, [&](std::size_t s) {
    Scan& scan = scans[s];
    const std::filesystem::path path = folder / scan.file;
    std::error_code unknown;
    scan.missing = !std::filesystem::exists(path, unknown) && !unknown;
    try {
      if (ending(path.string()) == "conf") throw FileError(path.string(), "an alignment inside an alignment");
      scan.points = read_points(path.string(), &scan.report);
    } catch (const FileError& e) {
      scan.error = e.what();
    }
  });
  const std::size_t listed = scans.size();
  leave_out_missing(in, scans);
  std::size_t n = 0;
  bool normals = true, colors = true;
  for (const Scan& s : scans) {
    if (!s.error.empty()) in.fail("a scan that it names cannot be read: " + s.error);
    n += s.points.size();
    normals &= s.points.has_normals(), colors &= s.points.has_colors();
    for (const std::string& w : s.report.warnings) in.warn(s.file + ": " + w);
  }
  in.report.format = scans.size() == listed ? fmt::format("Stanford alignment of {} scans", listed)
                                            : fmt::format("Stanford alignment of {} of {} scans", scans.size(), listed);

  PointSet all;
  std::vector<Vec3> world(n);
  std::vector<Vec3> eyes;
  all.scan_of_point.resize(n);
  if (normals) all.normals.resize(n);
  if (colors) all.colors.reserve(n);
  std::size_t first = 0;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    const Scan& scan = scans[s];
    const PointSet& p = scan.points;
    Box3 box;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Vec3 moved = scan.rotate(p.origin + Vec3(p.positions[i])) + scan.translation;
      world[first + i] = moved;
      box.extend(moved);
      if (normals) all.normals[first + i] = Vec3f(scan.rotate(Vec3(p.normals[i])));
      all.scan_of_point[first + i] = static_cast<std::uint16_t>(s);
    }
    const std::uint32_t shift = static_cast<std::uint32_t>(first);
    for (const auto& t : p.triangles) all.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
    if (colors) all.colors.insert(all.colors.end(), p.colors.begin(), p.colors.end());
    // Range scanners of this kind look along the z axis of their scan; far away, the rays are parallel.
    eyes.push_back(box.center() + scan.rotate({0, 0, 1}) * (1000 * box.diagonal()));
    all.scan_names.push_back(printable(scan.file, 200));
    first += p.size();
  }
  const auto joined = [&](AttributeTable PointSet::*table, bool triangles) {
    std::vector<AttributeTable> tables;
    for (Scan& scan : scans) {
      if (triangles && scan.points.triangles.empty()) continue;
      tables.push_back(std::move(scan.points.*table));
    }
    return join_tables(in, std::move(tables), "scans");
  };
  all.attributes = joined(&PointSet::attributes, false);
  all.triangle_attributes = joined(&PointSet::triangle_attributes, true);
  store_positions(in, all, n, [&](std::size_t i) { return world[i]; });
  for (const Vec3& eye : eyes) all.scanners.push_back(Vec3f(eye - all.origin));
  finish(in, all);
  return all;
}

}  // namespace sansmesh::inline v1::io
