// JSON of results and of the schema.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace sansmesh::cli {

/// Version of the keys that --json prints. It grows when a key goes or changes its meaning.
inline constexpr int kReportVersion = 1;

/// Objects keep the order of their fields. Sources that make some include <nlohmann/json.hpp>, which takes long to
/// compile.
using Json = nlohmann::ordered_json;

/// Indented by two blanks, with a line end. Bytes that are not UTF-8, as names of files can have, are replaced; numbers
/// that are not finite are null.
std::string text_of(const Json& json);

}  // namespace sansmesh::cli
