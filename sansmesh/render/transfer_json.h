// Transfer functions in files (docs/formats/transfer-function.md).
#pragma once

#include <string>
#include <string_view>

#include "sansmesh/render/transfer_function.h"

namespace sansmesh::inline v1 {

/// JSON of ours (docs/formats/transfer-function.md) or ParaView's colour maps (a list of objects with RGBPoints, of
/// which the first is taken). `file` is named in errors. Throws FileError.
TransferFunction parse_transfer_function(std::string_view json, const std::string& file);
TransferFunction read_transfer_function(const std::string& file);
/// JSON of ours: what parse_transfer_function reads back the same.
std::string transfer_function_json(const TransferFunction& function);

}  // namespace sansmesh::inline v1
