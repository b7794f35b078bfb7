// Options of pictures that what is drawn would not heed: none is accepted.
#pragma once

#include <vector>

#include "sansmesh/option.h"
#include "sansmesh/pictures.h"

namespace sansmesh::inline v1 {

/// The words of the option `frames` of pictures that stand still but for the view.
inline constexpr OptionFacts kTurntable{
    .text = "Turntable: so many pictures around the up axis, NAME_000.png, …", .unit = "count", .range = {2, 100000}};

/// The attribute, and what `color_by` calls it.
inline constexpr const char* kConfidence = "confidence";
inline constexpr const char *kAutoColor = "auto", *kOwnColor = "own";

/// The one object is a surface without a mesh.
bool is_meshless(const std::vector<PictureObject>& objects, const PictureOptions& options);
/// The one object is lines.
bool is_of_lines(const std::vector<PictureObject>& objects, const PictureOptions& options);
/// They are drawn as objects that stand side by side.
bool is_of_objects(const std::vector<PictureObject>& objects, const PictureOptions& options);

/// Options against the objects. Throws ArgumentError.
void check_objects(const std::vector<PictureObject>& objects, const PictureOptions& options);
/// The same for those that no object of these kinds heeds.
void check_kinds(const std::vector<ObjectKind>& kinds, const PictureOptions& options);

}  // namespace sansmesh::inline v1
