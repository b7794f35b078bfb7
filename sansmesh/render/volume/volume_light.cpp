#include "sansmesh/render/volume/volume_light.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/binary_scale.h"
#include "sansmesh/core/index_in.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr double kReferenceShare = 0.02;  // default reference length, as a share of the diagonal
constexpr int kMostPieces = 10;           // pieces of a step with separate integrals
constexpr double kFlat = 1e-6;            // least distance of table coordinates for a difference quotient
constexpr float kGrazing = 0.4f;
constexpr double kFaceOpacity = 0.004;  // least opacity at which a cut face is opaque

/// 1 − e^−x for x >= 0.
double absorbed(double x) {
  if (x > 0.03) return -std::expm1(-x);
  return x * (1 - x * (0.5 - x * (1.0 / 6 - x * (1.0 / 24))));  // error up to 2e-10
}

}  // namespace

VolumeLight::VolumeLight(const Camera& camera, const TransferFunction& transfer, const VolumePictureOptions& options,
                         bool separate, double size)
    : lighting_(camera),
      transfer_(transfer),
      colors_(separate ? TransferTable::colors_only(transfer) : TransferTable(transfer)),
      depths_(transfer),
      options_(options),
      separate_(separate) {
  const double reference = transfer.reference_length ? *transfer.reference_length / size : kReferenceShare;
  extinction_ = options.opacity_factor / reference;
  const auto [lower, upper] = transfer.range();
  weak_ = 1.5 * (separate ? transfer.opacities.back().value - transfer.opacities.front().value : upper - lower);
  for (const IsoSurface& iso : options.isos)
    iso_colors_.push_back(linear_color(iso.color ? *iso.color : transfer.color(iso.value)));
  if (options.opacity_factor == 0)
    for (const IsoSurface& iso : options.isos) least_shown_ = std::min(least_shown_.value_or(iso.value), iso.value);
}

void VolumeLight::shade(const TracedWalk& walk, TracedSample& sample, bool surface) const {
  if (sample.shaded) return;
  sample.shaded = true;
  sample.light = {1, 1, 1};
  sample.gloss = {};
  if (!options_.shading && !surface) return;
  const double steep = safe_norm(sample.gradient);
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
  // Emission has no side: at grazing angles both count, so that shading is continuous where the gradient turns away.
  if (!surface && facing > -kGrazing) {
    const float other = 0.5f * (1 + facing / kGrazing) * (1 + facing / kGrazing);
    lit = mix(lit, light(-n), other);
  }
  sample.light = mix(Vec3f{1, 1, 1}, lit, share);
  const float shine = dot(n, lighting_.key) > 0 ? highlight(dot(n, walk.half)) : 0;
  sample.gloss = (Lighting::kKey * shine + Lighting::kSkyHigh * (surface ? lighting_.sheen(n, d) : 0)) * share;
}

void VolumeLight::lay(TracedWalk& walk, const Vec3f& light, double opacity) const {
  walk.light += Vec3(light) * (walk.left * opacity);
  walk.left *= 1 - opacity;
}

void VolumeLight::cut_face(TracedWalk& walk, const TracedSample& sample) const {
  if (!sample.inside) return;
  double opacity = 1;
  if (options_.opacity_factor > 0)
    opacity = std::min(1.0, transfer_.opacity(separate_ ? sample.other : sample.value) / kFaceOpacity);
  if (opacity > 0) lay(walk, linear_color(transfer_.color(sample.value)), opacity);
}

void VolumeLight::gap_face(TracedWalk& walk, const TracedSample& sample) const {
  if (!options_.clip_faces || !sample.inside) return;
  double opacity = 1;
  if (options_.opacity_factor > 0) {
    opacity = std::min(1.0, transfer_.opacity(separate_ ? sample.other : sample.value) / kFaceOpacity);
  } else if (least_shown_ && sample.value < *least_shown_) {
    return;
  }
  if (!(opacity > 0)) return;
  TracedSample face = sample;
  face.gradient = face.gap_gradient, face.shaded = false;
  if (options_.shading) shade(walk, face, true);
  const Vec3f color = linear_color(transfer_.color(sample.value));
  lay(walk, shoulder(product(color, face.light) + face.gloss), opacity);
}

/// Emission and absorption between two shares of a step.
void VolumeLight::absorb(TracedWalk& walk, const TracedSample& a, const TracedSample& b, double from, double to) const {
  const double d = b.t - a.t;
  if (!(to > from) || !(d > 0) || extinction_ == 0) return;
  const double scale = colors_.scale();
  const StepCubic value(colors_.coordinate(a.value), a.slope * d * scale, colors_.coordinate(b.value),
                        b.slope * d * scale);
  const double other_scale = depths_.scale();
  const StepCubic other(depths_.coordinate(a.other), a.other_slope * d * other_scale, depths_.coordinate(b.other),
                        b.other_slope * d * other_scale);
  const StepCubic& dense = separate_ ? other : value;

  // The number of pieces follows from the bend of the value, its range, and the absorption.
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
      // The mean emitted colour between the two values.
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

void VolumeLight::go_through(TracedWalk& walk, TracedSample& a, TracedSample& b, std::span<IsoRoot> roots) const {
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
  for (IsoRoot& root : roots) {
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

}  // namespace sansmesh::inline v1::detail
