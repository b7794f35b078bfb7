// State of the rays of a VolumeTracer.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "sansmesh/render/scene/picture_scene.h"
#include "sansmesh/render/volume/volume_intervals.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// The cubic through two values with slopes (per length of the step).
struct StepCubic {
  double a, b, c, d;
  StepCubic(double v0, double s0, double v1, double s1)
      : a(2 * (v0 - v1) + s0 + s1), b(3 * (v1 - v0) - 2 * s0 - s1), c(s0), d(v0) {}
  double operator()(double s) const { return ((a * s + b) * s + c) * s + d; }
};

struct TracedSample {
  double t = 0, value = 0, slope = 0, other = 0, other_slope = 0;  // slopes per picture length
  Vec3 gradient;                                                   // for shading, per picture length
  bool inside = true, shaded = false;
  bool again = false;    // a closer position before it must be sampled first
  bool on_face = false;  // the ray has just left a gap
  double gap = -1, gap_slope = 0;
  Vec3 gap_gradient;  // per picture length
  Vec3f light{1, 1, 1}, gloss;
};

struct TracedWalk {
  Vec3 origin, direction;
  Vec3f half;                            // half-way vector of key light and eye, for highlights
  std::uint32_t slot = 0;                // index of the ray's answer
  std::uint32_t interval = 0, last = 0;  // the next one, and their end
  RayInterval now;
  bool within = false, begun = false, started = false;  // in a interval; at its begin; `before` is valid
  double t = 0;
  double retry = 0;    // a position before t that must be sampled first; 0: none
  int face_tries = 0;  // consecutive retries for the face of a gap
  TracedSample before;
  std::optional<RayInterval> rest;    // part of a interval behind a surface in it
  std::size_t layer = 0, layers = 0;  // the next of the surfaces, and their end
  Vec3 light;
  double left = 1;
};

/// A crossing of an iso-surface in a step.
struct IsoRoot {
  std::uint32_t walk = 0, iso = 0;
  double low = 0, high = 0, low_value = 0, high_value = 0;  // bracket; values minus the iso-value
  double d = 0;                                             // length of the step
  bool sure = false;                                        // both ends were evaluated: there is a root
  bool hit = false;
  TracedSample sample;
};

/// The steps of one round: sample i is the next one of walk active[i].
struct TracedRound {
  std::span<TracedWalk> walks;
  std::span<const std::uint32_t> active;
  std::span<TracedSample> samples;

  TracedWalk& walk(std::size_t i) const { return walks[active[i]]; }
};

/// Position and resolution of the rays.
struct TracedFrame {
  PictureFrame frame;
  float pixel = 0;  // width of a pixel at distance 1, or of parallel rays at any distance
  bool parallel = false;

  Vec3 world(const TracedWalk& walk, double t) const {
    return frame.center + (walk.origin + walk.direction * t) * frame.size;
  }
  /// Width of a pixel at distance t.
  double footprint(double t) const { return static_cast<double>(pixel) * (parallel ? 1 : t); }
};

}  // namespace sansmesh::inline v1::detail
