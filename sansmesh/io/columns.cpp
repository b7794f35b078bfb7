#include "sansmesh/io/columns.h"

namespace sansmesh::io {
namespace {

/// Calls use(at) with at(i) -> Vec3: one loader for the three columns where they agree in type, as they do in practice.
template <class Use>
void with_triples(const Column (&c)[3], Use&& use) {
  const bool uniform = c[0].type == c[1].type && c[1].type == c[2].type && c[0].stride == c[1].stride &&
                       c[1].stride == c[2].stride && c[0].swap == c[1].swap && c[1].swap == c[2].swap;
  if (!uniform) {
    use([&c](std::size_t i) { return Vec3{c[0][i], c[1][i], c[2][i]}; });
    return;
  }
  with_loader(c[0].type, c[0].swap, [&](auto at) {
    const char* const x = c[0].at;
    const char* const y = c[1].at;
    const char* const z = c[2].at;
    const std::size_t stride = c[0].stride;
    use([=](std::size_t i) {
      const std::size_t o = i * stride;
      return Vec3{static_cast<double>(at(x + o)), static_cast<double>(at(y + o)), static_cast<double>(at(z + o))};
    });
  });
}

}  // namespace

void decode_columns(const CloudColumns& columns, std::size_t n, PointSet& points, const Vec3& scale,
                    const Vec3& offset) {
  const std::size_t grain = 1 << 14;
  with_triples(columns.position, [&](auto at) {
    if (scale == Vec3{1, 1, 1} && offset == Vec3{}) {
      place_positions(points, n, at);
    } else {
      place_positions(points, n, [&](std::size_t i) {
        const Vec3 p = at(i);
        return Vec3{p.x * scale.x + offset.x, p.y * scale.y + offset.y, p.z * scale.z + offset.z};
      });
    }
  });
  if (columns.normal[0] && columns.normal[1] && columns.normal[2]) {
    points.normals.resize(n);
    with_triples(columns.normal,
                 [&](auto at) { parallel_for(0, n, grain, [&](std::size_t i) { points.normals[i] = Vec3f(at(i)); }); });
  }
  if (columns.color[0] && columns.color[1] && columns.color[2]) {
    const NumberType type = columns.color[0].type;
    points.colors.resize(n);
    with_triples(columns.color, [&](auto at) {
      double factor = 1;
      if (type != NumberType::u8) {
        const double largest = parallel_reduce(
            n, 1 << 16, 0.0,
            [&](std::size_t first, std::size_t last) {
              double m = 0;
              for (std::size_t i = first; i < last; ++i) {
                const Vec3 c = at(i);
                m = std::max({m, c.x, c.y, c.z});
              }
              return m;
            },
            [](double a, double b) { return std::max(a, b); });
        factor = color_scale(largest, is_real(type) && !columns.whole_colors);
      }
      parallel_for(0, n, grain, [&](std::size_t i) {
        const Vec3 c = at(i);
        points.colors[i] = {to_byte(c.x, factor), to_byte(c.y, factor), to_byte(c.z, factor)};
      });
    });
  }
  if (columns.confidence) {
    points.confidence.resize(n);
    parallel_for(0, n, grain, [&](std::size_t i) { points.confidence[i] = static_cast<float>(columns.confidence[i]); });
  }
}

}  // namespace sansmesh::io
