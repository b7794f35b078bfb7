// Include it first, before any Highway header, in every source that Highway compiles once per instruction set.
#pragma once

#include "sansmesh/core/instruction_sets.h"  // made by CMake (SANSMESH_INSTRUCTION_SETS)

// Kernels keep vectors in arrays and structs. Vectors of SVE and RVV have no size known at compile time and cannot be
// members: such processors run the NEON kernels or scalar code.
//
// SSSE3 would serve only processors of 2006 to 2009, which run scalar code instead, and would add a fifth to the
// compile time of every kernel.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | ~SANSMESH_COMPILED_SETS)
