// Reports of the library as JSON.
#pragma once

#include <string_view>
#include <vector>

#include "cli/report/json.h"
#include "sansmesh/report.h"

namespace sansmesh::cli {

/// A report that a command prints with --json, under a key ("output") or at the top level; or a single value of the
/// command.
struct AnnouncedReport {
  std::string_view key;
  const ReportSchema* schema;  ///< null for values
  bool list = false;           ///< list of reports
  ReportRow value = {};        ///< kind and text of a value
};
template <HasReport T>
AnnouncedReport report_of(std::string_view key = {}) {
  return {key, &T::schema()};
}
template <HasReport T>
AnnouncedReport reports_of(std::string_view key) {
  return {key, &T::schema(), true};
}

template <class T>
AnnouncedReport value_of(std::string_view key, std::string_view text) {
  AnnouncedReport entry{key, nullptr};
  entry.value.name = key, entry.value.text = text, entry.value.kind = report_detail::kind_of<T>();
  return entry;
}

/// Adds a value to an object; "output.lines" addresses a nested object.
void put_value(Json& object, std::string_view key, const ReportValue& value);
/// Adds an empty list.
void put_list(Json& object, std::string_view key);
/// Adds a report to an object, or to the nested object under a key. Missing values are null.
void put_report(Json& object, std::string_view key, const ReportSchema& schema, const void* report);
/// Adds a report to a list under a key.
void push_report(Json& object, std::string_view key, const ReportSchema& schema, const void* report);

/// Keys with kinds, units and descriptions of all reports of a command; keys of lists have the form "places[].radius".
Json json_of_keys(const std::vector<AnnouncedReport>& reports);

}  // namespace sansmesh::cli
