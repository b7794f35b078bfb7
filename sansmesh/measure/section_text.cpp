#include "sansmesh/measure/section_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "sansmesh/core/error.h"

namespace sansmesh {
namespace {

constexpr double kSheetWidth = 1000;  // pixels
constexpr double kTrueWidth = 0.7;    // pixels: width of hairlines

struct Extent {
  double u0 = INFINITY, v0 = INFINITY, u1 = -INFINITY, v1 = -INFINITY;
  bool empty() const { return !(u0 <= u1); }
};

/// Of each section. Those across the same direction share one, so that they can be laid over each other.
std::vector<Extent> frames_of(std::span<const Section> sections) {
  std::vector<Extent> frames(sections.size());
  std::vector<std::size_t> first(sections.size());
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const auto same = [&](const Section& s) {
      return s.plane.u == sections[i].plane.u && s.plane.v == sections[i].plane.v;
    };
    first[i] = static_cast<std::size_t>(std::find_if(sections.begin(), sections.end(), same) - sections.begin());
    Extent& e = frames[first[i]];
    for (const SectionCurve& curve : sections[i].curves)
      for (const auto& [u, v] : curve.plane) {
        e.u0 = std::min(e.u0, u), e.u1 = std::max(e.u1, u);
        e.v0 = std::min(e.v0, v), e.v1 = std::max(e.v1, v);
      }
  }
  for (std::size_t i = 0; i < sections.size(); ++i) frames[i] = frames[first[i]];
  return frames;
}

/// Lengths of the sheet that have the size of a pixel of 1/96 inch; for drawings that are not true to scale 1.
double pixel_of(const std::string& unit) {
  return unit == "mm" ? 25.4 / 96 : unit == "cm" ? 2.54 / 96 : unit == "in" ? 1.0 / 96 : 1;
}

void append_path(std::string& text, const Section& section, bool closed, double ou, double ov) {
  auto out = std::back_inserter(text);
  for (const SectionCurve& curve : section.curves) {
    if (curve.closed != closed) continue;
    char command = 'M';
    for (const auto& [u, v] : curve.plane) {
      fmt::format_to(out, "{}{:.7g} {:.7g}", command, u - ou, ov - v);
      command = 'L';
    }
    if (closed) text += 'Z';
    text += '\n';
  }
}

}  // namespace

void SectionSvgOptions::validate() const {
  if (!unit.empty() && unit != "mm" && unit != "cm" && unit != "in")
    throw ArgumentError("`unit` is '" + unit + "': must be mm, cm, in or empty");
}

double round_length(double length) {
  const double power = std::pow(10.0, std::floor(std::log10(length)));
  for (const double factor : {5.0, 2.0})
    if (factor * power <= length * (1 + 1e-9)) return factor * power;
  return power;
}

std::string section_svg(std::span<const Section> sections, const SectionSvgOptions& options) {
  options.validate();
  const std::vector<Extent> frames = frames_of(sections);
  // All drawings get the space of the largest.
  double width = 0, height = 0;
  for (const Extent& e : frames)
    if (!e.empty()) {
      width = std::max(width, e.u1 - e.u0);
      height = std::max(height, e.v1 - e.v0);
    }
  if (!(width > 0 || height > 0)) width = height = 1;
  width = std::max(width, 0.05 * height), height = std::max(height, 0.05 * width);
  const double margin = 0.04 * std::max(width, height);
  width += 2 * margin, height += 2 * margin;

  const std::size_t count = std::max<std::size_t>(1, sections.size());
  const auto columns = std::min<std::size_t>(
      count,
      static_cast<std::size_t>(std::max(1.0, std::round(std::sqrt(static_cast<double>(count) * height / width)))));
  const std::size_t rows = (count + columns - 1) / columns;
  const double pixel = pixel_of(options.unit);
  const double scale =
      options.unit.empty() ? kSheetWidth / (width * static_cast<double>(columns)) : 1;  // sheet / model
  // The text shrinks on narrow drawings, so that it stays within them.
  const double font = std::min(13 * pixel, scale * width / 22), head = options.titles ? 3.2 * font : 0,
               foot = options.titles ? 2.4 * font : 0;
  const double cell_width = scale * width, cell_height = scale * height + head + foot;
  const double sheet_width = cell_width * static_cast<double>(columns),
               sheet_height = cell_height * static_cast<double>(rows);

  std::string text;
  auto out = std::back_inserter(text);
  fmt::format_to(out,
                 "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
                 "width=\"{0:.7g}{2}\" height=\"{1:.7g}{2}\" viewBox=\"0 0 {0:.7g} {1:.7g}\">\n"
                 "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
                 sheet_width, sheet_height, options.unit);
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const Section& section = sections[i];
    const std::size_t row = i / columns;
    const double x = cell_width * static_cast<double>(i % columns), y = cell_height * static_cast<double>(row);
    const Extent e = frames[i].empty() ? Extent{0, 0, 0, 0} : frames[i];
    const double cu = 0.5 * (e.u0 + e.u1), cv = 0.5 * (e.v0 + e.v1);
    // Viewers compute in single precision.
    const double size = std::max(width, height), step = std::pow(10.0, std::ceil(std::log10(size)));
    const bool far = std::max(std::abs(cu), std::abs(cv)) > 100 * size;
    const double ou = far ? step * std::round(cu / step) : 0, ov = far ? step * std::round(cv / step) : 0;
    const std::string title = fmt::format("{}, length {:.6g}, area {:.6g}{}", equation(section.plane), section.length,
                                          section.area, section.closed() ? "" : " (not closed)");
    fmt::format_to(out, "<g id=\"plane{}\" data-origin=\"{:.12g} {:.12g}\">\n<title>{}</title>\n", i, ou, ov, title);
    fmt::format_to(
        out,
        "<svg x=\"{:.7g}\" y=\"{:.7g}\" width=\"{:.7g}\" height=\"{:.7g}\" viewBox=\"{:.7g} {:.7g} {:.7g} "
        "{:.7g}\" fill-rule=\"evenodd\" stroke=\"#20242b\" stroke-width=\"{:.4g}\" stroke-linejoin=\"round\">\n",
        x, y + head, cell_width, scale * height, cu - ou - 0.5 * width, ov - cv - 0.5 * height, width, height,
        kTrueWidth * pixel / scale);
    std::string path;
    append_path(path, section, true, ou, ov);
    if (!path.empty()) text += "<path fill=\"#c9d5e3\" d=\"" + path + "\"/>\n";
    path.clear();
    append_path(path, section, false, ou, ov);
    if (!path.empty()) text += "<path fill=\"none\" d=\"" + path + "\"/>\n";
    text += "</svg>\n";
    if (options.titles) {
      const double bar = round_length(0.3 * width), left = x + 0.5 * font, base = y + head + scale * height;
      fmt::format_to(out,
                     "<g font-family=\"sans-serif\" font-size=\"{:.4g}\" fill=\"#20242b\">\n"
                     "<text x=\"{:.7g}\" y=\"{:.7g}\">{}</text>\n<text x=\"{:.7g}\" y=\"{:.7g}\">length {:.6g}, area "
                     "{:.6g}{}</text>\n",
                     font, left, y + 1.3 * font, equation(section.plane), left, y + 2.6 * font, section.length,
                     section.area, section.closed() ? "" : " (not closed)");
      fmt::format_to(out,
                     "<path fill=\"none\" stroke=\"#20242b\" stroke-width=\"{:.4g}\" d=\"M{:.7g} "
                     "{:.7g}v{:.4g}h{:.7g}v-{:.4g}\"/>\n"
                     "<text x=\"{:.7g}\" y=\"{:.7g}\">{:.6g}{}</text>\n</g>\n",
                     1.2 * pixel, left, base + 0.6 * font, 0.5 * font, scale * bar, 0.5 * font,
                     left + scale * bar + 0.5 * font, base + 1.3 * font, bar,
                     options.unit.empty() ? "" : " " + options.unit);
    }
    text += "</g>\n";
  }
  text += "</svg>\n";
  return text;
}

std::string section_csv(std::span<const Section> sections) {
  std::string text = "plane,curve,closed,vertex,x,y,z,u,v\n";
  auto out = std::back_inserter(text);
  for (std::size_t s = 0; s < sections.size(); ++s)
    for (std::size_t c = 0; c < sections[s].curves.size(); ++c) {
      const SectionCurve& curve = sections[s].curves[c];
      for (std::size_t i = 0; i < curve.points.size(); ++i) {
        const Vec3& p = curve.points[i];
        fmt::format_to(out, "{},{},{},{},{:.12g},{:.12g},{:.12g},{:.12g},{:.12g}\n", s, c, curve.closed ? 1 : 0, i, p.x,
                       p.y, p.z, curve.plane[i][0], curve.plane[i][1]);
      }
    }
  return text;
}

}  // namespace sansmesh
