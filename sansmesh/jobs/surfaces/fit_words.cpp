#include "sansmesh/jobs/surfaces/fit_words.h"

#include <fmt/core.h>

#include "sansmesh/core/number_words.h"

namespace sansmesh::inline v1 {

std::string normals_made(bool estimated, const std::optional<OrientBy>& oriented_by) {
  return fmt::format("normals {}{}", estimated ? "estimated" : "as given",
                     oriented_by ? fmt::format(", oriented {}", orientation_words(*oriented_by)) : "");
}

std::vector<std::string> paper_words(const PaperReport& r, const FitsOfDegree& fits) {
  return {fmt::format("{} planes, {} of degree 2, {} of degree 3, {} of degree 4, {} constants; {} planes are borrowed "
                      "from the nearest samples",
                      grouped(fits[1]), grouped(fits[2]), grouped(fits[3]), grouped(fits[4]), grouped(fits[0]),
                      grouped(r.borrowed)),
          fmt::format("{}: {} subdivided for two sheets, {} for too many samples; of those with few samples {} "
                      "subdivided, {} not, since their children are worse; {} above the threshold; {} by balance alone",
                      counted(r.blocks, "block"), grouped(r.two_sheets), grouped(r.too_many), grouped(r.not_worse),
                      grouped(r.kept), grouped(r.above), grouped(r.balanced))};
}

std::string aspect_words(const MeshReport& report) {
  return fmt::format("aspect ratio {:.3f} ± {:.3f} before enhancement, {:.3f} ± {:.3f} after",
                     report.aspect_mean_before, report.aspect_deviation_before, report.aspect_mean,
                     report.aspect_deviation);
}

}  // namespace sansmesh::inline v1
