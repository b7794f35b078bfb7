# Compiler settings shared by every target: C++20, warnings, ccache, and no -march=native (Highway picks the
# instruction set at run time).
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
find_program(SANSMESH_CCACHE ccache)
if(SANSMESH_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${SANSMESH_CCACHE})
endif()

# Bit-identical results: the compiler may not fuse a*b+c differently from one build or call site to the next.
add_compile_options(-ffp-contract=off)

# Clang writes the time into precompiled headers, which a compiler cache could then never hand out.
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  add_compile_options("SHELL:-Xclang -fno-pch-timestamp")
endif()

# Instrumented kernels take minutes to compile for every instruction set; one with vectors shows the same mistakes. On
# x86-64 that is SSE4: less has none with this Highway, more would not run everywhere.
if(CMAKE_CXX_FLAGS MATCHES "-fsanitize|--coverage")
  set(SANSMESH_INSTRUMENTED ON)
  add_compile_definitions(HWY_COMPILE_ONLY_STATIC)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|[Aa][Mm][Dd]64")
    add_compile_options(-msse4.2 -mpclmul -maes)
  endif()
endif()

# Undefined behaviour is not looked for in headers of others (half of what is instrumented): what they hand out is checked
# where our code uses it. Named relative to the build folder, so that clones share the compiler cache.
if(SANSMESH_INSTRUMENTED AND CMAKE_CXX_COMPILER_ID MATCHES "Clang" AND CMAKE_GENERATOR STREQUAL "Ninja")
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/sanitizers.ignore CONTENT "[undefined]\nsrc:/usr/*\n")
  add_compile_options(-fsanitize-ignorelist=sanitizers.ignore)
endif()

# Most sources of the library and the tool compile faster where these are precompiled (benchmarks/README.md).
set(SANSMESH_COMMON_HEADERS
    <algorithm> <array> <atomic> <bit> <chrono> <cmath> <cstdint> <cstring> <fmt/core.h> <functional> <limits> <map> <memory> <mutex>
    <numbers> <numeric> <optional> <set> <span> <string> <string_view> <unordered_map> <utility> <variant> <vector>)

function(sansmesh_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wno-unused-parameter)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC 12 is wrong about moves of short strings and, where sources share a unit, about unnamed namespaces.
    target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-subobject-linkage)
    if(CMAKE_UNITY_BUILD)  # a tenth of the time was looking for memory to use again: up to 1 GiB there is no need
      target_compile_options(${target} PRIVATE "SHELL:--param ggc-min-heapsize=1048576")
    endif()
  endif()
  if(SANSMESH_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# For the tool and tests, much of whose compile time is that of headers of others (JSON, Eigen, GoogleTest): undefined
# behaviour is looked for in the library, errors of memory everywhere. Not optimized, a third of the time: the work is done
# in the library, which is linked first and whole so that its instances of templates are the ones that all call.
function(sansmesh_instrument_lightly target)
  if(SANSMESH_INSTRUMENTED)
    target_compile_options(${target} PRIVATE -fno-sanitize=undefined -O0)
    target_link_options(${target} PRIVATE "SHELL:-Wl,--whole-archive $<TARGET_FILE:sansmesh> -Wl,--no-whole-archive")
  endif()
endfunction()

# Where several sources make a unit (CMAKE_UNITY_BUILD: half the time, but more to compile again after a change): units
# of at most 16 sources of one room, 8 of tests, so that names in unnamed namespaces only have to differ within a room.
function(sansmesh_group_sources target)
  if(NOT CMAKE_UNITY_BUILD)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  set(sources_of_unit 16)
  if(target MATCHES "^test_")
    set(sources_of_unit 8)
  endif()
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    get_source_file_property(alone ${source} TARGET_DIRECTORY ${target} SKIP_UNITY_BUILD_INCLUSION)
    if(NOT alone)
      set(room "")
      if(source MATCHES "^${PROJECT_SOURCE_DIR}/sansmesh/([^/]+)/")
        set(room ${CMAKE_MATCH_1})
      endif()
      math(EXPR count_of_${room} "0${count_of_${room}} + 1")
      math(EXPR group "(${count_of_${room}} - 1) / ${sources_of_unit}")
      set_property(SOURCE ${source} TARGET_DIRECTORY ${target} PROPERTY UNITY_GROUP "${room}${group}")
    endif()
  endforeach()
endfunction()
