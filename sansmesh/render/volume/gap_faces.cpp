#include "sansmesh/render/volume/gap_faces.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace sansmesh::inline v1::detail {
namespace {

constexpr double kBesideFace = 0.02;  // pixels: distance of a sample from the face of a gap that it represents
constexpr int kFaceTries = 6;
constexpr int kFaceRounds = 40;

}  // namespace

bool may_pass_face(const TracedFrame& frame, const TracedSample& before, const TracedSample& now) {
  const double d = now.t - before.t;
  if ((before.gap > 0) != (now.gap > 0) || d < 0.5 * frame.footprint(now.t)) return false;
  const double side = now.gap > 0 ? -1 : 1;  // a rising value approaches a face
  const double rise = side * before.gap_slope, fall = side * now.gap_slope;
  if (!(rise > 0) || !(fall < 0)) return false;
  // The intersection of the two tangents bounds the maximum.
  const double v0 = side * before.gap, v1 = side * now.gap;
  const double at = std::clamp((v1 - v0 - fall * d) / (rise - fall), 0.0, d);
  return v0 + rise * at > 0;
}

std::size_t find_gap_faces(const ScalarField& gap, const TracedFrame& frame, const TracedRound& round) {
  struct Face {
    std::size_t i;
    double low, high, low_gap, high_gap, t;
  };
  std::vector<Face> faces;
  for (std::size_t i = 0; i < round.active.size(); ++i) {
    const TracedWalk& walk = round.walk(i);
    const TracedSample& now = round.samples[i];
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
  const auto beside = [&](const Face& f) { return kBesideFace * frame.footprint(f.high); };
  for (int turn = 0; turn < kFaceRounds && !open.empty(); ++turn) {
    x.clear();
    for (const std::size_t k : open) x.push_back(frame.world(round.walk(faces[k].i), faces[k].t));
    gaps.resize(x.size());
    gap.evaluate(x, gaps);
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
      // The secant, slightly beyond the root to bracket the face; every third time the middle.
      const double share = std::clamp(f.low_gap / (f.low_gap - f.high_gap), 0.0, 1.0), more = 0.1 * beside(f) / width;
      f.t = f.low + width * (turn % 3 == 2 ? 0.5 : std::clamp(share + (share < 0.5 ? more : -more), 0.02, 0.98));
      open[kept++] = open[n];
    }
    open.resize(kept);
  }
  for (const Face& f : faces) {
    TracedWalk& walk = round.walk(f.i);
    TracedSample& now = round.samples[f.i];
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

}  // namespace sansmesh::inline v1::detail
