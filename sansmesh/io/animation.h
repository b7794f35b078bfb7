// Writer of animated PNG files.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sansmesh/image.h"

namespace sansmesh::inline v1 {

/// An animated PNG (APNG, in the PNG specification since its third edition). Browsers play it; programs without APNG
/// support show the first picture. Pictures are compressed as they are added; only the part that changes is stored.
class Animation {
 public:
  /// Repeated endlessly. Throws ArgumentError unless `fps` is in 0.01..1000.
  explicit Animation(double fps);
  /// All pictures must have the size of the first, and be opaque if the first is. Throws ArgumentError.
  void add(const Image& picture);
  std::size_t size() const { return frames_.size(); }
  /// Throws FileError, and ArgumentError if there is no picture.
  void write(const std::string& file) const;

 private:
  struct Frame {
    std::uint32_t x = 0, y = 0, width = 0, height = 0;
    std::string packed;
  };
  double rate_;
  std::uint32_t width_ = 0, height_ = 0;
  bool opaque_ = true;
  std::vector<std::array<std::uint8_t, 4>> last_;
  std::vector<Frame> frames_;
};

}  // namespace sansmesh::inline v1
