// Reports of the library as JSON.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cli/report/json.h"
#include "sansmesh/report.h"

namespace sansmesh::cli {

/// A report that a command tells with --json, under a key ("output") or beside the others; or a value that only the
/// command knows.
struct ToldReport {
  std::string_view key;
  const ReportSchema* schema;  ///< null of values
  bool list = false;           ///< several reports
  ReportRow value = {};        ///< of a value: its kind and what it is
};
template <HasReport T>
ToldReport told(std::string_view key = {}) {
  return {key, &T::schema()};
}
template <HasReport T>
ToldReport told_list(std::string_view key) {
  return {key, &T::schema(), true};
}

template <class T>
ToldReport told_value(std::string_view key, std::string_view text) {
  ToldReport told{key, nullptr};
  told.value.name = key, told.value.text = text, told.value.kind = report_detail::kind_of<T>();
  return told;
}

/// Adds a value to an object, "output.lines" to the object that it holds there.
void put_value(Json& object, std::string_view key, const ReportValue& value);
/// Adds an empty list.
void put_list(Json& object, std::string_view key);
/// Adds what a report tells to an object, or to what it holds under a key. What there is not is null.
void put_report(Json& object, std::string_view key, const ReportSchema& schema, const void* report);
/// Adds a report to a list under a key.
void push_report(Json& object, std::string_view key, const ReportSchema& schema, const void* report);

/// Keys with kinds, units and sentences of all that a command tells, those of lists as "places[].radius".
Json json_of_keys(const std::vector<ToldReport>& told);

}  // namespace sansmesh::cli
