#include "sansmesh/measure/section_curves.h"

#include <algorithm>
#include <cmath>

namespace sansmesh::inline v1 {
namespace {

constexpr double kNoArea = 1e-12;  ///< share of the areas of all curves

}  // namespace

bool Section::closed() const { return open_curves() == 0; }

std::size_t Section::open_curves() const {
  return static_cast<std::size_t>(
      std::count_if(curves.begin(), curves.end(), [](const SectionCurve& c) { return !c.closed; }));
}

Section make_section(const CutPlane& plane, const std::vector<SectionChain>& chains,
                     const std::vector<std::array<double, 2>>& points) {
  Section section;
  section.plane = plane;
  double sizes = 0;
  for (const SectionChain& chain : chains) {
    SectionCurve curve;
    curve.closed = chain.closed;
    auto& line = curve.plane;
    for (const std::uint32_t p : chain.points)
      if (line.empty() || line.back() != points[p]) line.push_back(points[p]);
    while (curve.closed && line.size() > 1 && line.back() == line.front()) line.pop_back();
    if (line.size() < (curve.closed ? 3u : 2u)) continue;
    // Relative to one of the points, for accuracy far from the origin.
    const auto [u0, v0] = line[0];
    for (std::size_t i = 0; i < line.size(); ++i) {
      const auto [u, v] = line[i];
      curve.points.push_back(plane.at(u, v));
      if (i + 1 == line.size() && !curve.closed) break;
      const auto [s, t] = line[(i + 1) % line.size()];
      curve.length += std::hypot(s - u, t - v);
      if (curve.closed) curve.area += 0.5 * ((u - u0) * (t - v0) - (s - u0) * (v - v0));
    }
    section.length += curve.length;
    section.area += curve.area;
    sizes += std::abs(curve.area);
    section.curves.push_back(std::move(curve));
  }
  // Two layers in opposite directions cancel but for rounding errors.
  if (std::abs(section.area) < kNoArea * sizes) section.area = 0;
  return section;
}

}  // namespace sansmesh::inline v1
