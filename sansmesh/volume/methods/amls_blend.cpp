#include "sansmesh/volume/methods/amls_blend.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <utility>
#include <vector>

#include "sansmesh/volume/cells/higher_order_functions.h"
#include "sansmesh/volume/kernels/amls_kernels.h"
#include "sansmesh/volume/methods/grouped_field.h"
#include "sansmesh/volume/reconstruction_coefficients.h"
#include "sansmesh/volume/samples/support_index.h"

namespace sansmesh::inline v1 {
namespace {

using detail::AmlsBlock;
using detail::AmlsSums;

constexpr float kNothing = 1e-20f;

// Cache of the supports of cells, with a bounded size. Safe from any thread.
class KeptSupports {
 public:
  explicit KeptSupports(std::size_t cells) : lists_(cells <= kMostCells ? cells : 0) {}

  /// Number of supports, a sample of the cell, and the supports; null if the cell is not cached.
  const std::uint32_t* find(std::size_t cell) const {
    return lists_.empty() ? nullptr : lists_[cell].load(std::memory_order_acquire);
  }
  void keep(std::size_t cell, std::uint32_t own, std::span<const std::uint32_t> supports) {
    if (lists_.empty()) return;
    const std::lock_guard lock(mutex_);
    const std::size_t size = supports.size() + 2;
    if (lists_[cell].load(std::memory_order_relaxed) || kept_ + size > kMostKept) return;
    if (pages_.empty() || used_ + size > pages_.back().size()) {
      pages_.emplace_back(std::max(size, kPage));
      used_ = 0;
    }
    std::uint32_t* to = pages_.back().data() + used_;
    used_ += size, kept_ += size;
    to[0] = static_cast<std::uint32_t>(supports.size()), to[1] = own;
    std::copy(supports.begin(), supports.end(), to + 2);
    lists_[cell].store(to, std::memory_order_release);
  }

 private:
  static constexpr std::size_t kMostCells = std::size_t{1} << 21;  // 16 MiB of pointers
  static constexpr std::size_t kMostKept = std::size_t{48} << 18;  // 48 MiB of indices
  static constexpr std::size_t kPage = std::size_t{1} << 16;

  std::vector<std::atomic<const std::uint32_t*>> lists_;
  std::vector<std::vector<std::uint32_t>> pages_;
  std::size_t used_ = 0, kept_ = 0;
  std::mutex mutex_;
};

class AmlsBlend final : public GroupedField {
 public:
  AmlsBlend(std::shared_ptr<const SampledVolume> volume, std::shared_ptr<const VolumeLocator> locator,
            LocalPolynomials polynomials, SharedArray<float> radii, VolumeValues values, const AmlsShape& shape)
      : GroupedField(std::move(volume), std::move(locator), polynomials.components),
        polynomials_(std::move(polynomials)),
        radii_(std::move(radii)),
        values_(std::move(values)),
        shape_(shape),
        linear_share_(has_linear_share(this->volume())),
        index_(this->volume(), polynomials_.metrics.view(), radii_.view()),
        higher_(this->volume()),
        kept_(this->volume().lattice ? this->volume().size() : this->volume().cells.size()) {}

 private:
  // A cell with its supports in the layout of the kernel.
  struct Ready {
    std::size_t cell = ~std::size_t{0};
    std::uint32_t own = 0;
    Vec3 origin;
    std::size_t blocks = 0;
    std::vector<float> store;
    const float* floats = nullptr;  // in `store`, aligned to 64 bytes
  };

  struct Desk {
    static constexpr std::size_t kReady = 2048;  // neighbouring rays visit the same cells again
    std::array<Ready, kReady> ready;
    SupportIndex::Memory found;
    std::vector<std::pair<float, std::uint32_t>> order;
    std::array<Vec3f, kMostPoints> x;
    std::array<AmlsSums, kMostPoints> sums;
  };

  // A desk on loan: fields are evaluated often, a few points at a time, so that desks are reused.
  struct Borrowed final : Memory {
    explicit Borrowed(const AmlsBlend& field) : from(field) {
      const std::lock_guard lock(from.desks_mutex_);
      if (from.desks_.empty()) return;
      desk = std::move(from.desks_.back());
      from.desks_.pop_back();
    }
    ~Borrowed() override {
      if (!desk) return;
      const std::lock_guard lock(from.desks_mutex_);
      from.desks_.push_back(std::move(desk));
    }
    Borrowed(const Borrowed&) = delete;
    Borrowed& operator=(const Borrowed&) = delete;

    const AmlsBlend& from;
    std::unique_ptr<Desk> desk;
  };

  std::unique_ptr<Memory> memory() const override {
    auto borrowed = std::make_unique<Borrowed>(*this);
    if (!borrowed->desk) borrowed->desk = std::make_unique<Desk>();
    return borrowed;
  }
  bool goes_on_straight() const override { return true; }

  const Ready& ready(const CellLocation& location, Desk& desk) const {
    const std::size_t cell = location.cell;
    Ready& r = desk.ready[(cell * 0x9e3779b97f4a7c15ULL >> 40) % Desk::kReady];
    if (r.cell == cell) return r;
    std::span<const std::uint32_t> supports;
    if (const std::uint32_t* kept = kept_.find(cell)) {
      supports = {kept + 2, kept[0]};
      r.own = kept[1];
    } else {
      nearest_first(index_.of_cell(location, desk.found), desk);
      supports = desk.found.supports;
      r.own = desk.found.own;
      kept_.keep(cell, r.own, supports);
    }
    r.cell = cell;
    r.origin = volume().position(r.own);
    const std::size_t c = components(), floats = AmlsBlock::floats(c);
    r.blocks = (supports.size() + AmlsBlock::kWide - 1) / AmlsBlock::kWide;
    r.store.resize(r.blocks * floats + AmlsBlock::kWide);
    const auto address = reinterpret_cast<std::uintptr_t>(r.store.data());
    float* all = r.store.data() + (64 - address % 64) % 64 / sizeof(float);
    r.floats = all;
    for (std::size_t s = 0; s < r.blocks * AmlsBlock::kWide; ++s) {
      const std::size_t lane = s % AmlsBlock::kWide;
      float* block = all + s / AmlsBlock::kWide * floats;
      if (s < supports.size())
        put(supports[s], r.origin, r.own, block, lane);
      else
        AmlsBlock::clear(block, lane, c);
    }
    return r;
  }

  // The kernel skips blocks without a support in reach: blocks group supports of similar reach.
  void nearest_first(const Vec3& middle, Desk& desk) const {
    desk.order.clear();
    for (const std::uint32_t i : desk.found.supports)
      desk.order.emplace_back(
          static_cast<float>(squared_norm(polynomials_.metric(volume(), i)(middle - volume().position(i)))) /
              (radii_[i] * radii_[i]),
          i);
    std::sort(desk.order.begin(), desk.order.end());
    for (std::size_t s = 0; s < desk.order.size(); ++s) desk.found.supports[s] = desk.order[s].second;
  }

  void put(std::size_t i, const Vec3& origin, std::size_t own, float* block, std::size_t lane) const {
    const std::size_t c = components();
    float* to = block + lane;
    const auto next = [&to](float value) { *to = value, to += AmlsBlock::kWide; };
    const Vec3f center(volume().position(i) - origin);
    next(center.x), next(center.y), next(center.z);
    const StarMetric metric = polynomials_.metric(volume(), i);
    for (const Vec3f& row : metric.rows) next(row.x), next(row.y), next(row.z);
    next(1 / (radii_[i] * radii_[i]));
    for (std::size_t m = 0; m < c; ++m) {
      next(static_cast<float>(polynomials_.constants[i * c + m] - values_.values[own * c + m]));
      const std::span<const float> of = polynomials_.of(i, m);
      for (const float term : of) next(term);
      for (std::size_t j = of.size() + 1; j < AmlsBlock::kOwn; ++j) next(0);
    }
  }

  void evaluate_group(const Group& group, Memory& memory, const PolynomialValues& wanted) const override {
    Desk& desk = *static_cast<Borrowed&>(memory).desk;
    const std::size_t n = group.size, c = components();
    const bool gradient = !wanted.gradients.empty();
    // All of this depends on the cell alone, so that results do not depend on the other points in the cell.
    const Ready& cell = ready(group.cell, desk);
    if (!wanted.degrees.empty())
      for (std::size_t i = 0; i < n; ++i) wanted.degrees[group.to[i]] = polynomials_.degrees[cell.own];
    if (wanted.values.empty() && !gradient) return;
    for (std::size_t i = 0; i < n; ++i) desk.x[i] = Vec3f(group.x[i] - cell.origin);
    const detail::AmlsLaguerre laguerre{static_cast<float>(shape_.l0), static_cast<float>(shape_.l1),
                                        static_cast<float>(shape_.l2)};
    bool linear = false;
    for (std::size_t v = 0; linear_share_ && v < group.cell.corner_count; ++v)
      linear = linear || polynomials_.trust[group.cell.corners[v]] < 1;
    for (std::size_t m = 0; m < c; ++m) {
      const double base = values_.values[cell.own * c + m];
      detail::sum_amls(cell.floats, cell.blocks, c, m, laguerre, std::span(desk.x).first(n), gradient,
                       desk.sums.data());
      for (std::size_t i = 0; i < n; ++i) {
        const AmlsSums& s = desk.sums[i];
        constexpr auto kLeastShare = static_cast<float>(AmlsShape::kLeastShare);
        const bool by_weight = s.weight >= kLeastShare * s.size;
        const float divisor = by_weight ? s.weight : kLeastShare * s.size;
        double value = 0;  // minus the base
        Vec3 g;
        if (divisor > kNothing) {
          const float quotient = s.value / divisor;
          value = static_cast<double>(quotient);
          for (std::size_t k = 0; k < 3 && gradient; ++k) {
            const float slope = by_weight ? s.weight_slope[k] : kLeastShare * s.size_slope[k];
            g[k] = static_cast<double>((s.value_slope[k] - quotient * slope) / divisor);
          }
        }
        if (linear) share(*group.locations[i], group.x[i], m, base, value, gradient ? &g : nullptr);
        const std::size_t to = group.to[i] * c + m;
        if (!wanted.values.empty()) wanted.values[to] = base + value;
        if (gradient) wanted.gradients[to] = g;
      }
    }
  }

  // T value + (1 − T) L, and its gradient.
  void share(const CellLocation& location, const Vec3& x, std::size_t m, double base, double& value,
             Vec3* gradient) const {
    const std::size_t c = components();
    double trust = 0, line = 0;
    for (std::size_t v = 0; v < location.corner_count; ++v) {
      const std::size_t i = location.corners[v];
      trust += location.weights[v] * static_cast<double>(polynomials_.trust[i]);
      line += location.weights[v] * (values_.values[i * c + m] - base);
    }
    const bool all = trust >= 1, none = trust <= 0;
    if (all) return;
    if (none) trust = 0;
    static thread_local NodeWeights nodes;
    const bool own = higher_.find(location, x, gradient != nullptr, nodes);
    if (own) line = nodes.value(values_, m) - base;
    if (gradient) {
      std::array<Vec3, 8> slopes;
      shape_gradients(volume(), location, x, slopes);
      Vec3 line_slope, trust_slope;
      for (std::size_t v = 0; v < location.corner_count; ++v) {
        const std::size_t i = location.corners[v];
        line_slope += slopes[v] * (values_.values[i * c + m] - base);
        trust_slope += slopes[v] * static_cast<double>(polynomials_.trust[i]);
      }
      if (none) trust_slope = {};
      if (own) line_slope = nodes.gradient(values_, m);
      *gradient = *gradient * trust + line_slope * (1 - trust) + trust_slope * (value - line);
    }
    value = trust * value + (1 - trust) * line;
  }

  LocalPolynomials polynomials_;
  SharedArray<float> radii_;
  VolumeValues values_;
  AmlsShape shape_;
  bool linear_share_;
  SupportIndex index_;
  HigherOrderFunctions higher_;
  mutable KeptSupports kept_;
  mutable std::mutex desks_mutex_;
  mutable std::vector<std::unique_ptr<Desk>> desks_;
};

}  // namespace

bool has_linear_share(const SampledVolume& volume) { return !blends_supports(volume, "mls-detail"); }

std::unique_ptr<GroupedField> make_amls_blend(std::shared_ptr<const SampledVolume> volume,
                                              std::shared_ptr<const VolumeLocator> locator,
                                              LocalPolynomials polynomials, SharedArray<float> radii,
                                              VolumeValues values, const AmlsShape& shape) {
  return std::make_unique<AmlsBlend>(std::move(volume), std::move(locator), std::move(polynomials), std::move(radii),
                                     std::move(values), shape);
}

}  // namespace sansmesh::inline v1
