// Contents of a file of a volume.
#include <fmt/core.h>

#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/jobs/volume_state.h"

namespace sansmesh::inline v1 {

VolumeInfo volume_info(const VolumeModel& volume, Progress& progress) {
  VolumeInfo info{.samples = volume.samples(progress)};
  if (const FittedVolume* const held = dataset_of(volume).fitted())
    info.fitted = {held->array, held->chosen, held->coefficients.by_degree()};
  const VolumeFacts& f = info.samples->facts;
  const auto note = [&](const char* code, std::string text) {
    info.notes.push_back({.code = code,
                          .text = std::move(text),
                          .remedy = {},
                          .severity = Note::Severity::information,
                          .of = volume.name()});
  };
  const auto add = [&](const char* code, std::size_t n, const char* what, const char* text) {
    if (n > 0) note(code, fmt::format("{} {}", counted(n, what), text));
  };
  add("merged", f.merged, "point", "at the place of another: one sample each place");
  add("not_finite", f.not_finite, "point", "without finite coordinates left out");
  add("hidden", f.hidden, "point", "or cells hidden (blanked, covered by finer levels, ghosts)");
  add("overlapped", f.overlapped, "sample", "left out since a finer block covers their place");
  add("degenerate", f.degenerate, "cell", "without volume or with corners that coincide");
  add("inverted", f.inverted, "cell", "inside out, turned");
  if (f.layer > 0) note("layer", fmt::format("a single layer, taken as a slab {} thick", length_words(f.layer)));
  return info;
}

}  // namespace sansmesh::inline v1
