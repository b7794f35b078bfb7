// Base class of fields that evaluate all points of a cell together.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volume/methods/degree_field.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

class GroupedField : public VolumeField, public DegreeField {
 public:
  GroupedField(std::shared_ptr<const SampledVolume> volume, std::shared_ptr<const VolumeLocator> locator,
               std::size_t components)
      : volume_(std::move(volume)), locator_(std::move(locator)), components_(components) {}

  Box3 bounds() const override { return volume_->bounds(); }
  std::size_t components() const override { return components_; }
  void evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const final;
  void degrees(std::span<const Vec3> x, std::span<std::uint8_t> found) const final;
  void spacing(std::span<const Vec3> x, std::span<double> found) const override;

 protected:
  static constexpr std::size_t kMostPoints = 64;  ///< per group

  /// Per-thread state, kept between groups.
  struct Memory {
    virtual ~Memory() = default;
  };
  /// Points of one cell. A point outside the volume is replaced by its nearest point in it; `out` is the difference.
  struct Group {
    const CellLocation& cell;  ///< location of the first point
    std::size_t size = 0;
    std::array<const CellLocation*, kMostPoints> locations;
    std::array<Vec3, kMostPoints> x, out;
    std::array<std::uint32_t, kMostPoints> to;  ///< indices of the points in the results
  };

  virtual std::unique_ptr<Memory> memory() const = 0;
  /// Writes the requested values, gradients and degrees. The result at a point must not depend on the other points.
  virtual void evaluate_group(const Group& group, Memory& memory, const PolynomialValues& wanted) const = 0;

  /// Whether values outside continue linearly from the nearest points (held_outside); evaluate_group() then evaluates
  /// those. Otherwise evaluate_group() uses `out` itself.
  virtual bool goes_on_straight() const { return false; }

  const SampledVolume& volume() const { return *volume_; }
  /// For fields that consist of others on the same volume.
  static std::unique_ptr<Memory> memory_of(const GroupedField& part) { return part.memory(); }
  static void evaluate_part(const GroupedField& part, const Group& group, Memory& memory,
                            const PolynomialValues& wanted) {
    part.evaluate_group(group, memory, wanted);
  }
  void evaluate_all(std::span<const Vec3> x, const PolynomialValues& wanted) const;

 private:
  struct Block;
  void evaluate_outside(Group& group, const PolynomialValues& wanted, Block& block) const;
  void evaluate_block(std::span<const Vec3> x, std::span<const std::uint32_t> order, std::size_t first,
                      std::size_t last, const PolynomialValues& wanted, Block& block) const;

  std::shared_ptr<const SampledVolume> volume_;
  std::shared_ptr<const VolumeLocator> locator_;
  std::size_t components_;
};

}  // namespace sansmesh::inline v1
