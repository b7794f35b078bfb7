#include "sansmesh/flow_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kMostSeeds = 1e8;

[[noreturn]] void fail(std::string_view text, const std::string& why) {
  throw ArgumentError("seeds \"" + printable(text, 200) + "\": " + printable(why, 400));
}

std::vector<double> numbers_of(std::string_view text, std::string_view inside, std::size_t count, const char* form) {
  std::vector<double> numbers;
  while (!inside.empty()) {
    const std::size_t comma = inside.find(',');
    const std::string_view word = without_blanks(inside.substr(0, comma));
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
      fail(text, "\"" + std::string(word) + "\" is not a number; the form is " + form);
    numbers.push_back(value);
    inside = comma == std::string_view::npos ? std::string_view() : inside.substr(comma + 1);
  }
  if (numbers.size() != count)
    fail(text, std::to_string(numbers.size()) + " numbers in place of " + std::to_string(count) + ": " + form);
  return numbers;
}

std::size_t count_of(std::string_view text, double value, double least) {
  if (value != std::floor(value) || value < least || value > kMostSeeds)
    fail(text, "the number of seeds must be a whole number of at least " + std::to_string(static_cast<int>(least)));
  return static_cast<std::size_t>(value);
}

std::vector<Vec3> in_box(const Box3& box, std::size_t n) {
  const Vec3 size = box.size();
  // Directions thinner than the step have one layer; the seeds are distributed over the others.
  bool thin[3] = {};
  double step = 0;
  for (int pass = 0; pass < 3; ++pass) {
    double product = 1;
    int wide = 0;
    for (std::size_t k = 0; k < 3; ++k)
      if (!thin[k]) product *= std::max(size[k], 1e-100), ++wide;
    if (wide == 0) break;
    step = std::pow(product / static_cast<double>(n), 1.0 / wide);
    for (std::size_t k = 0; k < 3; ++k) thin[k] = thin[k] || size[k] < 0.5 * step;
  }
  std::size_t counts[3];
  for (std::size_t k = 0; k < 3; ++k) counts[k] = thin[k] ? 1 : index_in<std::size_t>(std::round(size[k] / step), 1, n);
  std::vector<Vec3> points;
  for (std::size_t k = 0; k < counts[2]; ++k)
    for (std::size_t j = 0; j < counts[1]; ++j)
      for (std::size_t i = 0; i < counts[0]; ++i) {
        const auto at = [&](std::size_t a, std::size_t m) {
          return box.lower[a] + size[a] * (static_cast<double>(m) + 0.5) / static_cast<double>(counts[a]);
        };
        points.push_back({at(0, i), at(1, j), at(2, k)});
      }
  return points;
}

Seeds one_shape(std::string_view text, const Box3& bounds) {
  const std::size_t open = text.find('(');
  if (open == std::string_view::npos || text.back() != ')')
    fail(text, "must be a shape such as line(0,0,0, 1,0,0, 50) or points(FILE)");
  const std::string_view name = without_blanks(text.substr(0, open));
  const std::string_view inside = without_blanks(text.substr(open + 1, text.size() - open - 2));
  Seeds seeds;
  if (name == "points" || name == "mesh" || name == "curve" || name == "loop") {
    if (inside.empty()) fail(text, "names no file");
    seeds.file = inside;
    seeds.closed = name == "loop";
    seeds.curve = name == "curve" || seeds.closed;
    seeds.mesh = name == "mesh";
    return seeds;
  }
  const auto vec = [](const std::vector<double>& v, std::size_t at) { return Vec3{v[at], v[at + 1], v[at + 2]}; };
  if (name == "point") {
    seeds.points = {vec(numbers_of(text, inside, 3, "point(x,y,z)"), 0)};
  } else if (name == "line") {
    const auto v = numbers_of(text, inside, 7, "line(ax,ay,az, bx,by,bz, n)");
    const std::size_t n = count_of(text, v[6], 2);
    for (std::size_t i = 0; i < n; ++i) {
      const double t = static_cast<double>(i) / static_cast<double>(n - 1);
      seeds.points.push_back(vec(v, 0) * (1 - t) + vec(v, 3) * t);
    }
    seeds.curve = true;
  } else if (name == "circle") {
    const auto v = numbers_of(text, inside, 8, "circle(cx,cy,cz, nx,ny,nz, radius, n)");
    const std::size_t n = count_of(text, v[7], 3);
    if (!(norm(vec(v, 3)) > 0) || !(v[6] > 0)) fail(text, "the normal and the radius must not be zero");
    Vec3 t, b;
    tangent_frame(normalized(vec(v, 3)), t, b);
    for (std::size_t i = 0; i < n; ++i) {
      const double turn = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
      seeds.points.push_back(vec(v, 0) + (t * std::cos(turn) + b * std::sin(turn)) * v[6]);
    }
    seeds.curve = seeds.closed = true;
  } else if (name == "plane") {
    const auto v = numbers_of(text, inside, 11, "plane(ox,oy,oz, ux,uy,uz, vx,vy,vz, nu, nv)");
    const std::size_t nu = count_of(text, v[9], 1), nv = count_of(text, v[10], 1);
    if (static_cast<double>(nu) * static_cast<double>(nv) > kMostSeeds) fail(text, "too many seeds");
    const auto share = [](std::size_t i, std::size_t n) {
      return n > 1 ? static_cast<double>(i) / static_cast<double>(n - 1) : 0.5;
    };
    for (std::size_t j = 0; j < nv; ++j)
      for (std::size_t i = 0; i < nu; ++i)
        seeds.points.push_back(vec(v, 0) + vec(v, 3) * share(i, nu) + vec(v, 6) * share(j, nv));
  } else if (name == "box") {
    const auto v = numbers_of(text, inside, 1, "box(n)");
    seeds.points = in_box(bounds, count_of(text, v[0], 1));
  } else {
    fail(text, "\"" + std::string(name) +
                   "\" is not a shape; known are point, line, circle, plane, box, points, curve, loop and mesh");
  }
  return seeds;
}

}  // namespace

Seeds parse_seeds(std::string_view text, const Box3& bounds) {
  Seeds all;
  std::size_t parts = 0;
  std::string_view rest = text;
  while (true) {
    const std::size_t end = rest.find(';');
    const std::string_view part = without_blanks(rest.substr(0, end));
    if (part.empty()) fail(text, "a shape is missing");
    Seeds one = one_shape(part, bounds);
    if (++parts == 1) {
      all = std::move(one);
    } else {
      if (!one.file.empty() || !all.file.empty()) fail(text, "a file cannot be combined with other seeds");
      all.points.insert(all.points.end(), one.points.begin(), one.points.end());
      all.curve = all.closed = false;
    }
    if (end == std::string_view::npos) return all;
    rest = rest.substr(end + 1);
  }
}

}  // namespace sansmesh::inline v1
