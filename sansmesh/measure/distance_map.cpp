#include "sansmesh/measure/distance_map.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/diverging_color.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/image.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kMapChunk = 1024;  // fixed: neighbours in a chunk share hints
constexpr double kInRange = 0.99;
constexpr std::size_t kMedianOf = 64;
constexpr std::array<std::uint8_t, 3> kLeftOut{150, 150, 150};

/// Weight of each vertex: a third of the area of its triangles; negative for unused vertices. Points: 1.
std::vector<double> weights(const TriangleMesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  if (mesh.triangles.empty()) return std::vector<double>(n, 1.0);
  std::vector<double> result(n, -1.0);
  for (const Triangle& t : mesh.triangles) {
    if (t[0] >= n || t[1] >= n || t[2] >= n) continue;
    const double third =
        triangle_area(Vec3(mesh.vertices[t[0]]), Vec3(mesh.vertices[t[1]]), Vec3(mesh.vertices[t[2]])) / 3;
    for (const std::uint32_t v : t) result[v] = std::max(0.0, result[v]) + (std::isfinite(third) ? third : 0);
  }
  return result;
}

double rounded_up(double value) {
  if (!(value > 0)) return 0;
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1);
  return unit * std::ceil(value / unit * (1 - 1e-9));
}

struct Sample {
  double distance, weight;
  std::uint32_t index;
};

double sum_of(const std::vector<Sample>& samples, double (*term)(const Sample&, double), double parameter) {
  return parallel_reduce(
      samples.size(), 16384, 0.0,
      [&](std::size_t first, std::size_t last) {
        double sum = 0;
        for (std::size_t i = first; i < last; ++i) sum += samples[i].weight * term(samples[i], parameter);
        return sum;
      },
      [](double a, double b) { return a + b; });
}

/// Weighted quantile of sorted samples; `value` is the sort key.
template <class Value>
double percentile(const std::vector<Sample>& sorted, double total, double share, Value&& value) {
  double sum = 0;
  for (const Sample& s : sorted) {
    sum += s.weight;
    if (sum >= share * total) return value(s);
  }
  return value(sorted.back());
}

DistanceStatistics statistics_of(std::vector<Sample> samples, const TriangleMesh& part,
                                 const DistanceMapOptions& options, bool has_sides, double smallest_range) {
  DistanceStatistics s;
  s.histogram.assign(kHistogramBins, 0);
  if (options.color_range) s.range = *options.color_range;
  if (samples.empty()) {
    s.mean = s.mean_absolute = s.rms = s.deviation = s.p05 = s.median = s.p95 = s.p95_absolute = s.lowest = s.highest =
        std::numeric_limits<double>::quiet_NaN();
    return s;
  }
  double total = sum_of(
      samples, [](const Sample&, double) { return 1.0; }, 0);
  s.area = total;
  if (!(total > 0)) {
    for (Sample& x : samples) x.weight = 1;
    total = static_cast<double>(samples.size());
  }
  s.mean = sum_of(
               samples, [](const Sample& x, double) { return x.distance; }, 0) /
           total;
  s.mean_absolute = sum_of(
                        samples, [](const Sample& x, double) { return std::abs(x.distance); }, 0) /
                    total;
  s.rms = std::sqrt(sum_of(
                        samples, [](const Sample& x, double) { return x.distance * x.distance; }, 0) /
                    total);
  const auto off = [](const Sample& x, double mean) { return (x.distance - mean) * (x.distance - mean); };
  s.deviation = std::sqrt(sum_of(samples, off, s.mean) / total);
  if (options.within)
    s.within_tolerance =
        sum_of(
            samples, [](const Sample& x, double t) { return std::abs(x.distance) <= t ? 1.0 : 0.0; }, *options.within) /
        total;

  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
    return std::abs(a.distance) != std::abs(b.distance) ? std::abs(a.distance) < std::abs(b.distance)
                                                        : a.index < b.index;
  });
  const auto size = [](const Sample& x) { return std::abs(x.distance); };
  s.p95_absolute = percentile(samples, total, 0.95, size);
  if (!options.color_range) {
    const double range = percentile(samples, total, kInRange, size);
    s.smallest_range = range < smallest_range;
    s.range = rounded_up(std::max(range, smallest_range));
  }
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.index < b.index;
  });
  const auto value = [](const Sample& x) { return x.distance; };
  s.p05 = percentile(samples, total, 0.05, value);
  s.median = percentile(samples, total, 0.5, value);
  s.p95 = percentile(samples, total, 0.95, value);
  s.lowest = samples.front().distance;
  s.highest = samples.back().distance;
  s.lowest_at = part.origin + Vec3(part.vertices[samples.front().index]);
  s.highest_at = part.origin + Vec3(part.vertices[samples.back().index]);

  const double low = has_sides ? -s.range : 0, width = (s.range - low) / kHistogramBins;
  for (const Sample& x : samples) {
    if (x.distance < low)
      s.below_range += x.weight / total;
    else if (x.distance > s.range)
      s.above_range += x.weight / total;
    else
      s.histogram[width > 0   ? index_in<std::size_t>((x.distance - low) / width, 0, kHistogramBins - 1)
                  : has_sides ? kHistogramBins / 2
                              : 0] += x.weight / total;
  }
  return s;
}

}  // namespace

const OptionSchema& DistanceMapOptions::schema() {
  using O = DistanceMapOptions;
  static constexpr OptionRow rows[] = {
      option<&O::within>(
          {.text = "Report the share within ±LENGTH", .unit = "length", .range = at_least(0), .old_name = "tolerance"}),
      option<&O::color_range>({.text = "Distance that gets the full colour",
                               .unit = "length",
                               .from_data = "99 % of the area is nearer",
                               .range = positive(),
                               .old_name = "range"}),
      option<&O::max_distance>({.text = "Leave out points farther away",
                                .unit = "length",
                                .from_data = "a tenth of the diagonal of the reference",
                                .range = positive()}),
      option<&O::skip_border>({.text = "Leave out points closest to the border of an open surface"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void DistanceMapOptions::validate() const { validate_options(*this); }

DistanceMap distance_map(const TriangleMesh& part, const SignedDistance& reference, const DistanceMapOptions& options,
                         Progress& progress) {
  options.validate();
  DistanceMap map;
  map.has_sides = reference.has_sides();
  map.max_distance = options.max_distance.value_or(0.1 * reference.bounds().diagonal());
  const std::size_t n = part.vertices.size();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  map.distance.assign(n, kNan);
  if (part.triangles.empty()) map.feet.assign(n, {kNan, kNan, kNan});
  const std::vector<double> weight = weights(part);
  // Spatial order makes searches short for any order of the vertices in the mesh.
  const KdTree tree(part.vertices);
  std::vector<std::uint32_t> order;
  order.reserve(n);
  for (const std::uint32_t i : tree.order())
    if (i < n && weight[i] >= 0) order.push_back(i);
  map.not_finite = n - order.size();
  if (order.empty()) throw DataError("no finite points to compare");

  // The reason for each NaN, until all are counted.
  enum class Left : std::uint8_t { no, beyond, lost, border };
  std::vector<Left> left(n, Left::no);
  std::vector<std::uint8_t> border(n);
  const std::size_t chunks = (order.size() + kMapChunk - 1) / kMapChunk;
  progress.begin("distances", chunks);
  parallel_for(0, chunks, 1, [&](std::size_t c) {
    const std::size_t first = c * kMapChunk, count = std::min(kMapChunk, order.size() - first);
    std::vector<Vec3> x(count);
    std::vector<MeasuredPoint> found(count);
    for (std::size_t k = 0; k < count; ++k) x[k] = part.origin + Vec3(part.vertices[order[first + k]]);
    reference.measure(x, map.max_distance, found);
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t i = order[first + k];
      border[i] = found[k].border;
      if (found[k].lost)
        left[i] = Left::lost;
      else if (!(std::abs(found[k].distance) <= map.max_distance))
        left[i] = Left::beyond;
      else if (found[k].border && options.skip_border)
        left[i] = Left::border;
      else
        map.distance[i] =
            static_cast<float>(options.reversed && map.has_sides ? -found[k].distance : found[k].distance);
      if (!map.feet.empty() && left[i] == Left::no) map.feet[i] = Vec3f(found[k].point - part.origin);
    }
    progress.advance();
  });

  std::vector<Sample> samples;
  for (std::size_t i = 0; i < n; ++i) {
    map.beyond += left[i] == Left::beyond;
    map.not_found += left[i] == Left::lost;
    map.at_border += border[i] && left[i] != Left::beyond;
    if (std::isnan(map.distance[i])) continue;
    samples.push_back({static_cast<double>(map.distance[i]), weight[i], static_cast<std::uint32_t>(i)});
  }
  map.measured = samples.size();
  progress.begin("statistics");
  map.statistics =
      statistics_of(std::move(samples), part, options, map.has_sides, kSmallestRange * reference.bounds().diagonal());
  return map;
}

std::vector<float> local_medians(const TriangleMesh& points, const DistanceMap& map, double radius) {
  const std::size_t n = map.distance.size();
  if (map.feet.size() != n || points.vertices.size() != n)
    throw ArgumentError("local_medians: the map is not one of these points");
  std::vector<float> shown = map.distance;
  const bool sided = points.normals.size() == n;
  const KdTree tree(map.feet);
  const auto most = static_cast<float>(radius * radius);
  tree.for_each_nearest(kMedianOf, [&](std::uint32_t slot, std::span<const Neighbour> near) {
    const std::uint32_t own = tree.order()[slot];
    std::array<float, kMedianOf> values{};
    std::size_t count = 0;
    for (const Neighbour& neighbour : near) {
      const std::uint32_t other = tree.order()[neighbour.index];
      if (neighbour.squared_distance > most) break;
      if (!sided || !(dot(points.normals[own], points.normals[other]) < 0)) values[count++] = map.distance[other];
    }
    if (count == 0) return;
    // An even number of values has two in the middle.
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(values.begin(), middle, values.begin() + static_cast<std::ptrdiff_t>(count));
    shown[own] = count % 2 == 1 ? *middle : 0.5f * (*middle + *std::max_element(values.begin(), middle));
  });
  return shown;
}

std::array<std::uint8_t, 3> distance_color(float distance, double range) {
  if (std::isnan(distance)) return kLeftOut;
  const Vec3f color = diverging_color(range > 0 ? static_cast<float>(static_cast<double>(distance) / range)
                                                : std::copysign(distance == 0 ? 0.0f : 1.0f, distance));
  return {to_byte(color.x), to_byte(color.y), to_byte(color.z)};
}

void apply_map(TriangleMesh& part, const DistanceMap& map, double range) {
  if (map.distance.size() != part.vertices.size())
    throw ArgumentError("apply_map: the map and the mesh differ in the number of vertices");
  part.attributes.set(part.triangles.empty() ? "distance" : "quality", map.distance);
  part.colors.resize(part.vertices.size());
  parallel_for(0, part.colors.size(), 8192,
               [&](std::size_t i) { part.colors[i] = distance_color(map.distance[i], range); });
}

namespace {

constexpr ReportRow kDistanceStatisticsRows[] = {
    reported<&DistanceStatistics::mean>({.text = "Mean of the signed distances", .unit = "length"}),
    reported<&DistanceStatistics::mean_absolute>({.text = "Mean of the distances", .unit = "length"}),
    reported<&DistanceStatistics::rms>({.text = "Root mean square of the distances", .unit = "length"}),
    reported<&DistanceStatistics::deviation>({.text = "Standard deviation of the signed distances", .unit = "length"}),
    reported<&DistanceStatistics::p05>({.text = "5 % of the signed distances are below", .unit = "length"}),
    reported<&DistanceStatistics::median>({.text = "Half of the signed distances are below", .unit = "length"}),
    reported<&DistanceStatistics::p95>({.text = "95 % of the signed distances are below", .unit = "length"}),
    reported<&DistanceStatistics::p95_absolute>({.text = "95 % of the distances are below", .unit = "length"}),
    reported<&DistanceStatistics::lowest>({.name = "lowest.value", .text = "Lowest signed distance", .unit = "length"}),
    reported<&DistanceStatistics::lowest_at>(
        {.name = "lowest.at", .text = "Place of the lowest signed distance", .unit = "length"}),
    reported<&DistanceStatistics::highest>(
        {.name = "highest.value", .text = "Highest signed distance", .unit = "length"}),
    reported<&DistanceStatistics::highest_at>(
        {.name = "highest.at", .text = "Place of the highest signed distance", .unit = "length"}),
    reported<&DistanceStatistics::within_tolerance>(
        {.text = "Share of the area within the tolerance", .unit = "share"}),
    reported<&DistanceStatistics::area>({.text = "Area that was measured; of points their number", .unit = "length²"})};

}  // namespace

const ReportSchema& DistanceStatistics::schema() {
  static constexpr ReportSchema schema{kDistanceStatisticsRows};
  return schema;
}

namespace {

constexpr ReportRow kDistanceMapRows[] = {
    reported<&DistanceMap::has_sides>({.name = "signed", .text = "Whether inside and outside are known"}),
    reported<[](const DistanceMap& r) { return r.distance.size(); }>(
        {.name = "vertices", .text = "Vertices of the mapped surface"}),
    reported<&DistanceMap::measured>({.text = "Vertices with a distance"}),
    reported<&DistanceMap::beyond>({.text = "Vertices left out: farther than the largest distance"}),
    reported<&DistanceMap::not_found>({.text = "Vertices left out: no surface found"}),
    reported<&DistanceMap::at_border>({.text = "Vertices whose closest point lies on a border"}),
    reported<&DistanceMap::not_finite>({.text = "Vertices left out: not finite, or unused"}),
    reported<&DistanceMap::max_distance>({.text = "Largest distance that counts", .unit = "length"}),
    reported<&DistanceMap::statistics>({.name = "distance", .text = "Statistics of the distances, weighted by area"}),
    reported<[](const DistanceMap& r) { return r.has_sides ? -r.statistics.range : 0.0; }>(
        {.name = "histogram.lower", .text = "Lower end of the histogram", .unit = "length"}),
    reported<[](const DistanceMap& r) { return r.statistics.range; }>(
        {.name = "histogram.upper", .text = "Upper end of the histogram", .unit = "length"}),
    reported<[](const DistanceMap& r) { return r.statistics.below_range; }>(
        {.name = "histogram.below", .text = "Share below its lower end", .unit = "share"}),
    reported<[](const DistanceMap& r) { return r.statistics.above_range; }>(
        {.name = "histogram.above", .text = "Share above its upper end", .unit = "share"}),
    reported<[](const DistanceMap& r) { return r.statistics.histogram; }>(
        {.name = "histogram.shares", .text = "Shares of bins of equal width", .unit = "share"})};

}  // namespace

const ReportSchema& DistanceMap::schema() {
  static constexpr ReportSchema schema{kDistanceMapRows};
  return schema;
}

}  // namespace sansmesh::inline v1
