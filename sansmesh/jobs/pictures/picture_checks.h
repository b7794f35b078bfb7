// Rejects picture options that do not apply to the objects.
#pragma once

#include <vector>

#include "sansmesh/option.h"
#include "sansmesh/pictures.h"

namespace sansmesh::inline v1 {

/// Name of the attribute, and value of `color_by`.
inline constexpr const char* kConfidence = "confidence";
inline constexpr const char *kAutoColor = "auto", *kOwnColor = "own";

/// Whether the single object is a surface without a mesh.
bool is_meshless(const std::vector<PictureObject>& objects, const PictureOptions& options);
/// Whether the single object is a set of lines.
bool is_of_lines(const std::vector<PictureObject>& objects, const PictureOptions& options);
/// Whether the picture shows several objects side by side.
bool is_of_objects(const std::vector<PictureObject>& objects, const PictureOptions& options);

/// Checks options against the objects. Throws ArgumentError.
void check_objects(const std::vector<PictureObject>& objects, const PictureOptions& options);
/// Checks options that none of these kinds of objects uses. Throws ArgumentError.
void check_kinds(const std::vector<ObjectKind>& kinds, const PictureOptions& options);

}  // namespace sansmesh::inline v1
