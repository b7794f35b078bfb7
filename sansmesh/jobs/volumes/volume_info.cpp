// Contents of volume files.
#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/volumes/volume_state.h"
#include "sansmesh/volume/smoothed_values.h"

namespace sansmesh::inline v1 {

namespace {

AttributeInfo array_info(const DatasetArray& array) {
  AttributeInfo info{array.name, array.of == Association::points ? "point" : "cell", array.type, {}, array.not_finite};
  for (std::size_t c = 0; c < array.components; ++c)
    info.ranges.push_back(value_if(!std::isnan(array.least[c]), std::pair(array.least[c], array.most[c])));
  return info;
}

VolumeInfo contents_of(const VolumeModel& volume, Progress& progress) {
  const std::shared_ptr<const SampledVolume> samples = volume.samples(progress);
  const VolumeDataset& dataset = dataset_of(volume);
  VolumeInfo info;
  info.format = dataset.format();
  info.facts = samples->facts;
  info.samples = samples->size();
  info.in_cells = samples->in_cells;
  info.box = samples->bounds();
  for (const DatasetArray& array : dataset.arrays()) info.arrays.push_back(array_info(array));
  if (const FittedVolume* const fitted = dataset.fitted())
    info.fitted = {fitted->array, fitted->chosen, fitted->coefficients.by_degree(),
                   fitted->coefficients.smoothed.empty() ? 0 : fitted->coefficients.noise};
  info.times = dataset.times();
  info.file_notes = dataset.notes();
  if (dataset.arrays().empty()) return info;
  try {
    const VolumeTraits& traits = volume.traits(progress);
    info.noise_kind = traits.kind;
    info.noise = traits.noisy ? traits.noise * traits.range : 0;
  } catch (const DataError&) {
    info.noise.reset();  // unusable values, as if none is finite, have other facts
  }
  return info;
}

/// Row for a member of VolumeFacts.
template <auto member>
constexpr ReportRow fact(const ReportFacts& facts) {
  return reported<[](const VolumeInfo& r) { return r.facts.*member; }>(facts);
}

using F = VolumeFacts;

}  // namespace

const ReportSchema& HeldReconstruction::schema() {
  static constexpr ReportRow rows[] = {
      reported<[](const HeldReconstruction& r) { return printable(r.array); }>({.name = "array", .text = "Array"}),
      reported<[](const HeldReconstruction& r) { return r.options.method; }>({.name = "method", .text = "Method"}),
      reported<[](const HeldReconstruction& r) { return r.options.degree; }>(
          {.name = "degree", .text = "Highest degree of polynomials"}),
      reported<[](const HeldReconstruction& r) { return r.options.radius; }>(
          {.name = "radius", .text = "Radius of supports", .unit = "spacings"}),
      reported<[](const HeldReconstruction& r) { return r.options.epsilon; }>(
          {.name = "epsilon", .text = "Shape parameter of the functions, small is smooth"}),
      reported<[](const HeldReconstruction& r) { return r.options.order; }>({.name = "order", .text = "Order"}),
      reported<[](const HeldReconstruction& r) { return r.options.iterations; }>(
          {.name = "iterations", .text = "Corrections by residuals"}),
      reported<[](const HeldReconstruction& r) { return r.options.spherical.value_or(false); }>(
          {.name = "spherical", .text = "Whether supports are balls"}),
      reported<[](const HeldReconstruction& r) { return r.options.interpolate; }>(
          {.name = "interpolate", .text = "Whether the field passes through the samples (mls, mls-detail)"}),
      reported<[](const HeldReconstruction& r) { return value_if(r.noise > 0, r.options.smoothing.value_or(0)); }>(
          {.name = "smoothing", .text = "Factor of the noise by which the samples were smoothed; the file keeps both"}),
      reported<[](const HeldReconstruction& r) { return value_if(r.noise > 0, r.noise); }>(
          {.name = "noise", .text = "Deviation of this noise", .unit = "value"}),
      reported<&HeldReconstruction::by_degree>({.text = "Polynomials of each degree"})};
  return report_schema<rows>();
}

const ReportSchema& VolumeInfo::schema() {
  static constexpr ReportRow rows[] = {
      reported<&VolumeInfo::format>({.text = "Format of the file"}),
      fact<&F::grid>({.name = "grid", .text = "Description of the grid"}),
      fact<&F::blocks>({.name = "blocks", .text = "Blocks"}),
      fact<&F::levels>({.name = "levels", .text = "Levels of refinement"}),
      fact<&F::points>({.name = "points", .text = "Points of the file"}),
      fact<&F::cells>({.name = "cells", .text = "Cells of the file"}),
      reported<&VolumeInfo::samples>({.text = "Samples"}),
      reported<[](const VolumeInfo& r) { return r.in_cells ? "cells" : "points"; }>(
          {.name = "values_of", .text = "Location of the values: points or cells"}),
      reported<[](const VolumeInfo& r) { return r.box.lower; }>(
          {.name = "lower", .text = "Lower corner of the box", .unit = "length"}),
      reported<[](const VolumeInfo& r) { return r.box.upper; }>(
          {.name = "upper", .text = "Upper corner of the box", .unit = "length"}),
      fact<&F::least_spacing>(
          {.name = "spacing.least", .text = "Least distance between neighbouring samples", .unit = "length"}),
      fact<&F::median_spacing>(
          {.name = "spacing.median", .text = "Median distance between neighbouring samples", .unit = "length"}),
      fact<&F::most_spacing>(
          {.name = "spacing.most", .text = "Largest distance between neighbouring samples", .unit = "length"}),
      fact<&F::aspect>({.name = "aspect", .text = "Largest ratio of longest to shortest edge of a cell"}),
      fact<&F::parts>({.name = "parts", .text = "Number of connected components"}),
      fact<&F::merged>({.name = "merged", .text = "Points that coincide with another"}),
      fact<&F::hidden>({.name = "hidden", .text = "Blanked, covered and ghost points or cells"}),
      fact<&F::overlapped>({.name = "overlapped", .text = "Samples dropped where a finer block is"}),
      fact<&F::degenerate>({.name = "degenerate", .text = "Cells without volume"}),
      fact<&F::inverted>({.name = "inverted", .text = "Inverted cells that were reoriented"}),
      fact<&F::not_finite>({.name = "not_finite", .text = "Points that are not finite"}),
      fact<&F::layer>({.name = "layer", .text = "Thickness given to a single layer, or 0", .unit = "length"}),
      reported<&VolumeInfo::arrays>({.text = "Arrays"}),
      reported<&VolumeInfo::noise>({.name = "noise",
                                    .text = "Deviation of the noise of the selected array, 0 if none is found",
                                    .unit = "value"}),
      reported<[](const VolumeInfo& r) { return value_if(!r.noise_kind.empty(), r.noise_kind); }>(
          {.name = "noise_kind", .text = "Kind of this noise: white, correlated or Rician"}),
      reported<&VolumeInfo::fitted>({.name = "reconstruction", .text = "Reconstruction stored in a fitted volume"}),
      reported<&VolumeInfo::times>({.text = "Times of the steps"}),
      reported<&VolumeInfo::file_notes>({.name = "notes", .text = "Notes on reading the file"})};
  return report_schema<rows>();
}

VolumeInfo volume_info(const VolumeModel& volume, Progress& progress) {
  VolumeInfo info = contents_of(volume, progress);
  const VolumeFacts& f = info.facts;
  const auto note = [&](const char* code, std::string text) {
    info.notes.push_back(
        {.code = code, .text = std::move(text), .severity = Note::Severity::information, .of = volume.name()});
  };
  const auto add = [&](const char* code, std::size_t n, const char* what, const char* text) {
    if (n > 0) note(code, fmt::format("{} {}", counted(n, what), text));
  };
  add("merged", f.merged, "point", "coincident with another: merged");
  add("not_finite", f.not_finite, "point", "without finite coordinates dropped");
  add("hidden", f.hidden, "point", "or cells hidden (blanked, covered by finer levels, ghosts)");
  add("overlapped", f.overlapped, "sample", "dropped under a finer block");
  add("degenerate", f.degenerate, "cell", "without volume or with coincident corners");
  add("inverted", f.inverted, "cell", "inverted, reoriented");
  if (f.layer > 0) note("layer", fmt::format("a single layer, treated as a slab {} thick", length_words(f.layer)));
  return info;
}

namespace {

/// Lines about the reconstruction stored in a fitted volume.
void add_fitted(const HeldReconstruction& fitted, std::vector<std::string>& lines) {
  const auto line = [&](const char* title, const std::string& text) { lines.push_back(titled(title, text, 12)); };
  const VolumeReconstructionOptions& o = fitted.options;
  std::string options;
  const auto add = [&](const char* name, const auto& value) {
    if (value) options += fmt::format("{}{} {}", options.empty() ? "" : ", ", name, *value);
  };
  add("degree at most", o.degree), add("radius", o.radius), add("epsilon", o.epsilon), add("order", o.order);
  add("iterations", o.iterations);
  if (o.spherical.value_or(false)) options += options.empty() ? "spherical" : ", spherical";
  line("fitted", fmt::format("{} by {}{}", printable(fitted.array, 80), o.method.value(),
                             options.empty() ? "" : " (" + options + ")"));
  if (!o.interpolate.value_or(true)) line("", "not through the samples, as printed");
  if (fitted.noise > 0)
    line("smoothed", fmt::format("by {:g} times the noise of {:.3g}; these samples are kept beside the file's",
                                 o.smoothing.value_or(1), fitted.noise));
  if (!fitted.by_degree.empty())
    line("polynomials",
         fmt::format("of degree 0 to {}: {}", fitted.by_degree.size() - 1, fmt::join(fitted.by_degree, ", ")));
}

}  // namespace

std::vector<std::string> summary_of(const VolumeInfo& made) {
  const VolumeFacts& f = made.facts;
  std::vector<std::string> lines;
  const auto line = [&](const char* title, const std::string& text) { lines.push_back(titled(title, text, 12)); };
  line("grid",
       fmt::format("{}, {}{}", f.grid, counted(f.points, "point"), f.cells > 0 ? ", " + counted(f.cells, "cell") : ""));
  if (f.blocks > 1 || f.levels > 1)
    line("blocks", fmt::format("{}{}", grouped(f.blocks), f.levels > 1 ? " in " + counted(f.levels, "level") : ""));
  line("samples", fmt::format("{} (values of {})", grouped(made.samples), made.in_cells ? "cells" : "points"));
  line("box", fmt::format("{}, {}", size_words(made.box.size()), box_words(made.box)));
  line("spacing",
       fmt::format("{} to {}, median {}; cells up to {:.3g} times as long as wide", length_words(f.least_spacing),
                   length_words(f.most_spacing), length_words(f.median_spacing), f.aspect));
  if (f.parts > 1) line("parts", fmt::format("{} connected components", grouped(f.parts)));
  for (const Note& note : made.notes) line("repaired", note.text);
  if (!made.times.empty())
    line("times", fmt::format("{}, from {:.6g} to {:.6g}", counted(made.times.size(), "step"), made.times.front(),
                              made.times.back()));
  for (const AttributeInfo& array : made.arrays) line("array", array_words(array));
  if (made.noise)
    line("noise", *made.noise > 0
                      ? fmt::format("{:.3g}, {}, smoothed by reconstructions{}", *made.noise, made.noise_kind,
                                    smoothed_unasked(made.samples) ? "" : " only on request")
                      : "none found");
  if (made.fitted) add_fitted(*made.fitted, lines);
  return lines;
}

}  // namespace sansmesh::inline v1
