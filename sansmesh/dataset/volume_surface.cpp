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
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/meshing/mesh_steps.h"
#include "sansmesh/points/poisson_discs.h"
#include "sansmesh/search/ball_tree.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/surface/foot_field.h"
#include "sansmesh/surface/layer_projection.h"
#include "sansmesh/triangulation/divide_blocks.h"
#include "sansmesh/volume/samples/sample_slopes.h"

namespace sansmesh::inline v1 {
namespace {

/// The kind as a flag.
struct HighGradient {
  using Kind = VolumeSurfaceOptions::Kind;
  static constexpr auto kind = OptionKind::flag;
  static OptionValue get(Kind v) { return v == Kind::high_gradient; }
  static Kind from(const OptionValue& v) { return std::get<bool>(v) ? Kind::high_gradient : Kind::isovalue; }
};

/// Thickness of the layer: δ in ω = exp(−(d/δs)²), d the distance from the surface that value and slope tell, s the
/// spacing. Samples of a Gaussian so wide add up to the same wherever they lie (Poisson's sum: to 10⁻⁴), thicker ones
/// see more of the curvature of f.
constexpr double kThickness = 1;
/// Samples farther off do not count: ω is below 0.01.
constexpr double kMostOff = 2.2;
/// No layer is thicker than what belongs to this share of the median slope: plateaus near the value would count whole.
constexpr double kLeastSlope = 0.05, kWeakSlope = 0.25;
/// h over the spacing without noise; its growth with what noise moves an isosurface by, in spacings; and its end.
constexpr double kWidth = 2, kWiden = 4, kMostWidth = 4;
/// Radius of the balls of the domain over the spacing, and the distance of samples that have one, over the layer's
/// thickness: along any line through the layer some ball is entered within half a spacing of the surface.
constexpr double kReach = 1.25, kBallsOff = 1.3;
/// Borders of materials end with the inner part of the balls: farther out feet may be undefined.
constexpr double kInner = 0.8;
constexpr double kSteepness = 0.35;    // β₂
constexpr double kLeastBorder = 0.15;  // of the largest gradient (of all but one in a thousand samples)
constexpr double kOutOfNoise = 4;      // times the median gradient
/// Shares of the local maximum from which on a sample counts, and has a ball.
constexpr double kCounts = 0.3, kOnRidge = 0.8;
/// Edge of blocks over the spacing, and of the balls that must hold fine blocks over those of the domain.
constexpr double kBlockEdge = 2.1, kBlockReach = 0.6;
constexpr int kDeepestBlocks = 13;
constexpr double kAround = 4;        // the cube of blocks beyond the layer, in spacings
constexpr double kMeshError = 0.02;  // in spacings
/// Rays ask whether places are in the volume where the field is smaller than this, over the largest radius of a ball.
constexpr double kCutThickness = 0.3;
/// Parts of meshes that are shorter than this along every axis, over the width h of the weights: where no sample is
/// inside of a closed part, or borders of materials begin, weights of that width tell nothing.
constexpr double kResolved = 1;
/// Vertices of borders of materials farther off than this are none, in spacings.
constexpr double kOffSurface = 0.2;
/// Distance between the feet that are handed out, in spacings.
constexpr double kSplats = 0.75;
/// Points are no closer than this part of the spacing; tries that are closer than this to others, over the distance
/// asked for, are given up at once.
constexpr int kMostAlong = 8;
constexpr double kThinned = 0.2;
constexpr std::size_t kFeetAtOnce = 65536;

/// A sample that counts.
struct Chosen {
  std::uint32_t sample;
  double weight;
  bool ball;
  Vec3 gradient;
};

/// What every chunk of samples finds, one after another: the same for any number of threads.
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

/// Median slope where a sample is nearer to the value than to one of its neighbours; 0 if nowhere.
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
    // The gradient is hardly larger than the contrast over the spacing: most samples are done with here.
    const double contrast = slopes.contrast(i);
    if (std::abs(off) > kMostOff * kThickness * (o.beta ? *o.beta : std::max(2 * contrast, floor))) return;
    const Vec3 gradient = slopes.gradient(i);
    const double steep = norm(gradient);
    if (!(steep > 0)) return;
    // Flat cells: the layer is as thick as samples are apart across the surface.
    const double across = slopes.spacing_along(i, gradient / steep);
    const double beta = o.beta ? *o.beta : kThickness * std::max(steep * across, floor);
    const double away = std::abs(off) / beta;
    if (away > kMostOff) return;
    // Plateaus: level sets near by are far apart there, each sample stands for little of their area.
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

/// On which side of a surface places are that are too far away to be projected. Values are about distances, of the
/// right sign; their gradients mean nothing.
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

/// Of isosurfaces: that of the nearest sample of the volume.
class ValueSide final : public LayerSide {
 public:
  ValueSide(const SampledVolume& volume, std::span<const double> values, double value, const LocalFrame& frame,
            Box3 bounds)
      : LayerSide(bounds), volume_(volume), frame_(frame), far_(bounds.diagonal()), above_(values.size()) {
    for (std::size_t i = 0; i < values.size(); ++i) above_[i] = values[i] > value;
    if (volume.lattice) return;
    std::vector<Vec3f> positions(volume.size());
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = Vec3f(frame.from_input(volume.positions[i]));
    tree_ = KdTree(positions);
  }

 private:
  double side(const Vec3& x) const override {
    std::size_t nearest = 0;
    if (volume_.lattice) {
      const Lattice& l = *volume_.lattice;
      const Vec3 a = l.to_axes(frame_.to_input(x));
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
  LocalFrame frame_;
  double far_;
  std::vector<std::uint8_t> above_;
  KdTree tree_;  ///< of samples that are not on a lattice
};

/// Of borders of materials: that of the tangent plane of the nearest foot.
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

/// The surface's field, defined in the volume alone. Only places on the surface are looked up, and of these only those
/// in balls that reach out of the volume.
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
  BallTree rim_;  ///< balls that reach out of the volume
  double thickness_ = 0;
};

/// Where a surface can be: inside of the volume and, where borders of materials end within it, of the balls of the
/// layer. Negative there, about the distance to where that ends.
class LayerDomain : public ScalarField {
 public:
  /// What is passed must outlive it. `balls`: null for surfaces that end with the volume alone.
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

/// Takes away triangles where the field jumps: half-way between two borders of materials the one's outside meets the
/// other's inside, and coarse blocks reach from the one to the other.
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

/// Takes away the parts that are shorter along every axis than the weights around them are wide, and closed ones that
/// hold less than what one sample stands for; how many these were.
std::size_t drop_unresolved(TriangleMesh& mesh, const BallUnion& balls, std::span<const float> spacing,
                            double smoothing) {
  const MeshComponents parts = find_components(mesh);
  std::vector<Box3> boxes(parts.size());
  std::vector<double> volumes(parts.size()), areas(parts.size());
  std::vector<Vec3> turned(parts.size());  // vectors of area add up to nothing over a closed part
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
  LocalFrame frame;
  VolumeSurfaceOptions options;
  VolumeSurfaceReport report;
  std::optional<LayerProjection> projection;
  SurfaceFeet feet;  ///< of the places
  std::unique_ptr<const LayerSide> side;
  BallUnion places;                  ///< samples next to the surface, a ball around each
  std::vector<float> place_spacing;  ///< of these
  std::unique_ptr<const VolumeDomain> domain;
  std::unique_ptr<const ScalarField> field;
  BallUnion balls;
  std::vector<float> spacing;
};

const OptionSchema& VolumeSurfaceOptions::schema() {
  using O = VolumeSurfaceOptions;
  static constexpr OptionRow rows[] = {
      option<&O::kind, HighGradient>(
          {.text = "Where the array changes most: borders of materials, at any value", .name = "high_gradient"}),
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
          {.text = "With `high_gradient`: gradients over the largest of the volume, not of the surroundings",
           .negative = "global_maximum"}),
      option<&O::corrector>({.text = "Quick: without the weights by distance", .negative = "predictor_only"}),
      option<&O::predictor>({.text = "Without the first guess", .negative = "corrector_only"}),
      option<&O::alternating>({.text = "Predictor: direction and offset in turns, as in the source"}),
      option<&O::line_search>({.text = "Corrector: offset by minimisation along the normal"}),
      option<&O::separate_sheets>({.text = "Samples count wherever they face", .negative = "all_sheets"}),
      option<&O::exact_projection>(
          {.text = "Pictures and meshes project at every place, not from paraboloids at the feet of samples",
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
  const LocalFrame frame = frame_for(box.center(), box.diagonal());
  state->frame = frame, state->options = options;
  r.noise = noise;

  const bool iso = options.kind == VolumeSurfaceOptions::Kind::isovalue;
  const SampledVolume& samples = *volume;
  if (samples.size() != values.size()) throw ArgumentError("as many values as samples are needed");
  if (samples.size() > std::numeric_limits<std::uint32_t>::max()) throw DataError("has more than 2³² samples");
  const auto [lowest, highest] = std::minmax_element(values.begin(), values.end());
  const double least = *lowest, range = *highest - least;
  if (!(range > 0)) throw DataError(fmt::format("is {:.6g} everywhere: there is no surface", least));
  if (iso && (options.value < least || options.value > *highest))
    throw DataError(fmt::format("does not have the value {:.6g}: values lie between {:.6g} and {:.6g}", options.value,
                                least, *highest));
  // As shares of the range: squares and quotients of very large and very small numbers are none.
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
    positions[i] = Vec3f(frame.from_input(samples.position(chosen[i].sample)));
  const KdTree tree(positions);
  LayerSamples layer;
  for (std::vector<Vec3f>* v : {&layer.positions, &layer.normals}) v->reserve(chosen.size());
  for (std::vector<float>* v : {&layer.weights, &layer.spacing, &layer.reach}) v->reserve(chosen.size());
  double heaviest = 0;
  for (const Chosen& c : chosen) heaviest = std::max(heaviest, c.weight);
  for (const std::uint32_t i : tree.order()) {
    const Chosen& c = chosen[i];
    const auto s = static_cast<float>(frame.from_input(slopes.spacing(c.sample)));
    layer.positions.push_back(positions[i]);
    layer.normals.push_back(Vec3f(normalized(c.gradient * -1.0)));
    layer.weights.push_back(static_cast<float>(c.weight / heaviest));
    layer.spacing.push_back(s);
    layer.reach.push_back(c.ball ? s * static_cast<float>(kReach) : 0);
    if (c.ball) state->place_spacing.push_back(s);
  }
  r.samples = chosen.size();
  std::vector<float> sorted = state->place_spacing;
  r.spacing = frame.to_input(static_cast<double>(median(sorted)));
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
    state->side = std::make_unique<ValueSide>(samples, shares, own.value, frame, bounds);
  else
    state->side = std::make_unique<PlaneSide>(feet, bounds);
  progress.begin("boundary");
  state->domain = std::make_unique<const VolumeDomain>(samples, frame);
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
const LocalFrame& VolumeSurface::frame() const { return state_->frame; }
const Projection& VolumeSurface::projection() const { return *state_->projection; }
const ScalarField& VolumeSurface::field() const { return *state_->field; }
const BallUnion& VolumeSurface::balls() const { return state_->balls; }
std::span<const float> VolumeSurface::spacing() const { return state_->spacing; }
PointSet VolumeSurface::feet() const {
  std::vector<Vec3> positions;
  positions.reserve(state_->feet.feet.size());
  for (const FootPoint& foot : state_->feet.feet) positions.push_back(foot.position);
  const auto kept = poisson_discs(positions, kSplats * state_->frame.from_input(state_->report.spacing));
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
  // Nothing reaches the cube's faces, where it would be closed.
  const double edge =
      std::max({size.x, size.y, size.z}) + 2 * kAround * state_->frame.from_input(state_->report.spacing);
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
  const LocalFrame& frame = surface.frame();
  MeshOptions own = meshing;
  if (meshing.mesh_error) own.mesh_error = frame.from_input(*meshing.mesh_error);
  const double error = own.mesh_error.value_or(kMeshError * frame.from_input(surface.report().spacing));
  r.mesh_error = frame.to_input(error);
  progress.begin("find surface");
  const BlockTree blocks = surface.blocks();
  PolygonizeOptions polygonize = detail::meshing_options(own, error, false);
  const bool iso = surface.options().kind == VolumeSurfaceOptions::Kind::isovalue;
  const LayerDomain domain(*surface.state_->domain, iso ? nullptr : &surface.balls());
  polygonize.domain = &domain;
  TriangleMesh mesh = detail::cut_out(surface.field(), blocks, own, polygonize, progress, r);
  if (mesh.triangles.empty()) throw DataError("has no such surface");
  progress.begin("finish mesh");
  if (!iso) drop_jumps(mesh, surface.field(), kOffSurface * frame.from_input(surface.report().spacing));
  if (meshing.components.kind == ComponentChoice::Kind::automatic) {
    const std::size_t dropped = drop_unresolved(mesh, surface.balls(), surface.spacing(), surface.report().smoothing);
    if (dropped > 0)
      r.warnings.push_back(counted(dropped, "part") +
                           " too small for weights of this width left out (`components = all` keeps them)");
  } else {
    detail::choose_components(mesh, meshing.components, {}, 0, r);
  }
  if (mesh.triangles.empty()) throw DataError("has no such surface that weights of this width can tell");
  const MeshTopology topology = measure_topology(mesh);
  r.components = static_cast<int>(topology.components);
  r.open = !topology.closed();
  move_to_input(mesh, frame);
  progress.finish();
  return mesh;
}

PointSet sample_volume_surface(const VolumeSurface& surface, std::optional<double> distance, Progress& progress) {
  if (distance && !(std::isfinite(*distance) && *distance >= surface.report().spacing / kMostAlong))
    throw ArgumentError(fmt::format("`distance` must be at least {:.4g}, a part of {} of the spacing",
                                    surface.report().spacing / kMostAlong, kMostAlong));
  const LocalFrame& frame = surface.frame();
  const double apart = frame.from_input(distance.value_or(surface.report().spacing));
  const BallUnion& places = surface.state_->places;
  const std::vector<float>& spacings = surface.state_->place_spacing;
  progress.begin("project", places.centers.size());
  std::vector<Vec3> feet, normals;
  std::vector<Vec3f> x;
  std::vector<float> around;
  const auto flush = [&] {
    progress.check();
    // Those in the volume, thinned at once: memory is that of the result, not of the tries.
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
    // Feet of the samples next to the surface and, where points are to be dense, of places around these.
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
  points.origin = frame.origin;
  points.positions.reserve(chosen.size()), points.normals.reserve(chosen.size());
  for (const std::uint32_t i : chosen) {
    points.positions.push_back(Vec3f(feet[i] * frame.unit));
    points.normals.push_back(Vec3f(normals[i]));
  }
  progress.finish();
  return points;
}

namespace {

constexpr ReportRow kVolumeSurfaceReportRows[] = {
    reported<&VolumeSurfaceReport::samples>({.text = "Samples that count"}),
    reported<&VolumeSurfaceReport::spacing>({.text = "Median spacing of these", .unit = "length"}),
    reported<&VolumeSurfaceReport::smoothing>({.text = "Width of the weights", .unit = "spacings"}),
    reported<&VolumeSurfaceReport::slope>(
        {.text = "Median slope of the quantity at the surface", .unit = "per length"}),
    reported<&VolumeSurfaceReport::noise>({.text = "Noise of the values", .unit = "unit of the array"}),
    reported<&VolumeSurfaceReport::beta>({.text = "Sharpness of the weights, where one holds everywhere"}),
    reported<&VolumeSurfaceReport::least_gradient>(
        {.text = "Slope from which on samples count, of high gradients", .unit = "per length"})};

}  // namespace

const ReportSchema& VolumeSurfaceReport::schema() {
  static constexpr ReportSchema schema{kVolumeSurfaceReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
