#include "align_report.h"

#include <fmt/core.h>

#include <vector>

#include "sansmesh/core/error.h"

namespace sansmesh::cli {
namespace {

constexpr double kLittleOverlap = 0.4;
constexpr double kOtherSize = 1.5;

const char* start_word(AlignStart start) { return start == AlignStart::anywhere ? "anywhere" : "here"; }

/// What should be said beside the numbers: the motion is not the only one, or is hardly told.
std::vector<std::string> alignment_warnings(const SurfaceAlignment& r, const SurfaceAlignmentOptions& options) {
  std::vector<std::string> warnings;
  if (r.alternatives > 0) {
    std::string angles;
    for (const double one : r.alternative_angles) angles += fmt::format("{}{:.0f}°", angles.empty() ? "" : ", ", one);
    warnings.push_back(fmt::format("the pose is not unique: {} {} as well, turned by {}",
                                   counted(r.alternatives, "other"), r.alternatives == 1 ? "fits" : "fit", angles));
  }
  if (r.free_motions > 0)
    warnings.push_back(fmt::format("the surfaces do not tell {}: they slide on each other",
                                   counted(static_cast<std::size_t>(r.free_motions), "motion")));
  if (r.found && r.overlap < kLittleOverlap)
    warnings.push_back(
        fmt::format("only {:.0f} % of it lie on the other surface{}", 100 * r.overlap,
                    options.start == AlignStart::as_it_lies ? ": `start = anywhere` looks elsewhere" : ""));
  if (r.found && r.mirror_image_fits)
    warnings.push_back("its mirror image fits the other surface, it does not itself: one of them is mirrored");
  else if (r.found && r.differing > kOtherShape)
    warnings.push_back(
        fmt::format("it may be another shape: {:.0f} % of it beside the other surface are {} off, more than "
                    "their noise explains",
                    100 * r.differing, length(r.differing_by)));
  return warnings;
}

}  // namespace

void add_align_options(CommandLine& c, SurfaceAlignmentOptions& o) {
  c.add_choice<AlignStart>(
       "--from", o.start,
       {{"auto", AlignStart::automatic}, {"here", AlignStart::as_it_lies}, {"anywhere", AlignStart::anywhere}},
       "Where the search starts: here, as it lies; anywhere, every way round; auto, here, and anywhere if that does "
       "not lead to a good fit [auto]")
      .type_name("CHOICE")
      .group("Alignment");
  c.add_flag("--scale", o.scale, "Find one factor for all lengths, too").group("Alignment");
  c.add_option("--align-samples", o.samples, "Samples of what moves that are compared [20000]")
      .type_name("COUNT")
      .within(100, 10000000)
      .group("Alignment");
  c.add_option("--align-iterations", o.iterations, "Steps of a search at most, 1..1000 [100]")
      .type_name("COUNT")
      .within(1, 1000)
      .group("Alignment");
}

SurfaceAlignment align_or_name(const TriangleMesh& moving, const std::string& moving_file, const TriangleMesh& fixed,
                               const std::string& fixed_file, const SurfaceAlignmentOptions& options,
                               Console& console) {
  SurfaceAlignment r;
  try {
    r = align_surfaces(moving, fixed, options, console.progress());
  } catch (const DataError& error) {
    const std::string what = error.what();
    throw FileError(what.rfind("the fixed", 0) == 0 ? fixed_file : moving_file, console.in_flags(what));
  }
  if (!r.found) {
    std::string why = "found no place on " + fixed_file + " where it fits";
    if (!options.scale && (r.size_ratio > kOtherSize || r.size_ratio < 1 / kOtherSize))
      why += fmt::format(" (it is {:.4g} times as large: --scale)", r.size_ratio);
    throw FileError(moving_file, why);
  }
  console.warn(moving_file, alignment_warnings(r, options));
  return r;
}

AffineMap map_of(const SimilarityMotion& m) {
  AffineMap map{m.x * m.scale, m.y * m.scale, m.z * m.scale, {}};
  map.shift = m.to - map.turn(m.from);
  return map;
}

void say_alignment(const SurfaceAlignment& r, Console& console) {
  const SimilarityMotion& m = r.motion;
  const Vec3 axis = m.axis();
  console.say(fmt::format("{:<16}{:.6g}° about ({:.4g}, {:.4g}, {:.4g}){}", "turned by", m.angle(), axis.x, axis.y,
                          axis.z, m.scale != 1 ? fmt::format(", scaled by {:.6g}", m.scale) : ""));
  const Vec3 shift = m.to - m.from;
  console.say(fmt::format("{:<16}({:.6g}, {:.6g}, {:.6g}); all of it by {} (root mean square)", "its middle by",
                          shift.x, shift.y, shift.z, length(r.moved)));
  console.say(fmt::format("{:<16}rms {}, half below {}, 95 % below {} (before: half below {})", "distance",
                          length(r.rms), length(r.median), length(r.p95), length(r.median_before)));
  console.say(fmt::format("{:<16}{:.1f} % of {} within {} of the surface; {}, started {}", "overlap", 100 * r.overlap,
                          counted(r.samples, "sample"), length(r.reach),
                          counted(static_cast<std::size_t>(r.iterations), "step"),
                          r.start == AlignStart::anywhere ? "anywhere"
                          : r.searched                    ? "as it lay"
                                                          : "as it lay, not looked for elsewhere (--from anywhere)"));
}

Json json_of_alignment(const SurfaceAlignment& r) {
  const SimilarityMotion& m = r.motion;
  const Vec3 axis = m.axis(), shift = m.to - m.from;
  return {{"angle_deg", m.angle()},
          {"axis", {axis.x, axis.y, axis.z}},
          {"scale", m.scale},
          {"shift_of_middle", {shift.x, shift.y, shift.z}},
          {"moved_rms", r.moved},
          {"rms", r.rms},
          {"median", r.median},
          {"p95", r.p95},
          {"median_before", r.median_before},
          {"overlap", r.overlap},
          {"reach", r.reach},
          {"differing_share", r.differing},
          {"differing_by", r.differing_by},
          {"mirror_image_fits", r.mirror_image_fits},
          {"samples", r.samples},
          {"iterations", r.iterations},
          {"from", start_word(r.start)},
          {"alternatives", r.searched ? Json(r.alternatives) : Json()},
          {"alternative_angles_deg", r.alternative_angles},
          {"free_motions", r.free_motions}};
}

Json json_of_matrix(const AffineMap& map) {
  Json rows = Json::array();
  for (std::size_t k = 0; k < 3; ++k) rows.push_back({map.x[k], map.y[k], map.z[k], map.shift[k]});
  rows.push_back({0, 0, 0, 1});
  return rows;
}

}  // namespace sansmesh::cli
