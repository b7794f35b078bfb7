// Remedies in notes and advice on clouds and on their surfaces, in one table: a test applies each to a cloud that
// causes it.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "sansmesh/note.h"

namespace sansmesh::inline v1 {

struct Remedy {
  std::string_view code;    ///< code of the note, or subject of the advice
  std::string_view option;  ///< option that removes the defect
  std::string_view text;    ///< names the option between grave accents
};

inline constexpr Remedy kRemedies[] = {
    {"scans_disagree", "align", "`align` moves them onto each other"},
    {"classes_left_out", "class", "`class = 0-255` keeps them"},
    {"unclassified_survey", "class", "`class = ground` leaves only the terrain"},
    {"clutter", "remove_outliers", "`keep_outliers` keeps them"},
    {"parts_left_out", "components", "`components = all` keeps them"},
    {"lost_samples", "components", "`components = all` keeps their parts"},
    {"lost_samples", "remove_outliers", "`remove_outliers` leaves out those that belong to no surface"},
    {"lost_samples", "open", "`open = true` ends the surface where the samples end"},
    {"advice_open", "open", "`open = false` closes it"},
    {"advice_open", "fill_holes", "`fill_holes` closes narrower gaps"},
    {"advice_closed", "open", "`open = true` leaves open what is wider than `fill_holes`"},
};

/// Remedy by code and option. Others do not compile.
consteval const Remedy& remedy(std::string_view code, std::string_view option) {
  for (const Remedy& r : kRemedies)
    if (r.code == code && r.option == option) return r;
  throw "the table has no such remedy";
}

/// Warning with a remedy.
inline Note with_remedy(const Remedy& remedy, std::string text) {
  return {.code = std::string(remedy.code), .text = std::move(text), .remedy = std::string(remedy.text)};
}

}  // namespace sansmesh::inline v1
