// A small set of sample indices with constant-time clearing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sansmesh::inline v1 {

/// The samples visited by a walk over stars. Memory is proportional to the largest walk, not to the volume, so that one
/// set per range of a loop is cheap. Open addressing; a slot is empty unless it has the number of the current walk.
class SampleSet {
 public:
  /// Removes all samples.
  void clear() {
    count_ = 0;
    if (++walk_ != 0) return;
    slots_.assign(slots_.size(), {});
    walk_ = 1;
  }
  /// False if it was present.
  bool insert(std::uint32_t sample) {
    if (2 * (count_ + 1) > slots_.size()) grow();
    Slot& slot = slots_[find(sample)];
    if (slot.walk == walk_) return false;
    slot = {sample, walk_};
    ++count_;
    return true;
  }
  bool contains(std::uint32_t sample) const { return !slots_.empty() && slots_[find(sample)].walk == walk_; }

 private:
  struct Slot {
    std::uint32_t sample = 0, walk = 0;
  };

  /// The slot of a sample, or the empty slot for it. At least half of the slots are empty.
  std::size_t find(std::uint32_t sample) const {
    const std::size_t mask = slots_.size() - 1;
    // Neighbours have equidistant indices: the upper bits of a product spread them.
    std::size_t at = (sample * 0x9e3779b97f4a7c15ULL >> 32) & mask;
    while (slots_[at].walk == walk_ && slots_[at].sample != sample) at = (at + 1) & mask;
    return at;
  }
  void grow() {
    std::vector<Slot> old(slots_.empty() ? 256 : 2 * slots_.size());
    old.swap(slots_);
    for (const Slot& slot : old)
      if (slot.walk == walk_) slots_[find(slot.sample)] = slot;
  }

  std::vector<Slot> slots_;  ///< a power of two
  std::size_t count_ = 0;
  std::uint32_t walk_ = 1;
};

}  // namespace sansmesh::inline v1
