// Natural neighbour interpolation (sibson1981).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "sansmesh/approximation/sample_index.h"
#include "sansmesh/volume/cells/axis_interval.h"
#include "sansmesh/volume/cells/convex_cell.h"
#include "sansmesh/volume/grid/corner_volume.h"
#include "sansmesh/volume/methods/pointwise_field.h"
#include "sansmesh/volume/reconstruction_input.h"
#include "sansmesh/volume/volume_method.h"

namespace sansmesh::inline v1 {
namespace detail {
namespace {

constexpr double kFarAway = 10;  ///< end of the cells: diagonals of the box beyond it
constexpr double kTie = 1e-6;    ///< relative difference below which squared distances are equal
constexpr std::size_t kMostCuts = 1000;
constexpr std::size_t kFirstGuess = 16;

/// Nearest-sample search: by axes in lattices, otherwise with a tree.
class NearestSample {
 public:
  explicit NearestSample(const SampledVolume& volume) : volume_(volume) {
    if (volume.lattice) return;
    std::vector<Position<3>> positions(volume.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const Vec3& x = volume.positions[i];
      positions[i] = {x.x, x.y, x.z};
    }
    index_ = SampleIndex<3>(positions);
    // The first of several coincident samples represents all: there is no plane between them.
    std::vector<std::uint32_t> order(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return positions[a] != positions[b] ? positions[a] < positions[b] : a < b;
    });
    for (std::size_t k = 1; k < order.size(); ++k) {
      if (positions[order[k]] != positions[order[k - 1]]) continue;
      if (first_.empty()) {
        first_.resize(order.size());
        std::iota(first_.begin(), first_.end(), 0u);
      }
      first_[order[k]] = first_[order[k - 1]];
    }
  }

  /// Replaces `out` by the `count` nearest samples (in lattices those of a cell), the nearest first.
  void find(const Vec3& x, std::size_t count, std::vector<std::uint32_t>& out) const {
    out.clear();
    if (volume_.lattice) {
      const Lattice& lattice = *volume_.lattice;
      const Vec3 a = lattice.to_axes(x);
      std::array<std::array<std::size_t, 2>, 3> at;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& axis = lattice.axes[k];
        const std::size_t i = interval_of(axis, lattice.uniform, a[k]);
        at[k] = a[k] - axis[i] < axis[i + 1] - a[k] ? std::array{i, i + 1} : std::array{i + 1, i};
      }
      const std::size_t nx = lattice.axes[0].size(), ny = lattice.axes[1].size();
      for (std::size_t c = 0; c < (count > 1 ? 8u : 1u); ++c)
        out.push_back(static_cast<std::uint32_t>(at[0][c & 1] + nx * (at[1][c >> 1 & 1] + ny * at[2][c >> 2])));
      return;
    }
    static thread_local std::vector<SampleIndex<3>::Hit> hits;
    index_.nearest({x.x, x.y, x.z}, count, hits);
    for (const auto& hit : hits) {
      const std::uint32_t sample = first_.empty() ? hit.index : first_[hit.index];
      if (std::find(out.begin(), out.end(), sample) == out.end()) out.push_back(sample);
    }
  }

 private:
  const SampledVolume& volume_;
  SampleIndex<3> index_;
  std::vector<std::uint32_t> first_;  // per sample: the first coincident one; empty without coincidences
};

struct NaturalNeighbour {
  std::uint32_t sample;
  Vec3 offset;  ///< from x
  double area;  ///< area of the face between the cells
  Vec3 moment;  ///< ∫ (p − x) dA over the face
};

/// f(x) = Σ u_i(x) f_i / Σ u_i(x), u_i the volume that a new sample at x would take from the Voronoi cell of sample i,
/// with the gradients of piper1993 (docs/methods/volume-baselines.md). Gaps of the mesh between neighbours have no
/// effect. Cell data receive additional samples at the volume's surface (corner_volume.h).
class SibsonField final : public WeightedField {
 public:
  SibsonField(std::shared_ptr<const SampledVolume> sampled, VolumeValues values)
      : WeightedField(std::move(sampled), std::move(values)), nearest_(volume()) {}

 protected:
  void weights(const Vec3& x, const CellLocation& /*location*/, bool slopes,
               std::vector<SampleWeight>& out) const override {
    static thread_local std::vector<std::uint32_t> near;
    nearest_.find(x, kFirstGuess, near);
    const double d0 = norm(volume().position(near[0]) - x);
    const double d1 = near.size() > 1 ? norm(volume().position(near[1]) - volume().position(near[0])) : d0;
    if (d0 > 1e-6 * d1) return around(x, slopes, out);
    const std::uint32_t sample = near[0];
    if (!slopes) return out.assign(1, {sample, 1, {}});
    // The gradient does not exist at a sample: use the mean of six points around it.
    static thread_local std::vector<SampleWeight> mean;
    mean.assign(1, {sample, 1, {}});
    for (std::size_t side = 0; side < 6; ++side) {
      Vec3 p = volume().position(sample);
      p[side / 2] += (side % 2 ? 1e-3 : -1e-3) * d1;
      around(p, true, out);
      for (const SampleWeight& w : out) mean.push_back({w.sample, 0, w.slope / 6});
    }
    out = mean;
  }

 private:
  /// Weights at x, which must not be a sample.
  void around(const Vec3& x, bool slopes, std::vector<SampleWeight>& out) const {
    static thread_local ConvexCell cell, part;
    static thread_local std::vector<NaturalNeighbour> neighbours;
    static thread_local std::vector<std::pair<double, const NaturalNeighbour*>> others;
    insert(x, cell, neighbours);
    out.clear();
    double sum = 0;
    Vec3 slope;
    for (const NaturalNeighbour& n : neighbours) {
      part.assign(cell);
      // Nearest first: they leave little for the others to cut.
      others.clear();
      for (const NaturalNeighbour& other : neighbours)
        if (other.sample != n.sample) others.push_back({squared_norm(other.offset - n.offset), &other});
      std::sort(others.begin(), others.end(), [](const auto& a, const auto& b) {
        return a.first != b.first ? a.first < b.first : a.second->sample < b.second->sample;
      });
      for (const auto& [squared, other] : others) {
        const Vec3 across = other->offset - n.offset;
        part.cut(across, dot(across, other->offset + n.offset) / 2, 0);
        if (part.empty()) break;
      }
      const double volume = std::max(part.volume(), 0.0);
      const Vec3 change = slopes ? n.moment / norm(n.offset) : Vec3{};
      out.push_back({n.sample, volume, change});
      sum += volume;
      slope += change;
    }
    if (!(sum > 0)) {  // a volume indistinguishable from zero
      std::vector<std::uint32_t> near;
      nearest_.find(x, 1, near);
      return out.assign(1, {near[0], 1, {}});
    }
    for (SampleWeight& w : out) {
      w.weight /= sum;
      w.slope = (w.slope - slope * w.weight) / sum;
    }
  }

  /// The cell of x among the samples, in coordinates relative to x, and its neighbours in ascending order.
  void insert(const Vec3& x, ConvexCell& cell, std::vector<NaturalNeighbour>& neighbours) const {
    const double far = kFarAway * bounds().diagonal();
    const Vec3 beyond{far, far, far};
    cell.assign_box(bounds().lower - beyond - x, bounds().upper + beyond - x);
    static thread_local std::vector<std::uint32_t> used, found;
    static thread_local std::vector<Vec3> done;  // corners without a nearer sample
    used.clear(), done.clear();
    const auto cut = [&](std::uint32_t sample) {
      const Vec3 d = volume().position(sample) - x;
      used.push_back(sample);
      cell.cut(d, dot(d, d) / 2, sample);
    };
    nearest_.find(x, kFirstGuess, found);
    for (const std::uint32_t s : found) cut(s);
    for (bool complete = false; !complete && used.size() < kMostCuts;) {
      complete = true;
      for (std::size_t v = 0; v < cell.vertices().size(); ++v) {
        const Vec3 p = cell.vertices()[v];
        if (std::find(done.begin(), done.end(), p) != done.end()) continue;
        nearest_.find(x + p, 1, found);
        const double squared = squared_norm(volume().position(found[0]) - x - p);
        if (squared < squared_norm(p) * (1 - kTie) && std::find(used.begin(), used.end(), found[0]) == used.end()) {
          cut(found[0]);
          complete = false;
          break;
        }
        done.push_back(p);
      }
    }
    static thread_local std::vector<ConvexCell::FaceMoment> faces;
    cell.moments(faces);
    neighbours.clear();
    for (const auto& face : faces)
      if (face.label != ConvexCell::kBox)
        neighbours.push_back({face.label, volume().position(face.label) - x, face.area, face.first});
    std::sort(neighbours.begin(), neighbours.end(), [](const auto& a, const auto& b) { return a.sample < b.sample; });
    std::size_t kept = 0;  // rounding may have split a face in two
    for (const NaturalNeighbour& n : neighbours) {
      if (kept > 0 && neighbours[kept - 1].sample == n.sample)
        neighbours[kept - 1].area += n.area, neighbours[kept - 1].moment += n.moment;
      else
        neighbours[kept++] = n;
    }
    neighbours.resize(kept);
  }

  NearestSample nearest_;
};

}  // namespace

}  // namespace detail

static std::unique_ptr<VolumeField> make_sibson_field(ReconstructionInput input) {
  detail::CornerSamples all = detail::with_surface_samples(std::move(input.volume), std::move(input.values));
  return std::make_unique<detail::SibsonField>(std::move(all.volume), std::move(all.values));
}

namespace {

constexpr VolumeMethod kSibsonMethods[] = {{.name = "sibson",
                                            .summary = "natural neighbours: volumes taken from Voronoi cells",
                                            .grids = "all",
                                            .make = make_sibson_field}};

}  // namespace

std::span<const VolumeMethod> sibson_field_methods() { return kSibsonMethods; }

}  // namespace sansmesh::inline v1
