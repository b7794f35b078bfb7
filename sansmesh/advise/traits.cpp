// Measures traits of a cloud: noise, density, creases, borders, outliers.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>

#include "sansmesh/advice.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/mesh/repair/sewn_mesh.h"
#include "sansmesh/points/cleaning/outliers.h"
#include "sansmesh/points/normals/denoise_normals.h"
#include "sansmesh/points/normals/given_normals.h"
#include "sansmesh/points/normals/normals.h"
#include "sansmesh/points/orientation/orientation.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/points/shape/principal_axes.h"
#include "sansmesh/points/statistics/neighbourhood_sample.h"
#include "sansmesh/points/statistics/noise.h"
#include "sansmesh/points/statistics/spacing.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kSpacingNeighbours = 16;  // the number used by surfaces
constexpr std::size_t kDensityPoints = 2000;
constexpr std::size_t kNormals = 30000;  // samples with estimated normals in the search for creases
constexpr std::size_t kMostTraitPoints = 500;
constexpr std::size_t kLooked = 24;    // neighbours searched for a crease
constexpr double kCreaseAngle = 40;    // degrees
constexpr double kSideAngle = 12;      // largest angle between normals of one side of a crease
constexpr double kHidingNoise = 0.35;  // noise over spacing above which creases are indistinguishable
constexpr double kBorderGap = 140;     // degrees of the tangent plane without a neighbour
constexpr std::size_t kBorderNeighbours = 24;
constexpr std::size_t kBorderPoints = 2000;
/// Samples fitted to test whether the surface is open, and share of open edges above which faces are a soup.
constexpr std::size_t kFitted = 60000;
constexpr double kSoup = 0.25;
constexpr int kMostNeighbours = 60;  // for the tangent plane in the test for borders

/// Quantile of spacings weighted by area: weighting by samples would mainly describe the dense parts. `ascending` must
/// be sorted.
double quantile_by_area(const std::vector<double>& ascending, double q) {
  double area = 0, passed = 0;
  for (const double s : ascending) area += s * s;
  for (const double s : ascending) {
    passed += s * s;
    if (passed >= q * area) return s;
  }
  return ascending.empty() ? 0 : ascending.back();
}

double degrees(double angle) { return angle * std::numbers::pi / 180; }

/// Side of the square that a sample represents, from the distance to the k-th neighbour.
double square_edge(double distance, std::size_t k) {
  return distance * std::sqrt(std::numbers::pi / static_cast<double>(k));
}

void measure_density(const PointSet& points, CloudTraits& traits) {
  std::vector<double> spacings, nearest;
  for (const Neighbourhood& n : sample_neighbourhoods(points.positions, kDensityPoints, 2 * kSpacingNeighbours)) {
    if (n.distances.size() < 6) continue;
    const std::size_t k = std::min(kSpacingNeighbours, n.distances.size() - 1);
    spacings.push_back(square_edge(static_cast<double>(n.distances[k]), k));
    nearest.push_back(static_cast<double>(n.distances[1]));
  }
  std::sort(spacings.begin(), spacings.end());
  const double low = quantile_by_area(spacings, 0.05), high = quantile_by_area(spacings, 0.95);
  const double middle = median(spacings);
  if (low > 0) traits.density_ratio = high / low;
  if (middle > 0) traits.evenness = median(nearest) / middle;
}

/// Whether the first of these normals (of the point itself) is next to an edge: the normals around it form two groups,
/// its own and a very different one. On a curved surface there are also normals in between.
bool next_to_crease(std::span<const Vec3f> normals) {
  const auto alike = [](const Vec3f& a, const Vec3f& b) { return std::abs(dot(a, b)); };
  const Vec3f own = normals[0];
  const auto far = std::min_element(normals.begin(), normals.end(),
                                    [&](const Vec3f& a, const Vec3f& b) { return alike(own, a) < alike(own, b); });
  if (alike(own, *far) > static_cast<float>(std::cos(degrees(kCreaseAngle)))) return false;
  const auto side = static_cast<float>(std::cos(degrees(kSideAngle)));
  std::size_t here = 0, there = 0;
  for (const Vec3f& n : normals) {
    here += alike(n, own) >= side;
    there += alike(n, *far) >= side;
  }
  return here >= 4 && there >= 4 && 10 * (here + there) >= 8 * normals.size();
}

/// Whether a large sector of the tangent plane around the point has no neighbours.
bool next_to_border(std::span<const Vec3f> offsets, const Vec3f& normal) {
  Vec3f t, b;
  tangent_frame(normal, t, b);
  std::vector<float> angles;
  for (std::size_t i = 1; i < offsets.size(); ++i) angles.push_back(std::atan2(dot(offsets[i], b), dot(offsets[i], t)));
  std::sort(angles.begin(), angles.end());
  float gap = angles.front() + 2 * std::numbers::pi_v<float> - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) gap = std::max(gap, angles[i] - angles[i - 1]);
  return gap > static_cast<float>(degrees(kBorderGap));
}

/// Open edges of the faces, unless these are a soup of separate faces.
void measure_open_edges(const PointSet& given, CloudTraits& traits) {
  TriangleMesh mesh;
  mesh.vertices = given.positions;
  mesh.triangles = given.triangles;
  const MeshTopology topology = sewn_topology(mesh);
  if (static_cast<double>(topology.boundary_edges) > kSoup * static_cast<double>(topology.edges)) return;
  traits.open_edges = topology.boundary_edges;
  traits.open_loops = topology.boundary_loops;
}

/// Openness of a fit to the samples or a subset, which distinguishes a solid from a sheet.
void measure_openness(PointSet points, CloudTraits& traits, Progress& progress) {
  if (points.size() > kFitted) {
    std::vector<std::uint8_t> mask(points.size());
    const double kept = static_cast<double>(kFitted) / static_cast<double>(points.size());
    // A fixed pseudo-random rule, independent of patterns in the order of samples (finaliser of SplitMix64).
    for (std::size_t i = 0; i < mask.size(); ++i) {
      std::uint64_t z = (i + 1) * 0x9E3779B97F4A7C15u;
      z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
      z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
      mask[i] = static_cast<double>(z >> 11) * 0x1p-53 >= kept;
    }
    remove_samples(points, mask);
  }
  points.triangles.clear();
  points.triangle_attributes = {};
  try {
    const FittedFunction function = fit_surface_function(std::move(points), {}, progress);
    const PartitionReport& r = function.field.report();
    traits.open = r.area > 0 ? std::min(1.0, r.open_area / r.area) : 0;
  } catch (const DataError&) {
    traits.open = 0;  // too few samples for any fit: unknown
  }
}

double share(const std::vector<std::uint8_t>& which, const std::vector<std::uint8_t>& known) {
  const auto all = std::count(known.begin(), known.end(), 1);
  return all > 0 ? static_cast<double>(std::count(which.begin(), which.end(), 1)) / static_cast<double>(all) : 0.0;
}

/// A band along a line contains length × width / spacing² samples. Its width is proportional to the radius of the
/// neighbourhoods: spacing √(k/π).
double line_length(double share_of_samples, double width_over_radius, const CloudTraits& t) {
  if (!(t.diagonal > 0)) return 0;
  const double radius = std::sqrt(static_cast<double>(kLooked) / std::numbers::pi);
  return share_of_samples * static_cast<double>(t.samples) * t.spacing / (width_over_radius * radius * t.diagonal);
}

void measure_creases(const PointSet& points, CloudTraits& traits, const LocalFrame& frame) {
  traits.creases_known = traits.noise_ratio() < kHidingNoise;
  if (!traits.creases_known) return;
  const double spacing = frame.from_input(traits.spacing), noise = frame.from_input(traits.noise);
  const int blur = choose_neighbours(spacing, noise);
  const std::size_t size = std::max<std::size_t>(5 * static_cast<std::size_t>(blur), 90);
  const std::vector<Neighbourhood> patches =
      sample_neighbourhoods(points.positions, std::min(kMostTraitPoints, kNormals / size), size);
  std::vector<std::uint8_t> crease(patches.size()), known(patches.size());
  parallel_for(0, patches.size(), 4, [&](std::size_t p) {
    if (patches[p].offsets.size() < kLooked) return;
    Progress silent;
    PointSet around;
    around.positions = patches[p].offsets;
    estimate_normals(around, {.neighbours = blur, .spacing = spacing, .noise = noise}, silent);
    denoise_normals(around, {.neighbours = blur, .spacing = spacing, .noise = noise}, silent);
    known[p] = squared_norm(around.normals[0]) > 0;
    crease[p] = known[p] && next_to_crease(std::span(around.normals).first(kLooked));
  });
  traits.creases = share(crease, known);
  traits.crease_length = line_length(traits.creases, 1.2, traits);
}

void measure_borders(const PointSet& points, CloudTraits& traits) {
  const auto k = static_cast<std::size_t>(std::clamp(choose_neighbours(traits.spacing, traits.noise),
                                                     static_cast<int>(kBorderNeighbours), kMostNeighbours));
  const std::vector<Neighbourhood> patches = sample_neighbourhoods(points.positions, kBorderPoints, 4 * k);
  std::vector<std::uint8_t> border(patches.size()), known(patches.size());
  parallel_for(0, patches.size(), 16, [&](std::size_t p) {
    const std::span<const Vec3f> offsets = patches[p].offsets;
    if (offsets.size() <= kBorderNeighbours) return;
    const std::span<const Vec3f> near = offsets.first(std::min(offsets.size(), k + 1));
    const PrincipalAxes axes = principal_axes(moments(near).covariance);
    known[p] = 1;
    // At creases, neighbours on the other side are hidden in the projection.
    if (axes.values.x > 0.03 * axes.values.z && traits.noise_ratio() < kHidingNoise) return;
    border[p] = next_to_border(offsets.first(kBorderNeighbours + 1), Vec3f(axes.axes[0]));
  });
  traits.borders = share(border, known);
  traits.border_length = line_length(traits.borders, 0.35, traits);
}

}  // namespace

CloudTraits measure_traits(PointSet given, Progress& progress, std::vector<Note>* notes) {
  CloudTraits traits;
  traits.faces = !given.triangles.empty();
  if (traits.faces) measure_open_edges(given, traits);
  PreparedCloud cloud = prepare_positions(std::move(given), FaceUse::automatic, progress);
  if (notes) *notes = cloud.notes;
  PointSet& points = cloud.points;
  traits.samples = points.size();

  const std::vector<std::uint8_t> outliers = find_outliers(points, {}, progress);
  const auto marked = static_cast<std::size_t>(std::count(outliers.begin(), outliers.end(), 1));
  traits.outliers = static_cast<double>(marked) / static_cast<double>(points.size());
  if (marked > 0) remove_samples(points, outliers);

  progress.begin("measure");
  const Vec3f size = bounds(points).size();
  traits.diagonal = cloud.frame.to_input(static_cast<double>(norm(size)));
  traits.spacing = cloud.frame.to_input(estimate_spacing(points));
  const NoiseEstimate estimate = measure_noise(points);
  const double noise = estimate.deviation;
  traits.noise = cloud.frame.to_input(noise);
  traits.most_noise = cloud.frame.to_input(estimate.most);
  traits.noise_known = estimate.known;
  traits.step = cloud.frame.to_input(estimate.step);
  measure_density(points, traits);
  progress.begin("check normals");
  traits.orientation = measure_orientation(points, noise);
  traits.normals = traits.orientation.check;
  progress.begin("creases and borders");
  measure_creases(points, traits, cloud.frame);
  measure_borders(points, traits);
  measure_openness(std::move(points), traits, progress);
  progress.finish();
  return traits;
}

namespace {

constexpr ReportRow kCloudTraitsRows[] = {
    reported<&CloudTraits::samples>({.text = "Samples that can be used"}),
    reported<&CloudTraits::diagonal>({.text = "Diagonal of the box", .unit = "length"}),
    reported<&CloudTraits::spacing>({.text = "Edge of the square that a sample stands for", .unit = "length"}),
    reported<&CloudTraits::noise>({.text = "Standard deviation of the samples off the surface", .unit = "length"}),
    reported<&CloudTraits::noise_known>({.text = "Whether noise and shape are distinguishable"}),
    reported<&CloudTraits::most_noise>({.text = "Upper bound of the noise", .unit = "length"}),
    reported<&CloudTraits::step>({.text = "Steps of the coordinates, where they hide the noise", .unit = "length"}),
    reported<&CloudTraits::density_ratio>(
        {.text = "Local spacing: its 95 % quantile over its 5 % quantile", .unit = "factor"}),
    reported<&CloudTraits::evenness>({.text = "Distance of the nearest sample over the spacing"}),
    reported<&CloudTraits::outliers>({.text = "Share of samples that belong to no surface", .unit = "share"}),
    reported<[](const CloudTraits& r) { return value_if(r.creases_known, r.creases); }>(
        {.name = "creases",
         .text = "Share of places next to a sharp edge; nothing where noise hides them",
         .unit = "share"}),
    reported<[](const CloudTraits& r) { return value_if(r.creases_known, r.crease_length); }>(
        {.name = "crease_length", .text = "Length of the sharp edges", .unit = "diagonals"}),
    reported<&CloudTraits::borders>({.text = "Share of places next to a border or hole", .unit = "share"}),
    reported<&CloudTraits::border_length>({.text = "Length of the borders", .unit = "diagonals"}),
    reported<&CloudTraits::open>({.text = "Share of the surface that bounds no solid", .unit = "share"}),
    reported<&CloudTraits::faces>({.text = "Whether there are faces"}),
    reported<[](const CloudTraits& r) { return value_if(r.faces, r.open_edges); }>(
        {.name = "open_edges", .text = "Edges of one face"}),
    reported<[](const CloudTraits& r) { return value_if(r.faces, r.open_loops); }>(
        {.name = "open_loops", .text = "Connected sets of these"}),
    reported<[](const CloudTraits& r) { return judge_normals(r.orientation).words; }>(
        {.name = "normals", .text = "Normals, in words"}),
    reported<[](const CloudTraits& r) { return judge_normals(r.orientation); }>(
        {.name = "orientation", .text = "How normals are oriented"})};

}  // namespace

const ReportSchema& CloudTraits::schema() {
  static constexpr ReportSchema schema{kCloudTraitsRows};
  return schema;
}

}  // namespace sansmesh::inline v1
