#include "sansmesh/core/cancel_scope.h"

#include <utility>

namespace sansmesh::inline v1 {
namespace {

thread_local const Progress* observed = nullptr;

}  // namespace

CancelScope::CancelScope(const Progress& progress) : before_(std::exchange(observed, &progress)) {}
CancelScope::~CancelScope() { observed = before_; }

void check_cancelled() {
  if (observed != nullptr) observed->check();
}

namespace detail {

const Progress* observed_progress() { return observed; }

ObserveAs::ObserveAs(const Progress* progress) : before_(observed) {
  if (progress != nullptr) progress->check();
  observed = progress;
}
ObserveAs::~ObserveAs() { observed = before_; }

}  // namespace detail
}  // namespace sansmesh::inline v1
