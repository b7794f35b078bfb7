#include "sansmesh/deform/cuts/mesh_occluder.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <mutex>
#include <vector>

#include "sansmesh/deform/cuts/detour_lattice.h"
#include "sansmesh/deform/cuts/triangle_sheet.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kGrowth = 0.5;  // margin of the default domain over the diagonal

Box3 domain_of(const Box3& sheet, const MeshOccluderOptions& options) {
  Box3 box = sheet;
  if (options.domain) {
    box.extend(*options.domain);
  } else {
    const double more = kGrowth * sheet.diagonal();
    box.lower -= Vec3{more, more, more}, box.upper += Vec3{more, more, more};
  }
  return box;
}

class MeshOccluder final : public Occluder {
 public:
  MeshOccluder(const TriangleMesh& mesh, const MeshOccluderOptions& options)
      : sheet_(mesh), lattice_(sheet_, domain_of(sheet_.bounds(), options), options.resolution) {}

  void detours(const Vec3& handle, std::span<const Vec3> x, std::span<Detour> found) const override {
    const std::vector<float>& extras = extras_from(handle);
    for (std::size_t i = 0; i < x.size(); ++i) found[i] = lattice_.interpolate(extras, x[i]);
  }

  void gaps(std::span<const Vec3> x, std::span<const Vec3> sources, std::span<const std::array<Vec3, 3>> jacobians,
            std::span<Gap> found) const override {
    std::vector<TriangleSheet::Crossing> crossings;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const std::array<Vec3, 3>* const jacobian = jacobians.empty() ? nullptr : &jacobians[i];
      if (!is_finite(x[i]) || !is_finite(sources[i])) {
        found[i] = {-std::numeric_limits<double>::infinity(), {}};
        continue;
      }
      crossings.clear();
      sheet_.crossings(x[i], sources[i], crossings);
      found[i] =
          crossings.empty() ? without(x[i], sources[i], jacobian) : across(x[i], sources[i], jacobian, crossings);
    }
  }

  void crossings(const Vec3& a, const Vec3& b, std::vector<double>& found) const override {
    std::vector<TriangleSheet::Crossing> all;
    sheet_.crossings(a, b, all);
    for (const TriangleSheet::Crossing& c : all) found.push_back(c.share);
  }

  void border_points(const Vec3& a, const Vec3& b, const Vec3& c, std::vector<Vec3>& found) const override {
    sheet_.border_points({a, b, c}, found);
  }

 private:
  struct Entry {
    std::once_flag once;
    std::vector<float> extras;
  };

  const std::vector<float>& extras_from(const Vec3& handle) const {
    Entry* entry = nullptr;
    {
      const std::lock_guard lock(mutex_);
      entry = &handles_[{handle.x, handle.y, handle.z}];
    }
    std::call_once(entry->once, [&] { entry->extras = lattice_.extra_lengths(handle); });
    return entry->extras;
  }

  /// Gap of a segment that does not cross.
  Gap without(const Vec3& x, const Vec3& u, const std::array<Vec3, 3>* jacobian) const {
    const TriangleSheet::Nearest n = sheet_.nearest(x, u, std::numeric_limits<double>::infinity());
    Gap gap{-n.distance, {}};
    if (!jacobian || !(n.distance > 0)) return gap;
    const Vec3 away = (x + (u - x) * n.share - n.point) / n.distance;
    for (std::size_t k = 0; k < 3; ++k)
      gap.gradient[k] = -((1 - n.share) * away[k] + n.share * dot(away, (*jacobian)[k]));
    return gap;
  }

  Gap across(const Vec3& x, const Vec3& u, const std::array<Vec3, 3>* jacobian,
             const std::vector<TriangleSheet::Crossing>& crossings) const {
    constexpr double kAnywhere = std::numeric_limits<double>::infinity();
    const TriangleSheet::Nearest near = sheet_.nearest(x, kAnywhere), near_u = sheet_.nearest(u, kAnywhere);
    const double a = near.distance, b = near_u.distance, sum = a + b;
    const double apart = sum > 0 ? a * b / sum : 0;
    const TriangleSheet::Crossing& first = crossings.front();
    const TriangleSheet::Nearest border = sheet_.nearest_border(first.point, kAnywhere);
    const bool twice = crossings.size() % 2 == 0;
    const double between = twice ? 0.5 * norm(crossings.back().point - first.point) : kAnywhere;
    Gap gap{std::min({apart, border.distance, between}), {}};
    if (!jacobian) return gap;
    const auto moved = [&](const TriangleSheet::Crossing& c, std::size_t k) {  // velocity of the crossing
      const std::array<Vec3, 3> t = sheet_.corners(c.triangle);
      const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
      Vec3 by = (*jacobian)[k] * c.share;
      by[k] += 1 - c.share;
      return by - (u - x) * (dot(by, n) / dot(u - x, n));
    };
    for (std::size_t k = 0; k < 3; ++k) {
      if (gap.depth == apart) {
        const double da = a > 0 ? (x - near.point)[k] / a : 0,
                     db = b > 0 ? dot(u - near_u.point, (*jacobian)[k]) / b : 0;
        if (sum > 0) gap.gradient[k] = (b * b * da + a * a * db) / (sum * sum);
      } else if (gap.depth == border.distance) {
        if (border.distance > 0) gap.gradient[k] = dot(first.point - border.point, moved(first, k)) / border.distance;
      } else if (between > 0) {
        gap.gradient[k] =
            0.25 * dot(crossings.back().point - first.point, moved(crossings.back(), k) - moved(first, k)) / between;
      }
    }
    return gap;
  }

  TriangleSheet sheet_;
  DetourLattice lattice_;
  mutable std::mutex mutex_;
  mutable std::map<std::array<double, 3>, Entry> handles_;
};

}  // namespace

void MeshOccluderOptions::validate() const {
  if (resolution < 8 || resolution > 256) throw ArgumentError("`resolution` of a mesh that cuts must lie in 8..256");
  if (domain && domain->empty()) throw ArgumentError("`domain` of a mesh that cuts is empty");
}

std::shared_ptr<const Occluder> mesh_occluder(const TriangleMesh& mesh, const MeshOccluderOptions& options) {
  options.validate();
  if (TriangleSheet(mesh).empty()) throw ArgumentError("a mesh that cuts has no triangle with an area");
  return std::make_shared<MeshOccluder>(mesh, options);
}

}  // namespace sansmesh::inline v1
