#include "sansmesh/deform/mls_deformation.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/deform/deform_setup.h"
#include "sansmesh/deform/node_fit.h"
#include "sansmesh/deform/weighted_nodes.h"

namespace sansmesh {
namespace {

constexpr std::size_t kMapBatch = 256;

}  // namespace

struct MlsDeformation::State {
  detail::DeformSetup setup;
  std::vector<std::shared_ptr<const Occluder>> cuts;

  void map(std::span<const Vec3> x, const MapAnswers& wanted) const;
  void map_gaps(std::span<const Vec3> x, std::span<const Vec3> sources, std::span<const Jacobian> jacobians,
                const MapAnswers& wanted) const;
};

void MlsDeformation::State::map(std::span<const Vec3> x, const MapAnswers& wanted) const {
  const bool gaps = !wanted.gaps.empty() || !wanted.gap_gradients.empty();
  const bool jacobian = !wanted.jacobians.empty() || (gaps && !cuts.empty());
  // Ways around from the handle h to x[i]: [i handles + h].
  const std::size_t handles = setup.handles.size();
  std::vector<Detour> detours, of_handle, scratch;
  if (!cuts.empty()) {
    detours.resize(handles * x.size());
    for (std::size_t h = 0; h < handles; ++h) {
      if (setup.handles[h].segment) continue;
      of_handle.assign(x.size(), {});
      detail::add_detours(cuts, setup.handles[h].q, x, of_handle, scratch);
      for (std::size_t i = 0; i < x.size(); ++i) detours[i * handles + h] = of_handle[i];
    }
  }
  detail::NodesFrom nodes;
  std::vector<double> columns;
  std::vector<Vec3> sources(gaps ? x.size() : 0);
  std::vector<Jacobian> jacobians(gaps ? x.size() : 0);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < x.size(); ++i) {
    detail::FittedPlace fit{{kNone, kNone, kNone}, {}};
    if (is_finite(x[i])) {
      const auto own =
          cuts.empty() ? std::span<const Detour>{} : std::span<const Detour>{detours}.subspan(i * handles, handles);
      detail::gather_nodes(setup, cuts, own, x[i], nodes);
      fit = detail::fit_nodes(setup, nodes, x[i], jacobian, columns);
      if (nodes.held) fit.position = *nodes.held;
    }
    if (!wanted.positions.empty()) wanted.positions[i] = fit.position;
    if (!wanted.jacobians.empty()) wanted.jacobians[i] = fit.jacobian;
    if (gaps) sources[i] = fit.position, jacobians[i] = fit.jacobian;
  }
  if (gaps) map_gaps(x, sources, jacobians, wanted);
}

void MlsDeformation::State::map_gaps(std::span<const Vec3> x, std::span<const Vec3> sources,
                                     std::span<const Jacobian> jacobians, const MapAnswers& wanted) const {
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

MlsDeformation::MlsDeformation(std::vector<Handle> handles, const MlsDeformationOptions& options,
                               std::vector<std::shared_ptr<const Occluder>> cuts) {
  auto state = std::make_unique<State>();
  state->setup = detail::set_up_deformation(handles, options);
  state->cuts = std::move(cuts);
  state_ = std::move(state);
}

MlsDeformation::~MlsDeformation() = default;

bool MlsDeformation::has_gaps() const { return !state_->cuts.empty(); }

void MlsDeformation::map(std::span<const Vec3> x, const MapAnswers& wanted) const {
  const auto part = [](auto answers, std::size_t first, std::size_t n) {
    return answers.empty() ? answers : answers.subspan(first, n);
  };
  parallel_ranges(0, x.size(), kMapBatch, [&](std::size_t first, std::size_t last) {
    const std::size_t n = last - first;
    state_->map(x.subspan(first, n), {part(wanted.positions, first, n), part(wanted.jacobians, first, n),
                                      part(wanted.gaps, first, n), part(wanted.gap_gradients, first, n)});
  });
}

}  // namespace sansmesh
