// A project outside sansmesh: only what find_package(sansmesh) gives.
#include <sansmesh/core/parallel.h>

#include <cstdio>

int main() {
  const std::size_t n = 100000;
  const auto sum = sansmesh::parallel_reduce<std::size_t>(
      n, 1000, 0,
      [](std::size_t first, std::size_t last) {
        std::size_t part = 0;
        for (std::size_t i = first; i < last; ++i) part += i;
        return part;
      },
      [](std::size_t a, std::size_t b) { return a + b; });
  std::printf("%zu\n", sum);
  return sum == n * (n - 1) / 2 ? 0 : 1;
}
