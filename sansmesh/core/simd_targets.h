// To be included first by every source that Highway compiles once for each instruction set, before any of its headers.
#pragma once

// Kernels keep vectors in arrays and structs. Those of SVE and RVV have no size that the compiler knows and cannot
// stand there: machines that have them run the kernels of NEON, or one number at a time.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
