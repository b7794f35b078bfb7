#include "sansmesh/dataset/volume_surface.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/dataset/isosurface.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/components.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/meshing/mesh_steps.h"
#include "sansmesh/points/poisson_discs.h"
#include "sansmesh/search/ball_tree.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/surface/foot_field.h"
#include "sansmesh/surface/layer_projection.h"
#include "sansmesh/triangulation/divide_blocks.h"
#include "sansmesh/volume/sample_slopes.h"

namespace sansmesh::inline v1 {
namespace {

/// The kind as a flag.
struct HighGradient {
  using Kind = VolumeSurfaceOptions::Kind;
  static constexpr auto kind = OptionKind::flag;
  static OptionValue get(Kind v) { return v == Kind::high_gradient; }
  static Kind from(const OptionValue& v) { return std::get<bool>(v) ? Kind::high_gradient : Kind::isovalue; }
};

/// Thickness of the layer: δ in ω = exp(−(d/δs)²), d the distance from the surface by value and slope, s the spacing.
/// The sum of Gaussians of this width is independent of the sample positions (Poisson summation: to 10⁻⁴); thicker
/// layers include more of the curvature of f.
constexpr double kThickness = 1;
/// Samples farther away are ignored: ω is below 0.01.
constexpr double kMostOff = 2.2;
/// Lower bound of the slope for the thickness of a layer, relative to the median: otherwise plateaus near the value
/// would count entirely.
constexpr double kLeastSlope = 0.05, kWeakSlope = 0.25;
/// h over the spacing without noise; its growth with the displacement of an isosurface by noise, in spacings; and its
/// upper bound.
constexpr double kWidth = 2, kWiden = 4, kMostWidth = 4;
/// Radius of the domain's balls over the spacing, and the distance of samples with a ball over the layer's thickness:
/// any line through the layer enters a ball within half a spacing of the surface.
constexpr double kReach = 1.25, kBallsOff = 1.3;
/// Borders of materials end with the inner part of the balls, since feet farther out may be undefined.
constexpr double kInner = 0.8;
constexpr double kSteepness = 0.35;    // β₂
constexpr double kLeastBorder = 0.15;  // relative to the largest gradient (without the top thousandth of the samples)
constexpr double kOutOfNoise = 4;      // times the median gradient
/// Shares of the local maximum above which a sample has a weight, and a ball.
constexpr double kCounts = 0.3, kOnRidge = 0.8;
/// Edge of blocks over the spacing, and radius of the balls filled with fine blocks over those of the domain.
constexpr double kBlockEdge = 2.1, kBlockReach = 0.6;
constexpr int kDeepestBlocks = 13;
constexpr double kAround = 4;        // margin of the cube of blocks beyond the layer, in spacings
constexpr double kMeshError = 0.02;  // in spacings
/// Rays test whether points are in the volume where the field is smaller than this, over the largest radius of a ball.
constexpr double kCutThickness = 0.3;
/// Smallest extent of mesh parts along some axis, over the width h of the weights: weights do not resolve smaller
/// closed parts without a sample inside, and beginnings of borders.
constexpr double kResolved = 1;
/// Vertices of borders of materials farther away than this are removed, in spacings.
constexpr double kOffSurface = 0.2;
/// Distance between feet() in spacings.
constexpr double kSplats = 0.75;
/// Points are no closer than this share of the spacing; candidates closer than this share of the requested distance to
/// others are dropped immediately.
constexpr int kMostAlong = 8;
constexpr double kThinned = 0.2;
constexpr std::size_t kFeetAtOnce = 65536;

/// A sample with a weight.
struct Chosen {
  std::uint32_t sample;
  double weight;
  bool ball;
  Vec3 gradient;
};

/// Collects the samples found by chunks in order: the same for any number of threads.
template <class Choose>
std::vector<Chosen> choose_samples(std::size_t n, Progress& progress, const Choose& choose) {
  constexpr std::size_t kChunk = 65536;
  const std::size_t chunks = (n + kChunk - 1) / kChunk;
  std::vector<std::vector<Chosen>> parts(chunks);
  progress.begin("find the layer", chunks);
  parallel_for(0, chunks, 1, [&](std::size_t c) {
    for (std::size_t i = c * kChunk; i < std::min((c + 1) * kChunk, n); ++i) choose(i, parts[c]);
    progress.advance();
  });
  std::vector<Chosen> all;
  for (std::vector<Chosen>& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// Median slope of samples nearer to the value than to one of their neighbours; 0 if there are none.
double slope_at(const SampleSlopes& slopes, std::span<const double> values, double value) {
  constexpr std::size_t kMany = 200'000;
  constexpr std::size_t kChunk = 65536;
  const std::size_t n = values.size(), chunks = (n + kChunk - 1) / kChunk;
  const std::size_t stride = 1 + n / (64 * kMany);
  std::vector<std::vector<double>> parts(chunks);
  parallel_for(0, chunks, 1, [&](std::size_t c) {
    for (std::size_t i = c * kChunk; i < std::min((c + 1) * kChunk, n); i += stride)
      if (std::abs(values[i] - value) < slopes.contrast(i)) parts[c].push_back(norm(slopes.gradient(i)));
  });
  std::vector<double> found;
  for (const std::vector<double>& part : parts) found.insert(found.end(), part.begin(), part.end());
  return median(found);
}

std::vector<Chosen> isovalue_layer(const SampleSlopes& slopes, std::span<const double> values, double noise,
                                   const VolumeSurfaceOptions& o, VolumeSurfaceReport& r, Progress& progress) {
  r.slope = slope_at(slopes, values, o.value);
  r.noise_distance = r.slope > 0 ? noise / r.slope : 0;
  r.beta = o.beta;
  return choose_samples(values.size(), progress, [&](std::size_t i, std::vector<Chosen>& found) {
    const double off = o.value - values[i];
    const double spacing = slopes.spacing(i);
    const double floor = kLeastSlope * r.slope * spacing + std::min(noise, kWeakSlope * r.slope * spacing);
    // The gradient is hardly larger than the contrast over the spacing: this rejects most samples.
    const double contrast = slopes.contrast(i);
    if (std::abs(off) > kMostOff * kThickness * (o.beta ? *o.beta : std::max(2 * contrast, floor))) return;
    const Vec3 gradient = slopes.gradient(i);
    const double steep = norm(gradient);
    if (!(steep > 0)) return;
    // For flat cells the thickness of the layer is the spacing across the surface.
    const double across = slopes.spacing_along(i, gradient / steep);
    const double beta = o.beta ? *o.beta : kThickness * std::max(steep * across, floor);
    const double away = std::abs(off) / beta;
    if (away > kMostOff) return;
    // On plateaus the level sets are far apart, and each sample represents little of their area.
    const double area = r.slope > 0 ? std::min(1.0, steep / (kWeakSlope * r.slope)) : 1;
    const double weight = std::exp(-away * away) * area * slopes.volume(i) / across;
    found.push_back({static_cast<std::uint32_t>(i), weight, away < kBallsOff, gradient});
  });
}

std::vector<Chosen> high_gradient_layer(const SampledVolume& volume, const SampleSlopes& slopes, double noise,
                                        const VolumeSurfaceOptions& o, VolumeSurfaceReport& r, Progress& progress) {
  const std::size_t n = volume.size();
  std::vector<float> steep(n);
  progress.begin("gradients");
  parallel_for(0, n, 4096, [&](std::size_t i) { steep[i] = static_cast<float>(norm(slopes.gradient(i))); });
  progress.check();
  std::vector<float> sorted = steep;
  const auto high = sorted.begin() + static_cast<std::ptrdiff_t>((n - 1) - n / 1000);
  std::nth_element(sorted.begin(), high, sorted.end());
  const double largest = static_cast<double>(*high);
  const double middle = static_cast<double>(median(sorted));
  r.least_gradient =
      o.least_gradient.value_or(std::max(kLeastBorder * largest, std::min(kOutOfNoise * middle, 0.5 * largest)));
  if (!(largest > 0) && !(middle > 0)) throw DataError("changes hardly anywhere: there is no border");
  const double beta = o.beta.value_or(kSteepness);
  r.beta = beta;
  std::vector<float> around;
  if (o.local_maximum) around = steepest_across(volume, slopes, steep, kCounts * r.least_gradient);
  std::vector<Chosen> all = choose_samples(n, progress, [&](std::size_t i, std::vector<Chosen>& found) {
    const double own = static_cast<double>(steep[i]), most = o.local_maximum ? static_cast<double>(around[i]) : largest;
    if (!(most > 0) || (o.local_maximum ? most : own) < r.least_gradient) return;
    const double share = std::min(1.0, own / most);
    if (o.local_maximum && share < kCounts) return;
    const double away = (share - 1) / beta;
    if (std::abs(away) > kMostOff) return;
    const Vec3 gradient = slopes.gradient(i);
    if (!(squared_norm(gradient) > 0)) return;
    const double across = slopes.spacing_along(i, normalized(gradient));
    const double weight = std::exp(-away * away) * slopes.volume(i) / across;
    const bool ball = o.local_maximum ? share > kOnRidge : std::abs(away) < kBallsOff;
    found.push_back({static_cast<std::uint32_t>(i), weight, ball, gradient});
  });
  std::vector<double> slope;
  for (const Chosen& c : all)
    if (c.ball) slope.push_back(norm(c.gradient));
  r.slope = median(slope);
  r.noise_distance = r.slope > 0 ? noise / r.slope : 0;
  return all;
}

/// The side of points too far from the surface for the projection. Values are approximate distances of the right sign;
/// gradients are meaningless.
class LayerSide : public ScalarField {
 public:
  explicit LayerSide(Box3 bounds) : bounds_(bounds) {}
  Box3 bounds() const override { return bounds_; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const override {
    parallel_for(0, x.size(), 256, [&](std::size_t i) {
      values[i] = side(x[i]);
      if (!gradients.empty()) gradients[i] = {0, 0, 1};
    });
  }

 private:
  virtual double side(const Vec3& x) const = 0;
  Box3 bounds_;
};

/// For isosurfaces: the side of the nearest sample of the volume.
class ValueSide final : public LayerSide {
 public:
  ValueSide(const SampledVolume& volume, std::span<const double> values, double value, const Placement& place,
            Box3 bounds)
      : LayerSide(bounds), volume_(volume), place_(place), far_(bounds.diagonal()), above_(values.size()) {
    for (std::size_t i = 0; i < values.size(); ++i) above_[i] = values[i] > value;
    if (volume.lattice) return;
    std::vector<Vec3f> positions(volume.size());
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = Vec3f(place.from_input(volume.positions[i]));
    tree_ = KdTree(positions);
  }

 private:
  double side(const Vec3& x) const override {
    std::size_t nearest = 0;
    if (volume_.lattice) {
      const Lattice& l = *volume_.lattice;
      const Vec3 a = l.to_axes(place_.to_input(x));
      std::size_t stride = 1;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::vector<double>& axis = l.axes[k];
        auto i = static_cast<std::size_t>(std::lower_bound(axis.begin(), axis.end(), a[k]) - axis.begin());
        if (i == axis.size() || (i > 0 && a[k] - axis[i - 1] < axis[i] - a[k])) --i;
        nearest += i * stride;
        stride *= axis.size();
      }
    } else if (const auto found = tree_.nearest(Vec3f(x))) {
      nearest = found->index;
    }
    return above_[nearest] ? -far_ : far_;
  }

  const SampledVolume& volume_;
  Placement place_;
  double far_;
  std::vector<std::uint8_t> above_;
  KdTree tree_;  ///< of samples not on a lattice
};

/// For borders of materials: the side of the tangent plane of the nearest foot.
class PlaneSide final : public LayerSide {
 public:
  PlaneSide(const SurfaceFeet& feet, Box3 bounds) : LayerSide(bounds) {
    std::vector<Vec3f> positions;
    positions.reserve(feet.feet.size());
    normals_.reserve(feet.feet.size());
    for (const FootPoint& foot : feet.feet) {
      positions.push_back(Vec3f(foot.position));
      normals_.push_back(Vec3f(foot.normal));
    }
    tree_ = KdTree(positions);
    positions_ = std::move(positions);
  }

 private:
  double side(const Vec3& x) const override {
    const auto found = tree_.nearest(Vec3f(x));
    return found ? dot(x - Vec3(positions_[found->index]), Vec3(normals_[found->index])) : 1;
  }

  std::vector<Vec3f> positions_, normals_;
  KdTree tree_;
};

/// The surface's field, defined in the volume only. Only points on the surface are located, and among these only those
/// in balls that extend beyond the volume.
class CutField final : public ScalarField {
 public:
  CutField(std::unique_ptr<const ScalarField> field, const VolumeDomain& volume, const BallUnion& balls)
      : field_(std::move(field)), volume_(volume) {
    std::vector<Vec3> centers(balls.centers.begin(), balls.centers.end());
    std::vector<double> depth(centers.size());
    volume.evaluate(centers, depth);
    std::vector<Vec3f> kept;
    std::vector<float> radii;
    for (std::size_t i = 0; i < centers.size(); ++i) {
      if (depth[i] < -static_cast<double>(balls.radii[i])) continue;
      kept.push_back(balls.centers[i]);
      radii.push_back(balls.radii[i]);
    }
    rim_ = BallTree(kept, radii);
    if (!radii.empty()) thickness_ = kCutThickness * static_cast<double>(*std::max_element(radii.begin(), radii.end()));
  }
  Box3 bounds() const override { return field_->bounds(); }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const override {
    field_->evaluate(x, values, gradients);
  }
  void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                          std::span<std::uint8_t> inside) const override {
    field_->evaluate_in_domain(x, values, gradients, inside);
    if (inside.empty() || rim_.size() == 0) return;
    std::vector<std::uint32_t> asked, touched;
    std::vector<Vec3> places;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (inside[i] == 0 || std::abs(values[i]) > thickness_) continue;
      const Vec3f p(x[i]);
      rim_.touching({p, p}, touched);
      if (touched.empty()) continue;
      asked.push_back(static_cast<std::uint32_t>(i));
      places.push_back(x[i]);
    }
    std::vector<std::uint8_t> within(places.size());
    volume_.locate(places, within);
    for (std::size_t k = 0; k < asked.size(); ++k) inside[asked[k]] = within[k];
  }

 private:
  std::unique_ptr<const ScalarField> field_;
  const VolumeDomain& volume_;
  BallTree rim_;  ///< balls that extend beyond the volume
  double thickness_ = 0;
};

/// Domain of a surface: the volume and, for borders of materials, which end inside it, the balls of the layer. Negative
/// inside, approximately the distance to the boundary.
class LayerDomain : public ScalarField {
 public:
  /// The arguments must outlive it. `balls`: null for surfaces that end only with the volume.
  LayerDomain(const VolumeDomain& volume, const BallUnion* balls) : volume_(volume), balls_(balls) {
    if (balls) tree_ = KdTree(balls->centers);
  }
  Box3 bounds() const override { return volume_.bounds(); }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const override {
    volume_.evaluate(x, values, gradients);
    if (!balls_) return;
    parallel_for(0, x.size(), 256, [&](std::size_t i) {
      const auto found = tree_.nearest(Vec3f(x[i]));
      if (!found) return;
      const Vec3 d = x[i] - Vec3(balls_->centers[found->index]);
      const double outside = norm(d) - kInner * static_cast<double>(balls_->radii[found->index]);
      if (outside <= values[i]) return;
      values[i] = outside;
      if (!gradients.empty()) gradients[i] = normalized(d);
    });
  }
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override {
    detail::ranges_by_slope(*this, 1, x, radius, found);
  }

 private:
  const VolumeDomain& volume_;
  const BallUnion* balls_;
  KdTree tree_;
};

/// Removes triangles where the field jumps: half-way between two borders of materials the outside of one meets the
/// inside of the other, and coarse blocks connect them.
void drop_jumps(TriangleMesh& mesh, const ScalarField& field, double most) {
  std::vector<Vec3> x(mesh.vertices.size());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = mesh.origin + Vec3(mesh.vertices[i]);
  std::vector<double> values(x.size());
  field.evaluate(x, values);
  const auto on_surface = [&](std::uint32_t v) { return std::abs(values[v]) <= most; };
  std::vector<std::uint8_t> keep(mesh.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t)
    keep[t] = std::all_of(mesh.triangles[t].begin(), mesh.triangles[t].end(), on_surface);
  if (std::all_of(keep.begin(), keep.end(), [](std::uint8_t k) { return k != 0; })) return;
  keep_triangles(mesh, keep);
  separate_fans(mesh);
}

/// Removes parts that are shorter along every axis than the width of the weights around them, and closed ones with less
/// volume than one sample represents; returns their number.
std::size_t drop_unresolved(TriangleMesh& mesh, const BallUnion& balls, std::span<const float> spacing,
                            double smoothing) {
  const MeshComponents parts = find_components(mesh);
  std::vector<Box3> boxes(parts.size());
  std::vector<double> volumes(parts.size()), areas(parts.size());
  std::vector<Vec3> turned(parts.size());  // vector areas sum to zero over a closed part
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::size_t part = parts.of_triangle[t];
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3 p(mesh.vertices[a]), q(mesh.vertices[b]), r(mesh.vertices[c]);
    boxes[part].extend(p), boxes[part].extend(q), boxes[part].extend(r);
    volumes[part] += dot(p, cross(q, r)) / 6;
    const Vec3 area = cross(q - p, r - p);
    turned[part] += area, areas[part] += norm(area);
  }
  const KdTree near(balls.centers);
  std::vector<std::uint8_t> small(parts.size());
  for (std::size_t i = 0; i < small.size(); ++i) {
    const auto found = near.nearest(Vec3f(mesh.origin + boxes[i].center()));
    if (!found) continue;
    const double s = static_cast<double>(spacing[found->index]);
    const Vec3 size = boxes[i].size();
    small[i] = std::max({size.x, size.y, size.z}) < kResolved * smoothing * s ||
               (norm(turned[i]) < 1e-3 * areas[i] && std::abs(volumes[i]) < s * s * s);
  }
  const auto dropped = static_cast<std::size_t>(std::count(small.begin(), small.end(), 1));
  if (dropped == 0) return 0;
  std::vector<std::uint8_t> keep(mesh.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) keep[t] = small[parts.of_triangle[t]] == 0;
  keep_triangles(mesh, keep);
  return dropped;
}

}  // namespace

struct VolumeSurface::State {
  std::shared_ptr<const SampledVolume> volume;
  Placement place;
  VolumeSurfaceOptions options;
  VolumeSurfaceReport report;
  std::optional<LayerProjection> projection;
  SurfaceFeet feet;  ///< feet of `places`
  std::unique_ptr<const LayerSide> side;
  BallUnion places;                  ///< samples next to the surface, with a ball around each
  std::vector<float> place_spacing;  ///< spacing at `places`
  std::unique_ptr<const VolumeDomain> domain;
  std::unique_ptr<const ScalarField> field;
  BallUnion balls;
  std::vector<float> spacing;
};

const OptionSchema& VolumeSurfaceOptions::schema() {
  using O = VolumeSurfaceOptions;
  static constexpr OptionRow rows[] = {
      option<&O::kind, HighGradient>(
          {.text = "Borders of materials, where the gradient is largest, at any value", .name = "high_gradient"}),
      option<&O::beta>({.text = "Width of the weights: of values in their unit, of gradients as a share, 0.01 to 1",
                        .from_data = "by the slope at each sample; 0.35"}),
      option<&O::smoothing>({.text = "h of the weights by distance, in spacings",
                             .from_data = "2, more with noise",
                             .range = {.least = 0.5, .most = 20}}),
      option<&O::least_gradient>({.text = "Of a border, with `high_gradient`",
                                  .from_data = "from the noise",
                                  .range = positive(),
                                  .needs = "high_gradient"}),
      option<&O::local_maximum>(
          {.text = "With `high_gradient`: gradients relative to the largest of the volume, not of the neighbourhood",
           .negative = "global_maximum"}),
      option<&O::corrector>({.text = "Fast: omit the corrector's weights by distance", .negative = "predictor_only"}),
      option<&O::predictor>({.text = "Omit the predictor", .negative = "corrector_only"}),
      option<&O::alternating>({.text = "Predictor: optimise direction and offset in turn, as in the source"}),
      option<&O::line_search>({.text = "Corrector: offset by minimisation along the normal"}),
      option<&O::separate_sheets>({.text = "Use samples of all orientations", .negative = "all_sheets"}),
      option<&O::exact_projection>(
          {.text = "Pictures and meshes project at every point instead of using paraboloids at the feet of samples",
           .old_name = "exact"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void VolumeSurfaceOptions::validate() const {
  validate_options(*this);
  check_argument(predictor || corrector, "`predictor = false` and `corrector = false` exclude each other");
  check_argument(kind == Kind::high_gradient || local_maximum, "`local_maximum = false` needs `high_gradient`");
  if (kind == Kind::isovalue) {
    if (!std::isfinite(value)) throw ArgumentError("`value` must be finite");
    if (beta && !(std::isfinite(*beta) && *beta > 0)) throw ArgumentError("`beta` must be positive");
  } else {
    if (beta) check_range("beta", *beta, 0.01, 1);
  }
  LayerOptions layer;
  layer.smoothing = smoothing.value_or(layer.smoothing), layer.predictor = predictor, layer.corrector = corrector;
  layer.validate();
}

VolumeSurface make_volume_surface(std::shared_ptr<const SampledVolume> volume, std::span<const double> values,
                                  double noise, const VolumeSurfaceOptions& options, Progress& progress) {
  options.validate();
  auto state = std::make_unique<VolumeSurface::State>();
  VolumeSurfaceReport& r = state->report;
  const Box3 box = volume->bounds();
  const Placement place = placement_for(box.center(), box.diagonal());
  state->place = place, state->options = options;
  r.noise = noise;

  const bool iso = options.kind == VolumeSurfaceOptions::Kind::isovalue;
  const SampledVolume& samples = *volume;
  if (samples.size() != values.size()) throw ArgumentError("the numbers of values and samples differ");
  if (samples.size() > std::numeric_limits<std::uint32_t>::max()) throw DataError("has more than 2³² samples");
  const auto [lowest, highest] = std::minmax_element(values.begin(), values.end());
  const double least = *lowest, range = *highest - least;
  if (!(range > 0)) throw DataError(fmt::format("is {:.6g} everywhere: there is no surface", least));
  if (iso && (options.value < least || options.value > *highest))
    throw DataError(fmt::format("does not have the value {:.6g}: values lie between {:.6g} and {:.6g}", options.value,
                                least, *highest));
  // As shares of the range: squares and quotients of very large or small numbers would overflow or underflow.
  std::vector<double> shares(values.size());
  parallel_for(0, values.size(), 65536, [&](std::size_t i) { shares[i] = (values[i] - least) / range; });
  VolumeSurfaceOptions own = options;
  if (iso) own.value = (options.value - least) / range;
  if (iso && own.beta) own.beta = *own.beta / range;
  if (own.least_gradient) own.least_gradient = *own.least_gradient / range;
  progress.begin("slopes");
  const SampleSlopes slopes(samples, shares);
  const std::vector<Chosen> chosen = iso ? isovalue_layer(slopes, shares, noise / range, own, r, progress)
                                         : high_gradient_layer(samples, slopes, noise / range, own, r, progress);
  r.slope *= range, r.least_gradient *= range, r.beta = iso ? options.beta : r.beta;
  if (std::none_of(chosen.begin(), chosen.end(), [](const Chosen& c) { return c.ball; }))
    throw DataError(iso ? fmt::format("has no sample near enough to the value {:.6g}", options.value)
                        : fmt::format("has no border where the gradient is {:.6g} or more", r.least_gradient));
  progress.begin("prepare projection");
  std::vector<Vec3f> positions(chosen.size());
  for (std::size_t i = 0; i < chosen.size(); ++i)
    positions[i] = Vec3f(place.from_input(samples.position(chosen[i].sample)));
  const KdTree tree(positions);
  LayerSamples layer;
  for (std::vector<Vec3f>* v : {&layer.positions, &layer.normals}) v->reserve(chosen.size());
  for (std::vector<float>* v : {&layer.weights, &layer.spacing, &layer.reach}) v->reserve(chosen.size());
  double heaviest = 0;
  for (const Chosen& c : chosen) heaviest = std::max(heaviest, c.weight);
  for (const std::uint32_t i : tree.order()) {
    const Chosen& c = chosen[i];
    const auto s = static_cast<float>(place.from_input(slopes.spacing(c.sample)));
    layer.positions.push_back(positions[i]);
    layer.normals.push_back(Vec3f(normalized(c.gradient * -1.0)));
    layer.weights.push_back(static_cast<float>(c.weight / heaviest));
    layer.spacing.push_back(s);
    layer.reach.push_back(c.ball ? s * static_cast<float>(kReach) : 0);
    if (c.ball) state->place_spacing.push_back(s);
  }
  r.samples = chosen.size();
  std::vector<float> sorted = state->place_spacing;
  r.spacing = place.to_input(static_cast<double>(median(sorted)));
  const double moved = r.spacing > 0 ? r.noise_distance / r.spacing : 0;
  r.smoothing = options.smoothing.value_or(std::min(kWidth + kWiden * moved, kMostWidth));

  LayerOptions projection;
  projection.smoothing = r.smoothing;
  projection.predictor = options.predictor, projection.corrector = options.corrector;
  projection.alternating = options.alternating, projection.line_search = options.line_search;
  projection.separate_sheets = options.separate_sheets;
  state->projection.emplace(layer, projection);
  state->places = state->projection->balls();
  progress.begin("project");
  state->feet = find_feet(*state->projection, state->places.centers, state->place_spacing);
  const SurfaceFeet& feet = state->feet;
  progress.check();
  if (feet.feet.empty()) throw DataError("has no such surface");
  const Box3 bounds = state->projection->bounds();
  if (iso)
    state->side = std::make_unique<ValueSide>(samples, shares, own.value, place, bounds);
  else
    state->side = std::make_unique<PlaneSide>(feet, bounds);
  progress.begin("boundary");
  state->domain = std::make_unique<const VolumeDomain>(samples, place);
  std::unique_ptr<const ScalarField> field;
  if (options.exact_projection) {
    field = std::make_unique<const ProjectionField>(*state->projection, state->side.get());
    state->balls = state->places, state->spacing = state->place_spacing;
  } else {
    auto of_feet = std::make_unique<const FootField>(feet, state->side.get());
    state->balls = of_feet->balls(), state->spacing = feet.spacing;
    field = std::move(of_feet);
  }
  state->field = std::make_unique<const CutField>(std::move(field), *state->domain, state->balls);
  state->volume = std::move(volume);
  progress.finish();
  return VolumeSurface(std::move(state));
}

VolumeSurface::VolumeSurface(std::unique_ptr<State> state) : state_(std::move(state)) {}
VolumeSurface::~VolumeSurface() = default;
VolumeSurface::VolumeSurface(VolumeSurface&&) noexcept = default;
VolumeSurface& VolumeSurface::operator=(VolumeSurface&&) noexcept = default;

const SampledVolume& VolumeSurface::volume() const { return *state_->volume; }
const Placement& VolumeSurface::place() const { return state_->place; }
const Projection& VolumeSurface::projection() const { return *state_->projection; }
const ScalarField& VolumeSurface::field() const { return *state_->field; }
const BallUnion& VolumeSurface::balls() const { return state_->balls; }
std::span<const float> VolumeSurface::spacing() const { return state_->spacing; }
PointSet VolumeSurface::feet() const {
  std::vector<Vec3> positions;
  positions.reserve(state_->feet.feet.size());
  for (const FootPoint& foot : state_->feet.feet) positions.push_back(foot.position);
  const auto kept = poisson_discs(positions, kSplats * state_->place.from_input(state_->report.spacing));
  PointSet points;
  points.positions.reserve(kept.size()), points.normals.reserve(kept.size());
  for (const std::uint32_t i : kept) {
    points.positions.push_back(Vec3f(positions[i]));
    points.normals.push_back(Vec3f(state_->feet.feet[i].normal));
  }
  return points;
}
const VolumeSurfaceOptions& VolumeSurface::options() const { return state_->options; }
const VolumeSurfaceReport& VolumeSurface::report() const { return state_->report; }

BlockTree VolumeSurface::blocks() const {
  const BallUnion& balls = state_->balls;
  std::vector<float> radii = balls.radii;
  for (float& r : radii) r *= static_cast<float>(kBlockReach);
  const BallTree near(balls.centers, radii);
  const Vec3 size = state_->projection->bounds().size();
  // The surface must not reach the cube's faces, where it would be closed.
  const double edge =
      std::max({size.x, size.y, size.z}) + 2 * kAround * state_->place.from_input(state_->report.spacing);
  BlockTree tree(state_->projection->bounds().center() - Vec3{edge, edge, edge} * 0.5, edge);
  divide_blocks(tree, kDeepestBlocks, [&](std::size_t block, std::vector<std::uint32_t>& touched) {
    const double half = tree.block_edge(block) / 2;
    const Vec3 center = tree.block_center(block), h{half, half, half};
    near.touching({Vec3f(center - h), Vec3f(center + h)}, touched);
    float least = std::numeric_limits<float>::infinity();
    for (const std::uint32_t t : touched) least = std::min(least, state_->spacing[t]);
    return !touched.empty() && 2 * half > kBlockEdge * static_cast<double>(least);
  });
  return tree;
}

TriangleMesh mesh_volume_surface(const VolumeSurface& surface, const MeshOptions& meshing, Progress& progress,
                                 MeshReport* report) {
  meshing.validate();
  MeshReport local;
  MeshReport& r = report ? *report : local;
  r = {};
  const Placement& place = surface.place();
  MeshOptions own = meshing;
  if (meshing.mesh_error) own.mesh_error = place.from_input(*meshing.mesh_error);
  const double error = own.mesh_error.value_or(kMeshError * place.from_input(surface.report().spacing));
  r.mesh_error = place.to_input(error);
  progress.begin("find surface");
  const BlockTree blocks = surface.blocks();
  PolygonizeOptions polygonize = detail::meshing_options(own, error, false);
  const bool iso = surface.options().kind == VolumeSurfaceOptions::Kind::isovalue;
  const LayerDomain domain(*surface.state_->domain, iso ? nullptr : &surface.balls());
  polygonize.domain = &domain;
  TriangleMesh mesh = detail::cut_out(surface.field(), blocks, own, polygonize, progress, r);
  if (mesh.triangles.empty()) throw DataError("has no such surface");
  progress.begin("finish mesh");
  if (!iso) drop_jumps(mesh, surface.field(), kOffSurface * place.from_input(surface.report().spacing));
  if (meshing.components.kind == ComponentChoice::Kind::automatic) {
    const std::size_t dropped = drop_unresolved(mesh, surface.balls(), surface.spacing(), surface.report().smoothing);
    if (dropped > 0)
      r.warnings.push_back(counted(dropped, "part") +
                           " too small for weights of this width left out (`components = all` keeps them)");
  } else {
    detail::choose_components(mesh, meshing.components, {}, 0, r);
  }
  if (mesh.triangles.empty()) throw DataError("has no such surface that weights of this width resolve");
  const MeshTopology topology = measure_topology(mesh);
  r.components = static_cast<int>(topology.components);
  r.open = !topology.closed();
  move_to_input(mesh, place);
  progress.finish();
  return mesh;
}

PointSet sample_volume_surface(const VolumeSurface& surface, std::optional<double> distance, Progress& progress) {
  if (distance && !(std::isfinite(*distance) && *distance >= surface.report().spacing / kMostAlong))
    throw ArgumentError(fmt::format("`distance` must be at least {:.4g}, a part of {} of the spacing",
                                    surface.report().spacing / kMostAlong, kMostAlong));
  const Placement& place = surface.place();
  const double apart = place.from_input(distance.value_or(surface.report().spacing));
  const BallUnion& places = surface.state_->places;
  const std::vector<float>& spacings = surface.state_->place_spacing;
  progress.begin("project", places.centers.size());
  std::vector<Vec3> feet, normals;
  std::vector<Vec3f> x;
  std::vector<float> around;
  const auto flush = [&] {
    progress.check();
    // Points in the volume are thinned immediately: memory is proportional to the result.
    std::vector<Vec3> found, facing;
    for (const FootPoint& f : find_feet(surface.projection(), x, around).feet)
      found.push_back(f.position), facing.push_back(f.normal);
    std::vector<std::uint8_t> inside(found.size());
    surface.state_->domain->locate(found, inside);
    for (const std::uint32_t i : poisson_discs(found, kThinned * apart)) {
      if (inside[i] == 0) continue;
      feet.push_back(found[i]);
      normals.push_back(facing[i]);
    }
    x.clear(), around.clear();
  };
  for (std::size_t i = 0; i < places.centers.size(); ++i) {
    // Feet of the samples next to the surface and, for dense results, of points around these.
    const double ratio = 2 * static_cast<double>(spacings[i]) / apart;
    const int along = index_in<int>(std::ceil(ratio), 1, 2 * kMostAlong);
    const float step = spacings[i] / static_cast<float>(along), first = 0.5f * static_cast<float>(1 - along);
    for (int a = 0; a < along; ++a)
      for (int b = 0; b < along; ++b)
        for (int c = 0; c < along; ++c) {
          const Vec3f at{static_cast<float>(a), static_cast<float>(b), static_cast<float>(c)};
          x.push_back(places.centers[i] + (at + Vec3f{first, first, first}) * step);
          around.push_back(spacings[i]);
        }
    if (x.size() >= kFeetAtOnce) flush();
    progress.advance();
  }
  if (!x.empty()) flush();
  if (feet.empty()) throw DataError("has no such surface");
  progress.begin("choose points");
  const std::vector<std::uint32_t> chosen = poisson_discs(feet, apart);
  PointSet points;
  points.origin = place.origin;
  points.positions.reserve(chosen.size()), points.normals.reserve(chosen.size());
  for (const std::uint32_t i : chosen) {
    points.positions.push_back(Vec3f(feet[i] * place.unit));
    points.normals.push_back(Vec3f(normals[i]));
  }
  progress.finish();
  return points;
}

namespace {

constexpr ReportRow kVolumeSurfaceReportRows[] = {
    reported<&VolumeSurfaceReport::samples>({.text = "Samples with a weight"}),
    reported<&VolumeSurfaceReport::spacing>({.text = "Median spacing of these samples", .unit = "length"}),
    reported<&VolumeSurfaceReport::smoothing>({.text = "Width of the weights", .unit = "spacings"}),
    reported<&VolumeSurfaceReport::slope>(
        {.text = "Median slope of the quantity at the surface", .unit = "per length"}),
    reported<&VolumeSurfaceReport::noise>({.text = "Noise of the values", .unit = "unit of the array"}),
    reported<&VolumeSurfaceReport::beta>({.text = "β of the weights, if it is the same everywhere"}),
    reported<&VolumeSurfaceReport::least_gradient>(
        {.text = "Smallest gradient of a border, for high gradients", .unit = "per length"})};

}  // namespace

const ReportSchema& VolumeSurfaceReport::schema() {
  static constexpr ReportSchema schema{kVolumeSurfaceReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
