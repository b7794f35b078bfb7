// Resampling of volumes to uniform grids.
#include <fmt/core.h>

#include <algorithm>
#include <cstdint>

#include "sansmesh/dataset/resample_volume.h"
#include "sansmesh/jobs/volumes/volume_state.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/volumes.h"

namespace sansmesh::inline v1 {

ResampleResult resample(const VolumeModel& volume, const ResampleOptions& options, Progress& progress) {
  options.validate();
  ResampleResult result;
  const auto field = volume.field(progress, result.notes);
  result.block =
      with_name(volume.name(), [&] { return resample_volume(*field, volume.array_name(), options, progress); });
  const AttributeTable& arrays = result.block.point_arrays;
  const auto& inside = *arrays[arrays.size() - 1].as<std::uint8_t>();
  for (std::size_t k = 0; k < 3; ++k) result.report.size[k] = result.block.axes[k].size();
  result.report.reconstruction = volume.report();
  result.report.inside =
      static_cast<double>(std::count(inside.begin(), inside.end(), 1)) / static_cast<double>(inside.size());
  return result;
}

std::string lattice_words(const std::array<std::size_t, 3>& size, double inside) {
  return fmt::format("{} × {} × {} values, {:.1f} % in the volume", size[0], size[1], size[2], 100 * inside);
}

const ReportSchema& ResampleReport::schema() {
  static constexpr ReportRow rows[] = {
      reported<&ResampleReport::size>({.name = "output.size", .text = "Values along the axes"}),
      reported<&ResampleReport::inside>(
          {.name = "output.inside", .text = "Share of the values inside the volume", .unit = "share"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
