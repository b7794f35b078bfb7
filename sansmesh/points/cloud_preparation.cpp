#include "sansmesh/cloud_options.h"

#include <string>
#include <string_view>

#include "sansmesh/points/orientation/orient_words.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::string_view kFaces[] = {"auto", "ignore", "sample", "vertices"};
constexpr std::string_view kNormals[] = {"auto", "given", "estimate"};

/// Conversion of classes from and to text.
struct ClassWords {
  static constexpr auto kind = OptionKind::text;
  static OptionValue get(const PointClasses& classes) { return point_classes_text(classes); }
  static PointClasses from(const OptionValue& value) { return parse_point_classes(std::get<std::string>(value)); }
};

constexpr OptionRow kRows[] = {
    option<&CloudPreparation::faces>(
        {.text = "Of a mesh: sample its faces, ignore them, take its vertices, however few, or "
                 "auto (sample them if vertices are sparse, on creases or on thin parts)",
         .choices = kFaces}),
    option<&CloudPreparation::normals>(
        {.text = "Use given ones unchanged, estimate new ones, or auto (flip given ones if necessary)",
         .choices = kNormals}),
    option<&CloudPreparation::orient_by>(
        {.text = "Source of the signs of normals (auto: the first known one)", .choices = kOrientByWords}),
    option<&CloudPreparation::align>({.text = "Align slightly misregistered scans"}),
    option<&CloudPreparation::remove_outliers>(
        {.text = "Remove stray samples, which belong to no surface",
         .from_data = "reconstruct, fit: clear clutter",
         .negative = "keep_outliers",
         .negative_text = "Keep stray samples, also where they are clearly clutter"}),
    option<&CloudPreparation::classes, ClassWords>(
        {.text = "Only points of these comma-separated classes: names (ground, building) or numbers (2, 3-5)",
         .unit = "classes",
         .from_data = "all",
         .name = "class"})};
constexpr OptionSchema kSchema{kRows};

}  // namespace

const OptionSchema& CloudPreparation::schema() { return kSchema; }

}  // namespace sansmesh::inline v1
