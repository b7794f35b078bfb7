#include "align_report.h"

#include <fmt/core.h>

namespace sansmesh::cli {
namespace {

const char* start_word(AlignStart start) { return start == AlignStart::anywhere ? "anywhere" : "here"; }

}  // namespace

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
