// Stream and path surfaces by advancing fronts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/flow/flow_sheet.h"
#include "sansmesh/flow/particles_ahead.h"
#include "sansmesh/flow/seed_curve.h"
#include "sansmesh/flow/trace.h"
#include "sansmesh/flow_options.h"
#include "sansmesh/progress.h"
#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1 {

/// A particle of a front, between its neighbours.
struct FrontMember {
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::uint32_t particle = 0;
  std::uint32_t point = kNone;   ///< its last point
  std::uint32_t before = kNone;  ///< index in the previous front; none: inserted since
  double s = 0;
  Vec3 was;             ///< position at the previous front
  bool joined = false;  ///< with the next member; the last one with the first
  bool removed = false;
  bool needed = false;  ///< inserted beside an obstacle: not removed
};

/// The advancing fronts of a surface. `field` is steady for stream surfaces; the options are valid and have a `start`.
class FlowFronts {
 public:
  /// Seeds the first front.
  FlowFronts(const VectorField& field, const SeedCurve& curve, const FlowSurfaceOptions& options);

  /// Advances from the seeds in one direction, until the end of the surface.
  void run(bool backward, Progress& progress);

  FlowSheet take() { return std::move(sheet_); }

 private:
  /// Particles that moved less than this, over Δ₀, since their last point keep it; particles closer to each other than
  /// this count as one.
  static constexpr double kAtRest = 1e-3;

  const Vec3& place(const FrontMember& m) const { return particles_.positions[m.particle]; }
  bool ended(const FrontMember& m) const { return particles_.ends[m.particle].has_value(); }
  bool at_rim(const FrontMember& a, const FrontMember& b) const { return ended(a) || ended(b); }
  std::size_t next_index(std::size_t i) const { return i + 1 < next_.size() ? i + 1 : 0; }
  const FrontMember& after(std::size_t i) const { return next_[next_index(i)]; }
  bool full() const { return sheet_.points.size() + next_.size() >= options_.most_points; }

  void seed();

  double next_step(double last) const;

  /// Largest distance of a particle from one front to the next.
  double longest_way() const { return options_.alpha * spacing_; }

  double fastest() const;

  /// Advances to a front at `to`, or earlier where particles became fast on the way. `step` is the time between fronts
  /// at median speed, `end` the last moment. Returns the moment of the front.
  double advance(double from, double to, double step, double end);

  /// Moves the members at most so far that none exceeds the largest distance.
  double move_members(const std::vector<std::uint32_t>& which, double from, double to, double step);

  /// Median distance moved since the previous front, of the particles that moved.
  double median_step() const;

  enum class Gap : std::uint8_t { good, wide, torn };

  /// The two inequalities of tejada2008, 5.3.
  Gap judge(const FrontMember& a, const FrontMember& b) const;

  /// Length of the seed curve from a to the next member b.
  double span(const FrontMember& a, const FrontMember& b) const { return span(a.s, b.s); }
  double span(double a, double b) const { return b > a ? b - a : b + length_ - a; }
  /// Midpoint on the seed curve.
  double middle(double a, double b) const {
    const double s = a + 0.5 * span(a, b);
    return s >= length_ && curve_.closed ? s - length_ : s;
  }

  /// Inserts particles until no fillable gap is too wide.
  void fill_gaps(double from, double to);

  /// Separates neighbours across regions without flow.
  void pass_obstacles(double from, double to);

  /// Inserts a particle after each member of `wide`; the surface tears where none exists.
  void insert(std::span<const std::uint32_t> wide, double from, double to, bool needed);

  /// Finds particles that start at arc lengths s, the midpoints of the gaps `wide`, and their positions at the previous
  /// front.
  void find(const std::vector<double>& s, std::span<const std::uint32_t> wide, double from, double to, Particles& p,
            std::vector<Vec3>& was);

  /// Traces from the seed curve to the previous front, and to this one.
  void trace(const std::vector<double>& s, double from, double to, Particles& p, std::vector<Vec3>& was);

  std::uint32_t append(const Particles& from, std::size_t k);

  /// Members between which and the next one there is no flow half-way.
  std::vector<std::uint32_t> blocked(double time) const;

  /// A ribbon that tears somewhere ends as a whole, at the previous front: parts of it would be attached at single
  /// points.
  void drop_parted_insertions();

  /// Marks particles that are collinear with both neighbours and near them. Never two in a row.
  void remove_needless();

  /// The remaining member before or after i, if i is joined with it; else n.
  std::size_t neighbour(std::size_t i, bool after) const;

  /// Adds points for members with a neighbour. Returns whether any has moved. Where fronts are close together because
  /// of few fast particles, slow ones keep their points for some fronts, except at the last one.
  bool make_points(bool last);

  /// Triangles between the previous front and this one.
  void make_triangles();

  /// Triangulates between two rows of points, each time with the shorter diagonal.
  void zip(const std::vector<std::uint32_t>& lower, const std::vector<std::uint32_t>& upper);

  /// Keeps members with a neighbour, if one of the two continues: beside a particle that has ended, its neighbours
  /// still sweep the region between.
  void keep_continuing();

  const VectorField& field_;
  const SeedCurve& curve_;
  const FlowSurfaceOptions& options_;
  TraceOptions trace_;
  double start_ = 0, length_ = 0, spacing_ = 0, least_span_ = 0;
  FlowSheet sheet_;
  Particles particles_, seeds_;       ///< particles of this direction; particles at their starts
  std::vector<std::uint32_t> names_;  ///< indices of particles_, the same in both directions
  std::vector<FrontMember> members_, next_, first_;
  std::vector<double> moments_;    ///< moments of the fronts up to the previous one
  ParticlesAhead ahead_;           ///< particles traced along in this direction
  double share_ = 1;               ///< time between fronts over that at median speed
  double way_ = 0, most_way_ = 0;  ///< sums of the particles' median steps
  std::size_t front_ = 0, inserted_ = 0;
  double work_ = 0;  ///< moves of a particle to a front
};

/// The front at the seeds and all fronts forward, backward or both, to their ends.
FlowSheet advance_fronts(const VectorField& field, const SeedCurve& curve, const FlowSurfaceOptions& options,
                         Progress& progress);

}  // namespace sansmesh::inline v1
