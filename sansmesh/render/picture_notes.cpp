#include "sansmesh/render/picture_notes.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "sansmesh/render/stroke_text.h"

namespace sansmesh {
namespace {

constexpr int kLowestWithBar = 100;
constexpr int kBarTicks = 5;

double letter_height(int picture_height) { return std::max(7.0, picture_height / 52.0); }

/// Sizes of a bar in pixels.
struct BarLayout {
  double text, gap, thick, top, bottom;
  std::vector<double> ticks;
  double step = 1, widest = 0, lower, upper;

  BarLayout(int height, const TransferFunction& function, const std::string& title)
      : text(letter_height(height)), gap(0.9 * text), thick(2.2 * text), top(0.2 * height), bottom(0.8 * height) {
    std::tie(lower, upper) = function.range();
    if (upper > lower) ticks = round_ticks(lower, upper, kBarTicks);
    if (ticks.size() > 1) step = ticks[1] - ticks[0];
    if (!(upper > lower)) ticks = {lower}, step = 1e-3 * std::abs(lower);
    for (const double t : ticks) widest = std::max(widest, stroke_width(tick_text(t, step), text));
    widest += thick + 1.6 * gap;
    widest = std::max(widest, stroke_width(title, text));
  }

  /// 0 at the lower end of the bar, 1 at the upper; its middle where all is one value.
  double place(double value) const { return upper > lower ? (value - lower) / (upper - lower) : 0.5; }
};

/// A place in the picture, in pixels; none behind the camera.
std::optional<std::pair<double, double>> seen_at(const Vec3& x, const PictureFrame& frame, const Camera& camera,
                                                 const Image& image) {
  const Vec3 d = (x - frame.center) / frame.size - Vec3(camera.position);
  const double depth = -dot(d, Vec3(camera.backward));
  if (!(depth > 1e-3)) return std::nullopt;
  const double u = dot(d, Vec3(camera.right)) / (depth * static_cast<double>(camera.half_width));
  const double v = dot(d, Vec3(camera.up)) / (depth * static_cast<double>(camera.half_height));
  return std::pair{0.5 * (u + 1) * image.width, 0.5 * (1 - v) * image.height};
}

/// An edge of the box: along an axis, at one end of each of the two others.
struct BoxEdge {
  std::size_t axis;
  bool high[2];  ///< of the next axis, and of the one after it
};

Vec3 on_edge(const Box3& box, const BoxEdge& e, double along) {
  Vec3 p;
  p[e.axis] = along;
  for (std::size_t k = 0; k < 2; ++k) {
    const std::size_t other = (e.axis + 1 + k) % 3;
    p[other] = e.high[k] ? box.upper[other] : box.lower[other];
  }
  return p;
}

/// Whether the face of the box at that end of an axis is seen from outside.
bool face_seen(const Box3& box, std::size_t axis, bool high, const Vec3& eye) {
  return high ? eye[axis] > box.upper[axis] : eye[axis] < box.lower[axis];
}

Vec3 eye_of(const PictureFrame& frame, const Camera& camera) {
  return frame.center + Vec3(camera.position) * frame.size;
}

}  // namespace

std::vector<double> round_ticks(double lower, double upper, int count) {
  std::vector<double> ticks;
  const double span = upper - lower;
  if (!(span > 0) || !std::isfinite(span) || count < 1) return ticks;
  const double rough = span / count, power = std::pow(10.0, std::floor(std::log10(rough)));
  double factor = 10;
  for (const double f : {1.0, 2.0, 5.0})
    if (f * power >= 0.75 * rough) {
      factor = f;
      break;
    }
  const double step = factor * power;
  if (!(step > 0)) return ticks;
  const double first = std::ceil(lower / step - 1e-9), last = std::floor(upper / step + 1e-9);
  for (double k = first; k <= last && ticks.size() < 100; ++k) ticks.push_back(k == 0 ? 0 : k * step);
  return ticks;
}

std::string tick_text(double value, double step) {
  if (!std::isfinite(value)) return {};
  const double size = std::max(std::abs(value), std::abs(step));
  std::string text;
  if (value == 0) {
    text = "0";
  } else if (size >= 1e5 || size < 1e-3) {
    const auto power = [](double v) { return static_cast<int>(std::floor(std::log10(std::abs(v)) + 1e-9)); };
    const int digits = power(value) - power(step);
    text = fmt::format("{:.{}e}", value, std::clamp(digits, 0, 6));
    // 1.5e-07 is 1.5e-7.
    const std::size_t e = text.find('e');
    std::string exponent = text.substr(e + 2);
    exponent.erase(0, std::min(exponent.find_first_not_of('0'), exponent.size() - 1));
    text = text.substr(0, e) + "e" + (text[e + 1] == '-' ? "-" : "") + exponent;
  } else {
    const int digits = std::clamp(static_cast<int>(std::ceil(-std::log10(std::abs(step)) - 0.01)), 0, 9);
    text = fmt::format("{:.{}f}", value, digits);
  }
  for (std::size_t at = 0; (at = text.find('-', at)) != std::string::npos;) text.replace(at, 1, "\u2212");
  return text;
}

Rgba ink_for(const Image& image) {
  // What the corners and the middles of the sides show is the background.
  double sum = 0, weight = 0;
  for (const auto& [fx, fy] :
       {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}, {0.5, 0.0}, {0.0, 0.5}, {1.0, 0.5}}) {
    if (image.pixels.empty()) break;
    const Rgba& p = image.at(static_cast<int>(fx * (image.width - 1)), static_cast<int>(fy * (image.height - 1)));
    const double light =
        0.3 * static_cast<double>(p[0]) + 0.6 * static_cast<double>(p[1]) + 0.1 * static_cast<double>(p[2]);
    sum += light * static_cast<double>(p[3]) + (1 - static_cast<double>(p[3]));
    weight += 1;
  }
  if (weight > 0 && sum / weight < 0.45) return {0.92f, 0.93f, 0.95f, 1};
  return {from_byte(32), from_byte(36), from_byte(43), 1};
}

int value_bar_width(int height, const TransferFunction& function, const std::string& title) {
  if (height < kLowestWithBar) return 0;
  const BarLayout layout(height, function, title);
  return static_cast<int>(std::ceil(layout.widest + 2 * layout.gap));
}

Image beside_value_bar(const Image& picture, const TransferFunction& function, const std::string& title,
                       std::span<const double> marks, const Image* paper) {
  if (picture.height < kLowestWithBar || picture.width < 1) return picture;
  Image image(picture.width + value_bar_width(picture.height, function, title), picture.height);
  const Image& behind = paper && paper->width > 0 && paper->height == picture.height ? *paper : picture;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image.at(x, y) = x < picture.width ? picture.at(x, y) : behind.at(behind.width - 1, y);
  const BarLayout bar(picture.height, function, title);
  const Rgba ink = ink_for(image);
  const double left = picture.width + bar.gap * 0.5, right = left + bar.thick;
  const int first = static_cast<int>(std::lround(bar.top)), last = static_cast<int>(std::lround(bar.bottom));
  for (int y = first; y < last; ++y) {
    const double share = 1 - (y + 0.5 - first) / (last - first);
    const Vec3f c = function.color(bar.lower + share * (bar.upper - bar.lower));
    for (int x = static_cast<int>(std::lround(left)); x < static_cast<int>(std::lround(right)); ++x)
      image.at(x, y) = {c.x, c.y, c.z, 1};
  }
  const double line = std::max(1.0, bar.text / 9), x0 = std::lround(left), x1 = std::lround(right);
  for (const auto& [ax, ay, bx, by] :
       {std::array{x0, double(first), x1, double(first)}, std::array{x0, double(last), x1, double(last)},
        std::array{x0, double(first), x0, double(last)}, std::array{x1, double(first), x1, double(last)}})
    draw_line(image, ax, ay, bx, by, line, ink);
  for (const double t : bar.ticks) {
    const double y = last - bar.place(t) * (last - first);
    draw_line(image, x1, y, x1 + 0.6 * bar.gap, y, line, ink);
    draw_strokes(image, x1 + 1.3 * bar.gap, y + 0.5 * bar.text, bar.text, tick_text(t, bar.step), ink);
  }
  for (const double m : marks) {
    const double y = last - bar.place(m) * (last - first);
    if (m >= bar.lower && m <= bar.upper) draw_line(image, x0, y, x1, y, line, ink);
  }
  draw_strokes(image, x0, first - 1.4 * bar.text, bar.text, title, ink);
  return image;
}

void draw_box_edges(Image& image, const Box3& box, const PictureFrame& frame, const Camera& camera) {
  const Vec3 eye = eye_of(frame, camera);
  Rgba ink = ink_for(image);
  for (std::size_t k = 0; k < 3; ++k) ink[k] = 0.55f * ink[k] + 0.45f * image.at(0, 0)[k] * image.at(0, 0)[3];
  const double width = std::max(1.0, image.height / 600.0);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (int c = 0; c < 4; ++c) {
      const BoxEdge e{axis, {(c & 1) != 0, (c & 2) != 0}};
      // An edge between two faces that are seen would cross what it bounds.
      if (face_seen(box, (axis + 1) % 3, e.high[0], eye) && face_seen(box, (axis + 2) % 3, e.high[1], eye)) continue;
      const auto a = seen_at(on_edge(box, e, box.lower[axis]), frame, camera, image);
      const auto b = seen_at(on_edge(box, e, box.upper[axis]), frame, camera, image);
      if (a && b) draw_line(image, a->first, a->second, b->first, b->second, width, ink);
    }
}

void draw_box_ticks(Image& image, const Box3& box, const PictureFrame& frame, const Camera& camera,
                    const std::string& unit) {
  const Vec3 eye = eye_of(frame, camera);
  const Rgba ink = ink_for(image);
  const double text = 0.85 * letter_height(image.height), width = std::max(1.0, text / 9);
  const auto middle = seen_at(box.center(), frame, camera, image);
  if (!middle) return;
  struct Label {
    double left, top, right, bottom;
  };
  std::vector<Label> labels;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // The lowest of the edges of the silhouette; of upright ones that on the left.
    std::optional<BoxEdge> best;
    double rank = 0;
    for (int c = 0; c < 4; ++c) {
      const BoxEdge e{axis, {(c & 1) != 0, (c & 2) != 0}};
      if (face_seen(box, (axis + 1) % 3, e.high[0], eye) == face_seen(box, (axis + 2) % 3, e.high[1], eye)) continue;
      const auto a = seen_at(on_edge(box, e, box.lower[axis]), frame, camera, image);
      const auto b = seen_at(on_edge(box, e, box.upper[axis]), frame, camera, image);
      if (!a || !b) continue;
      const bool upright = std::abs(b->second - a->second) > std::abs(b->first - a->first);
      const double own = upright ? -(a->first + b->first) + 0.3 * (a->second + b->second) : a->second + b->second;
      if (!best || own > rank) best = e, rank = own;
    }
    if (!best || !(box.upper[axis] > box.lower[axis])) continue;
    const auto a = *seen_at(on_edge(box, *best, box.lower[axis]), frame, camera, image);
    const auto b = *seen_at(on_edge(box, *best, box.upper[axis]), frame, camera, image);
    const double length = std::hypot(b.first - a.first, b.second - a.second);
    if (length < 6 * text) continue;
    double nx = -(b.second - a.second) / length, ny = (b.first - a.first) / length;  // away from the middle
    if (nx * (0.5 * (a.first + b.first) - middle->first) + ny * (0.5 * (a.second + b.second) - middle->second) < 0)
      nx = -nx, ny = -ny;
    const std::vector<double> ticks =
        round_ticks(box.lower[axis], box.upper[axis], std::clamp(static_cast<int>(length / (7 * text)), 1, 6));
    const double step = ticks.size() > 1 ? ticks[1] - ticks[0] : box.upper[axis] - box.lower[axis];
    double widest = 0;
    const auto write = [&](double x, double y, const std::string& what) {
      const double w = stroke_width(what, text);
      widest = std::max(widest, w);
      // Where two axes meet, one of their values is enough.
      const double rim = 0.5 * text, middle_x = x + 0.5 * w * std::clamp(1.4 * nx, -1.0, 1.0);
      x = std::clamp(middle_x, rim + 0.5 * w, std::max(rim + 0.5 * w, image.width - rim - 0.5 * w));
      const Label own{x - 0.5 * w - rim, y - text - rim, x + 0.5 * w + rim, y + text + rim};
      for (const Label& o : labels)
        if (own.left < o.right && o.left < own.right && own.top < o.bottom && o.top < own.bottom) return;
      labels.push_back(own);
      draw_strokes(image, x - 0.5 * w, y + 0.5 * text + 0.4 * text * ny, text, what, ink);
    };
    for (const double t : ticks) {
      const auto p = *seen_at(on_edge(box, *best, t), frame, camera, image);
      draw_line(image, p.first, p.second, p.first + 0.6 * text * nx, p.second + 0.6 * text * ny, width, ink);
      write(p.first + 1.3 * text * nx, p.second + 1.3 * text * ny, tick_text(t, step));
    }
    const double way = 2.6 * text + std::abs(nx) * widest + text * std::abs(ny);
    write(0.5 * (a.first + b.first) + way * nx, 0.5 * (a.second + b.second) + way * ny,
          std::string(1, static_cast<char>('x' + axis)) + (unit.empty() ? "" : " [" + unit + "]"));
  }
}

void draw_title(Image& image, std::string_view title) {
  const Rgba ink = ink_for(image);
  double text = 1.35 * letter_height(image.height);
  const double edge = 1.2 * text;
  double widest = 0;
  for (std::string_view rest = title; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    widest = std::max(widest, stroke_width(rest.substr(0, end), text));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  if (widest > image.width - 2 * edge && widest > 0) text *= std::max(0.1, (image.width - 2 * edge) / widest);
  double y = edge + text;
  while (!title.empty()) {
    const std::size_t end = std::min(title.find('\n'), title.size());
    draw_strokes(image, edge, y, text, title.substr(0, end), ink);
    y += 1.9 * text;
    title.remove_prefix(std::min(end + 1, title.size()));
  }
}

}  // namespace sansmesh
