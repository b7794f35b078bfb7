// ParaView's file series: JSON that names a file for each time.
#include <nlohmann/json.hpp>

#include "sansmesh/core/json_text-inl.h"
#include "sansmesh/io/grids/header_fields.h"
#include "sansmesh/io/grids/volume_readers.h"

namespace sansmesh::inline v1::io {

std::vector<PvdEntry> read_file_series(const Input& in) {
  using nlohmann::json;
  json series;
  try {
    series = detail::parse_json<json>(in.bytes);
  } catch (const ArgumentError& error) {
    in.fail(std::string("is not a series of files: it ") + error.what());
  }
  if (!series.is_object() || !series.contains("files") || !series["files"].is_array())
    in.fail("is not a series of files: it has no list \"files\"");
  std::vector<PvdEntry> entries;
  for (const json& file : series["files"]) {
    if (!file.is_object() || !file.contains("name") || !file["name"].is_string() ||
        file["name"].get_ref<const std::string&>().empty())
      in.fail("names a step without a file");
    if (!file.contains("time") || !file["time"].is_number()) in.fail("gives a time that is not a number");
    entries.push_back({file["time"].get<double>(), beside(in, file["name"].get_ref<const std::string&>())});
  }
  if (entries.empty()) in.fail("names no files");
  return entries;
}

}  // namespace sansmesh::inline v1::io
