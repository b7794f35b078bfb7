#include "sansmesh/partition/local_function.h"

namespace sansmesh {

float local_value(const LocalFunction& f, const Vec3f& x) {
  const Vec3f d = (x - f.center) / f.scale;
  const float u = dot(d, f.xi), v = dot(d, f.eta), w = dot(d, f.nu);
  const auto& c = f.coefficient;
  float g = c[0];
  if (f.degree >= 1) g += u * c[1] + v * c[2];
  if (f.degree >= 2) g += u * u * c[3] + u * v * c[4] + v * v * c[5];
  if (f.degree >= 3) g += u * u * u * c[6] + u * u * v * c[7] + u * v * v * c[8] + v * v * v * c[9];
  if (f.degree >= 4)
    g += u * u * u * u * c[10] + u * u * u * v * c[11] + u * u * v * v * c[12] + u * v * v * v * c[13] +
         v * v * v * v * c[14];
  return (w - g) * f.scale;
}

}  // namespace sansmesh
