#include "sansmesh/attribute_table.h"
#include "sansmesh/inspect.h"
#include "sansmesh/mesh/align/align_surfaces.h"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/data/reference_system.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kLittleOverlap = 0.4;
constexpr double kOtherSize = 1.5;

/// Notes on motions that are not unique or badly determined.
void add_alignment_notes(const SurfaceAlignment& r, const SurfaceAlignmentOptions& options, const std::string& name,
                         std::vector<Note>& notes) {
  const auto note = [&](const char* code, std::string text, const char* remedy = "") {
    notes.push_back({.code = code, .text = std::move(text), .remedy = remedy, .of = name});
  };
  if (r.alternatives > 0)
    note("not_unique",
         fmt::format("the pose is not unique: {} {} as well, turned by {:.0f}°", counted(r.alternatives, "other"),
                     r.alternatives == 1 ? "fits" : "fit", fmt::join(r.alternative_angles, "°, ")));
  if (r.free_motions > 0)
    note("free_motions", fmt::format("the surfaces do not determine {}: they can slide on each other",
                                     counted(static_cast<std::size_t>(r.free_motions), "motion")));
  if (r.overlap < kLittleOverlap)
    note("little_overlap", fmt::format("only {:.0f} % of it are on the other surface", 100 * r.overlap),
         options.start == AlignStart::given_pose ? "`from = anywhere` searches all positions" : "");
  if (r.mirror_image_fits)
    note("mirrored", "its mirror image fits the other surface better than it does: one of them is mirrored");
  else if (r.differing > kOtherShape)
    note("other_shape", fmt::format("it may be another shape: {:.0f} % of it beside the other surface are {} off, more "
                                    "than their noise explains",
                                    100 * r.differing, length_words(r.differing_by)));
}

}  // namespace

AlignResult align(const AnySurface& moving, const AnySurface& fixed, const SurfaceAlignmentOptions& options,
                  Progress& progress, const AffineMap& before) {
  options.validate();
  require_same_system(moving.reference(), moving.name(), fixed.reference(), fixed.name());
  AlignResult result;
  result.moved = *moving.mesh(progress, result.notes);
  if (before != AffineMap()) transform(result.moved, before);
  result.fixed = fixed.mesh(progress, result.notes);
  SurfaceAlignment& r = result.report;
  try {
    r = align_surfaces(result.moved, *result.fixed, options, progress);
  } catch (const DataError& error) {
    const std::string what = error.what();
    throw DataError((what.rfind("the fixed", 0) == 0 ? fixed.name() : moving.name()) + ": " + what);
  }
  if (!r.found) {
    std::string why = moving.name() + ": found no place on " + fixed.name() + " where it fits";
    if (!options.find_scale && (r.size_ratio > kOtherSize || r.size_ratio < 1 / kOtherSize))
      why += fmt::format(" (it is {:.4g} times as large: `find_scale`)", r.size_ratio);
    throw DataError(why);
  }
  add_alignment_notes(r, options, moving.name(), result.notes);
  const AffineMap motion = r.motion.map();
  transform(result.moved, motion);
  result.moved.reference = result.fixed->reference;
  result.motion = motion.after(before);
  return result;
}

const ReportSchema& AlignResult::schema() {
  static constexpr ReportRow rows[] = {
      reported<&AlignResult::report>({.name = "alignment", .text = "Motion and quality of the fit"}),
      reported<[](const AlignResult& r) { return r.motion.rows(); }>(
          {.name = "matrix", .text = "Motion as 4 rows of 4 numbers"})};
  return report_schema<rows>();
}

std::vector<std::string> summary_of(const SurfaceAlignment& r) {
  const SimilarityMotion& m = r.motion;
  return {titled("turned by", fmt::format("{:.6g}° about {}{}", m.angle(), point_words(m.axis(), 4),
                                          m.scale != 1 ? fmt::format(", scaled by {:.6g}", m.scale) : "")),
          titled("its middle by", fmt::format("{}; all of it by {} (root mean square)", point_words(m.to - m.from),
                                              length_words(r.moved))),
          titled("distance",
                 fmt::format("rms {}, half below {}, 95 % below {} (before: half below {})", length_words(r.rms),
                             length_words(r.median), length_words(r.p95), length_words(r.median_before))),
          titled("overlap", fmt::format("{:.1f} % of {} within {} of the surface; {}, started {}", 100 * r.overlap,
                                        counted(r.samples, "sample"), length_words(r.reach),
                                        counted(static_cast<std::size_t>(r.iterations), "step"),
                                        r.start == AlignStart::anywhere ? "anywhere"
                                        : r.searched                    ? "as it lay"
                                                     : "as it lay, not looked for elsewhere (`from = anywhere`)"))};
}

}  // namespace sansmesh::inline v1
