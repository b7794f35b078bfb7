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

# Instrumented kernels take minutes to compile for every instruction set; one shows the same mistakes.
if(CMAKE_CXX_FLAGS MATCHES "-fsanitize|--coverage")
  add_compile_definitions(HWY_COMPILE_ONLY_STATIC)
endif()

function(sansmesh_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wno-unused-parameter)
  if(SANSMESH_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()
