// Wall-clock and CPU time of benchmarks.
#pragma once

#include <chrono>

#include "sansmesh/progress.h"

/// Seconds of work; CPU seconds are those of all threads.
struct Time {
  double wall = 0, cpu = 0;
  Time operator-(const Time& o) const { return {wall - o.wall, cpu - o.cpu}; }
  Time operator+(const Time& o) const { return {wall + o.wall, cpu + o.cpu}; }
};

inline Time now() {
  return {std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(),
          sansmesh::process_cpu_seconds()};
}

template <class Work>
Time time_of(const Work& work) {
  const Time start = now();
  work();
  return now() - start;
}

/// The run with the least wall-clock time.
template <class Work>
Time fastest_of(int runs, const Work& work) {
  Time best = time_of(work);
  for (int k = 1; k < runs; ++k)
    if (const Time one = time_of(work); one.wall < best.wall) best = one;
  return best;
}
