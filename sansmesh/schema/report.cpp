#include "sansmesh/report.h"

#include <stdexcept>
#include <utility>

namespace sansmesh::inline v1 {

ReportValue report_value(const ReportRow& row, const void* report) {
  ReportValue value = row.get(report);
  if (row.kind != ReportKind::choice || std::holds_alternative<std::monostate>(value)) return value;
  const std::int64_t number = std::get<std::int64_t>(value);
  if (!std::in_range<std::size_t>(number) || static_cast<std::size_t>(number) >= row.choices.size())
    throw std::logic_error("a choice without a word: " + std::string(row.name));
  return std::string(row.choices[static_cast<std::size_t>(number)]);
}

}  // namespace sansmesh::inline v1
