// Values and gradients of a volume at points.
#include <fmt/core.h>

#include <algorithm>
#include <iterator>

#include "sansmesh/core/number_words.h"
#include "sansmesh/volumes.h"

namespace sansmesh::inline v1 {
namespace {

std::vector<std::string> component_names(const std::string& array, std::size_t components) {
  if (components == 1) return {array};
  std::vector<std::string> names;
  names.reserve(components);
  for (std::size_t c = 0; c < components; ++c) names.push_back(fmt::format("{}_{}", array, c));
  return names;
}

/// A name as a CSV field, quoted if necessary.
std::string csv_name(const std::string& name) {
  if (name.find_first_of(",\"\n\r") == std::string::npos) return name;
  std::string quoted = "\"";
  for (const char c : name) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

ProbeResult probe_volume(const VolumeModel& volume, std::span<const Vec3> points, Progress& progress) {
  ProbeResult result;
  const auto field = volume.field(progress, result.notes);
  progress.begin("probe");
  const std::size_t n = points.size(), components = field->components();
  result.points.assign(points.begin(), points.end());
  result.names = component_names(volume.array_name(), components);
  result.values.resize(n * components), result.gradients.resize(n * components), result.inside.resize(n);
  field->query({.points = result.points}, {result.values, result.gradients, result.inside});
  result.report.reconstruction = volume.report();
  result.report.inside = static_cast<std::size_t>(std::count(result.inside.begin(), result.inside.end(), 1));
  if (n > 0 && result.report.inside == 0) {
    const Box3 box = field->bounds();
    result.notes.push_back({.code = "outside",
                            .text = fmt::format("none of {} is in the volume, which extends from {} to {}",
                                                counted(n, "point"), point_words(box.lower), point_words(box.upper)),
                            .of = volume.name()});
  }
  return result;
}

std::string probe_table(const ProbeResult& p) {
  std::string text = "x,y,z";
  for (const std::string& name : p.names)
    text += fmt::format(",{},{},{},{}", csv_name(name), csv_name(name + "_dx"), csv_name(name + "_dy"),
                        csv_name(name + "_dz"));
  text += ",inside\n";
  const std::size_t n = p.names.size();
  for (std::size_t i = 0; i < p.points.size(); ++i) {
    const Vec3& x = p.points[i];
    fmt::format_to(std::back_inserter(text), "{},{},{}", x.x, x.y, x.z);
    for (std::size_t c = 0; c < n; ++c) {
      const Vec3& d = p.gradients[i * n + c];
      fmt::format_to(std::back_inserter(text), ",{},{},{},{}", p.values[i * n + c], d.x, d.y, d.z);
    }
    fmt::format_to(std::back_inserter(text), ",{}\n", p.inside[i]);
  }
  return text;
}

const ReportSchema& ProbeReport::schema() {
  static constexpr ReportRow rows[] = {reported<&ProbeReport::inside>({.text = "Points inside the volume"})};
  return report_schema<rows>();
}

std::vector<ProbedValue> probed_values(const ProbeResult& p) {
  std::vector<ProbedValue> values;
  values.reserve(p.values.size());
  const std::size_t components = p.names.size();
  for (std::size_t k = 0; k < p.values.size(); ++k)
    values.push_back({p.points[k / components], p.names[k % components], p.values[k], p.gradients[k],
                      p.inside[k / components] != 0});
  return values;
}

const ReportSchema& ProbedValue::schema() {
  static constexpr ReportRow rows[] = {
      reported<&ProbedValue::at>({.text = "Query point", .unit = "length"}),
      reported<&ProbedValue::name>({.text = "Component"}),
      reported<&ProbedValue::value>({.text = "Value", .unit = "unit of the array"}),
      reported<&ProbedValue::gradient>({.text = "Gradient", .unit = "per length"}),
      reported<&ProbedValue::inside>({.text = "Whether the point is inside the volume"})};
  return report_schema<rows>();
}

std::vector<std::string> summary_of(const ProbeResult& probed) {
  const std::size_t n = probed.points.size();
  std::vector<std::string> lines{
      fmt::format("{}, {} in the volume", counted(n, "point"), grouped(probed.report.inside))};
  if (n <= kListedPoints)
    for (const ProbedValue& v : probed_values(probed))
      lines.push_back(fmt::format("{}  {} {:.8g}  gradient {}{}", point_words(v.at, 8), v.name, v.value,
                                  point_words(v.gradient), v.inside ? "" : "  outside"));
  return lines;
}

}  // namespace sansmesh::inline v1
