#include "sansmesh/flow/released_sheet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "sansmesh/core/edge_key.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/data/triangles.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::uint32_t kNothing = ~std::uint32_t{0};
/// Edges with a particle that does not arrive, or across a region without flow, are halved down to this fraction of
/// their initial extent.
constexpr double kLeastPartAtRim = 1.0 / 8;
/// Least distance of rows in units of the rounding of moments; closer rows would be released at the same moment.
constexpr double kLeastSpacing = 4;

class ReleasedSheet {
 public:
  ReleasedSheet(const VectorField& field, const SeedCurve& curve, const FlowSurfaceOptions& options)
      : field_(field), curve_(curve), options_(options), trace_(options.trace) {
    trace_.backward = options.direction == FlowDirection::backward;
    streak_ = options.kind == FlowSurfaceKind::streak;
    length_ = curve.length();
    spacing_ = length_ / static_cast<double>(curve.closed ? *options.seeds : *options.seeds - 1);
    end_ = *options.start + (trace_.backward ? -1 : 1) * *options.duration;
    least_part_ = least_seed_distance(field, trace_) / spacing_;
    sheet_.report.spacing = spacing_;
  }

  FlowSheet make(Progress& progress) {
    progress.begin("particles", 1);
    lay();
    progress.begin("refine", 1);
    while (!active_.empty() && refine()) progress.check();
    std::sort(torn_.begin(), torn_.end());
    sheet_.report.tears = static_cast<std::size_t>(std::unique(torn_.begin(), torn_.end()) - torn_.begin());
    sheet_.report.particles = s_.size();
    for (std::size_t i = 0; i < s_.size(); ++i) {
      FlowPoint point;
      point.position = particles_.positions[i], point.velocity = particles_.velocities[i];
      point.s = s_[i], point.t = streak_ ? released(row_[i]) : end_;
      point.front = whole_part<std::int32_t>(std::round(row_[i] / row_spacing_));
      point.particle = static_cast<std::uint32_t>(i);
      sheet_.points.push_back(point);
      if (particles_.ends[i]) ++sheet_.report.ends[static_cast<std::size_t>(*particles_.ends[i])];
    }
    progress.finish();
    return std::move(sheet_);
  }

 private:
  /// Rows are parametrised by age, or by the swept fraction of the curve.
  double released(double row) const {
    return row == row_extent_ ? *options_.start : end_ + (trace_.backward ? row : -row);
  }

  /// Spacing of floating-point numbers at the largest moment.
  double rounding_of_moments() const {
    const double largest = std::max(std::abs(*options_.start), std::abs(end_));
    return std::nextafter(largest, std::numeric_limits<double>::infinity()) - largest;
  }

  /// Traces the particles with these s and rows to the end.
  void follow(std::span<const double> s, std::span<const double> rows) {
    std::vector<Vec3> seeds = curve_.at(s);
    std::vector<double> moments(s.size(), *options_.start);
    for (std::size_t i = 0; i < s.size(); ++i) {
      if (streak_)
        moments[i] = released(rows[i]);
      else
        seeds[i] += *options_.sweep * (rows[i] / row_extent_);
    }
    Particles p = particles_at(field_, seeds, moments);
    std::vector<std::uint32_t> all(s.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint32_t>(i);
    move_particles(field_, p, all, end_, trace_);
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    append(s_, s), append(row_, rows);
    append(particles_.positions, p.positions), append(particles_.velocities, p.velocities);
    append(particles_.ends, p.ends);
  }

  /// Creates rows of as many particles as there are seeds.
  void lay() {
    const std::size_t n = *options_.seeds;
    std::vector<double> line(n);
    for (std::size_t i = 0; i < n; ++i) line[i] = std::min(spacing_ * static_cast<double>(i), length_);
    row_extent_ = streak_ ? *options_.duration : norm(*options_.sweep);
    double step = spacing_;
    if (streak_) {
      const Particles p = particles_at(field_, curve_.at(line), std::vector<double>(n, *options_.start));
      std::vector<double> speeds;
      for (std::size_t i = 0; i < n; ++i)
        if (!p.ends[i]) speeds.push_back(norm(p.velocities[i]));
      if (speeds.empty()) throw DataError("no part of the seed curve is in the flow");
      step = options_.front_step ? *options_.front_step : front_time(std::move(speeds), spacing_);
    }
    if (options_.most_points / 2 < n) throw ArgumentError("`most_points` must be at least twice `particles`");
    const std::size_t room = (options_.most_points - n) / std::max<std::size_t>(n, 2);
    const std::size_t most = std::max<std::size_t>(1, std::min(options_.most_fronts, room));
    const auto rows = index_in<std::size_t>(std::ceil(row_extent_ / step * (1 - 1e-9)), 1, most);
    row_spacing_ = row_extent_ / static_cast<double>(rows);
    sheet_.report.moments_meet = streak_ && row_spacing_ < kLeastSpacing * rounding_of_moments();
    sheet_.report.fronts = rows + 1;
    std::vector<double> s, row;
    for (std::size_t k = 0; k <= rows; ++k)
      for (std::size_t i = 0; i < n; ++i)
        s.push_back(line[i]), row.push_back(k == rows ? row_extent_ : row_spacing_ * static_cast<double>(k));
    follow(s, row);
    for (std::size_t k = 0; k < rows; ++k)
      for (std::size_t i = 0; i + (curve_.closed ? 0 : 1) < n; ++i) {
        const auto a = static_cast<std::uint32_t>(k * n + i), b = static_cast<std::uint32_t>(k * n + (i + 1) % n);
        const auto up = static_cast<std::uint32_t>(n);
        // Reversed, like all triangles backward: rows by age run against the flow.
        const bool shorter = distance(b, a + up) <= distance(a, b + up);
        add(shorter ? Triangle{a, b, a + up} : Triangle{a, b, b + up});
        add(shorter ? Triangle{b, b + up, a + up} : Triangle{a, b + up, a + up});
      }
  }

  void add(Triangle t) {
    if (streak_ && trace_.backward) std::swap(t[1], t[2]);
    active_.push_back(t);
  }

  double distance(std::uint32_t a, std::uint32_t b) const {
    return norm(particles_.positions[a] - particles_.positions[b]);
  }
  bool arrived(std::uint32_t i) const { return !particles_.ends[i]; }

  /// From a to b along the seed curve, the shorter way around.
  double along(std::uint32_t a, std::uint32_t b) const {
    const double d = s_[b] - s_[a];
    return !curve_.closed || std::abs(d) <= 0.5 * length_ ? d : d - std::copysign(length_, d);
  }

  /// Edges of the active triangles.
  struct Edges {
    std::vector<std::uint64_t> keys;   ///< ascending
    std::vector<std::uint8_t> inside;  ///< the midpoint is in the flow
    std::vector<std::uint8_t> halve;
    std::vector<std::uint8_t> bad;  ///< too wide, or across a region without flow
    bool rims = false;              ///< edges at rims are halved

    std::size_t size() const { return keys.size(); }
    std::pair<std::uint32_t, std::uint32_t> ends(std::size_t e) const {
      return {smaller_end(keys[e]), larger_end(keys[e])};
    }
    /// The edge of these nodes; size() if there is none.
    std::size_t find(std::uint32_t a, std::uint32_t b) const {
      const auto found = std::lower_bound(keys.begin(), keys.end(), edge_key(a, b));
      return found != keys.end() && *found == edge_key(a, b) ? static_cast<std::size_t>(found - keys.begin()) : size();
    }
  };

  // Extent of an edge, over the distance of seeds and over that of rows.
  double part_s(std::uint32_t a, std::uint32_t b) const { return std::abs(along(a, b)) / spacing_; }
  double part_row(std::uint32_t a, std::uint32_t b) const { return std::abs(row_[a] - row_[b]) / row_spacing_; }

  /// Finds the edges, and those to be halved.
  Edges judge_edges() const {
    Edges edges;
    for (const Triangle& t : active_)
      for (std::size_t k = 0; k < 3; ++k) edges.keys.push_back(edge_key(t[k], t[(k + 1) % 3]));
    std::sort(edges.keys.begin(), edges.keys.end());
    edges.keys.erase(std::unique(edges.keys.begin(), edges.keys.end()), edges.keys.end());
    const std::size_t n = edges.size();
    std::vector<Vec3> places(n), vectors(n);
    edges.inside.resize(n), edges.halve.resize(n), edges.bad.resize(n);
    for (std::size_t e = 0; e < n; ++e) {
      const auto [a, b] = edges.ends(e);
      places[e] = (particles_.positions[a] + particles_.positions[b]) * 0.5;
    }
    field_.evaluate(places, std::vector<double>(n, end_), vectors, edges.inside);
    for (std::size_t e = 0; e < n; ++e) {
      const auto [a, b] = edges.ends(e);
      if (!arrived(a) || !arrived(b)) continue;
      const bool wide = distance(a, b) > options_.alpha * spacing_;
      edges.bad[e] = wide || edges.inside[e] == 0;
      // Below the integration error all particles between are noise, even if released far apart in time.
      const double part = part_s(a, b) > 0 ? part_s(a, b) : part_row(a, b);
      edges.halve[e] = wide && edges.inside[e] != 0 && part > least_part_;
    }
    halve_rims(edges);
    return edges;
  }

  /// At rims all edges of a triangle are halved; otherwise some would never become short.
  void halve_rims(Edges& edges) const {
    for (const Triangle& t : active_) {
      const bool some = arrived(t[0]) || arrived(t[1]) || arrived(t[2]);
      bool rim = some && !(arrived(t[0]) && arrived(t[1]) && arrived(t[2]));
      std::array<std::size_t, 3> of{};
      for (std::size_t k = 0; k < 3; ++k) {
        of[k] = edges.find(t[k], t[(k + 1) % 3]);
        rim = rim || (edges.bad[of[k]] != 0 && edges.inside[of[k]] == 0);
      }
      if (!rim) continue;
      for (const std::size_t e : of) {
        const auto [a, b] = edges.ends(e);
        if (std::max(part_s(a, b), part_row(a, b)) > kLeastPartAtRim) edges.halve[e] = 1, edges.rims = true;
      }
    }
  }

  /// Halves the edges of the active triangles that need it; triangles without such edges are done. Returns false if the
  /// limit of points is reached.
  bool refine() {
    const Edges edges = judge_edges();
    const std::size_t n = edges.size();
    std::vector<std::uint32_t> middle(n, kNothing);
    std::vector<double> s, row;
    for (std::size_t e = 0; e < n; ++e) {
      if (edges.halve[e] == 0) continue;
      const auto [a, b] = edges.ends(e);
      middle[e] = static_cast<std::uint32_t>(s_.size() + s.size());
      const double half = s_[a] + 0.5 * along(a, b);
      s.push_back(!curve_.closed ? half : half < 0 ? half + length_ : half >= length_ ? half - length_ : half);
      row.push_back(0.5 * (row_[a] + row_[b]));
    }
    const bool room = s_.size() + s.size() <= options_.most_points;
    if (room) {
      sheet_.report.inserted += s.size();
      follow(s, row);
    } else {
      std::fill(middle.begin(), middle.end(), kNothing);
      sheet_.report.complete = false;
    }
    for (std::size_t e = 0; e < n; ++e)
      if (edges.bad[e] != 0 && middle[e] == kNothing) torn_.push_back(edges.keys[e]);
    std::vector<Triangle> parts, done;
    const auto divide = [&](const Triangle& t) {
      std::array<std::uint32_t, 3> m{};
      bool whole = true;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t e = edges.find(t[k], t[(k + 1) % 3]);
        m[k] = e < n ? middle[e] : kNothing;
        whole = whole && arrived(t[k]) && (e == n || edges.bad[e] == 0);
      }
      if (m[0] != kNothing || m[1] != kNothing || m[2] != kNothing)
        cut(t, m, parts);
      else if (whole)
        done.push_back(t);
    };
    // Finished triangles share edges with those at rims.
    if (edges.rims && room) {
      for (const Triangle& t : sheet_.triangles) divide(t);
      sheet_.triangles.clear();
    }
    for (const Triangle& t : active_) divide(t);
    sheet_.triangles.insert(sheet_.triangles.end(), done.begin(), done.end());
    active_ = std::move(parts);
    return room;
  }

  /// Subdivides a triangle; m[k] is the midpoint of the edge from corner k to the next, if any.
  void cut(const Triangle& t, const std::array<std::uint32_t, 3>& m, std::vector<Triangle>& parts) const {
    const auto number = std::count_if(m.begin(), m.end(), [](std::uint32_t i) { return i != kNothing; });
    if (number == 3) {
      parts.insert(parts.end(), {{t[0], m[0], m[2]}, {m[0], t[1], m[1]}, {m[2], m[1], t[2]}, {m[0], m[1], m[2]}});
      return;
    }
    // With one midpoint the first edge has it, with two the last edge has none.
    std::size_t k = 0;
    while (m[k] == kNothing || (number == 2 && m[(k + 1) % 3] == kNothing)) ++k;
    const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3], ab = m[k], bc = m[(k + 1) % 3];
    if (number == 1) {
      parts.insert(parts.end(), {{a, ab, c}, {ab, b, c}});
    } else if (distance(a, bc) <= distance(ab, c)) {
      parts.insert(parts.end(), {{ab, b, bc}, {a, ab, bc}, {a, bc, c}});
    } else {
      parts.insert(parts.end(), {{ab, b, bc}, {a, ab, c}, {ab, bc, c}});
    }
  }

  const VectorField& field_;
  const SeedCurve& curve_;
  const FlowSurfaceOptions& options_;
  TraceOptions trace_;
  bool streak_ = false;
  double length_ = 0, spacing_ = 0, end_ = 0, row_extent_ = 0, row_spacing_ = 0, least_part_ = 0;
  std::vector<double> s_, row_;  // per particle
  Particles particles_;          // positions, velocities and ends
  std::vector<Triangle> active_;
  std::vector<std::uint64_t> torn_;  // edges
  FlowSheet sheet_;
};

}  // namespace

FlowSheet released_sheet(const VectorField& field, const SeedCurve& curve, const FlowSurfaceOptions& options,
                         Progress& progress) {
  return ReleasedSheet(field, curve, options).make(progress);
}

}  // namespace sansmesh::inline v1
