// Signs of normals by connected parts: by the votes of neighbours, and by a known sensor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sansmesh/points/orientation/relation_graph.h"
#include "sansmesh/points/orientation/sign_graph.h"
#include "sansmesh/progress.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// Magnitude of the cosine between normal and direction to the sensor above which the normal clearly faces the sensor
/// or away from it.
inline constexpr float kLeastSensorCosine = 0.25f;
/// Thresholds of edge reliability in the order of joining; down to the last one the patches are smooth.
inline constexpr int kSure[] = {118, 105, 90, 75};
/// Voting patches: largest number of stretches of samples, and largest number of patches per stretch. Rough normals
/// break a stretch into many patches; votes between more of them would be slow and uninformative.
inline constexpr std::size_t kMostStretches = 20000, kMostPatchesOfStretch = 4;

/// Directions from the samples of a graph to the sensor, and an extra node that represents it: samples that agree with
/// this node face the sensor.
class SensorCosines {
 public:
  SensorCosines() = default;
  /// `directions`: unit vectors in the caller's order, or none. Rough parts have also been seen from the side and from
  /// within by an airborne sensor: only `firm` samples count.
  SensorCosines(const RelationGraph& graph, const std::vector<Vec3f>& directions, bool from_air);

  bool known() const { return !cosine_.empty(); }
  /// Cosine between normal and sensor direction; 0 if unknown.
  float cosine(std::size_t s) const { return cosine_[s]; }
  /// Joins the samples with larger magnitudes of the cosine to the extra node, the last of the forest.
  void join(SignForest& forest, float least) const;
  /// Forgets the directions of samples that the sensor has not seen. Their patches join by votes.
  void forget(std::vector<std::uint8_t> hidden);
  /// Whether a sample is hidden; empty if none is.
  const std::vector<std::uint8_t>& hidden() const { return hidden_; }
  /// Whether each smooth patch has been seen from one side. Large clouds are tested on some stretches in tree order.
  bool believable(const RelationGraph& graph) const;

 private:
  std::vector<float> cosine_;
  std::vector<std::uint8_t> hidden_;
};

/// Connected parts of the graph, and the sign of each sample that makes it agree with its part.
struct Parts {
  std::vector<std::uint32_t> part;  ///< part of each sample
  std::vector<std::int8_t> sign;
  std::size_t count = 0;
  /// Confidence that the signs make the part's normals point outward: negative = inward.
  std::vector<double> outwardness;
  /// Parts so far from closed that they have no outside.
  std::vector<std::uint8_t> open;
  /// Part whose samples have been seen from a known side, and the sign that makes them face it.
  std::optional<std::uint32_t> seen;
  std::int8_t seen_sign = 1;
};

/// Joins smooth patches first, from the most to the least reliable edges; then patches by the vote of all edges between
/// them. Samples that clearly face the sensor or away are fixed before, the others after the patches.
void propagate(const RelationGraph& graph, const SensorCosines& sensor, SignForest& forest, Progress& progress);

/// Sets of a forest that joins the samples of a graph. `outwardness` and `open` are empty.
Parts collect_parts(const RelationGraph& graph, const SensorCosines& sensor, SignForest& forest);

/// Flips individual samples that contradict most of their neighbours. The sensor direction weighs as much as all
/// neighbours.
void polish(const RelationGraph& graph, const SensorCosines& sensor, Parts& parts);

/// These three steps: the parts of a graph, with polished signs.
Parts propagated_parts(const RelationGraph& graph, const SensorCosines& sensor, Progress& progress);

/// Number of sets of a flat forest.
std::size_t sets_of(const SignForest& forest);

/// Determines the signs of a graph's normals. Noise can make even the most reliable edges contradictory, so that the
/// first ones decide for whole regions. Votes between small patches, unless there are too many, use all edges. Keeps
/// the result with fewer contradictions.
Parts settle_signs(const RelationGraph& graph, const SensorCosines& sensor, Progress& progress);

/// Determines `outwardness` and `open`. Combines the enclosed volume, relative to its possible maximum, with the mean
/// cosine between normals and the directions in which their samples are extremal. A part so flat that neither is
/// significant (terrain) faces up. Skips the part with a known sensor.
void judge_outwardness(const RelationGraph& graph, Parts& parts);

}  // namespace sansmesh::inline v1::detail
