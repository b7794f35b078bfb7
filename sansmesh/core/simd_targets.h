// To be included first by every source that Highway compiles once for each instruction set, before any of its headers.
#pragma once

#include "sansmesh/core/instruction_sets.h"  // made by CMake (SANSMESH_INSTRUCTION_SETS)

// Kernels keep vectors in arrays and structs. Those of SVE and RVV have no size that the compiler knows and cannot
// stand there: machines that have them run the kernels of NEON, or one number at a time.
//
// SSSE3 would serve processors of 2006 to 2009 alone, which compute one number at a time instead, and cost every kernel
// a fifth of its time to compile.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | ~SANSMESH_COMPILED_SETS)
