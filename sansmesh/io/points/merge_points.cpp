#include "sansmesh/io/points/merge_points.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <string_view>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/data/reference_system.h"
#include "sansmesh/error.h"
#include "sansmesh/io/points/assemble_points.h"
#include "sansmesh/io/points/las_header.h"

namespace sansmesh::inline v1::io {
namespace {

/// Joins one array of all parts; each part's is freed as soon as it is copied.
template <class T>
void append_arrays(std::vector<PointSet>& parts, std::vector<T> PointSet::*array, std::size_t total,
                   std::vector<T>& out) {
  out.reserve(total);
  for (PointSet& part : parts) {
    out.insert(out.end(), (part.*array).begin(), (part.*array).end());
    std::vector<T>().swap(part.*array);
  }
}

/// The same for arrays that only some parts have: the result has none, and a warning reports it.
template <class T>
void append_if_all(const std::vector<std::string>& files, std::vector<PointSet>& parts, std::vector<T> PointSet::*array,
                   std::size_t total, const char* what, PointSet& all, ReadReport& report) {
  const auto has = [&](const PointSet& part) { return !(part.*array).empty(); };
  const auto without = std::find_if_not(parts.begin(), parts.end(), has);
  if (without == parts.end()) return append_arrays(parts, array, total, all.*array);
  if (std::any_of(parts.begin(), parts.end(), has))
    report.warnings.push_back(printable(files[static_cast<std::size_t>(without - parts.begin())], 200) + ": has no " +
                              what + ": those of the other files were left out");
}

/// The same with unknown values for parts without the array.
template <class T>
void append_if_any(std::vector<PointSet>& parts, std::vector<T> PointSet::*array, const std::vector<std::size_t>& sizes,
                   std::size_t total, const T& unknown, PointSet& all) {
  if (std::all_of(parts.begin(), parts.end(), [&](const PointSet& part) { return (part.*array).empty(); })) return;
  for (std::size_t k = 0; k < parts.size(); ++k)
    if ((parts[k].*array).empty()) (parts[k].*array).assign(sizes[k], unknown);
  append_arrays(parts, array, total, all.*array);
}

/// Scans are numbered per file. A file without scans counts as one scan with an unknown viewpoint; its number follows
/// those of all scans with viewpoints.
void number_scans(const std::vector<std::string>& files, const std::vector<std::size_t>& points,
                  std::vector<PointSet>& parts, PointSet& all, ReadReport& report) {
  std::size_t scanners = 0, others = 0;
  for (const PointSet& part : parts) scanners += part.scanners.size(), others += part.scan_of_point.empty();
  if (scanners + others >= PointSet::kUnknownScan) {
    report.warnings.push_back("more than 65,534 scans: the scan numbers of the samples were left out");
    for (PointSet& part : parts) part.scan_of_point.clear(), part.scanners.clear();
    return;
  }
  all.scan_names.resize(scanners + others);
  std::size_t first = 0, other = scanners;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    PointSet& part = parts[k];
    const std::size_t own = part.scanners.size();
    for (std::size_t s = 0; s < own; ++s)
      all.scan_names[first + s] = s < part.scan_names.size() ? part.scan_names[s] : printable(files[k], 200);
    if (part.scan_of_point.empty()) {
      all.scan_names[other] = printable(files[k], 200);
      part.scan_of_point.assign(points[k], static_cast<std::uint16_t>(other++));
    } else {
      for (std::uint16_t& scan : part.scan_of_point)
        scan = scan < own ? static_cast<std::uint16_t>(scan + first) : PointSet::kUnknownScan;
    }
    first += own;
  }
}

/// Joins the tables of all parts. Warns of attributes with one name and several types.
AttributeTable join(const std::vector<std::string>& files, const std::vector<PointSet>& parts,
                    AttributeTable PointSet::*table, const std::vector<std::size_t>& rows, ReadReport& report) {
  std::vector<const AttributeTable*> tables(parts.size());
  for (std::size_t k = 0; k < parts.size(); ++k) tables[k] = &(parts[k].*table);
  AttributeTable all = join_rows(tables, rows);
  for (std::size_t k = 0; k < parts.size(); ++k)
    for (const Attribute& a : *tables[k])
      if (const Attribute* const kept = all.find(a.name); kept->type() != a.type() || kept->components != a.components)
        report.warnings.push_back(printable(files[k], 200) + ": '" + printable(a.name, 80) +
                                  "' is of another type than in the files before: unknown for these points");
  return all;
}

/// Box of a LAS or LAZ file of any version, as its header states it.
std::optional<Box3> stated_box(const std::string& file) {
  char header[kLasHeaderBytes];
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(header, sizeof header) || std::string_view(header, 4) != "LASF") return std::nullopt;
  const Box3 box = load_las_box(header);
  if (box.empty() || !is_finite(box.size())) return std::nullopt;
  return box;
}

/// The common reference system. Throws FileError if two files state different ones.
SharedSystem join_systems(const std::vector<std::string>& files, const std::vector<PointSet>& parts,
                          ReadReport& report) {
  CommonSystem common;
  std::size_t unknown = 0, first_unknown = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (!parts[k].reference && unknown++ == 0) first_unknown = k;
    if (const auto* const other = common.add(files[k], parts[k].reference))
      throw FileError(files[k], "its reference system is " + system_words(*parts[k].reference) + ", and that of " +
                                    printable(other->name, 200) + " is " + system_words(*other->system) +
                                    ": they cannot be read as one");
  }
  SharedSystem system = common.system();
  if (system && unknown > 0)
    report.warnings.push_back(printable(files[first_unknown], 200) +
                              (unknown > 1 ? " and " + grouped(unknown - 1) + " more state" : ": states") +
                              " no reference system: that of the other files is assumed, " + system_words(*system));
  return system;
}

}  // namespace

std::optional<Vec3> stated_origin(const std::vector<std::string>& files, const std::optional<Box3>& selected) {
  Box3 all;
  for (const std::string& file : files) {
    const std::optional<Box3> box = stated_box(file);
    if (!box) return std::nullopt;
    all.extend(selected ? common_part(*box, *selected) : *box);
  }
  if (all.empty()) return std::nullopt;
  return choose_origin(all);
}

Vec3 common_origin(std::span<const PointSet> parts) {
  std::size_t n = 0;
  for (const PointSet& part : parts) n += part.size();
  // The selection of store_positions in a file with all points.
  const std::size_t step = 1 + n / (1 << 16);
  std::vector<Vec3> some;
  Box3 box;
  std::size_t first = 0;
  for (const PointSet& part : parts) {
    const Box3f own = bounds(part);
    box.extend(part.origin + Vec3(own.lower)), box.extend(part.origin + Vec3(own.upper));
    for (std::size_t i = (step - first % step) % step; i < part.size(); i += step)
      some.push_back(part.origin + Vec3(part.positions[i]));
    first += part.size();
  }
  return choose_origin(box, some);
}

PointSet merge_points(const std::vector<std::string>& files, std::vector<PointSet> parts, ReadReport& report) {
  std::vector<std::size_t> points(parts.size()), triangles(parts.size());
  std::size_t n = 0, faces = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    points[k] = parts[k].size(), triangles[k] = parts[k].triangles.size();
    n += points[k], faces += triangles[k];
    if (n > 0xfffffffeu)
      throw FileError(files[k], "together with those before it holds " + grouped(n) +
                                    " points; at most 4,294,967,294 are supported");
  }
  PointSet all;
  all.origin = parts[0].origin;
  all.reference = join_systems(files, parts, report);
  all.attributes = join(files, parts, &PointSet::attributes, points, report);
  all.triangle_attributes = join(files, parts, &PointSet::triangle_attributes, triangles, report);
  number_scans(files, points, parts, all, report);
  std::uint32_t first = 0;  // triangles are numbered per file, too
  for (PointSet& part : parts) {
    part.attributes.clear(), part.triangle_attributes.clear();
    for (auto& t : part.triangles)
      for (std::uint32_t& corner : t) corner += first;
    first += static_cast<std::uint32_t>(part.size());
  }
  append_if_all(files, parts, &PointSet::normals, n, "normals", all, report);
  append_if_all(files, parts, &PointSet::colors, n, "colours", all, report);
  append_arrays(parts, &PointSet::scan_of_point, n, all.scan_of_point);
  append_arrays(parts, &PointSet::scanners, all.scan_names.size(), all.scanners);
  append_if_any(parts, &PointSet::grid_normals, points, n, Vec3f{}, all);
  append_arrays(parts, &PointSet::triangles, faces, all.triangles);
  append_arrays(parts, &PointSet::positions, n, all.positions);
  return all;
}

}  // namespace sansmesh::inline v1::io
