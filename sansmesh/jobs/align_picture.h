// Picture of a surface that was moved onto another one.
#pragma once

#include "sansmesh/core/progress.h"
#include "sansmesh/data/image.h"
#include "sansmesh/jobs/align.h"
#include "sansmesh/render/render_options.h"

namespace sansmesh {

/// The moved surface in orange, the fixed one in gray.
Image draw_alignment(const AlignResult& aligned, RenderOptions look, Progress& progress);

}  // namespace sansmesh
