#include "sansmesh/query.h"

#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/space_map.h"
#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1 {
namespace {

template <class Value, class Gradient>
void check_sizes(const QueryPoints& at, const FieldValues<Value, Gradient>& wanted) {
  const auto fits = [n = at.points.size()](const auto& span) { return span.empty() || span.size() == n; };
  if (!fits(wanted.values) || !fits(wanted.gradients) || !fits(wanted.inside))
    throw ArgumentError("the numbers of results and points differ");
  if (at.times.size() > 1 && at.times.size() != at.points.size())
    throw ArgumentError("the numbers of times and points differ");
}

/// Span of the requested results, or of a buffer if they are only needed internally.
template <class T>
std::span<T> or_room(std::span<T> wanted, std::size_t count, std::vector<T>& room) {
  if (!wanted.empty()) return wanted;
  room.resize(count);
  return room;
}

}  // namespace

void ScalarField::query(const QueryPoints& at, const ScalarFieldValues& wanted) const {
  check_sizes(at, wanted);
  std::vector<double> room;
  const std::span<double> values = or_room(wanted.values, at.points.size(), room);
  if (wanted.inside.empty()) return evaluate(at.points, values, wanted.gradients);
  evaluate_in_domain(at.points, values, wanted.gradients, wanted.inside);
}

void VectorField::query(const QueryPoints& at, const VectorFieldValues& wanted) const {
  check_sizes(at, wanted);
  const std::size_t n = at.points.size();
  std::vector<double> moments;
  std::span<const double> times = at.times;
  if (times.size() != n) {
    moments.assign(n, times.empty() ? 0 : times[0]);
    times = moments;
  }
  std::vector<Vec3> room;
  std::vector<std::uint8_t> room_inside;
  evaluate(at.points, times, or_room(wanted.values, n, room), or_room(wanted.inside, n, room_inside), wanted.gradients);
}

void SpaceMap::query(const QueryPoints& at, const VectorFieldValues& wanted) const {
  check_sizes(at, wanted);
  const std::size_t n = at.points.size();
  if (wanted.inside.empty()) return map(at.points, {wanted.values, wanted.gradients, {}, {}});
  std::vector<Vec3> room;
  std::vector<double> gaps(has_gaps() ? n : 0);
  const std::span<Vec3> positions = or_room(wanted.values, n, room);
  map(at.points, {positions, wanted.gradients, gaps, {}});
  for (std::size_t i = 0; i < n; ++i) wanted.inside[i] = is_finite(positions[i]) && (gaps.empty() || gaps[i] <= 0);
}

}  // namespace sansmesh::inline v1
