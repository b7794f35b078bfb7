#include "sansmesh/solid_measures.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kMostPlanes = 100000;

std::optional<double> number(std::string text) {
  while (!text.empty() && text.front() == ' ') text.erase(0, 1);
  while (!text.empty() && text.back() == ' ') text.pop_back();
  if (!text.empty() && text.front() == '+') text.erase(0, 1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

CutPlane axis_plane(int axis, double value) {
  if (axis < 0 || axis > 2) throw ArgumentError(fmt::format("axis {}: must be 0, 1 or 2", axis));
  if (!std::isfinite(value)) throw ArgumentError("the position of a plane must be finite");
  CutPlane plane;
  plane.normal = plane.u = plane.v = {};
  const auto k = static_cast<std::size_t>(axis);
  plane.normal[k] = 1;
  plane.u[(k + 1) % 3] = 1;
  plane.v[(k + 2) % 3] = 1;
  plane.offset = value;
  return plane;
}

CutPlane cut_plane(const Vec3& normal, double offset) {
  const double size = std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)});
  if (!is_finite(normal) || !(size > 0) || !std::isfinite(offset))
    throw ArgumentError(fmt::format("plane {:g},{:g},{:g},{:g}: needs a normal with a direction and finite numbers",
                                    normal.x, normal.y, normal.z, offset));
  // Scaled first, so that squares of very large or small components do not overflow or underflow.
  const Vec3 scaled = normal / size;
  const double length = norm(scaled);
  const Vec3 n = scaled / length;
  const double d = offset / size / length;
  if (!std::isfinite(d)) throw ArgumentError(fmt::format("plane with offset {:g}: too far away", offset));
  for (int axis = 0; axis < 3; ++axis)
    if (n[static_cast<std::size_t>(axis)] == 1) return axis_plane(axis, d);
  CutPlane plane;
  plane.normal = n;
  plane.offset = d;
  tangent_frame(n, plane.u, plane.v);
  return plane;
}

std::vector<CutPlane> plane_series(int axis, double start, double step, int count) {
  if (count < 1 || count > kMostPlanes)
    throw ArgumentError(fmt::format("{} planes: must be 1 to {}", count, kMostPlanes));
  if (!std::isfinite(step) || (count > 1 && step == 0))
    throw ArgumentError(fmt::format("a step of {:g} between planes: must be finite and not 0", step));
  std::vector<CutPlane> planes;
  planes.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) planes.push_back(axis_plane(axis, start + i * step));
  return planes;
}

std::vector<CutPlane> spread_planes(const Box3& box, int axis, int count) {
  if (box.empty()) throw ArgumentError("an empty box cannot be cut");
  if (axis < 0 || axis > 2) throw ArgumentError(fmt::format("axis {}: must be 0, 1 or 2", axis));
  const auto k = static_cast<std::size_t>(axis);
  const double thickness = box.size()[k] / (count + 1.0);
  if (count > 1 && !(thickness > 0)) return plane_series(axis, box.center()[k], 0, 1);
  return plane_series(axis, box.lower[k] + thickness, thickness, count);
}

std::vector<CutPlane> middle_planes(const Box3& box) {
  if (box.empty()) throw ArgumentError("an empty box cannot be cut");
  const Vec3 middle = box.center();
  return {axis_plane(0, middle.x), axis_plane(1, middle.y), axis_plane(2, middle.z)};
}

CutPlane parse_plane(const std::string& text) {
  const auto fail = [&]() -> CutPlane {
    throw ArgumentError(ArgumentFault{.field = "plane",
                                      .value = "'" + printable(text, 60) + "'",
                                      .allowed = "like z=0.5 or nx,ny,nz,d with finite numbers",
                                      .remedy = {}});
  };
  if (const auto equals = text.find('='); equals != std::string::npos) {
    std::string name = text.substr(0, equals);
    while (!name.empty() && name.back() == ' ') name.pop_back();
    const auto value = number(text.substr(equals + 1));
    if (name.size() != 1 || !value) return fail();
    const std::size_t axis = std::string("xyz").find(static_cast<char>(name[0] | 0x20));
    return axis == std::string::npos ? fail() : axis_plane(static_cast<int>(axis), *value);
  }
  double values[4];
  std::size_t from = 0;
  for (int k = 0; k < 4; ++k) {
    const std::size_t comma = text.find(',', from);
    if ((comma == std::string::npos) != (k == 3)) return fail();
    const auto value = number(text.substr(from, comma - from));
    if (!value) return fail();
    values[k] = *value;
    from = comma + 1;
  }
  return cut_plane({values[0], values[1], values[2]}, values[3]);
}

std::string text_of_option(const CutPlane& plane) {
  const Vec3& n = plane.normal;
  for (std::size_t k = 0; k < 3; ++k)
    if (n[k] == 1) return fmt::format("{}={}", "xyz"[k], plane.offset);
  return fmt::format("{},{},{},{}", n.x, n.y, n.z, plane.offset);
}

std::string equation(const CutPlane& plane) {
  std::string text;
  for (std::size_t k = 0; k < 3; ++k) {
    const double n = plane.normal[k];
    if (n == 0) continue;
    if (!text.empty())
      text += n < 0 ? " - " : " + ";
    else if (n < 0)
      text += "-";
    if (std::abs(n) != 1) text += fmt::format("{:.6g} ", std::abs(n));
    text += "xyz"[k];
  }
  return fmt::format("{} = {:.8g}", text, plane.offset + 0.0);  // turns -0 into 0
}

}  // namespace sansmesh::inline v1
