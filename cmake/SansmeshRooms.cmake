# Rooms of the library: folders of sansmesh/ with one subject each.

# sansmesh_room(NAME [SEES room...]): the folder NAME as a target sansmesh_NAME, whose objects the library consists of. Its
# CMakeLists.txt lists sources, public headers and registries by the functions below.
function(sansmesh_room SANSMESH_ROOM)
  set(target sansmesh_${SANSMESH_ROOM})
  add_library(${target} OBJECT)
  sansmesh_library_settings(${target})
  add_subdirectory(${SANSMESH_ROOM})
  sansmesh_group_sources(${target})
  set_property(GLOBAL APPEND PROPERTY SANSMESH_ROOMS ${SANSMESH_ROOM})
endfunction()

# What all sources of the library are compiled with. Precompiled headers are shared, which equal settings allow. Every
# source includes what it needs all the same: scripts/tidy --alone compiles them without.
function(sansmesh_library_settings target)
  sansmesh_warnings(${target})
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/include)
  target_include_directories(${target} SYSTEM PRIVATE ${SANSMESH_XXHASH_INCLUDE_DIR})
  target_link_libraries(${target} PRIVATE TBB::tbb hwy::hwy fmt::fmt PNG::PNG ZLIB::ZLIB embree Qhull::qhull_r Eigen3::Eigen nlohmann_json::nlohmann_json)
  set_target_properties(${target} PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  if(target STREQUAL "sansmesh_core")
    target_precompile_headers(${target} PRIVATE ${SANSMESH_COMMON_HEADERS})
  else()
    target_precompile_headers(${target} REUSE_FROM sansmesh_core)
  endif()
endfunction()

# sansmesh_sources(source... [ALONE source...]): sources of a room. Those after ALONE share no unit with others where
# several sources make a unit (CMAKE_UNITY_BUILD): kernels are compiled once for every instruction set, others take longest.
function(sansmesh_sources)
  cmake_parse_arguments(of "" "" "ALONE" ${ARGN})
  target_sources(sansmesh_${SANSMESH_ROOM} PRIVATE ${of_UNPARSED_ARGUMENTS} ${of_ALONE})
  if(of_ALONE)
    set_source_files_properties(${of_ALONE} TARGET_DIRECTORY sansmesh_${SANSMESH_ROOM} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
endfunction()

# Defines LIST() of HEADER, the entries of a registry that the library has by itself: those of each SOURCE, in the given
# order. With KINDS as the last word of LIST (own_volume_methods: methods), SOURCE.cpp has SOURCE_KINDS(), or SOURCE() if
# its name ends so. They are named here so that no linker drops a source that nothing else calls.
function(sansmesh_registry entry header list)
  set(declared "")
  set(called "")
  string(REGEX REPLACE ".*_" "" kinds ${list})
  foreach(source IN LISTS ARGN)
    get_filename_component(name ${source} NAME)
    string(REGEX REPLACE "_${kinds}$" "" name ${name})
    string(APPEND declared "std::span<const ${entry}> ${name}_${kinds}();\n")
    string(APPEND called "\n          ${name}_${kinds}(),")
    sansmesh_sources(${source}.cpp)
  endforeach()
  set(generated ${CMAKE_CURRENT_BINARY_DIR}/${list}.cpp)
  file(CONFIGURE OUTPUT ${generated} @ONLY CONTENT
"#include \"${header}\"

namespace sansmesh::inline v1 {

${declared}
std::vector<std::span<const ${entry}>> ${list}() {
  return {${called}};
}

}  // namespace sansmesh::inline v1
")
  sansmesh_sources(ALONE ${generated})
endfunction()

# Public headers of a room, include/sansmesh/NAME.h: installed, and read by scripts/check-includes.
function(sansmesh_headers)
  foreach(name IN LISTS ARGN)
    set_property(GLOBAL APPEND PROPERTY SANSMESH_HEADERS ${PROJECT_SOURCE_DIR}/include/sansmesh/${name}.h)
  endforeach()
endfunction()
