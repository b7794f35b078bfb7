// A small set of numbers of samples, forgotten in no time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sansmesh::inline v1 {

/// Which of a volume's samples a walk over stars has met. Its memory follows the largest walk, not the volume: one for
/// each range of a loop costs nothing. Open addressing; slots are void unless they bear the number of the walk.
class SampleSet {
 public:
  /// Forgets all.
  void clear() {
    count_ = 0;
    if (++walk_ != 0) return;
    slots_.assign(slots_.size(), {});
    walk_ = 1;
  }
  /// False if it was there.
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

  /// The slot of a sample, or the void one where it would be. At least half of the slots are void.
  std::size_t find(std::uint32_t sample) const {
    const std::size_t mask = slots_.size() - 1;
    // Neighbours have numbers at equal distances: the upper bits of a product spread them.
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
