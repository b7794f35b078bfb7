#include "sansmesh/volume/choose_reconstruction.h"

#include <fmt/core.h>

#include "sansmesh/volume/smoothed_values.h"

namespace sansmesh::inline v1 {
namespace {

/// On larger lattices polynomials at each sample take too long for their gain.
constexpr std::size_t kLargeLattice = 500'000;
/// On larger grids of other kinds they take too much memory.
constexpr std::size_t kLargeGrid = 20'000'000;

}  // namespace

VolumeReconstructionChoice choose_reconstruction(const SampledVolume& volume, const VolumeTraits& traits,
                                                 std::optional<double> smoothing) {
  const char* const then = smoothing ? (*smoothing > 0 ? "which is smoothed first" : "which is kept")
                           : smoothed_unasked(volume.size())
                               ? "which is smoothed first"
                               : "which only `smoothing` smooths, since there are so many";
  const auto percent = [](double share) { return fmt::format("{:.2g} %", 100 * share); };
  if (traits.noisy && volume.size() <= (volume.lattice ? kLargeLattice : kLargeGrid))
    return {"mls-detail", fmt::format("a {} with noise ({} of the range), {}: local polynomials gain most",
                                      volume.lattice ? "lattice" : "grid", percent(traits.noise), then)};
  if (volume.lattice) {
    if (traits.noisy)
      return {"cubic", fmt::format("a large lattice with noise ({} of the range), {}: cubics through its samples are "
                                   "smooth and quick",
                                   percent(traits.noise), then)};
    if (!traits.resolved())
      return {
          "cubic",
          fmt::format("a lattice whose samples are noisy or too far apart for parabolas (left out they are missed by "
                      "{} of the range, by planes {}): a cubic through each is smooth, and no other method is nearer",
                      percent(traits.left_out[2]), percent(traits.left_out[1]))};
    if (!traits.edges_resolved())
      return {
          "cubic",
          fmt::format("a lattice with edges that are too fine for parabolas (left out, samples are missed by {} of "
                      "the range, root mean square, by planes {}): a cubic through each is smooth, and nearer there",
                      percent(traits.left_out_rms[2]), percent(traits.left_out_rms[1]))};
    if (volume.size() > kLargeLattice)
      return {"cubic", "a large lattice: cubics through its samples are smooth and quick"};
    return {"mls-detail",
            fmt::format("a lattice that resolves what it shows (a sample left out is missed by {} of the range): local "
                        "polynomials gain most",
                        percent(traits.left_out[2]))};
  }
  if (volume.size() > kLargeGrid)
    return {"linear", "a very large grid: polynomials about its samples would take too much memory"};
  if (!traits.resolved())
    return {
        "mls-detail",
        fmt::format("a grid whose samples are noisy or too far apart for parabolas (left out they are missed by {} of "
                    "the range, by planes {}): little can be gained over its own interpolation but smoothness",
                    percent(traits.left_out[2]), percent(traits.left_out[1]))};
  return {
      "mls-detail",
      fmt::format("a grid that resolves what it shows (samples left out are missed by {} of the range, by planes {}): "
                  "local polynomials gain most",
                  percent(traits.left_out[2]), percent(traits.left_out[1]))};
}

}  // namespace sansmesh::inline v1
