#include "sansmesh/partition/fit/crease_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace sansmesh::inline v1 {
namespace {

constexpr float kCreaseCosine = 0.985f;  // normals that differ by more than 10° may belong to different sheets
constexpr std::uint8_t kTooFew = 255;
constexpr std::size_t kBarelyTouched = 4;  ///< in the ball, below which a sheet takes samples around it
/// A larger deviation of a normal from the plane of the two sheets' normals makes a corner.
constexpr float kCornerSine = 0.5f;

/// If the relation of two sheets is ambiguous, the order of joining that leaves the samples on the zero set is used, if
/// its mean square is at most kJoinedSquare times that of the separate sheets, or its rms at most kJoinedShare of the
/// scale.
constexpr double kJoinedSquare = 4, kJoinedShare = 1e-3;

/// Orders and joins the pieces to minimise the distance of the samples from the zero set. False: not close enough.
bool join_by_samples(std::span<const Vec3f> positions, std::span<const float> weights, double mean_square, float scale,
                     std::vector<LocalFunction>& pieces) {
  const std::size_t sheets = pieces.size();
  std::vector<std::array<float, 3>> value(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    for (std::size_t s = 0; s < sheets; ++s) value[i][s] = local_value(pieces[s], positions[i]);
  double least = std::numeric_limits<double>::max(), total = 0;
  for (const float w : weights) total += w;
  std::size_t best_last = 0, best_way = 0;
  for (std::size_t last = sheets == 2 ? 1 : 0; last < (sheets == 2 ? 2u : 3u); ++last)
    for (std::size_t way = 0; way < (sheets == 2 ? 2u : 4u); ++way) {
      const std::size_t a = last == 0 ? 1 : 0, b = sheets == 2 ? 1 : last == 2 ? 1 : 2;
      double squares = 0;
      for (std::size_t i = 0; i < positions.size(); ++i) {
        float v = way % 2 ? std::max(value[i][a], value[i][b]) : std::min(value[i][a], value[i][b]);
        if (sheets == 3) v = way / 2 ? std::max(v, value[i][last]) : std::min(v, value[i][last]);
        squares += static_cast<double>(weights[i]) * static_cast<double>(v) * static_cast<double>(v);
      }
      if (squares < least) least = squares, best_last = last, best_way = way;
    }
  const double allowed = std::max(kJoinedSquare * mean_square, std::pow(kJoinedShare * static_cast<double>(scale), 2));
  if (!(total > 0) || least > allowed * total) return false;
  if (sheets == 3) std::swap(pieces[best_last], pieces[2]);
  pieces[0].convex = best_way % 2;
  pieces[1].convex = best_way / 2;
  return true;
}

/// Representative normals of the sheets: the two farthest apart, and a third if one deviates from their plane.
std::vector<Vec3f> seed_sheets(std::span<const Vec3f> normals) {
  Vec3f mean;
  for (const Vec3f& n : normals) mean += n;
  const auto farthest = [&](const Vec3f& from) {
    const Vec3f* worst = &normals[0];
    for (const Vec3f& n : normals)
      if (dot(n, from) < dot(*worst, from)) worst = &n;
    return *worst;
  };
  const Vec3f a = farthest(normalized(mean)), b = farthest(a);
  if (dot(a, b) > kCreaseCosine) return {};
  std::vector<Vec3f> seeds{a, b};
  const Vec3f across = normalized(cross(a, b));
  float most = 0;
  Vec3f third;
  for (const Vec3f& n : normals)
    if (std::abs(dot(n, across)) > most) most = std::abs(dot(n, across)), third = n;
  if (most > kCornerSine && across != Vec3f{}) seeds.push_back(third);
  return seeds;
}

/// Sheets of the samples around a crease.
struct CreaseSheets {
  std::vector<Vec3f> normal;
  std::vector<std::uint8_t> of;  ///< sheet of each sample; kTooFew: none
};

/// Assigns the first `inner` samples to the sheets with the nearest normals, and others to sheets of few samples. Empty
/// if there are none.
CreaseSheets split_sheets(std::span<const Vec3f> normals, std::size_t inner) {
  CreaseSheets found{seed_sheets(normals.first(inner)), std::vector<std::uint8_t>(normals.size(), kTooFew)};
  std::vector<Vec3f>& sheet = found.normal;
  if (sheet.empty()) return found;
  const std::size_t sheets = sheet.size();
  const auto nearest = [&](const Vec3f& n) {
    std::size_t best = 0;
    for (std::size_t s = 1; s < sheets; ++s)
      if (dot(n, sheet[s]) > dot(n, sheet[best])) best = s;
    return best;
  };
  for (int round = 0; round < 3; ++round) {
    std::vector<Vec3f> sum(sheets);
    for (std::size_t i = 0; i < inner; ++i) {
      const std::size_t best = nearest(normals[i]);
      found.of[i] = static_cast<std::uint8_t>(best);
      sum[best] += normals[i];
    }
    for (std::size_t s = 0; s < sheets; ++s) sheet[s] = normalized(sum[s]);
  }
  std::vector<std::size_t> count(sheets, 0);
  for (std::size_t i = 0; i < inner; ++i) ++count[found.of[i]];
  // A sheet that the ball barely touches needs the samples around it: without the sheet the others would extend beyond
  // the crease.
  const std::vector<std::size_t> within = count;
  for (std::size_t i = inner; i < normals.size(); ++i) {
    const std::size_t best = nearest(normals[i]);
    if (within[best] >= kBarelyTouched || dot(normals[i], sheet[best]) < kCreaseCosine) continue;
    found.of[i] = static_cast<std::uint8_t>(best);
    ++count[best];
  }
  // A sheet with a single sample cannot be fitted; it must not distort the others either.
  std::vector<std::uint8_t> rank(sheets, kTooFew);
  std::size_t kept = 0;
  for (std::size_t s = 0; s < sheets; ++s)
    if (count[s] >= 2) {
      sheet[kept] = sheet[s];
      rank[s] = static_cast<std::uint8_t>(kept++);
    }
  sheet.resize(kept);
  for (std::uint8_t& s : found.of)
    if (s != kTooFew) s = rank[s];
  return found;
}

/// Whether two sheets meet in a convex (1) or concave (0) crease, or neither (-1).
int crease_between(const LocalFunction& a, const LocalFunction& b, std::span<const Vec3f> positions,
                   std::span<const std::uint8_t> of, std::uint8_t sheet_a, std::uint8_t sheet_b) {
  const auto is_inside = [&](const LocalFunction& f, std::uint8_t other) {
    double sum = 0;
    for (std::size_t i = 0; i < positions.size(); ++i)
      if (of[i] == other) sum += static_cast<double>(local_value(f, positions[i]));
    return sum < 0;
  };
  // Convex if each is on the inner side of the other.
  const bool ab = is_inside(a, sheet_b), ba = is_inside(b, sheet_a);
  return ab == ba ? static_cast<int>(ab) : -1;
}

/// Orders and joins the pieces by max and min. False: no joining leaves the samples on the zero set.
bool join_pieces(std::span<const Vec3f> positions, std::span<const float> weights, std::span<const std::uint8_t> of,
                 double mean_square, float scale, std::vector<LocalFunction>& piece) {
  const auto relation = [&](std::uint8_t a, std::uint8_t b) {
    return crease_between(piece[a], piece[b], positions, of, a, b);
  };
  if (piece.size() == 1) {
    piece[0].convex = 1;
    return true;
  }
  if (piece.size() == 2) {
    const int r = relation(0, 1);
    if (r < 0) return join_by_samples(positions, weights, mean_square, scale, piece);
    piece[0].convex = r == 1;
    return true;
  }
  const int ab = relation(0, 1), bc = relation(1, 2), ac = relation(0, 2);
  // One sheet may be on both sides of another, as in corners that are neither convex nor concave.
  if (ab < 0 || bc < 0 || ac < 0) return join_by_samples(positions, weights, mean_square, scale, piece);
  // The pair that differs from the other two is joined first.
  if (ab == bc && ab != ac) std::swap(piece[1], piece[2]);
  if (ab == ac && ab != bc) std::swap(piece[0], piece[2]);
  const bool odd = ab == bc && bc == ac;
  const int first = odd ? ab : (bc == ac ? ab : ab == bc ? ac : bc);
  const int second = odd ? ab : 1 - first;
  piece[0].convex = first == 1;
  piece[1].convex = second == 1;
  return true;
}

}  // namespace

CreaseFit fit_crease(std::span<const Vec3f> positions, std::span<const Vec3f> normals, std::span<const float> weights,
                     std::size_t inner, const Vec3f& center, float scale, int max_degree) {
  CreaseFit result;
  if (inner < 8) return result;
  const CreaseSheets sheets = split_sheets(normals, inner);
  if (sheets.normal.empty()) return result;
  std::vector<LocalFunction> piece(sheets.normal.size());
  LocalSamples samples;
  double squares = 0, total = 0;
  for (std::size_t s = 0; s < piece.size(); ++s) {
    LocalFunction& f = piece[s];
    f.center = center;
    f.scale = scale;
    f.nu = sheets.normal[s];
    tangent_frame(f.nu, f.xi, f.eta);
    samples.clear();
    double spread = 0, members = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      if (sheets.of[i] != s) continue;
      const Vec3f d = (positions[i] - center) / scale;
      samples.add(dot(d, f.xi), dot(d, f.eta), dot(d, f.nu), std::max(weights[i], 0.05f));
      spread += 1 - dot(normals[i], f.nu), members += 1;
    }
    // Within a sheet the normals must agree (mean deviation below about 20°): noise is not a crease.
    if (spread > 0.06 * members) return result;
    const DegreeFits fits = fit_all_degrees(samples, std::min(max_degree, 2));
    if (fits.highest < 0) return result;
    // A sheet's samples fill only part of the ball: it is curved only if a plane is clearly insufficient. Few samples
    // define their plane by their normals alone.
    f.degree = fits.highest >= 2 && fits.mean_square[2] < 0.5 * fits.mean_square[1] ? 2 : std::min(fits.highest, 1);
    f.coefficient = monomial_coefficients(fits, f.degree);
    squares += fits.mean_square[static_cast<std::size_t>(f.degree)] * scale * scale * fits.weight_sum;
    total += fits.weight_sum;
  }
  result.mean_square = squares / total;
  if (join_pieces(positions, weights, sheets.of, result.mean_square, scale, piece)) result.pieces = std::move(piece);
  return result;
}

float least_cosine(std::span<const LocalFunction> pieces) {
  float least = 1;
  for (std::size_t i = 0; i < pieces.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) least = std::min(least, dot(pieces[i].nu, pieces[j].nu));
  return least;
}

}  // namespace sansmesh::inline v1
