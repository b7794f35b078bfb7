// Writes sections as SVG drawings and CSV tables.
#pragma once

#include <span>
#include <string>

#include "sansmesh/measure/section.h"

namespace sansmesh::inline v1 {

struct SectionSvgOptions {
  /// Unit of lengths, "mm", "cm" or "in": the drawing is true to scale. Empty: the drawing is about 1000 pixels wide.
  std::string unit;
  bool titles = true;  ///< equation of the plane, length, area and a scale bar at every drawing
  /// Throws ArgumentError that names the option.
  void validate() const;
};

/// A sheet with one drawing per plane, side by side, at a common scale: the solid filled by the even-odd rule, outlines
/// as hairlines. The sheet is laid out in pixels of 1/96 inch. Each plane is a group (a layer in drawing editors) with
/// its equation as label; an inner group converts pixels to the unit of lengths, u to the right and v up (y = −v).
/// Planes with the same normal show the same region. Where coordinates are much larger than the drawing, they are
/// relative to the group's data-origin.
std::string section_svg(std::span<const Section> sections, const SectionSvgOptions& options = {});

/// One row per vertex: plane,curve,closed,vertex,x,y,z,u,v; planes, curves and vertices are counted from 0, lengths
/// have 12 significant digits. Closed curves do not repeat their first vertex.
std::string section_csv(std::span<const Section> sections);

/// The largest round number (1, 2 or 5 times a power of ten) up to `length`, which is positive.
double round_length(double length);

/// Summary line: "z = 0.5    length 1.2   area 0.3   2 curves".
std::string section_words(const Section& section);

}  // namespace sansmesh::inline v1
