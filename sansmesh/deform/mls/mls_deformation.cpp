#include "sansmesh/deform/mls/mls_deformation.h"

#include <limits>
#include <optional>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/deform/mls/deform_setup.h"
#include "sansmesh/deform/mls/node_fit.h"
#include "sansmesh/deform/mls/point_kernels.h"
#include "sansmesh/deform/mls/weighted_nodes.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kMapBatch = 256;

}  // namespace

struct MlsDeformation::State {
  detail::DeformSetup setup;
  std::vector<std::shared_ptr<const Occluder>> cuts;
  std::optional<detail::PointMap> points;  ///< vectorised positions, if all handles are points

  void map(std::span<const Vec3> x, const MappedPoints& wanted) const;
  /// Detours from handle h to x[i] at [h x.size() + i]; empty without cuts.
  std::vector<Detour> ways_around(std::span<const Vec3> x) const;
  void map_one_by_one(std::span<const Vec3> x, std::span<const Detour> ways, std::span<Vec3> positions,
                      std::span<Jacobian> jacobians) const;
  void map_gaps(std::span<const Vec3> x, std::span<const Vec3> sources, std::span<const Jacobian> jacobians,
                const MappedPoints& wanted) const;
};

std::vector<Detour> MlsDeformation::State::ways_around(std::span<const Vec3> x) const {
  std::vector<Detour> ways(cuts.empty() ? 0 : setup.handles.size() * x.size()), scratch;
  if (cuts.empty()) return ways;
  for (std::size_t h = 0; h < setup.handles.size(); ++h) {
    if (setup.handles[h].segment) continue;
    detail::add_detours(cuts, setup.handles[h].q, x, std::span<Detour>(ways).subspan(h * x.size(), x.size()), scratch);
  }
  return ways;
}

void MlsDeformation::State::map(std::span<const Vec3> x, const MappedPoints& wanted) const {
  const bool gaps = !wanted.gaps.empty() || !wanted.gap_gradients.empty();
  std::vector<Vec3> own_positions(wanted.positions.empty() && gaps ? x.size() : 0);
  const std::span<Vec3> positions = wanted.positions.empty() ? std::span<Vec3>(own_positions) : wanted.positions;
  std::vector<Jacobian> own_jacobians(wanted.jacobians.empty() && !wanted.gap_gradients.empty() ? x.size() : 0);
  const std::span<Jacobian> jacobians =
      wanted.jacobians.empty() ? std::span<Jacobian>(own_jacobians) : wanted.jacobians;
  const std::vector<Detour> ways = ways_around(x);
  if (points && !positions.empty()) {
    std::vector<double> extras(ways.size());
    for (std::size_t i = 0; i < ways.size(); ++i) extras[i] = ways[i].extra;
    detail::map_positions(*points, x, extras, positions);
  }
  if (!jacobians.empty() || !points) map_one_by_one(x, ways, points ? std::span<Vec3>{} : positions, jacobians);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (!is_finite(x[i])) positions[i] = {kNone, kNone, kNone};
  if (gaps) map_gaps(x, positions, jacobians, wanted);
}

void MlsDeformation::State::map_one_by_one(std::span<const Vec3> x, std::span<const Detour> ways,
                                           std::span<Vec3> positions, std::span<Jacobian> jacobians) const {
  const std::size_t handles = setup.handles.size();
  std::vector<Detour> own(cuts.empty() ? 0 : handles);
  detail::NodesFrom nodes;
  std::vector<double> columns;
  for (std::size_t i = 0; i < x.size(); ++i) {
    detail::FittedPosition fit;
    if (is_finite(x[i])) {
      for (std::size_t h = 0; h < own.size(); ++h) own[h] = ways[h * x.size() + i];
      detail::gather_nodes(setup, cuts, own, x[i], nodes);
      fit = detail::fit_nodes(setup, nodes, x[i], !jacobians.empty(), columns);
    }
    if (!positions.empty()) positions[i] = nodes.held.value_or(fit.position);
    if (!jacobians.empty()) jacobians[i] = fit.jacobian;
  }
}

void MlsDeformation::State::map_gaps(std::span<const Vec3> x, std::span<const Vec3> sources,
                                     std::span<const Jacobian> jacobians, const MappedPoints& wanted) const {
  std::vector<Gap> deepest(x.size(), Gap{-std::numeric_limits<double>::infinity(), {}}), found(x.size());
  for (const auto& cut : cuts) {
    cut->gaps(x, sources, jacobians, found);
    for (std::size_t i = 0; i < x.size(); ++i)
      if (found[i].depth > deepest[i].depth) deepest[i] = found[i];
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!wanted.gaps.empty()) wanted.gaps[i] = deepest[i].depth;
    if (!wanted.gap_gradients.empty()) wanted.gap_gradients[i] = deepest[i].gradient;
  }
}

namespace {

std::optional<detail::PointMap> map_of_points(const detail::DeformSetup& setup) {
  if (!setup.plain || setup.line != detail::HandleLine::none) return std::nullopt;
  detail::PointMap map;
  map.kind = setup.options.kind;
  for (const detail::DeformHandle& h : setup.handles) {
    for (std::size_t k = 0; k < 3; ++k) map.q[k].push_back(h.q[k]), map.p[k].push_back(h.p[k]);
    map.weight.push_back(h.weight);
  }
  map.alpha = setup.options.alpha, map.damping = setup.options.damping;
  map.floor_square = setup.floor_square;
  map.unit = 1 / setup.extent, map.terms = setup.terms;
  return map;
}

}  // namespace

MlsDeformation::MlsDeformation(const std::vector<Handle>& handles, const MlsDeformationOptions& options,
                               std::vector<std::shared_ptr<const Occluder>> cuts) {
  auto state = std::make_unique<State>();
  state->setup = detail::set_up_deformation(handles, options);
  state->cuts = std::move(cuts);
  state->points = map_of_points(state->setup);
  state_ = std::move(state);
}

MlsDeformation::~MlsDeformation() = default;

bool MlsDeformation::has_gaps() const { return !state_->cuts.empty(); }

void MlsDeformation::map(std::span<const Vec3> x, const MappedPoints& wanted) const {
  const auto part = [](auto answers, std::size_t first, std::size_t n) {
    return answers.empty() ? answers : answers.subspan(first, n);
  };
  parallel_ranges(0, x.size(), kMapBatch, [&](std::size_t first, std::size_t last) {
    const std::size_t n = last - first;
    state_->map(x.subspan(first, n), {part(wanted.positions, first, n), part(wanted.jacobians, first, n),
                                      part(wanted.gaps, first, n), part(wanted.gap_gradients, first, n)});
  });
}

}  // namespace sansmesh::inline v1
