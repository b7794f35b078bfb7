#include "sansmesh/render/volume/volume_tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "sansmesh/core/binary_scale.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/render/scene/pixel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kReferenceShare = 0.02;  // default reference length, of the diagonal
constexpr int kMostPieces = 10;           // of a step, each with its own integral
constexpr double kFlat = 1e-6;            // places of the table that are too near each other for a difference
constexpr double kBent = 0.25;            // of the range: by how much a value may miss where a slope pointed
constexpr double kShortest = 0.05;        // of a step that is halved
constexpr int kRootRounds = 10;
constexpr float kGrazing = 0.4f;
constexpr double kFaceOpacity = 0.004;  // from which on a cut face is opaque
constexpr double kBesideFace = 0.02;    // pixels: how far from the face of a gap a sample on it lies
constexpr int kFaceTries = 6;

/// 1 − e^−x for x >= 0.
double absorbed(double x) {
  if (x > 0.03) return -std::expm1(-x);
  return x * (1 - x * (0.5 - x * (1.0 / 6 - x * (1.0 / 24))));  // to 2e-10
}

/// The cubic through two values with slopes (per length of the step).
struct Cubic {
  double a, b, c, d;
  Cubic(double v0, double s0, double v1, double s1)
      : a(2 * (v0 - v1) + s0 + s1), b(3 * (v1 - v0) - 2 * s0 - s1), c(s0), d(v0) {}
  double operator()(double s) const { return ((a * s + b) * s + c) * s + d; }
};

}  // namespace

struct VolumeTracer::Sample {
  double t = 0, value = 0, slope = 0, other = 0, other_slope = 0;  // slopes per picture length
  Vec3 gradient;                                                   // that shades, per picture length
  bool inside = true, shaded = false;
  bool again = false;    // nearer to the sample before, the value was going elsewhere
  bool on_face = false;  // where the ray has just come out of a gap
  double gap = -1, gap_slope = 0;
  Vec3 gap_gradient;  // per picture length
  Vec3f light{1, 1, 1}, gloss;
};

struct VolumeTracer::Walk {
  Vec3 origin, direction;
  Vec3f half;                           // between the ways to the key light and to the eye: the mirror's normal
  std::uint32_t slot = 0;               // of the ray's answer
  std::uint32_t stretch = 0, last = 0;  // the next one, and where they end
  RayStretch now;
  bool within = false, begun = false, started = false;  // in a stretch; at its begin; `before` holds
  double t = 0;
  double retry = 0;    // a place before t that is to be seen first; 0: none
  int face_tries = 0;  // how often in a row that was for the face of a gap
  Sample before;
  std::optional<RayStretch> rest;     // of a stretch in which a surface stands: what is behind that
  std::size_t layer = 0, layers = 0;  // the next of the surfaces, and where they end
  Vec3 light;
  double left = 1;
};

/// A surface in the way.
struct VolumeTracer::Layer {
  double t = 0;
  Vec3f light;
  float opacity = 1;
  std::uint32_t ray = 0;
};

struct VolumeTracer::Root {
  std::uint32_t walk = 0, iso = 0;
  double low = 0, high = 0, low_value = 0, high_value = 0;  // bracket; values minus that of the iso-surface
  double d = 0;                                             // length of the step
  bool sure = false;                                        // both ends were evaluated: there is a root
  bool done = false, hit = false;
  Sample sample;
};

struct VolumeTracer::Scratch {
  std::vector<Walk> walks;
  std::vector<RayStretch> stretches;
  std::vector<std::uint32_t> first;
  std::vector<Layer> layers;  // by ray and distance
  std::vector<std::uint32_t> active;
  std::vector<Vec3> x, gradients, other_gradients;
  std::vector<double> values, others;
  std::vector<std::uint8_t> inside;
  std::vector<double> gaps;
  std::vector<Vec3> gap_gradients;
  std::vector<Sample> samples;
  std::vector<Root> roots;
};

VolumeTracer::VolumeTracer(const TracedVolume& volume, const Camera& camera, const TransferFunction& transfer,
                           const VolumePictureOptions& options)
    : volume_(volume),
      parallel_(camera.parallel),
      lighting_(camera),
      transfer_(transfer),
      colors_(volume.opacity ? TransferTable::colors_only(transfer) : TransferTable(transfer)),
      depths_(transfer),
      options_(options),
      separate_(volume.opacity != nullptr),
      footprint_(2 * camera.half_height / static_cast<float>(options.picture.view.height)) {
  const double reference = transfer.reference_length ? *transfer.reference_length / volume.frame.size : kReferenceShare;
  extinction_ = options.opacity_factor / reference;
  const auto [lower, upper] = transfer.range();
  value_range_ = upper - lower, other_range_ = transfer.opacities.back().value - transfer.opacities.front().value;
  weak_ = 1.5 * (separate_ ? transfer.opacities.back().value - transfer.opacities.front().value : upper - lower);
  for (const IsoSurface& iso : options.isos)
    iso_colors_.push_back(linear_color(iso.color ? *iso.color : transfer.color(iso.value)));
  if (options.opacity_factor == 0)
    for (const IsoSurface& iso : options.isos) least_shown_ = std::min(least_shown_.value_or(iso.value), iso.value);
  const VolumeCells& cells = *volume.cells;
  clear_.assign(cells.size(), 0);
  if (!options.skip_empty) return;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const ValueRange& dense = separate_ ? cells.other_range(c) : cells.range(c);
    bool clear = options.opacity_factor == 0 || depths_.clear(dense.least, dense.most);
    for (const IsoSurface& iso : options.isos)
      clear = clear && !(cells.range(c).least <= iso.value && iso.value <= cells.range(c).most);
    clear_[c] = clear;
  }
  // Faces of gaps show values that are clear otherwise.
  if (volume.gap && options.clip_faces && options.opacity_factor == 0) {
    const double radius = 0.5 * norm(cells.edge());
    std::vector<Vec3> centers;
    centers.reserve(cells.size());
    for (std::size_t c = 0; c < cells.size(); ++c) centers.push_back(cells.center(c));
    std::vector<ValueRange> ranges(cells.size());
    volume.gap->ranges(centers, radius, ranges);
    for (std::size_t c = 0; c < cells.size(); ++c)
      if (ranges[c].holds_zero() && (!least_shown_ || cells.range(c).most >= *least_shown_)) clear_[c] = 0;
  }
  detail::clear_reach(cells, clear_);
}

Vec3 VolumeTracer::world(const Walk& walk, double t) const {
  return volume_.frame.center + (walk.origin + walk.direction * t) * volume_.frame.size;
}

double VolumeTracer::footprint(double t) const { return static_cast<double>(footprint_) * (parallel_ ? 1 : t); }

double VolumeTracer::step_at(std::size_t cell, double t) const {
  const Vec3& edge = volume_.cells->edge();
  const double most = std::min({edge.x, edge.y, edge.z}) / volume_.frame.size;
  const double step = options_.step * volume_.cells->spacing(cell) / volume_.frame.size;
  return std::max(std::min(step, most), 0.5 * footprint(t));
}

/// Goes on to the volume behind, through the surfaces on the way there; false: there is none, or nothing more to see.
bool VolumeTracer::next_stretch(Walk& walk, const Scratch& s) const {
  const bool more = walk.rest || walk.stretch != walk.last;
  const RayStretch next = walk.rest ? *walk.rest : more ? s.stretches[walk.stretch] : RayStretch{};
  for (; walk.layer != walk.layers && (!more || s.layers[walk.layer].t <= next.begin); ++walk.layer) {
    lay(walk, s.layers[walk.layer].light, static_cast<double>(s.layers[walk.layer].opacity));
    if (walk.left <= options_.least_light) walk.left = 0;
  }
  if (!more || walk.left == 0) return false;
  if (!walk.rest) ++walk.stretch;
  walk.rest.reset();
  walk.now = next;
  if (walk.layer != walk.layers && s.layers[walk.layer].t < next.end) {
    walk.rest = RayStretch{s.layers[walk.layer].t, next.end, false, next.ends_at_cut};
    walk.now.end = walk.rest->begin, walk.now.ends_at_cut = false;
  }
  return true;
}

/// Finds out where the walk is to be evaluated next; false: it is at its end.
bool VolumeTracer::next_place(Walk& walk, const Scratch& scratch) const {
  for (;;) {
    if (!walk.within) {
      if (!next_stretch(walk, scratch)) return false;
      walk.within = walk.begun = true;
      walk.started = false;
      walk.t = walk.now.begin;
      if (walk.now.begins_at_cut && options_.clip_faces) return true;
    }
    const double at = walk.started ? walk.before.t : walk.t;
    std::size_t cell = volume_.cells->cell(world(walk, at));
    if (!clear_[cell]) {
      if (!walk.started) return true;
      if (walk.retry > 0) {
        walk.t = walk.retry, walk.retry = 0;
        return true;
      }
      double step = step_at(cell, at);
      // A long step must not lead over what is fine in the next cell.
      const double way = volume_.cells->exit(cell, world(walk, at), walk.direction * volume_.frame.size);
      if (way < step && at + way < walk.now.end) {
        const double beyond = at + way + 1e-7;
        step = std::min(step, way + step_at(volume_.cells->cell(world(walk, beyond)), beyond));
      }
      walk.t = walk.now.end - at <= 1.01 * step ? walk.now.end : at + step;
      return true;
    }
    // A leap over cells in which nothing is to be seen.
    double t = at;
    const Vec3 d = walk.direction * volume_.frame.size;
    while (clear_[cell] && t < walk.now.end) {
      t += volume_.cells->exit(cell, world(walk, t), d, clear_[cell] - 1u) + 1e-7;
      if (t < walk.now.end) cell = volume_.cells->cell(world(walk, t));
    }
    walk.started = walk.begun = false;
    if (t >= walk.now.end) {
      walk.within = false;
      if (!walk.now.ends_at_cut || !options_.clip_faces) continue;
      walk.within = true;
      walk.t = walk.now.end;
      return true;
    }
    walk.t = t;
    return true;
  }
}

/// Whether a step is too long for what the slopes at its ends say: flat cells at walls hide layers that are much
/// thinner than samples are apart. Halving ends at a quarter of a pixel.
bool VolumeTracer::too_far(const Walk& walk, const Sample& now) const {
  const Sample& before = walk.before;
  const double d = now.t - before.t;
  if (d < 0.5 * footprint(now.t) || d < kShortest * step_at(volume_.cells->cell(world(walk, before.t)), before.t))
    return false;
  const double rise = now.value - before.value;
  const double bend = std::max(std::abs(before.slope * d - rise), std::abs(now.slope * d - rise));
  if (bend > kBent * value_range_) return true;
  if (!separate_) return false;
  const double other = now.other - before.other;
  return std::max(std::abs(before.other_slope * d - other), std::abs(now.other_slope * d - other)) >
         kBent * other_range_;
}

/// Samples of all active walks at their places.
std::size_t VolumeTracer::evaluate(Scratch& s) const {
  const std::size_t n = s.x.size();
  s.values.resize(n), s.gradients.resize(n), s.samples.resize(n);
  const bool ask = !volume_.bounded;
  s.inside.assign(ask ? n : 0, 1);
  volume_.field->evaluate(s.x, {s.values, s.gradients, s.inside});
  if (separate_) {
    s.others.resize(n), s.other_gradients.resize(n);
    volume_.opacity->evaluate(s.x, {s.others, s.other_gradients});
  }
  if (volume_.gap) {
    s.gaps.resize(n), s.gap_gradients.resize(n);
    volume_.gap->evaluate(s.x, s.gaps, s.gap_gradients);
  }
  return n;
}

void VolumeTracer::shade(const Walk& walk, Sample& sample, bool surface) const {
  if (sample.shaded) return;
  sample.shaded = true;
  sample.light = {1, 1, 1};
  sample.gloss = {};
  if (!options_.shading && !surface) return;
  const double steep = long_norm(sample.gradient);
  if (!(steep > 0)) return;
  const double weaker = weak_ / steep;
  const float share = surface ? 1.0f : static_cast<float>(1 / (1 + weaker * weaker));
  Vec3f n(sample.gradient / steep);
  const Vec3f d(walk.direction);
  float facing = dot(n, d);
  if (facing > 0) n = -n, facing = -facing;
  const auto light = [&](const Vec3f& m) {
    return lighting_.ambient(m) + Lighting::kFill * std::max(0.0f, dot(m, lighting_.fill)) +
           Lighting::kKey * std::max(0.0f, dot(m, lighting_.key));
  };
  Vec3f lit = light(n);
  // What glows has no side: at grazing angles both count, so that nothing jumps where the gradient turns away.
  if (!surface && facing > -kGrazing) {
    const float other = 0.5f * (1 + facing / kGrazing) * (1 + facing / kGrazing);
    lit = mix(lit, light(-n), other);
  }
  sample.light = mix(Vec3f{1, 1, 1}, lit, share);
  const float shine = dot(n, lighting_.key) > 0 ? highlight(dot(n, walk.half)) : 0;
  sample.gloss = (Lighting::kKey * shine + Lighting::kSkyHigh * (surface ? lighting_.sheen(n, d) : 0)) * share;
}

void VolumeTracer::lay(Walk& walk, const Vec3f& light, double opacity) const {
  walk.light += Vec3(light) * (walk.left * opacity);
  walk.left *= 1 - opacity;
}

void VolumeTracer::cut_face(Walk& walk, const Sample& sample) const {
  if (!sample.inside) return;
  double opacity = 1;
  if (options_.opacity_factor > 0)
    opacity = std::min(1.0, transfer_.opacity(separate_ ? sample.other : sample.value) / kFaceOpacity);
  if (opacity > 0) lay(walk, linear_color(transfer_.color(sample.value)), opacity);
}

/// The face behind a gap, lit by the gradient of the gap.
void VolumeTracer::gap_face(Walk& walk, const Sample& sample) const {
  if (!options_.clip_faces || !sample.inside) return;
  double opacity = 1;
  if (options_.opacity_factor > 0) {
    opacity = std::min(1.0, transfer_.opacity(separate_ ? sample.other : sample.value) / kFaceOpacity);
  } else if (least_shown_ && sample.value < *least_shown_) {
    return;
  }
  if (!(opacity > 0)) return;
  Sample face = sample;
  face.gradient = face.gap_gradient, face.shaded = false;
  if (options_.shading) shade(walk, face, true);
  const Vec3f color = linear_color(transfer_.color(sample.value));
  lay(walk, shoulder(product(color, face.light) + face.gloss), opacity);
}

/// Whether a gap may begin and end, or what is between two gaps, within a step, as the slopes at its ends say.
bool VolumeTracer::may_pass_face(const Walk& walk, const Sample& now) const {
  const Sample& before = walk.before;
  const double d = now.t - before.t;
  if ((before.gap > 0) != (now.gap > 0) || d < 0.5 * footprint(now.t)) return false;
  const double side = now.gap > 0 ? -1 : 1;  // going up is towards a face
  const double rise = side * before.gap_slope, fall = side * now.gap_slope;
  if (!(rise > 0) || !(fall < 0)) return false;
  // Two lines meet where they would be highest.
  const double v0 = side * before.gap, v1 = side * now.gap;
  const double at = std::clamp((v1 - v0 - fall * d) / (rise - fall), 0.0, d);
  return v0 + rise * at > 0;
}

/// Where steps of this round lead into a gap or out of it: a sample beside the face is to be seen first.
std::size_t VolumeTracer::find_faces(Scratch& s) const {
  struct Face {
    std::size_t i;
    double low, high, low_gap, high_gap, t;
  };
  std::vector<Face> faces;
  for (std::size_t i = 0; i < s.active.size(); ++i) {
    const Walk& walk = s.walks[s.active[i]];
    const Sample& now = s.samples[i];
    if (!walk.started || now.again || (walk.before.gap > 0) == (now.gap > 0)) continue;
    Face f{i, walk.before.t, now.t, walk.before.gap, now.gap, 0};
    f.t = f.low + (f.high - f.low) * std::clamp(f.low_gap / (f.low_gap - f.high_gap), 0.02, 0.98);
    faces.push_back(f);
  }
  std::size_t count = 0;
  std::vector<std::size_t> open(faces.size());
  for (std::size_t k = 0; k < open.size(); ++k) open[k] = k;
  std::vector<Vec3> x;
  std::vector<double> gaps;
  const auto beside = [&](const Face& f) { return kBesideFace * footprint(f.high); };
  for (int round = 0; round < 4 * kRootRounds && !open.empty(); ++round) {
    x.clear();
    for (const std::size_t k : open) x.push_back(world(s.walks[s.active[faces[k].i]], faces[k].t));
    gaps.resize(x.size());
    volume_.gap->evaluate(x, gaps);
    count += x.size();
    std::size_t kept = 0;
    for (std::size_t n = 0; n < open.size(); ++n) {
      Face& f = faces[open[n]];
      if ((gaps[n] > 0) == (f.low_gap > 0)) {
        f.low = f.t, f.low_gap = gaps[n];
      } else {
        f.high = f.t, f.high_gap = gaps[n];
      }
      const double width = f.high - f.low;
      if (width < 0.25 * beside(f)) continue;
      // The secant, a little beyond so that the face comes between; every third time the middle.
      const double share = std::clamp(f.low_gap / (f.low_gap - f.high_gap), 0.0, 1.0), more = 0.1 * beside(f) / width;
      f.t = f.low + width * (round % 3 == 2 ? 0.5 : std::clamp(share + (share < 0.5 ? more : -more), 0.02, 0.98));
      open[kept++] = open[n];
    }
    open.resize(kept);
  }
  for (const Face& f : faces) {
    Walk& walk = s.walks[s.active[f.i]];
    Sample& now = s.samples[f.i];
    const bool into = walk.before.gap <= 0;
    const double at = into ? f.low - beside(f) : f.high + beside(f);
    const double left = into ? f.low - walk.before.t : now.t - f.high;
    if (left <= 2 * beside(f) || walk.face_tries >= kFaceTries) {
      now.on_face = !into;
      walk.face_tries = 0;
      continue;
    }
    ++walk.face_tries;
    now.again = true;
    walk.retry = at;
  }
  return count;
}

/// Emission and absorption between two shares of a step.
void VolumeTracer::absorb(Walk& walk, const Sample& a, const Sample& b, double from, double to) const {
  const double d = b.t - a.t;
  if (!(to > from) || !(d > 0) || extinction_ == 0) return;
  const double scale = colors_.scale();
  const Cubic value(colors_.place(a.value), a.slope * d * scale, colors_.place(b.value), b.slope * d * scale);
  const double other_scale = depths_.scale();
  const Cubic other(depths_.place(a.other), a.other_slope * d * other_scale, depths_.place(b.other),
                    b.other_slope * d * other_scale);
  const Cubic& dense = separate_ ? other : value;

  // How bent the value is, how far it goes, and how much is absorbed say how many pieces are needed.
  double u = dense(from);
  const double end = dense(to), span = std::abs(end - u);
  const double bend = (std::abs(dense.a) + std::abs(dense.b)) * (to - from) * (to - from);
  TransferTable::Entry dark = depths_.at(u);
  const TransferTable::Entry dark_end = depths_.at(end);
  const double mean = span > kFlat ? (dark_end.depth - dark.depth) / (end - u) : depths_.density(u).depth;
  if (mean == 0 && bend < 0.5) return;
  const double depth = mean * extinction_ * d * (to - from);
  const double wish = 1 + bend * (16.0 / TransferTable::kBins) + span * (6.0 / TransferTable::kBins) + 2 * depth;
  const int pieces = index_in<int>(wish, 1, kMostPieces);
  const double piece = (to - from) / pieces, length = piece * d * extinction_;

  double v = separate_ ? value(from) : u;
  TransferTable::Entry bright = separate_ ? colors_.at(v) : dark;
  Vec3 glow;
  double left = walk.left;
  for (int i = 0; i < pieces; ++i) {
    const double s = from + (i + 1) * piece;
    const double un = i + 1 == pieces ? end : dense(s), vn = separate_ ? value(s) : un;
    const TransferTable::Entry dark_next = i + 1 == pieces ? dark_end : depths_.at(un);
    const TransferTable::Entry bright_next = separate_ ? colors_.at(vn) : dark_next;
    const double steep =
        std::abs(un - u) > kFlat ? (dark_next.depth - dark.depth) / (un - u) : depths_.density(u).depth;
    if (steep > 0) {
      // The mean colour of what glows between the two values.
      TransferTable::Entry share{bright_next.depth - bright.depth, bright_next.red - bright.red,
                                 bright_next.green - bright.green, bright_next.blue - bright.blue};
      if (std::abs(vn - v) <= kFlat || share.depth == 0) share = colors_.density(v);
      const double opacity = absorbed(steep * length), weight = left * opacity;
      const double scaled = share.depth != 0 ? weight / share.depth : 0;
      const float middle = static_cast<float>(s - 0.5 * piece);
      const Vec3f light = mix(a.light, b.light, middle), gloss = mix(a.gloss, b.gloss, middle);
      glow.x += scaled * share.red * static_cast<double>(light.x) + weight * static_cast<double>(gloss.x);
      glow.y += scaled * share.green * static_cast<double>(light.y) + weight * static_cast<double>(gloss.y);
      glow.z += scaled * share.blue * static_cast<double>(light.z) + weight * static_cast<double>(gloss.z);
      left -= weight;
    }
    u = un, v = vn, dark = dark_next, bright = bright_next;
  }
  walk.light += glow;
  walk.left = left;
}

/// From one sample to the next, through the iso-surfaces between them.
void VolumeTracer::go_through(Walk& walk, Sample& a, Sample& b, std::span<Root> roots) const {
  if (!a.inside || !b.inside) return;
  const double d = b.t - a.t;
  const double first = separate_ ? a.other : a.value, second = separate_ ? b.other : b.value;
  const double slope =
      d * std::max(std::abs(separate_ ? a.other_slope : a.slope), std::abs(separate_ ? b.other_slope : b.slope));
  const double margin = 0.3 * slope;
  if (extinction_ > 0 && !depths_.clear(std::min(first, second) - margin, std::max(first, second) + margin)) {
    shade(walk, a, false);
    shade(walk, b, false);
  }
  double at = 0;
  for (Root& root : roots) {
    if (!root.hit) continue;
    const double s = std::clamp((root.sample.t - a.t) / d, at, 1.0);
    absorb(walk, a, b, at, s);
    at = s;
    shade(walk, root.sample, true);
    const Vec3f light = shoulder(product(iso_colors_[root.iso], root.sample.light) + root.sample.gloss);
    lay(walk, light, options_.isos[root.iso].opacity);
    if (walk.left <= options_.least_light) break;
  }
  if (walk.left > options_.least_light) absorb(walk, a, b, at, 1);
}

/// Places where iso-surfaces cross the steps of this round; by walk and distance.
std::size_t VolumeTracer::find_roots(Scratch& s) const {
  constexpr int kRootParts = 4;  // of a step that are looked at for a change of sign: a cubic has up to three roots
  s.roots.clear();
  for (std::size_t i = 0; i < s.active.size(); ++i) {
    const Walk& walk = s.walks[s.active[i]];
    const Sample &a = walk.before, &b = s.samples[i];
    if (!walk.started || b.again || !a.inside || !b.inside) continue;
    const double d = b.t - a.t;
    if (!(d > 0)) continue;
    const Cubic value(a.value, a.slope * d, b.value, b.slope * d);
    for (std::size_t k = 0; k < options_.isos.size(); ++k) {
      const double level = options_.isos[k].value;
      double low = a.value - level;
      for (int p = 1; p <= kRootParts; ++p) {
        const double high = (p == kRootParts ? b.value : value(p / double(kRootParts))) - level;
        if ((low >= 0) != (high >= 0)) {
          Root root;
          root.walk = static_cast<std::uint32_t>(i), root.iso = static_cast<std::uint32_t>(k);
          root.low = a.t + d * (p - 1) / kRootParts, root.high = p == kRootParts ? b.t : a.t + d * p / kRootParts;
          root.low_value = low, root.high_value = high, root.d = d;
          // Of a single change the ends of the step are as good as those of the part, and known for certain.
          if ((a.value >= level) != (b.value >= level)) root.sure = true;
          s.roots.push_back(root);
        }
        low = high;
      }
    }
  }
  if (s.roots.empty()) return 0;
  // Changes of sign that only the cubic sees are one of several in their step: those are checked.
  std::size_t count = 0;
  std::vector<std::size_t> open;
  std::vector<Vec3> x, gradients;
  std::vector<double> values, others;
  for (std::size_t r = 0; r < s.roots.size(); ++r) {
    Root& root = s.roots[r];
    root.sample.t =
        root.low + (root.high - root.low) * std::clamp(root.low_value / (root.low_value - root.high_value), 0.02, 0.98);
    const auto same = [&](const Root& o) { return o.walk == root.walk && o.iso == root.iso; };
    const bool alone = (r == 0 || !same(s.roots[r - 1])) && (r + 1 == s.roots.size() || !same(s.roots[r + 1]));
    if (root.sure && alone) {
      const Walk& walk = s.walks[s.active[root.walk]];
      const double level = options_.isos[root.iso].value;
      root.low = walk.before.t, root.low_value = walk.before.value - level;
      root.high = s.samples[root.walk].t, root.high_value = s.samples[root.walk].value - level;
    } else {
      root.sure = false;
    }
    open.push_back(r);
  }
  for (int round = 0; round < kRootRounds && !open.empty(); ++round) {
    x.clear();
    for (const std::size_t r : open) x.push_back(world(s.walks[s.active[s.roots[r].walk]], s.roots[r].sample.t));
    values.resize(x.size()), gradients.resize(x.size());
    volume_.field->evaluate(x, {values, gradients});
    count += x.size();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < open.size(); ++i) {
      Root& root = s.roots[open[i]];
      const Walk& walk = s.walks[s.active[root.walk]];
      Sample& now = root.sample;
      now.value = values[i], now.gradient = gradients[i] * volume_.frame.size;
      const double value = values[i] - options_.isos[root.iso].value;
      const double slope = dot(now.gradient, walk.direction);
      if ((value >= 0) == (root.low_value >= 0)) {
        root.low = now.t, root.low_value = value;
      } else {
        root.high = now.t, root.high_value = value;
      }
      const double tolerance = std::max(1e-4 * root.d, 0.01 * footprint(now.t));
      double next = slope != 0 ? now.t - value / slope : now.t;
      const double change = std::abs(next - now.t);
      if ((slope != 0 && change < tolerance && next >= root.low - tolerance && next <= root.high + tolerance) ||
          root.high - root.low < tolerance || value == 0) {
        root.hit = root.sure || std::abs(value) <= 4 * std::abs(slope) * tolerance;
        if (slope != 0 && change < tolerance) now.t = std::clamp(next, root.low, root.high);
        continue;
      }
      const double inner = 0.02 * (root.high - root.low);
      if (!(next > root.low + inner && next < root.high - inner) || round > 4) next = 0.5 * (root.low + root.high);
      now.t = next;
      open[kept++] = open[i];
    }
    open.resize(kept);
  }
  for (const std::size_t r : open) s.roots[r].hit = s.roots[r].sure;
  std::stable_sort(s.roots.begin(), s.roots.end(), [](const Root& a, const Root& b) {
    return a.walk != b.walk ? a.walk < b.walk : a.sample.t < b.sample.t;
  });
  return count;
}

/// Where surfaces stand in the way of the rays, and how they look.
void VolumeTracer::find_layers(const EyeRays& rays, Scratch& s) const {
  std::vector<std::size_t> first;
  std::vector<SurfacePoint> points;
  for (const PictureScene* scene : volume_.surfaces) {
    scene->layers(rays, first, points);
    for (std::size_t i = 0; i < rays.size(); ++i)
      for (std::size_t k = first[i]; k < first[i + 1]; ++k) {
        const SurfacePoint& p = points[k];
        Pixel pixel;
        pixel.color = p.color, pixel.ambient = lighting_.ambient(p.normal), pixel.open = pixel.lit = 1;
        pixel.facing = std::max(0.0f, dot(p.normal, lighting_.key));
        pixel.fill = std::max(0.0f, dot(p.normal, lighting_.fill));
        pixel.shine = pixel.facing > 0 ? p.gloss * lighting_.shine(p.normal, rays.directions[i]) : 0;
        pixel.sheen = p.gloss * lighting_.sheen(p.normal, rays.directions[i]);
        pixel.beyond = p.beyond;
        s.layers.push_back(
            {static_cast<double>(p.distance), surface_light(pixel), p.opacity, static_cast<std::uint32_t>(i)});
      }
  }
  std::stable_sort(s.layers.begin(), s.layers.end(),
                   [](const Layer& a, const Layer& b) { return a.ray != b.ray ? a.ray < b.ray : a.t < b.t; });
  for (std::size_t k = 0; k < s.layers.size(); ++k) {
    Walk& walk = s.walks[s.layers[k].ray];
    if (walk.layers == 0) walk.layer = k;
    walk.layers = k + 1;
  }
}

std::size_t VolumeTracer::trace(const EyeRays& eye, std::span<TracedLight> lights) const {
  Scratch s;
  s.walks.resize(eye.size());
  std::vector<VolumeRay> rays(eye.size());
  for (std::size_t i = 0; i < rays.size(); ++i) rays[i] = {Vec3(eye.origin(i)), normalized(Vec3(eye.directions[i]))};
  volume_.stretches->find(rays, options_.clips, s.stretches, s.first);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Walk& walk = s.walks[i];
    walk.origin = rays[i].origin;
    walk.direction = rays[i].direction;
    walk.half = normalized(lighting_.key - eye.directions[i]);
    walk.slot = static_cast<std::uint32_t>(i);
    walk.stretch = s.first[i], walk.last = s.first[i + 1];
  }
  find_layers(eye, s);

  std::size_t count = 0;
  s.active.resize(eye.size());
  for (std::size_t i = 0; i < s.active.size(); ++i) s.active[i] = static_cast<std::uint32_t>(i);
  for (;;) {
    std::size_t kept = 0;
    s.x.clear();
    for (const std::uint32_t w : s.active) {
      if (!next_place(s.walks[w], s)) continue;
      s.active[kept++] = w;
      s.x.push_back(world(s.walks[w], s.walks[w].t));
    }
    s.active.resize(kept);
    if (kept == 0) break;
    count += evaluate(s);
    for (std::size_t i = 0; i < kept; ++i) {
      const Walk& walk = s.walks[s.active[i]];
      Sample& now = s.samples[i];
      now = {};
      now.t = walk.t, now.value = s.values[i];
      const Vec3 gradient = s.gradients[i] * volume_.frame.size;
      now.slope = dot(gradient, walk.direction);
      now.gradient = gradient;
      if (separate_) {
        now.gradient = s.other_gradients[i] * volume_.frame.size;
        now.other = s.others[i], now.other_slope = dot(now.gradient, walk.direction);
      }
      now.inside = s.inside.empty() || s.inside[i];
      if (volume_.gap) {
        now.gap = s.gaps[i], now.gap_gradient = s.gap_gradients[i] * volume_.frame.size;
        now.gap_slope = dot(now.gap_gradient, walk.direction);
        now.inside = now.inside && now.gap <= 0;
      }
      const bool both = walk.started && walk.before.gap <= 0 && now.gap <= 0;
      if (walk.started && ((both && too_far(walk, now)) || (volume_.gap && may_pass_face(walk, now)))) {
        now.again = true;
        s.walks[s.active[i]].retry = 0.5 * (walk.before.t + now.t);
      }
    }
    if (volume_.gap) count += find_faces(s);
    if (!options_.isos.empty()) count += find_roots(s);
    std::size_t root = 0;
    for (std::size_t i = 0; i < kept; ++i) {
      Walk& walk = s.walks[s.active[i]];
      Sample& now = s.samples[i];
      if (now.again) continue;
      std::size_t last = root;
      while (last < s.roots.size() && s.roots[last].walk == i) ++last;
      if (walk.begun && walk.now.begins_at_cut && options_.clip_faces) cut_face(walk, now);
      walk.begun = false;
      if (now.on_face) gap_face(walk, now);
      if (walk.started) go_through(walk, walk.before, now, std::span(s.roots).subspan(root, last - root));
      root = last;
      if (walk.left <= options_.least_light) {
        walk.left = 0, walk.within = false;
        continue;
      }
      walk.before = now;
      walk.started = true;
      if (now.t < walk.now.end) continue;
      if (walk.now.ends_at_cut && options_.clip_faces) cut_face(walk, now);
      walk.within = walk.started = false;
    }
  }
  for (const Walk& walk : s.walks) {
    TracedLight& found = lights[walk.slot];
    found.light = Vec3f(walk.light);
    found.left = static_cast<float>(walk.left);
  }
  return count;
}

}  // namespace sansmesh::inline v1
