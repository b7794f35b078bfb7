// Picture of a surface that was moved onto another one.
#pragma once

#include "sansmesh/image.h"
#include "sansmesh/inspect.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/render_options.h"

namespace sansmesh::inline v1 {

/// The moved surface in orange, the fixed one in gray.
Image draw_alignment(const AlignResult& aligned, RenderOptions look, Progress& progress);

}  // namespace sansmesh::inline v1
