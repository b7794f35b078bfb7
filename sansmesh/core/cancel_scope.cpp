#include "sansmesh/core/cancel_scope.h"

#include <utility>

namespace sansmesh::inline v1 {
namespace {

thread_local const Progress* heard = nullptr;

}  // namespace

CancelScope::CancelScope(const Progress& progress) : before_(std::exchange(heard, &progress)) {}
CancelScope::~CancelScope() { heard = before_; }

void check_cancelled() {
  if (heard != nullptr) heard->check();
}

namespace detail {

const Progress* observed_progress() { return heard; }

ObserveAs::ObserveAs(const Progress* progress) : before_(heard) {
  if (progress != nullptr) progress->check();
  heard = progress;
}
ObserveAs::~ObserveAs() { heard = before_; }

}  // namespace detail
}  // namespace sansmesh::inline v1
