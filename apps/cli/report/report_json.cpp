#include "cli/report/report_json.h"

#include <nlohmann/json.hpp>
#include <set>
#include <type_traits>
#include <utility>

namespace sansmesh::cli {
namespace {

/// Field of an object or of a nested object, "output.file"; added if missing.
Json& value_at(Json& object, std::string_view path) {
  const std::size_t dot = path.find('.');
  Json& part = object[std::string(path.substr(0, dot))];
  return dot == std::string_view::npos ? part : value_at(part, path.substr(dot + 1));
}

Json json_of_value(const ReportValue& value) {
  return std::visit(
      [](const auto& v) -> Json {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, std::monostate>) {
          return nullptr;
        } else if constexpr (std::is_same_v<T, ReportCounts>) {
          Json counts = Json::object();
          for (const auto& [name, count] : v) counts[name] = count;
          return counts;
        } else {
          return v;
        }
      },
      value);
}

void put_rows(Json& object, const ReportSchema& schema, const void* report);

/// Value of a row: an object for a report, null without one; a list for several reports.
Json json_of_row(const ReportRow& row, const void* report) {
  if (row.get) return json_of_value(report_value(row, report));
  Json json = row.kind == ReportKind::reports ? Json::array() : Json();
  row.each(report, [&](const void* part) {
    Json one = Json::object();
    put_rows(one, row.part(), part);
    if (row.kind == ReportKind::reports)
      json.push_back(std::move(one));
    else
      json = std::move(one);
  });
  return json;
}

void put_rows(Json& object, const ReportSchema& schema, const void* report) {
  for (const ReportRow& row : schema.rows) {
    if (row.inlined) {
      row.each(report, [&](const void* part) { put_rows(object, row.part(), part); });
      continue;
    }
    value_at(object, row.name) = json_of_row(row, report);
  }
}

constexpr std::string_view kKinds[] = {"flag",    "whole", "real",  "text",   "choice", "wholes",
                                       "numbers", "texts", "table", "counts", "report", "reports"};

/// Lists keys shared by several reports once. `optional`: the reports may be missing.
void push_rows(Json& list, std::string_view before, const ReportSchema& schema, bool optional,
               std::set<std::string>& known) {
  for (const ReportRow& row : schema.rows) {
    const bool maybe = optional || row.optional;
    if (row.inlined) {
      push_rows(list, before, row.part(), maybe, known);
      continue;
    }
    const std::string key = std::string(before) + (before.empty() ? "" : ".") + std::string(row.name);
    if (known.insert(key).second) {
      Json json = {{"key", key}, {"kind", kKinds[static_cast<std::size_t>(row.kind)]}, {"text", row.text}};
      if (!row.unit.empty()) json["unit"] = row.unit;
      if (!row.choices.empty()) json["choices"] = std::vector(row.choices.begin(), row.choices.end());
      if (maybe) json["optional"] = true;
      list.push_back(std::move(json));
    }
    if (row.part) push_rows(list, row.kind == ReportKind::reports ? key + "[]" : key, row.part(), maybe, known);
  }
}

}  // namespace

std::string text_of(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

void put_value(Json& object, std::string_view key, const ReportValue& value) {
  value_at(object, key) = json_of_value(value);
}

void put_list(Json& object, std::string_view key) { value_at(object, key) = Json::array(); }

void put_report(Json& object, std::string_view key, const ReportSchema& schema, const void* report) {
  put_rows(key.empty() ? object : value_at(object, key), schema, report);
}

void push_report(Json& object, std::string_view key, const ReportSchema& schema, const void* report) {
  Json one = Json::object();
  put_rows(one, schema, report);
  value_at(object, key).push_back(std::move(one));
}

Json json_of_keys(const std::vector<AnnouncedReport>& reports) {
  Json list = Json::array();
  std::set<std::string> known;
  for (const AnnouncedReport& one : reports)
    if (one.schema)
      push_rows(list, std::string(one.key) + (one.list ? "[]" : ""), *one.schema, false, known);
    else
      push_rows(list, "", ReportSchema{{&one.value, 1}}, false, known);
  return list;
}

}  // namespace sansmesh::cli
