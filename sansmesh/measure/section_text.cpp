#include "sansmesh/measure/section_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <vector>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

// Pixels of 1/96 inch: sheets are laid out in pixels for every unit, since renderers misplace letters of fonts smaller
// than a few units.
constexpr double kSheetWidth = 1000;  // for drawings that are not true to scale
constexpr double kHairline = 0.7, kBarLine = 1.2;
constexpr double kFont = 13, kLeastFont = 7;
/// Upper bound of the average width of a letter over the font size.
constexpr double kLetter = 0.6;

struct Extent {
  double u0 = INFINITY, v0 = INFINITY, u1 = -INFINITY, v1 = -INFINITY;
  bool empty() const { return !(u0 <= u1); }
};

/// Region of each section. Sections with the same normal share one, so that they can be overlaid.
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

/// Pixels per unit of length; 0 for drawings that are not true to scale.
double pixels_in(const std::string& unit) {
  return unit == "mm" ? 96 / 25.4 : unit == "cm" ? 96 / 2.54 : unit == "in" ? 96 : 0;
}

/// Caption of a section: plane, length and area.
std::array<std::string, 2> lines_of(const Section& section, const std::string& unit) {
  return {equation(section.plane),
          fmt::format("length {:.6g}{}, area {:.6g}{}{}", section.length, unit.empty() ? "" : " " + unit, section.area,
                      unit.empty() ? "" : " " + unit + "\u00B2", section.closed() ? "" : " (not closed)")};
}

/// Counts characters, not bytes.
std::size_t letters_in(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
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

/// Measures of a sheet with one drawing per section. All drawings have the space of the largest.
struct Sheet {
  double width = 0, height = 0;  ///< size of a drawing, in model units
  double scale = 1;              ///< pixels per length of the model
  double font = kFont, head = 0, foot = 0;
  double cell_width = 0, cell_height = 0;
  std::size_t columns = 1, rows = 1;
};

Sheet layout_of(std::span<const Section> sections, const std::vector<Extent>& frames,
                const SectionSvgOptions& options) {
  Sheet sheet;
  double &width = sheet.width, &height = sheet.height;
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
  sheet.columns = index_in<std::size_t>(std::round(std::sqrt(static_cast<double>(count) * height / width)), 1, count);
  sheet.rows = (count + sheet.columns - 1) / sheet.columns;
  sheet.scale =
      options.unit.empty() ? kSheetWidth / (width * static_cast<double>(sheet.columns)) : pixels_in(options.unit);
  // On narrow drawings the text shrinks to the smallest readable size, and is then given more space.
  std::size_t letters = 1;
  for (const Section& section : sections)
    for (const std::string& line : lines_of(section, options.unit)) letters = std::max(letters, letters_in(line));
  const double line_width = kLetter * (static_cast<double>(letters) + 1.5);  // over the font size
  sheet.font = std::clamp(sheet.scale * width / line_width, kLeastFont, kFont);
  if (options.titles) sheet.head = 3.2 * sheet.font, sheet.foot = 2.4 * sheet.font;
  sheet.cell_width = std::max(sheet.scale * width, options.titles ? sheet.font * line_width : 0);
  sheet.cell_height = sheet.scale * height + sheet.head + sheet.foot;
  return sheet;
}

/// Appends the group of section i at its place on the sheet.
void append_drawing(std::string& text, std::size_t i, const Section& section, const Extent& e, const Sheet& sheet,
                    const SectionSvgOptions& options) {
  auto out = std::back_inserter(text);
  const auto& [width, height, scale, font, head, foot, cell_width, cell_height, columns, rows] = sheet;
  const std::size_t row = i / columns;
  const double x = cell_width * static_cast<double>(i % columns), y = cell_height * static_cast<double>(row);
  const double cu = 0.5 * (e.u0 + e.u1), cv = 0.5 * (e.v0 + e.v1);
  // Viewers use single precision.
  const double size = std::max(width, height), step = std::pow(10.0, std::ceil(std::log10(size)));
  const bool far = std::max(std::abs(cu), std::abs(cv)) > 100 * size;
  const double ou = far ? step * std::round(cu / step) : 0, ov = far ? step * std::round(cv / step) : 0;
  const auto [where, sizes] = lines_of(section, options.unit);
  fmt::format_to(out,
                 "<g id=\"plane{}\" inkscape:groupmode=\"layer\" inkscape:label=\"{}\" data-origin=\"{:.12g} "
                 "{:.12g}\">\n<title>{}, {}</title>\n",
                 i, where, ou, ov, where, sizes);
  // Transforms to the unit of lengths, v up.
  fmt::format_to(out,
                 "<g transform=\"matrix({0:.7g} 0 0 {0:.7g} {1:.7g} {2:.7g})\" fill-rule=\"evenodd\" "
                 "stroke=\"#20242b\" stroke-width=\"{3:.4g}\" stroke-linejoin=\"round\">\n",
                 scale, x + 0.5 * cell_width - scale * (cu - ou), y + head + scale * (0.5 * height - (ov - cv)),
                 kHairline / scale);
  std::string path;
  append_path(path, section, true, ou, ov);
  if (!path.empty()) text += "<path fill=\"#c9d5e3\" d=\"" + path + "\"/>\n";
  path.clear();
  append_path(path, section, false, ou, ov);
  if (!path.empty()) text += "<path fill=\"none\" d=\"" + path + "\"/>\n";
  text += "</g>\n";
  if (options.titles) {
    const double bar = round_length(0.3 * width), left = x + 0.5 * font, base = y + head + scale * height;
    fmt::format_to(out,
                   "<g font-family=\"sans-serif\" font-size=\"{:.4g}\" fill=\"#20242b\">\n"
                   "<text x=\"{:.7g}\" y=\"{:.7g}\">{}</text>\n<text x=\"{:.7g}\" y=\"{:.7g}\">{}</text>\n",
                   font, left, y + 1.3 * font, where, left, y + 2.6 * font, sizes);
    fmt::format_to(out,
                   "<path fill=\"none\" stroke=\"#20242b\" stroke-width=\"{:.4g}\" d=\"M{:.7g} "
                   "{:.7g}v{:.4g}h{:.7g}v-{:.4g}\"/>\n"
                   "<text x=\"{:.7g}\" y=\"{:.7g}\">{:.6g}{}</text>\n</g>\n",
                   kBarLine, left, base + 0.6 * font, 0.5 * font, scale * bar, 0.5 * font,
                   left + scale * bar + 0.5 * font, base + 1.3 * font, bar,
                   options.unit.empty() ? "" : " " + options.unit);
  }
  text += "</g>\n";
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
  const Sheet sheet = layout_of(sections, frames, options);
  const double width = sheet.cell_width * static_cast<double>(sheet.columns),
               height = sheet.cell_height * static_cast<double>(sheet.rows);
  const double in_unit = options.unit.empty() ? 1 : 1 / sheet.scale;
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
      "xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" version=\"1.1\" "
      "width=\"{:.7g}{}\" height=\"{:.7g}{}\" viewBox=\"0 0 {:.7g} {:.7g}\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
      width * in_unit, options.unit, height * in_unit, options.unit, width, height);
  for (std::size_t i = 0; i < sections.size(); ++i)
    append_drawing(text, i, sections[i], frames[i].empty() ? Extent{0, 0, 0, 0} : frames[i], sheet, options);
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

std::string section_words(const Section& s) {
  const std::size_t open = s.open_curves();
  return fmt::format("{:<20} length {:<11.6g} area {:<11.6g} {}{}", equation(s.plane), s.length, s.area,
                     s.curves.empty() ? "nothing there" : counted(s.curves.size(), "curve"),
                     open > 0 ? fmt::format(" ({} open)", grouped(open)) : "");
}

}  // namespace sansmesh::inline v1
