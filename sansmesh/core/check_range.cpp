#include "sansmesh/core/check_range.h"

#include <cmath>
#include <string>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

void check_range(const char* name, double value, double lowest, double highest) {
  if (value >= lowest && value <= highest) return;
  const auto shown = [](double v) {
    std::string text = std::to_string(v);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text;
  };
  throw ArgumentError(ArgumentFault{.field = name,
                                    .value = std::isfinite(value) ? shown(value) : std::to_string(value),
                                    .allowed = "from " + shown(lowest) + " to " + shown(highest),
                                    .remedy = {}});
}

void check_argument(bool ok, const char* message) {
  if (!ok) throw ArgumentError(message);
}

}  // namespace sansmesh::inline v1
