// Converts polygons and strips of any length to triangles.
#pragma once

#include <span>

#include "sansmesh/core/number_words.h"
#include "sansmesh/io/input.h"

namespace sansmesh::inline v1::io {

/// Collects triangles. Polygons become fans around their first corner. Impossible indices become 0xffffffff, which
/// `finish` rejects.
class FaceSink {
 public:
  /// `face_of`, if given, receives for each triangle the number of its polygon or strip, counted from 0.
  FaceSink(const Input& in, std::vector<std::array<std::uint32_t, 3>>& triangles,
           std::vector<std::uint32_t>* face_of = nullptr)
      : in_(in), triangles_(triangles), face_of_(face_of) {}

  void add_polygon(std::span<const std::int64_t> corners) {
    if (corners.size() < 3) ++degenerate_;
    for (std::size_t k = 2; k < corners.size(); ++k) triangle(corners[0], corners[k - 1], corners[k]);
    ++face_;
  }

  /// Every other triangle is turned; a negative index ends one strip and begins the next.
  void add_strip(std::span<const std::int64_t> corners) {
    std::size_t start = 0;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      if (corners[k] < 0) {
        start = k + 1;
      } else if (k >= start + 2) {
        const std::int64_t a = corners[k - 2], b = corners[k - 1], c = corners[k];
        if (a == b || b == c || a == c) continue;  // a turn of the strip
        if ((k - start) % 2 == 0)
          triangle(a, b, c);
        else
          triangle(b, a, c);
      }
    }
    ++face_;
  }

  /// Reports skipped faces.
  void done() const {
    if (degenerate_ > 0) {
      in_.warn(grouped(degenerate_) + " faces with fewer than 3 corners were left out");
    }
  }

 private:
  void triangle(std::int64_t a, std::int64_t b, std::int64_t c) {
    triangles_.push_back({narrow(a), narrow(b), narrow(c)});
    if (face_of_) face_of_->push_back(face_);
  }
  static std::uint32_t narrow(std::int64_t v) {
    return v < 0 || v > 0xfffffffe ? 0xffffffffu : static_cast<std::uint32_t>(v);
  }

  const Input& in_;
  std::vector<std::array<std::uint32_t, 3>>& triangles_;
  std::vector<std::uint32_t>* face_of_;
  std::uint32_t face_ = 0;
  std::size_t degenerate_ = 0;
};

}  // namespace sansmesh::inline v1::io
