#include "sansmesh/render/annotate/stroke_text.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "sansmesh/core/index_in.h"

namespace sansmesh::inline v1 {
namespace {

/// A letter on a raster. A point is a digit (from the left) and a letter (c: on the line, j: height of capitals, a:
/// lowest); blanks separate strokes. Strokes that begin with ~ are curves, with the inner points as control points.
struct Letter {
  std::uint32_t code;
  int width;
  const char* strokes;
};

constexpr Letter kLetters[] = {
    {' ', 2, ""},
    {'!', 0, "0j0e 0c0c"},
    {'"', 2, "0j0h 2j2h"},
    {'#', 4, "1c1j 3c3j 0e4e 0h4h"},
    {'$', 4, "~4i3j1j0i0h1g3f4e4d3c1c0d 2j2c"},
    {'%', 4, "~1j2j2h0h0j1j ~3e4e4c2c2e3e 0c4j"},
    {'&', 4, "4c1h ~1h1j3j3h1g0e0c3c4e"},
    {'\'', 0, "0j0h"},
    {'(', 2, "~2j0h0d2b"},
    {')', 2, "~0j2h2d0b"},
    {'*', 4, "2i2e 0h4f 0f4h"},
    {'+', 4, "0f4f 2h2d"},
    {',', 1, "1c0a"},
    {'-', 3, "0f3f"},
    {'.', 0, "0c0c"},
    {'/', 4, "0b4j"},
    {'0', 4, "~2j4j4c0c0j2j"},
    {'1', 4, "1i2j2c 1c3c"},
    {'2', 4, "~0i1j3j4i4h3f0c 0c4c"},
    {'3', 4, "~0i1j3j4i4h3g2g ~2g3g4f4d3c1c0d"},
    {'4', 4, "3c3j0e4e"},
    {'5', 4, "4j0j0g ~0g1h3h4g4d3c1c0d"},
    {'6', 4, "~3j1j0h0d1c3c4d4f3g1g0e"},
    {'7', 4, "0j4j1c"},
    {'8', 4, "~2g0g0j4j4g2g ~2g4g4c0c0g2g"},
    {'9', 4, "~1c3c4e4i3j1j0i0g1f3f4h"},
    {':', 0, "0c0c 0g0g"},
    {';', 1, "1g1g 1c0a"},
    {'<', 4, "4h0f4d"},
    {'=', 4, "0g4g 0e4e"},
    {'>', 4, "0h4f0d"},
    {'?', 4, "~0i1j4j4h2g2e 2c2c"},
    {'@', 5, "~3f1g1e3e3g ~3e4e5g5j0j0c4c"},
    {'A', 4, "0c2j4c 1e3e"},
    {'B', 4, "0c0j ~0j3j4i4h3g0g ~0g3g4f4d3c0c"},
    {'C', 4, "~4i3j0j0c3c4d"},
    {'D', 4, "0c0j ~0j2j4j4c2c0c"},
    {'E', 4, "4j0j0c4c 0g3g"},
    {'F', 4, "4j0j0c 0g3g"},
    {'G', 4, "~4i3j0j0c3c4d 4d4f2f"},
    {'H', 4, "0c0j 4c4j 0g4g"},
    {'I', 0, "0c0j"},
    {'J', 3, "3j3e ~3e3c0c0e"},
    {'K', 4, "0c0j 4j0f 1g4c"},
    {'L', 4, "0j0c4c"},
    {'M', 4, "0c0j2f4j4c"},
    {'N', 4, "0c0j4c4j"},
    {'O', 5, "~0f0c5c5j0j0f"},
    {'P', 4, "0c0j ~0j3j4i4g3f0f"},
    {'Q', 5, "~0f0c5c5j0j0f 3e5c"},
    {'R', 4, "0c0j ~0j3j4i4g3f0f 2f4c"},
    {'S', 4, "~4i3j1j0i0h1g3f4e4d3c1c0d"},
    {'T', 4, "0j4j 2j2c"},
    {'U', 4, "0j0e ~0e0c4c4e 4e4j"},
    {'V', 4, "0j2c4j"},
    {'W', 6, "0j1c3i5c6j"},
    {'X', 4, "0c4j 0j4c"},
    {'Y', 4, "0j2g4j 2g2c"},
    {'Z', 4, "0j4j0c4c"},
    {'[', 2, "2j0j0b2b"},
    {'\\', 4, "0j4b"},
    {']', 2, "0j2j2b0b"},
    {'^', 4, "0h2j4h"},
    {'_', 4, "0b4b"},
    {'`', 1, "0j1i"},
    {'a', 4, "4h4c ~4g3h0h0c3c4d"},
    {'b', 4, "0j0c ~0g1h4h4c1c0d"},
    {'c', 4, "~4g3h0h0c3c4d"},
    {'d', 4, "4j4c ~4g3h0h0c3c4d"},
    {'e', 4, "0f4f ~4f4h0h0c3c4d"},
    {'f', 3, "~3j1j1g 1g1c 0h3h"},
    {'g', 4, "4h4c ~4c4a1a0a ~4g3h0h0c3c4d"},
    {'h', 4, "0j0c ~0g1h4h4f 4f4c"},
    {'i', 0, "0h0c 0j0j"},
    {'j', 1, "1h1b ~1b1a0a 1j1j"},
    {'k', 3, "0j0c 3h0e 1f3c"},
    {'l', 1, "0j0d ~0d0c1c"},
    {'m', 6, "0h0c ~0g1h3h3f 3f3c ~3g4h6h6f 6f6c"},
    {'n', 4, "0h0c ~0g1h4h4f 4f4c"},
    {'o', 4, "~2h4h4c0c0h2h"},
    {'p', 4, "0h0a ~0g1h4h4c1c0d"},
    {'q', 4, "4h4a ~4g3h0h0c3c4d"},
    {'r', 3, "0h0c ~0f1h3h"},
    {'s', 3, "~3g2h0h0f3f3c1c0d"},
    {'t', 3, "1j1d ~1d1c3c 0h3h"},
    {'u', 4, "0h0e ~0e0c3c4d 4h4c"},
    {'v', 4, "0h2c4h"},
    {'w', 6, "0h2c3g4c6h"},
    {'x', 4, "0c4h 0h4c"},
    {'y', 4, "0h2c 4h1a"},
    {'z', 4, "0h4h0c4c"},
    {'{', 3, "~3j1j1h0f ~0f1d1b3b"},
    {'|', 0, "0j0b"},
    {'}', 3, "~0j2j2h3f ~3f2d2b0b"},
    {'~', 4, "~0f1g3e4f"},
    {0xB0, 2, "~1j2j2h0h0j1j"},
    {0xB1, 4, "0g4g 2i2e 0c4c"},
    {0xB2, 2, "~0i1j2j2i0g 0g2g"},
    {0xB3, 2, "~0j2j2i1i ~1i2i2g0g"},
    {0xB5, 4, "0h0a ~0e0c3c4d 4h4c"},
    {0xB7, 0, "0f0f"},
    {0xD7, 3, "0d3g 0g3d"},
    {0x3BC, 4, "0h0a ~0e0c3c4d 4h4c"},
    {0x2212, 4, "0f4f"},
};
constexpr Letter kUnknownLetter{0, 3, "0c0j3j3c0c"};
constexpr double kBetween = 2.2;  // units between letters
constexpr double kCapital = 7;    // height of a capital in units

/// The next character of UTF-8; an invalid byte counts as one character.
std::uint32_t next_code(std::string_view& text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
  const std::uint32_t first = byte(0);
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC0 ? 2 : 1;
  if (length == 1 || length > text.size()) {
    text.remove_prefix(1);
    return first < 0x80 ? first : 0xFFFD;
  }
  std::uint32_t code = first & (0xFFu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) code = code << 6 | (byte(i) & 0x3F);
  text.remove_prefix(length);
  return code;
}

const Letter& letter_of(std::uint32_t code) {
  for (const Letter& l : kLetters)
    if (l.code == code) return l;
  return kUnknownLetter;
}

using Spots = std::vector<std::pair<double, double>>;

/// A stroke as a chain of line segments, in units.
Spots chain_of(std::string_view stroke) {
  const bool curved = !stroke.empty() && stroke[0] == '~';
  if (curved) stroke.remove_prefix(1);
  Spots points;
  for (std::size_t i = 0; i + 1 < stroke.size(); i += 2) points.emplace_back(stroke[i] - '0', stroke[i + 1] - 'c');
  if (!curved || points.size() < 3) return points;
  // Parabolas that touch the lines between the points at their middles.
  constexpr int kPieces = 6;
  Spots chain{points.front()};
  const auto middle = [](const auto& a, const auto& b) {
    return std::pair{(a.first + b.first) / 2, (a.second + b.second) / 2};
  };
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const auto from = i == 1 ? points[0] : middle(points[i - 1], points[i]);
    const auto to = i + 2 == points.size() ? points[i + 1] : middle(points[i], points[i + 1]);
    for (int k = 1; k <= kPieces; ++k) {
      const double t = k / double(kPieces), a = (1 - t) * (1 - t), b = 2 * t * (1 - t), c = t * t;
      chain.emplace_back(a * from.first + b * points[i].first + c * to.first,
                         a * from.second + b * points[i].second + c * to.second);
    }
  }
  return chain;
}

double distance_to_piece(double x, double y, double x0, double y0, double x1, double y1) {
  const double dx = x1 - x0, dy = y1 - y0, length = dx * dx + dy * dy;
  const double t = length > 0 ? std::clamp(((x - x0) * dx + (y - y0) * dy) / length, 0.0, 1.0) : 0;
  return std::hypot(x - x0 - t * dx, y - y0 - t * dy);
}

void lay_ink(Rgba& pixel, const Rgba& ink, double cover) {
  const float a = ink[3] * static_cast<float>(cover), rest = pixel[3] * (1 - a), sum = a + rest;
  if (!(sum > 0)) return;
  for (std::size_t k = 0; k < 3; ++k) pixel[k] = (ink[k] * a + pixel[k] * rest) / sum;
  pixel[3] = sum;
}

/// Chains of one letter or line: overlapping segments count once.
void draw_chains(Image& image, const std::vector<Spots>& chains, double width, const Rgba& ink) {
  double x0 = 1e30, y0 = 1e30, x1 = -1e30, y1 = -1e30;
  for (const Spots& chain : chains)
    for (const auto& [x, y] : chain)
      x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
  const double rim = 0.5 * width + 1;
  const auto pixel = [](double at, int most) { return index_in<int>(at, 0, most); };
  for (int y = pixel(y0 - rim, image.height); y < pixel(y1 + rim + 1, image.height); ++y)
    for (int x = pixel(x0 - rim, image.width); x < pixel(x1 + rim + 1, image.width); ++x) {
      double nearest = 1e30;
      for (const Spots& chain : chains)
        for (std::size_t i = 0; i < std::max<std::size_t>(1, chain.size()) - 1; ++i)
          nearest = std::min(nearest, distance_to_piece(x + 0.5, y + 0.5, chain[i].first, chain[i].second,
                                                        chain[i + 1].first, chain[i + 1].second));
      const double cover = std::clamp(0.5 * width - nearest + 0.5, 0.0, 1.0);
      if (cover > 0) lay_ink(image.at(x, y), ink, cover);
    }
}

}  // namespace

void draw_line(Image& image, double x0, double y0, double x1, double y1, double width, const Rgba& ink) {
  if (!(std::isfinite(x0) && std::isfinite(y0) && std::isfinite(x1) && std::isfinite(y1))) return;
  // Draws slanted lines in pieces, to visit only pixels near the line.
  const int pieces = index_in<int>(std::hypot(x1 - x0, y1 - y0) / 32, 1, 4096);
  if (pieces == 1 || ink[3] < 1) return draw_chains(image, {{{x0, y0}, {x1, y1}}}, width, ink);
  for (int i = 0; i < pieces; ++i) {
    const double a = i / double(pieces), b = (i + 1) / double(pieces);
    draw_chains(image, {{{x0 + a * (x1 - x0), y0 + a * (y1 - y0)}, {x0 + b * (x1 - x0), y0 + b * (y1 - y0)}}}, width,
                ink);
  }
}

void draw_strokes(Image& image, double x, double y, double height, std::string_view text, const Rgba& ink) {
  const double unit = height / kCapital;
  while (!text.empty()) {
    const Letter& letter = letter_of(next_code(text));
    std::vector<Spots> chains;
    std::string_view strokes = letter.strokes;
    while (!strokes.empty()) {
      const std::size_t end = std::min(strokes.find(' '), strokes.size());
      Spots chain = chain_of(strokes.substr(0, end));
      for (auto& [px, py] : chain) px = x + px * unit, py = y - py * unit;
      chains.push_back(std::move(chain));
      strokes.remove_prefix(std::min(end + 1, strokes.size()));
    }
    if (!chains.empty()) draw_chains(image, chains, std::max(1.1, 0.95 * unit), ink);
    x += (letter.width + kBetween) * unit;
  }
}

double stroke_width(std::string_view text, double height) {
  double units = 0;
  while (!text.empty()) units += letter_of(next_code(text)).width + kBetween;
  return std::max(0.0, units - kBetween) * height / kCapital;
}

}  // namespace sansmesh::inline v1
