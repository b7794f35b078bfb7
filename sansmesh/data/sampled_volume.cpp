#include "sansmesh/sampled_volume.h"

namespace sansmesh::inline v1 {

void SampledVolume::star(std::size_t sample, std::vector<std::uint32_t>& out) const {
  if (!lattice) {
    const auto row = stars[sample];
    out.assign(row.begin(), row.end());
    return;
  }
  out.clear();
  const auto at = lattice->indices(sample);
  const std::size_t step[] = {1, lattice->axes[0].size(), lattice->axes[0].size() * lattice->axes[1].size()};
  for (std::size_t k = 3; k-- > 0;)
    if (at[k] > 0) out.push_back(static_cast<std::uint32_t>(sample - step[k]));
  for (std::size_t k = 0; k < 3; ++k)
    if (at[k] + 1 < lattice->axes[k].size()) out.push_back(static_cast<std::uint32_t>(sample + step[k]));
}

Box3 SampledVolume::bounds() const {
  Box3 box;
  if (lattice) {
    const auto& l = *lattice;
    for (int c = 0; c < 8; ++c)
      box.extend(l.from_axes(
          {c & 1 ? l.upper[0] : l.lower[0], c & 2 ? l.upper[1] : l.lower[1], c & 4 ? l.upper[2] : l.lower[2]}));
    return box;
  }
  for (const Vec3& x : positions) box.extend(x);
  for (const Vec3& x : corners) box.extend(x);
  return box;
}

}  // namespace sansmesh::inline v1
