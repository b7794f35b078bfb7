#include "sansmesh/deform/maps/cut_map.h"

#include <algorithm>
#include <utility>

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kCutMapGrain = 4096;

/// Workspace for n results, empty if none are requested.
template <class T>
std::vector<T> scratch_for(std::span<T> wanted, std::size_t n) {
  return std::vector<T>(wanted.empty() ? 0 : n);
}

template <class T>
void scatter(const std::vector<T>& from, const std::vector<std::size_t>& to, std::span<T> answers) {
  for (std::size_t i = 0; i < from.size(); ++i) answers[to[i]] = from[i];
}

}  // namespace

CutMap::CutMap(std::shared_ptr<const SpaceMap> exact, std::vector<std::shared_ptr<const Occluder>> cuts,
               const Box3& box, const std::array<std::size_t, 3>& sizes, Progress& progress)
    : exact_(std::move(exact)), lattice_(displacement_map(*exact_, box, sizes, progress)) {
  const BoxLattice& lattice = lattice_.lattice();
  const BoxLattice::Index cells{sizes[0] - 1, sizes[1] - 1, sizes[2] - 1};
  const double reach = norm(lattice.spacing) / 2;  // every point of a cell is within this distance of a corner
  const std::size_t points = lattice.size();
  std::vector<std::uint8_t> crossed(points);  // per point: a cut crosses the link to the next point along some axis
  std::vector<std::uint8_t> near(points);     // per point: a cut may be within reach
  parallel_ranges(0, points, kCutMapGrain, [&](std::size_t first, std::size_t last) {
    std::vector<double> found;
    for (std::size_t i = first; i < last; ++i) {
      const BoxLattice::Index at = lattice.index(i);
      const Vec3 x = lattice.position(at);
      found.clear();
      for (std::size_t k = 0; k < 3 && found.empty(); ++k) {
        if (at[k] + 1 == sizes[k]) continue;
        Vec3 y = x;
        y[k] += lattice.spacing[k];
        for (const auto& cut : cuts) cut->crossings(x, y, found);
      }
      crossed[i] = !found.empty();
      for (const auto& cut : cuts) {
        Gap gap;
        cut->gaps({&x, 1}, {&x, 1}, {}, {&gap, 1});  // depth >= −(distance of x from the cut)
        near[i] = near[i] || gap.depth >= -reach;
      }
    }
  });
  // Cuts narrower than a cell pass between links.
  const std::vector<std::uint8_t> links = crossed;
  parallel_ranges(0, points, kCutMapGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      if (!near[i]) continue;
      const BoxLattice::Index at = lattice.index(i);
      bool known = false;
      for (std::size_t c = at[2] - (at[2] > 0); c <= std::min(at[2] + 1, sizes[2] - 1); ++c)
        for (std::size_t b = at[1] - (at[1] > 0); b <= std::min(at[1] + 1, sizes[1] - 1); ++b)
          for (std::size_t a = at[0] - (at[0] > 0); a <= std::min(at[0] + 1, sizes[0] - 1); ++a)
            known = known || links[lattice.point({a, b, c})];
      if (!known) crossed[i] = 1;
    }
  });
  beside_cut_.assign(cells[0] * cells[1] * cells[2], 0);
  for (std::size_t i = 0; i < points; ++i) {
    if (!crossed[i]) continue;
    const BoxLattice::Index at = lattice.index(i);
    std::array<std::size_t, 3> from{}, to{};  // cells around the link in any direction, and their neighbours
    for (std::size_t k = 0; k < 3; ++k) {
      from[k] = at[k] < 2 ? 0 : at[k] - 2;
      to[k] = std::min(at[k] + 1, cells[k] - 1);
    }
    for (std::size_t c = from[2]; c <= to[2]; ++c)
      for (std::size_t b = from[1]; b <= to[1]; ++b)
        for (std::size_t a = from[0]; a <= to[0]; ++a) beside_cut_[a + cells[0] * (b + cells[1] * c)] = 1;
  }
}

double CutMap::exact_share() const {
  return static_cast<double>(std::count(beside_cut_.begin(), beside_cut_.end(), 1)) /
         static_cast<double>(beside_cut_.size());
}

std::size_t CutMap::cell_of(const Vec3& x) const {
  const BoxLattice& lattice = lattice_.lattice();
  std::size_t cell = 0;
  for (std::size_t k = 3; k-- > 0;) {
    const std::size_t cells = lattice.sizes[k] - 1;
    const double at =
        std::clamp((x[k] - lattice.box.lower[k]) / lattice.spacing[k], 0.0, static_cast<double>(cells - 1));
    cell = cell * cells + static_cast<std::size_t>(at);
  }
  return cell;
}

void CutMap::map(std::span<const Vec3> x, const MappedPoints& wanted) const {
  std::vector<std::uint8_t> exact(x.size());
  parallel_for(0, x.size(), kCutMapGrain,
               [&](std::size_t i) { exact[i] = lattice_.lattice().box.contains(x[i]) && beside_cut_[cell_of(x[i])]; });
  lattice_.map(x, wanted);
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (exact[i]) which.push_back(i);
  if (which.empty()) return;
  std::vector<Vec3> y;
  y.reserve(which.size());
  for (const std::size_t i : which) y.push_back(x[i]);
  std::vector<Vec3> positions = scratch_for(wanted.positions, y.size()),
                    slopes = scratch_for(wanted.gap_gradients, y.size());
  std::vector<Jacobian> jacobians = scratch_for(wanted.jacobians, y.size());
  std::vector<double> gaps = scratch_for(wanted.gaps, y.size());
  exact_->map(y, {positions, jacobians, gaps, slopes});
  scatter(positions, which, wanted.positions);
  scatter(jacobians, which, wanted.jacobians);
  scatter(gaps, which, wanted.gaps);
  scatter(slopes, which, wanted.gap_gradients);
}

void CutMap::images(std::span<const Box3> boxes, std::span<Box3> found) const {
  const Vec3 margin = lattice_.lattice().spacing * 2.0;
  std::vector<Box3> wider(boxes.begin(), boxes.end());
  for (Box3& box : wider)
    if (!box.empty()) box.lower -= margin, box.upper += margin;
  lattice_.images(wider, found);
}

}  // namespace sansmesh::inline v1
