// A quantity of one or several components anywhere in a volume: the interface between reconstructions of volumes, which
// make such fields of samples, and what looks at them (probes, renderers, polygonisers).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// What is wanted at a batch of points; spans that are empty are not wanted.
struct VolumeAnswers {
  std::span<double> values;         ///< components() a point
  std::span<Vec3> gradients;        ///< components() a point: value per length
  std::span<std::uint8_t> inside;   ///< one a point: 1 in the volume, else 0
  std::span<std::uint8_t> degrees;  ///< one a point: degree of the polynomials that the answer is made of, 0 if of none
};

class SANSMESH_API VolumeField {
 public:
  virtual ~VolumeField() = default;

  /// Of the volume: it lies in here.
  virtual Box3 bounds() const = 0;
  /// Numbers a point: 1 of a scalar, 3 of a vector.
  virtual std::size_t components() const = 0;

  /// All that is wanted at all of x. Answers are finite everywhere: outside of the volume, near its boundary, they go
  /// on as inside; farther away they are those of some place of the volume. At points that are not finite they are
  /// zero. Each answer depends on its point alone, not on the rest of the batch nor on threads. Neighbouring points in
  /// neighbouring slots go fastest. Sizes must agree. Safe from several threads. The field itself runs in parallel, as
  /// ScalarField does: whoever asks hands over all points that it has.
  virtual void evaluate(std::span<const Vec3> x, const VolumeAnswers& wanted) const = 0;

  /// The distance between neighbouring samples around each of x (length, > 0): finer than this nothing is known.
  virtual void spacing(std::span<const Vec3> x, std::span<double> found) const = 0;

  /// What all values of the first component within each box lie between, as far as that is known without looking: where
  /// it is not, the ends are infinite, and they are so unless this is overridden. As many entries as boxes. Safe from
  /// several threads.
  virtual void ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const {
    constexpr double kUnknown = std::numeric_limits<double>::infinity();
    std::fill_n(found.begin(), boxes.size(), ValueRange{-kUnknown, kUnknown});
  }
};

}  // namespace sansmesh::inline v1
