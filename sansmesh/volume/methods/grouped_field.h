// Fields that are evaluated cell by cell: points are located, and those of a cell answered together.
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
  void evaluate(std::span<const Vec3> x, const VolumeAnswers& wanted) const final;
  void degrees(std::span<const Vec3> x, std::span<std::uint8_t> found) const final;
  void spacing(std::span<const Vec3> x, std::span<double> found) const override;

 protected:
  static constexpr std::size_t kMostPoints = 64;  ///< of a group

  /// What a thread keeps between groups.
  struct Memory {
    virtual ~Memory() = default;
  };
  /// Points of one cell. Those outside of the volume are at their nearest place of it; `out` tells how far they are.
  struct Group {
    const VolumePlace& cell;  ///< the first place
    std::size_t size = 0;
    std::array<const VolumePlace*, kMostPoints> places;
    std::array<Vec3, kMostPoints> x, out;
    std::array<std::uint32_t, kMostPoints> to;  ///< numbers of the points in the answers
  };

  virtual std::unique_ptr<Memory> memory() const = 0;
  /// Puts in values, gradients and degrees, what is wanted of them. An answer must not depend on the others.
  virtual void answer(const Group& group, Memory& memory, const PolynomialAnswers& wanted) const = 0;

  /// Whether values outside go on straight from the nearest places (held_outside), which answer() is asked for then.
  /// Otherwise it heeds `out` itself.
  virtual bool goes_on_straight() const { return false; }

  const SampledVolume& volume() const { return *volume_; }
  CellShape shape_of(std::size_t cell) const {
    return volume_->lattice ? CellShape::hexahedron : volume_->cells.shapes[cell];
  }
  /// Of a corner of a cell, as places have them.
  Vec3 corner(std::uint32_t c) const { return volume_->lattice ? volume_->lattice->position(c) : volume_->corner(c); }

 private:
  struct Block;
  void evaluate_all(std::span<const Vec3> x, const PolynomialAnswers& wanted) const;
  void answer_outside(Group& group, const PolynomialAnswers& wanted, Block& block) const;
  void evaluate_block(std::span<const Vec3> x, std::span<const std::uint32_t> order, std::size_t first,
                      std::size_t last, const PolynomialAnswers& wanted, Block& block) const;

  std::shared_ptr<const SampledVolume> volume_;
  std::shared_ptr<const VolumeLocator> locator_;
  std::size_t components_;
};

}  // namespace sansmesh::inline v1
