#include "sansmesh/render/volume/volume_tracer.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sansmesh/render/scene/pixel.h"
#include "sansmesh/render/volume/gap_faces.h"
#include "sansmesh/render/volume/iso_roots.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kBent = 0.25;  // share of the range: largest difference between a value and the prediction of a slope
constexpr double kShortest = 0.05;  // least share of a step that is halved

}  // namespace

/// A surface along the ray.
struct VolumeTracer::Layer {
  double t = 0;
  Vec3f light;
  float opacity = 1;
  std::uint32_t ray = 0;
};

struct VolumeTracer::Scratch {
  std::vector<TracedWalk> walks;
  std::vector<RayInterval> intervals;
  std::vector<std::uint32_t> first;
  std::vector<Layer> layers;  // by ray and distance
  std::vector<std::uint32_t> active;
  std::vector<Vec3> x, gradients, other_gradients;
  std::vector<double> values, others;
  std::vector<std::uint8_t> inside;
  std::vector<double> gaps;
  std::vector<Vec3> gap_gradients;
  std::vector<TracedSample> samples;
  std::vector<IsoRoot> roots;
};

VolumeTracer::VolumeTracer(const TracedVolume& volume, const Camera& camera, const TransferFunction& transfer,
                           const VolumePictureOptions& options)
    : volume_(volume),
      frame_{volume.frame, 2 * camera.half_height / static_cast<float>(options.picture.view.height), camera.parallel},
      light_(camera, transfer, options, volume.opacity != nullptr, volume.frame.size),
      options_(options),
      separate_(volume.opacity != nullptr) {
  const auto [lower, upper] = transfer.range();
  value_range_ = upper - lower, other_range_ = transfer.opacities.back().value - transfer.opacities.front().value;
  const VolumeCells& cells = *volume.cells;
  const Vec3& edge = cells.edge();
  const double most = std::min({edge.x, edge.y, edge.z}) / frame_.frame.size;
  steps_.reserve(cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c)
    steps_.push_back(std::min(options.step * cells.spacing(c) / frame_.frame.size, most));
  clear_.assign(cells.size(), 0);
  if (!options.skip_empty) return;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const ValueRange& dense = separate_ ? cells.other_range(c) : cells.range(c);
    bool clear = light_.clear(dense.least, dense.most);
    for (const IsoSurface& iso : options.isos)
      clear = clear && !(cells.range(c).least <= iso.value && iso.value <= cells.range(c).most);
    clear_[c] = clear;
  }
  // Faces of gaps show values that are otherwise clear.
  if (volume.gap && options.clip_faces && options.opacity_factor == 0) {
    const double radius = 0.5 * norm(cells.edge());
    std::vector<Vec3> centers;
    centers.reserve(cells.size());
    for (std::size_t c = 0; c < cells.size(); ++c) centers.push_back(cells.center(c));
    std::vector<ValueRange> ranges(cells.size());
    volume.gap->ranges(centers, radius, ranges);
    for (std::size_t c = 0; c < cells.size(); ++c)
      if (ranges[c].holds_zero() && (!light_.least_shown() || cells.range(c).most >= *light_.least_shown()))
        clear_[c] = 0;
  }
  detail::clear_reach(cells, clear_);
}

/// Advances to the next interval, through the surfaces before it; false if there is none, or nothing more is visible.
bool VolumeTracer::next_interval(TracedWalk& walk, const Scratch& s) const {
  const bool more = walk.rest || walk.interval != walk.last;
  const RayInterval next = walk.rest ? *walk.rest : more ? s.intervals[walk.interval] : RayInterval{};
  for (; walk.layer != walk.layers && (!more || s.layers[walk.layer].t <= next.begin); ++walk.layer) {
    light_.lay(walk, s.layers[walk.layer].light, static_cast<double>(s.layers[walk.layer].opacity));
    if (walk.left <= options_.least_light) walk.left = 0;
  }
  if (!more || walk.left == 0) return false;
  if (!walk.rest) ++walk.interval;
  walk.rest.reset();
  walk.now = next;
  if (walk.layer != walk.layers && s.layers[walk.layer].t < next.end) {
    walk.rest = RayInterval{s.layers[walk.layer].t, next.end, false, next.ends_at_cut};
    walk.now.end = walk.rest->begin, walk.now.ends_at_cut = false;
  }
  return true;
}

/// Finds the next position of the walk; false at its end.
bool VolumeTracer::advance(TracedWalk& walk, const Scratch& scratch) const {
  for (;;) {
    if (!walk.within) {
      if (!next_interval(walk, scratch)) return false;
      walk.within = walk.begun = true;
      walk.started = false;
      walk.t = walk.now.begin;
      if (walk.now.begins_at_cut && options_.clip_faces) return true;
    }
    const double at = walk.started ? walk.before.t : walk.t;
    std::size_t cell = volume_.cells->cell(frame_.world(walk, at));
    if (!clear_[cell]) {
      if (!walk.started) return true;
      if (walk.retry > 0) {
        walk.t = walk.retry, walk.retry = 0;
        return true;
      }
      double step = step_at(cell, at);
      // A long step must not skip details in the next cell.
      const double way = volume_.cells->exit(cell, frame_.world(walk, at), walk.direction * frame_.frame.size);
      if (way < step && at + way < walk.now.end) {
        const double beyond = at + way + 1e-7;
        step = std::min(step, way + step_at(volume_.cells->cell(frame_.world(walk, beyond)), beyond));
      }
      walk.t = walk.now.end - at <= 1.01 * step ? walk.now.end : at + step;
      return true;
    }
    // Skips clear cells.
    double t = at;
    const Vec3 d = walk.direction * frame_.frame.size;
    while (clear_[cell] && t < walk.now.end) {
      t += volume_.cells->exit(cell, frame_.world(walk, t), d, clear_[cell] - 1u) + 1e-7;
      if (t < walk.now.end) cell = volume_.cells->cell(frame_.world(walk, t));
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

/// Whether a step is too long for the slopes at its ends: flat cells at walls hide layers much thinner than the
/// spacing. Halving ends at a quarter of a pixel.
bool VolumeTracer::too_far(const TracedWalk& walk, const TracedSample& now) const {
  const TracedSample& before = walk.before;
  const double d = now.t - before.t;
  if (d < 0.5 * frame_.footprint(now.t) ||
      d < kShortest * step_at(volume_.cells->cell(frame_.world(walk, before.t)), before.t))
    return false;
  const double rise = now.value - before.value;
  const double bend = std::max(std::abs(before.slope * d - rise), std::abs(now.slope * d - rise));
  if (bend > kBent * value_range_) return true;
  if (!separate_) return false;
  const double other = now.other - before.other;
  return std::max(std::abs(before.other_slope * d - other), std::abs(now.other_slope * d - other)) >
         kBent * other_range_;
}

/// Samples all active walks at their positions.
std::size_t VolumeTracer::evaluate(Scratch& s) const {
  const std::size_t n = s.x.size();
  s.values.resize(n), s.gradients.resize(n), s.samples.resize(n);
  s.inside.assign(volume_.bounded ? 0 : n, 1);
  volume_.field->evaluate(s.x, {s.values, s.gradients, s.inside});
  if (separate_) {
    s.others.resize(n), s.other_gradients.resize(n);
    volume_.opacity->evaluate(s.x, {s.others, s.other_gradients});
  }
  if (volume_.gap) {
    s.gaps.resize(n), s.gap_gradients.resize(n);
    volume_.gap->evaluate(s.x, s.gaps, s.gap_gradients);
  }
  const double size = frame_.frame.size;
  for (std::size_t i = 0; i < n; ++i) {
    TracedWalk& walk = s.walks[s.active[i]];
    TracedSample& now = s.samples[i];
    now = {};
    now.t = walk.t, now.value = s.values[i];
    now.gradient = s.gradients[i] * size;
    now.slope = dot(now.gradient, walk.direction);
    if (separate_) {
      now.gradient = s.other_gradients[i] * size;
      now.other = s.others[i], now.other_slope = dot(now.gradient, walk.direction);
    }
    now.inside = s.inside.empty() || s.inside[i];
    if (volume_.gap) {
      now.gap = s.gaps[i], now.gap_gradient = s.gap_gradients[i] * size;
      now.gap_slope = dot(now.gap_gradient, walk.direction);
      now.inside = now.inside && now.gap <= 0;
    }
    if (!walk.started) continue;
    const bool both = walk.before.gap <= 0 && now.gap <= 0;
    if ((both && too_far(walk, now)) || (volume_.gap && detail::may_pass_face(frame_, walk.before, now))) {
      now.again = true;
      walk.retry = 0.5 * (walk.before.t + now.t);
    }
  }
  return n;
}

/// Hits of the surfaces along the rays, and their appearance.
void VolumeTracer::find_layers(const EyeRays& rays, Scratch& s) const {
  std::vector<std::size_t> first;
  std::vector<SurfacePoint> points;
  for (const PictureScene* scene : volume_.surfaces) {
    scene->layers(rays, first, points);
    for (std::size_t i = 0; i < rays.size(); ++i)
      for (std::size_t k = first[i]; k < first[i + 1]; ++k) {
        const SurfacePoint& p = points[k];
        Pixel pixel;
        pixel.color = p.color, pixel.ambient = light_.lighting().ambient(p.normal), pixel.open = pixel.lit = 1;
        pixel.facing = std::max(0.0f, dot(p.normal, light_.lighting().key));
        pixel.fill = std::max(0.0f, dot(p.normal, light_.lighting().fill));
        pixel.shine = pixel.facing > 0 ? p.gloss * light_.lighting().shine(p.normal, rays.directions[i]) : 0;
        pixel.sheen = p.gloss * light_.lighting().sheen(p.normal, rays.directions[i]);
        pixel.beyond = p.beyond;
        s.layers.push_back(
            {static_cast<double>(p.distance), surface_light(pixel), p.opacity, static_cast<std::uint32_t>(i)});
      }
  }
  std::stable_sort(s.layers.begin(), s.layers.end(),
                   [](const Layer& a, const Layer& b) { return a.ray != b.ray ? a.ray < b.ray : a.t < b.t; });
  for (std::size_t k = 0; k < s.layers.size(); ++k) {
    TracedWalk& walk = s.walks[s.layers[k].ray];
    if (walk.layers == 0) walk.layer = k;
    walk.layers = k + 1;
  }
}

/// Adds the light of a step from the walk's last sample to `now`.
void VolumeTracer::take_step(TracedWalk& walk, TracedSample& now, std::span<IsoRoot> roots) const {
  if (walk.begun && walk.now.begins_at_cut && options_.clip_faces) light_.cut_face(walk, now);
  walk.begun = false;
  if (now.on_face) light_.gap_face(walk, now);
  if (walk.started) light_.go_through(walk, walk.before, now, roots);
  if (walk.left <= options_.least_light) {
    walk.left = 0, walk.within = false;
    return;
  }
  walk.before = now;
  walk.started = true;
  if (now.t < walk.now.end) return;
  if (walk.now.ends_at_cut && options_.clip_faces) light_.cut_face(walk, now);
  walk.within = walk.started = false;
}

std::size_t VolumeTracer::trace(const EyeRays& eye, std::span<TracedLight> lights) const {
  Scratch s;
  s.walks.resize(eye.size());
  std::vector<VolumeRay> rays(eye.size());
  for (std::size_t i = 0; i < rays.size(); ++i) rays[i] = {Vec3(eye.origin(i)), normalized(Vec3(eye.directions[i]))};
  volume_.intervals->find(rays, options_.clips, s.intervals, s.first);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    TracedWalk& walk = s.walks[i];
    walk.origin = rays[i].origin;
    walk.direction = rays[i].direction;
    walk.half = normalized(light_.lighting().key - eye.directions[i]);
    walk.slot = static_cast<std::uint32_t>(i);
    walk.interval = s.first[i], walk.last = s.first[i + 1];
  }
  find_layers(eye, s);

  std::size_t count = 0;
  s.active.resize(eye.size());
  std::iota(s.active.begin(), s.active.end(), 0u);
  for (;;) {
    std::size_t kept = 0;
    s.x.clear();
    for (const std::uint32_t w : s.active) {
      if (!advance(s.walks[w], s)) continue;
      s.active[kept++] = w;
      s.x.push_back(frame_.world(s.walks[w], s.walks[w].t));
    }
    s.active.resize(kept);
    if (kept == 0) break;
    count += evaluate(s);
    const detail::TracedRound round{s.walks, s.active, s.samples};
    if (volume_.gap) count += detail::find_gap_faces(*volume_.gap, frame_, round);
    if (!options_.isos.empty()) count += detail::find_iso_roots(*volume_.field, frame_, options_.isos, round, s.roots);
    std::size_t root = 0;
    for (std::size_t i = 0; i < kept; ++i) {
      if (s.samples[i].again) continue;
      const std::size_t first = root;
      while (root < s.roots.size() && s.roots[root].walk == i) ++root;
      take_step(round.walk(i), s.samples[i], std::span(s.roots).subspan(first, root - first));
    }
  }
  for (const TracedWalk& walk : s.walks) {
    TracedLight& found = lights[walk.slot];
    found.light = Vec3f(walk.light);
    found.left = static_cast<float>(walk.left);
  }
  return count;
}

}  // namespace sansmesh::inline v1
