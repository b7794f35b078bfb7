// Flows by formula: for tests, for teaching, and to try seeds and options on.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1 {

struct AnalyticFlow {
  std::string_view name;
  std::string_view what;  ///< a line about it
  bool unsteady = false;
};

/// Those that analytic_flow() knows.
std::span<const AnalyticFlow> analytic_flows();

/// The flow of that name, with exact derivatives. Throws ArgumentError naming those that there are.
std::unique_ptr<VectorField> analytic_flow(std::string_view name);

}  // namespace sansmesh::inline v1
