// Advice on volumes.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "sansmesh/core/number_words.h"
#include "sansmesh/dataset/joined_arrays.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/volumes/volume_state.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/volume/smoothed_values.h"

namespace sansmesh::inline v1 {
namespace {

/// Vector array for flows: the selected array if it has vectors, otherwise the first, or vectors of separate
/// components.
std::optional<DatasetArray> flow_array(const VolumeDataset& dataset, const std::string& looked_at) {
  std::optional<DatasetArray> found;
  for (const DatasetArray& a : dataset.arrays()) {
    if (a.components != 2 && a.components != 3) continue;
    if (a.name == looked_at) return a;
    if (!found) found = a;
  }
  if (found || dataset.fitted()) return found;
  return joined_array(dataset.arrays(), vector_components(dataset.arrays()));
}

/// Seed line along the longer of the two axes perpendicular to the main flow.
std::array<Vec3, 2> line_across(const SampledVolume& volume, const DatasetArray& flow) {
  const Box3 box = volume.bounds();
  const Vec3 size = box.size(), middle = box.center();
  std::size_t along = 0;
  for (std::size_t c = 1; c < flow.components; ++c)
    if (std::abs(flow.least[c] + flow.most[c]) > std::abs(flow.least[along] + flow.most[along])) along = c;
  std::size_t across = along == 0 ? 1 : 0;
  for (std::size_t c = 0; c < 3; ++c)
    if (c != along && size[c] > size[across]) across = c;
  std::array<Vec3, 2> ends{middle, middle};
  // Leaves a margin of 5 %: at the boundary there is often no flow, or none into the volume.
  ends[0][across] = box.lower[across] + 0.05 * size[across];
  ends[1][across] = box.upper[across] - 0.05 * size[across];
  return ends;
}

double mean_value(const VolumeModel& volume, std::size_t samples) {
  double sum = 0;
  for (std::size_t i = 0; i < samples; ++i) sum += volume.sample_value(i);
  return sum / static_cast<double>(samples);
}

}  // namespace

VolumeAdvice advise(const VolumeModel& volume, Progress& progress) {
  const VolumeDataset& dataset = dataset_of(volume);
  const auto samples = volume.samples(progress);
  VolumeAdvice advice;
  advice.facts = samples->facts;
  VolumeAdviceInput& offer = advice.offer;
  offer.values = !dataset.arrays().empty();
  offer.steps = std::max<std::size_t>(dataset.times().size(), 1);
  // Only unstructured cells may be an elastic body.
  offer.body = samples->facts.unstructured;
  offer.lattice = samples->lattice.has_value();
  if (!offer.values && !offer.body)
    with_name(volume.name(),
              [] { throw DataError("has no arrays, and no cells of a body: there is nothing to advise"); });
  if (offer.values) {
    const DatasetArray& of = volume.array();
    const bool vector = of.components > 1 && !volume.choice().component;
    const std::string& asked = volume.options().array;
    advice.array = vector ? of.name + ":magnitude" : asked.empty() ? of.name : asked;
    advice.value = vector ? mean_value(volume, samples->size()) : volume.middle_value();
    if (const std::optional<DatasetArray> vectors = flow_array(dataset, of.name)) {
      offer.vectors = true;
      advice.flow = vectors->name;
      advice.seeds = line_across(*samples, *vectors);
    }
    offer.traits = volume.traits(progress);
    offer.recommended = volume.recommended(progress);
  }
  advice.recommendations = advise_volume(offer);
  return advice;
}

namespace {

std::string share_words(double share) { return fmt::format("{:.2g} %", 100 * share); }

}  // namespace

std::vector<std::string> summary_of(const VolumeAdvice& advice) {
  const VolumeFacts& facts = advice.facts;
  const VolumeAdviceInput& offer = advice.offer;
  const VolumeTraits& t = offer.traits;
  if (!offer.values)
    return {fmt::format("{}, {} ({}), no arrays", counted(facts.points, "point"), counted(facts.cells, "cell"),
                        facts.grid)};
  const char* const then = !t.noisy                      ? ""
                           : smoothed_unasked(t.samples) ? ", smoothed first"
                                                         : ", smoothed only on request";
  return {fmt::format("{} of {} ({}{})", counted(t.samples, "sample"), advice.array, facts.grid,
                      offer.steps > 1 ? fmt::format(", {} steps", offer.steps) : ""),
          fmt::format(
              "  error of predicting a sample from its neighbours: {} of the range by the mean, {} by planes, {} by "
              "parabolas, {} by cubics",
              share_words(t.left_out[0]), share_words(t.left_out[1]), share_words(t.left_out[2]),
              share_words(t.left_out[3])),
          fmt::format("  noise {}{} of the range{}; steps at {} of the samples", t.noisy ? "" : "at most ",
                      share_words(t.noise), then, share_words(t.steps)),
          titled("reconstruction", fmt::format("{}, since it is {}", offer.recommended.method, offer.recommended.why))};
}

const ReportSchema& VolumeAdvice::schema() {
  static constexpr ReportRow rows[] = {
      reported<[](const VolumeAdvice& r) { return value_if(r.offer.values, r.array); }>(
          {.name = "array", .text = "Selected array"}),
      reported<[](const VolumeAdvice& r) { return value_if(r.offer.values, r.offer.traits.samples); }>(
          {.name = "samples", .text = "Samples of the array"}),
      reported<[](const VolumeAdvice& r) { return value_if(r.offer.values, r.offer.traits.left_out); }>(
          {.name = "left_out",
           .text = "Median error of predicting a sample by its neighbours, for degrees 0 to 3",
           .unit = "share of the range"}),
      reported<[](const VolumeAdvice& r) { return value_if(r.offer.values, r.offer.traits.left_out_rms); }>(
          {.name = "left_out_rms", .text = "Root mean square of these errors", .unit = "share of the range"}),
      reported<[](const VolumeAdvice& r) { return value_if(r.offer.values, r.offer.traits.noise); }>(
          {.name = "noise", .text = "Upper bound of the noise", .unit = "share of the range"}),
      reported<[](const VolumeAdvice& r) { return value_if(r.offer.values, r.offer.traits.noisy); }>(
          {.name = "noisy", .text = "Whether noise was found, which reconstructions smooth first"}),
      reported<[](const VolumeAdvice& r) { return value_if(r.offer.values, r.offer.traits.steps); }>(
          {.name = "steps", .text = "Share of the samples next to steps", .unit = "share"}),
      reported<[](const VolumeAdvice& r) { return value_if(r.offer.values, r.offer.traits.resolved()); }>(
          {.name = "resolved", .text = "Whether the samples resolve the quantity"}),
      reported<[](const VolumeAdvice& r) { return value_if(r.offer.values, std::string(r.offer.recommended.method)); }>(
          {.name = "method", .text = "Recommended method"}),
      reported<[](const VolumeAdvice& r) { return value_if(r.offer.values, r.offer.recommended.why); }>(
          {.name = "why", .text = "Reason for the method"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
