// Bitwise equality of arrays, NaN and padding included.
#pragma once

#include <cstring>
#include <span>

namespace sansmesh::test {

/// For vectors, spans and shared arrays.
template <class A, class B>
bool same_bytes(const A& a, const B& b) {
  const std::span x(a.data(), a.size()), y(b.data(), b.size());
  return x.size() == y.size() && (x.empty() || std::memcmp(x.data(), y.data(), x.size_bytes()) == 0);
}

}  // namespace sansmesh::test
