// Animations in one file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sansmesh/image.h"

namespace sansmesh::inline v1 {

/// An animated PNG (APNG, in the PNG specification since its third edition): browsers play it, programs that do not
/// know it show the first picture. Pictures are packed as they come, of each only the part that changes.
class Animation {
 public:
  /// `loops`: how often it is played, 0: for ever. Throws ArgumentError unless `fps` is in 0.01..1000.
  explicit Animation(double fps, unsigned loops = 0);
  /// All must have the size of the first, and are opaque where that is. Throws ArgumentError.
  void add(const Image& picture);
  std::size_t size() const { return frames_.size(); }
  /// Throws FileError, ArgumentError where there is no picture.
  void write(const std::string& file) const;

 private:
  struct Frame {
    std::uint32_t x = 0, y = 0, width = 0, height = 0;
    std::string packed;
  };
  double rate_;
  unsigned loops_;
  std::uint32_t width_ = 0, height_ = 0;
  bool opaque_ = true;
  std::vector<std::array<std::uint8_t, 4>> last_;
  std::vector<Frame> frames_;
};

}  // namespace sansmesh::inline v1
