#include "sansmesh/render/annotate/picture_notes.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "sansmesh/core/index_in.h"
#include "sansmesh/render/annotate/stroke_text.h"
#include "sansmesh/render/scene/color_space.h"
#include "sansmesh/render/scene/lighting.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kLowestWithBar = 100;
constexpr int kBarTicks = 5;
constexpr double kBarPoint = 0.55;     // length of a pointed end, relative to the bar's width
constexpr double kLegendLetters = 16;  // widest name, relative to the height of its letters

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

  /// 0 at the lower end of the bar, 1 at the upper; 0.5 if the range is a single value.
  double share_of(double value) const { return upper > lower ? (value - lower) / (upper - lower) : 0.5; }
};

/// Pixel coordinates of a point; empty behind the camera.
std::optional<std::pair<double, double>> seen_at(const Vec3& x, const PictureFrame& frame, const Camera& camera,
                                                 const Image& image) {
  const Vec3 d = (x - frame.center) / frame.size - Vec3(camera.position);
  const double depth = -dot(d, Vec3(camera.backward));
  if (!camera.parallel && !(depth > 1e-3)) return std::nullopt;
  const double scale = camera.parallel ? 1 : depth;
  const double u = dot(d, Vec3(camera.right)) / (scale * static_cast<double>(camera.half_width));
  const double v = dot(d, Vec3(camera.up)) / (scale * static_cast<double>(camera.half_height));
  return std::pair{0.5 * (u + 1) * image.width, 0.5 * (1 - v) * image.height};
}

/// An edge of the box: along an axis, at one end of each of the two others.
struct BoxEdge {
  std::size_t axis;
  bool high[2];  ///< on the next axis, and on the one after it
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

/// Whether the box face at that end of an axis is visible from outside.
bool face_seen(const Box3& box, std::size_t axis, bool high, const Vec3& eye) {
  return high ? eye[axis] > box.upper[axis] : eye[axis] < box.lower[axis];
}

Vec3 eye_of(const PictureFrame& frame, const Camera& camera) {
  // For parallel rays, a distant point whose side is that of the rays.
  const Vec3 position = Vec3(camera.position) + Vec3(camera.backward) * (camera.parallel ? 1e6 : 0.0);
  return frame.center + position * frame.size;
}

/// 0..1, on white if transparent.
double lightness_of(const Rgba& p) {
  const double light =
      0.3 * static_cast<double>(p[0]) + 0.6 * static_cast<double>(p[1]) + 0.1 * static_cast<double>(p[2]);
  return light * static_cast<double>(p[3]) + (1 - static_cast<double>(p[3]));
}

/// Readable ink on a background of this lightness.
Rgba ink_on(double lightness) {
  if (lightness < 0.45) return {0.92f, 0.93f, 0.95f, 1};
  return {from_byte(32), from_byte(36), from_byte(43), 1};
}

/// Readable ink on a part of the picture, according to its foreground if it has any.
Rgba ink_within(const Image& image, double left, double top, double right, double bottom) {
  double sum = 0, weight = 0;
  for (int y = index_in<int>(top, 0, image.height); y < std::min<double>(image.height, bottom); ++y)
    for (int x = index_in<int>(left, 0, image.width); x < std::min<double>(image.width, right); ++x)
      sum += lightness_of(image.at(x, y)), weight += 1;
  return weight > 0 ? ink_on(sum / weight) : ink_for(image);
}

/// The same on a plate, which is drawn first if lines or edges in the part would disturb.
Rgba plate_within(Image& image, double left, double top, double right, double bottom) {
  constexpr float kBusy = 0.12f, kPlate = 0.8f;
  const Rgba ink = ink_within(image, left, top, right, bottom);
  const int x0 = index_in<int>(left, 0, image.width), y0 = index_in<int>(top, 0, image.height);
  const int x1 = index_in<int>(right, 0, image.width), y1 = index_in<int>(bottom, 0, image.height);
  double least = 1, most = 0;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const double lightness = lightness_of(image.at(x, y));
      least = std::min(least, lightness), most = std::max(most, lightness);
    }
  if (most - least < kBusy) return ink;
  const float paper = ink[0] < 0.5f ? 0.95f : 0.1f;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      Rgba& p = image.at(x, y);
      const float alpha = kPlate + (1 - kPlate) * p[3];
      for (std::size_t c = 0; c < 3; ++c) p[c] = (kPlate * paper + (1 - kPlate) * p[3] * p[c]) / alpha;
      p[3] = alpha;
    }
  return ink;
}

/// Widens a picture by `added` columns that repeat the last one of `behind`.
Image widened(const Image& picture, int added, const Image& behind) {
  Image image(picture.width + added, picture.height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image.at(x, y) = x < picture.width ? picture.at(x, y) : behind.at(behind.width - 1, y);
  return image;
}

/// The pointed end of a bar: its base at `y`, its tip `point` below that.
void draw_bar_point(Image& image, double x0, double x1, int y, double point, const Vec3f& color, double line,
                    const Rgba& ink) {
  const double middle = 0.5 * (x0 + x1);
  const int rows = static_cast<int>(std::lround(std::abs(point)));
  for (int k = 0; k < rows; ++k) {
    const double share = 1 - (k + 0.5) / rows, half = 0.5 * (x1 - x0) * share;
    const int row = point > 0 ? y + k : y - 1 - k;
    if (row < 0 || row >= image.height) continue;
    for (int x = static_cast<int>(std::lround(middle - half)); x < std::lround(middle + half); ++x)
      if (x >= 0 && x < image.width) image.at(x, row) = {color.x, color.y, color.z, 1};
  }
  draw_line(image, x0, y, middle, y + point, line, ink);
  draw_line(image, x1, y, middle, y + point, line, ink);
}

/// Shortens a text to this width; dots replace its end.
std::string shortened(const std::string& text, double height, double widest) {
  if (stroke_width(text, height) <= widest) return text;
  std::string part = text;
  while (!part.empty() && stroke_width(part + "..", height) > widest) {
    while (!part.empty() && (static_cast<unsigned char>(part.back()) & 0xC0u) == 0x80u) part.pop_back();
    if (!part.empty()) part.pop_back();
  }
  return part + "..";
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
    const auto power = [](double v) { return whole_part<int>(std::floor(std::log10(std::abs(v)) + 1e-9)); };
    const int digits = power(value) - power(step);
    text = fmt::format("{:.{}e}", value, std::clamp(digits, 0, 6));
    // 1.5e-07 is 1.5e-7.
    const std::size_t e = text.find('e');
    std::string exponent = text.substr(e + 2);
    exponent.erase(0, std::min(exponent.find_first_not_of('0'), exponent.size() - 1));
    text = text.substr(0, e) + "e" + (text[e + 1] == '-' ? "-" : "") + exponent;
  } else {
    const int digits = index_in<int>(std::ceil(-std::log10(std::abs(step)) - 0.01), 0, 9);
    text = fmt::format("{:.{}f}", value, digits);
  }
  for (std::size_t at = 0; (at = text.find('-', at)) != std::string::npos;) text.replace(at, 1, "\u2212");
  return text;
}

Rgba ink_for(const Image& image) {
  // The corners and the middles of the sides usually show the background.
  double sum = 0, weight = 0;
  for (const auto& [fx, fy] :
       {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}, {0.5, 0.0}, {0.0, 0.5}, {1.0, 0.5}}) {
    if (image.pixels.empty()) break;
    sum += lightness_of(image.at(static_cast<int>(fx * (image.width - 1)), static_cast<int>(fy * (image.height - 1))));
    weight += 1;
  }
  return weight > 0 ? ink_on(sum / weight) : ink_on(1);
}

std::string with_unit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " [" + unit + "]";
}

int color_bar_width(int height, const TransferFunction& function, const std::string& title) {
  if (height < kLowestWithBar) return 0;
  const BarLayout layout(height, function, title);
  return static_cast<int>(std::ceil(layout.widest + 2 * layout.gap));
}

Image with_color_bar(const Image& picture, const TransferFunction& function, const std::string& title,
                     std::span<const double> marks, const Image* paper, const BarEnds& ends) {
  if (picture.height < kLowestWithBar || picture.width < 1) return picture;
  const Image& behind = paper && paper->width > 0 && paper->height == picture.height ? *paper : picture;
  Image image = widened(picture, color_bar_width(picture.height, function, title), behind);
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
  const double point = kBarPoint * bar.thick;
  if (ends.above) draw_bar_point(image, x0, x1, first, -point, function.color(bar.upper), line, ink);
  if (ends.below) draw_bar_point(image, x0, x1, last, point, function.color(bar.lower), line, ink);
  for (const double t : bar.ticks) {
    const double y = last - bar.share_of(t) * (last - first);
    draw_line(image, x1, y, x1 + 0.6 * bar.gap, y, line, ink);
    draw_strokes(image, x1 + 1.3 * bar.gap, y + 0.5 * bar.text, bar.text, tick_text(t, bar.step), ink);
  }
  for (const double m : marks) {
    const double y = last - bar.share_of(m) * (last - first);
    if (m >= bar.lower && m <= bar.upper) draw_line(image, x0, y, x1, y, line, ink);
  }
  draw_strokes(image, x0, first - 1.4 * bar.text - (ends.above ? point : 0), bar.text, title, ink);
  return image;
}

int legend_width(int height, std::span<const LegendEntry> entries) {
  if (height < kLowestWithBar || entries.empty()) return 0;
  const double text = letter_height(height);
  double widest = 0;
  for (const LegendEntry& e : entries)
    widest = std::max(widest, stroke_width(shortened(e.name, text, kLegendLetters * text), text));
  return static_cast<int>(std::ceil(widest + 4.2 * text));
}

Image annotation_background(const RenderOptions& o) {
  Image paper(1, o.view.height);
  const float u = (static_cast<float>(o.view.width) - 0.5f) / static_cast<float>(o.view.width);
  for (int y = 0; y < o.view.height && o.look.effective_background().kind != Background::Kind::transparent; ++y) {
    const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(o.view.height);
    const Vec3f color = srgb_color(background_light(o, u, v));
    paper.at(0, y) = {color.x, color.y, color.z, 1};
  }
  return paper;
}

Image with_legend(const Image& picture, std::span<const LegendEntry> entries, const Image* paper) {
  const int added = legend_width(picture.height, entries);
  if (added == 0 || picture.width < 1) return picture;
  Image image = widened(picture, added, paper ? *paper : picture);
  const double text = letter_height(picture.height);
  const double line = std::min(2.2 * text, 0.9 * picture.height / static_cast<double>(entries.size()));
  const double size = std::min(text, 0.8 * line);
  const Rgba ink = ink_for(image);
  double y = 0.5 * (picture.height - line * static_cast<double>(entries.size()));
  for (const LegendEntry& e : entries) {
    const double middle = y + 0.5 * line, left = picture.width + 0.8 * text;
    for (int v = static_cast<int>(std::lround(middle - 0.7 * size)); v < std::lround(middle + 0.7 * size); ++v)
      for (int u = static_cast<int>(std::lround(left)); u < std::lround(left + 1.4 * size); ++u)
        if (v >= 0 && v < image.height && u < image.width) image.at(u, v) = {e.color.x, e.color.y, e.color.z, 1};
    draw_strokes(image, left + 2.2 * size, middle + 0.5 * size, size, shortened(e.name, text, kLegendLetters * text),
                 ink);
    y += line;
  }
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
      // An edge between two visible faces would cross the content.
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
    // The lowest edge of the silhouette; of upright ones the leftmost.
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
    double nx = -(b.second - a.second) / length, ny = (b.first - a.first) / length;  // away from the centre
    if (nx * (0.5 * (a.first + b.first) - middle->first) + ny * (0.5 * (a.second + b.second) - middle->second) < 0)
      nx = -nx, ny = -ny;
    const std::vector<double> ticks =
        round_ticks(box.lower[axis], box.upper[axis], index_in<int>(length / (7 * text), 1, 6));
    const double step = ticks.size() > 1 ? ticks[1] - ticks[0] : box.upper[axis] - box.lower[axis];
    double widest = 0;
    const auto write = [&](double x, double y, const std::string& what) {
      const double w = stroke_width(what, text);
      widest = std::max(widest, w);
      // Where two axes meet, one value is enough.
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

void draw_scale_bar(Image& image, const PictureFrame& frame, const Camera& camera, double length,
                    const std::string& unit) {
  const double width = 2 * static_cast<double>(camera.half_width) * frame.size * length;  // width of the picture
  const std::vector<double> steps = round_ticks(0, width, 5);
  if (!camera.parallel || steps.size() < 2 || !(width > 0)) return;
  const double bar = steps[1] / width * image.width;
  const double text = letter_height(image.height), edge = 1.4 * text, line = std::max(1.0, text / 7);
  const std::string what = tick_text(steps[1], steps[1]) + (unit.empty() ? "" : " " + unit);
  const double y = image.height - edge, rim = 0.6 * text;
  const Rgba ink = plate_within(image, edge - rim, y - 1.8 * text - rim,
                                edge + std::max(bar, stroke_width(what, text)) + rim, y + 0.4 * text + rim);
  draw_line(image, edge, y, edge + bar, y, line, ink);
  for (const double x : {edge, edge + bar}) draw_line(image, x, y - 0.4 * text, x, y + 0.4 * text, line, ink);
  draw_strokes(image, edge, y - 0.8 * text, text, what, ink);
}

void draw_title(Image& image, std::string_view title) {
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
    const std::string_view line = title.substr(0, end);
    const Rgba ink = ink_within(image, edge, y - text, edge + stroke_width(line, text), y + 0.3 * text);
    draw_strokes(image, edge, y, text, line, ink);
    y += 1.9 * text;
    title.remove_prefix(std::min(end + 1, title.size()));
  }
}

}  // namespace sansmesh::inline v1
