// Places where a function should not be trusted without a look, listed and looked at.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/function/diagnose_function.h"
#include "sansmesh/functions.h"
#include "sansmesh/image.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/render_options.h"

namespace sansmesh::inline v1 {

/// The places, each from outside and ringed, with its number and what is worst there: pictures as the options have
/// them, in the order of the list, or with `sheet` small ones, all on one. Of no places none. Throws ArgumentError for
/// bad options, and for more places than a sheet holds.
std::vector<Image> draw_places(const DiagnoseResult& made, RenderOptions options, bool sheet, Progress& progress);

}  // namespace sansmesh::inline v1
