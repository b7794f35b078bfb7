// Sections as files: drawings and tables, as text.
#pragma once

#include <span>
#include <string>

#include "sansmesh/measure/section.h"

namespace sansmesh::inline v1 {

struct SectionSvgOptions {
  /// The unit of lengths, "mm", "cm" or "in": the drawing is true to scale. Empty: the drawing is about 1000 pixels
  /// wide.
  std::string unit;
  bool titles = true;  ///< the plane's equation, length and area, and a scale bar, at every drawing
  /// Throws ArgumentError saying which.
  void validate() const;
};

/// A sheet with one drawing per plane, side by side, all at the same scale: the solid filled by the even-odd rule,
/// outlines as hairlines. The sheet is laid out in pixels of 1/96 inch; each plane is a group (a layer, to editors of
/// drawings) with its equation as label, in which another one turns pixels into the unit of lengths, u to the right and
/// v up (y = −v). Planes across the same direction show the same part of it. Where coordinates are much larger than the
/// drawing, they are relative to the place that the group's data-origin names.
std::string section_svg(std::span<const Section> sections, const SectionSvgOptions& options = {});

/// One row per vertex: plane,curve,closed,vertex,x,y,z,u,v; planes, curves and vertices are counted from 0, lengths
/// have 12 significant digits. Closed curves do not repeat their first vertex.
std::string section_csv(std::span<const Section> sections);

/// A round number (1, 2 or 5 times a power of ten) of at most `length`, which is positive.
double round_length(double length);

/// "z = 0.5    length 1.2   area 0.3   2 curves", for people.
std::string section_words(const Section& section);

}  // namespace sansmesh::inline v1
