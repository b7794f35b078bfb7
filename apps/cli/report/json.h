// JSON of results and of the schema.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace sansmesh::cli {

/// Version of the keys of --json. It increases when a key is removed or changes its meaning.
inline constexpr int kReportVersion = 1;

/// Objects keep the order of their fields. Only sources that create JSON include <nlohmann/json.hpp>, which is slow to
/// compile.
using Json = nlohmann::ordered_json;

/// Indented by two spaces, with a line end. Invalid UTF-8 (possible in file names) is replaced; numbers that are not
/// finite are null.
std::string text_of(const Json& json);

}  // namespace sansmesh::cli
