# Instruction sets that kernels are compiled for, as a header that only kernels include: sansmesh/core/instruction_sets.h.
# Results do not depend on them.
set(SANSMESH_INSTRUCTION_SETS all CACHE STRING "all (the processor's best is chosen at run time), or native: this machine's best and none, which compiles in half the time")
set_property(CACHE SANSMESH_INSTRUCTION_SETS PROPERTY STRINGS all native)

set(SANSMESH_COMPILED_SETS -1LL)
if(SANSMESH_INSTRUCTION_SETS STREQUAL "native" AND NOT CMAKE_CROSSCOMPILING)
  if(NOT DEFINED SANSMESH_NATIVE_SETS)
    # Of Highway's bits the lowest is the best that it compiles and this machine has, the highest is no vectors at all.
    set(source ${CMAKE_BINARY_DIR}/instruction_sets/native.cpp)
    file(WRITE ${source} "#include <hwy/highway.h>

#include <cstdio>

int main() {
  const auto here = hwy::SupportedTargets() & HWY_TARGETS;
  std::printf(\"%lldLL\", static_cast<long long>((here & -here) | HWY_BASELINE_TARGETS));
}
")
    try_run(status compiled ${CMAKE_BINARY_DIR}/instruction_sets ${source} LINK_LIBRARIES hwy::hwy CXX_STANDARD 20 RUN_OUTPUT_VARIABLE printed)
    if(compiled AND status EQUAL 0)
      set(SANSMESH_NATIVE_SETS ${printed} CACHE INTERNAL "Highway's bits of the instruction sets of this machine")
    endif()
  endif()
  if(SANSMESH_NATIVE_SETS)
    set(SANSMESH_COMPILED_SETS ${SANSMESH_NATIVE_SETS})
  endif()
elseif(NOT SANSMESH_INSTRUCTION_SETS MATCHES "^(all|native)$")
  message(FATAL_ERROR "SANSMESH_INSTRUCTION_SETS must be all or native, not '${SANSMESH_INSTRUCTION_SETS}'")
endif()
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/include/sansmesh/core/instruction_sets.h @ONLY CONTENT
"// Bits of Highway's targets that kernels are compiled for.
#pragma once

#define SANSMESH_COMPILED_SETS @SANSMESH_COMPILED_SETS@
")
