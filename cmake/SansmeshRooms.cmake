# Rooms of the library: folders of sansmesh/ with one subject each.

include(FirstPicture)

# sansmesh_room(NAME [SEES room...]): the folder NAME as object libraries, of which the library consists: sansmesh_NAME with
# what the first picture needs, sansmesh_NAME_later with the rest. Its CMakeLists.txt lists sources, public headers and
# registries by the functions below.
function(sansmesh_room SANSMESH_ROOM)
  set(room ${SANSMESH_ROOM})
  add_subdirectory(${room})
  set_property(GLOBAL APPEND PROPERTY SANSMESH_ROOMS ${room})
  get_property(alone GLOBAL PROPERTY SANSMESH_ALONE_${room})
  set_source_files_properties(${alone} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  foreach(part "" _later)
    get_property(sources GLOBAL PROPERTY SANSMESH_SOURCES_${room}${part})
    if(sources)
      set(target sansmesh_${room}${part})
      add_library(${target} OBJECT ${sources})
      sansmesh_library_settings(${target})
      sansmesh_group_sources(${target})
      set_property(GLOBAL APPEND PROPERTY SANSMESH_PARTS${part} ${target})
    endif()
  endforeach()
endfunction()

# What all sources of the library are compiled with. Precompiled headers are shared, which equal settings allow. Every
# source includes what it needs all the same: scripts/tidy --alone compiles them without.
function(sansmesh_library_settings target)
  sansmesh_warnings(${target})
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/include)
  target_include_directories(${target} SYSTEM PRIVATE ${SANSMESH_XXHASH_INCLUDE_DIR})
  target_link_libraries(${target} PRIVATE TBB::tbb hwy::hwy fmt::fmt PNG::PNG ZLIB::ZLIB embree Qhull::qhull_r Eigen3::Eigen nlohmann_json::nlohmann_json)
  set_target_properties(${target} PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_compile_options(${target} PRIVATE -ffunction-sections -fdata-sections)  # what is not called needs not be there to link
  if(target MATCHES "_(core|followed)$")  # sources that a fuzzer follows have a setting of their own
    target_precompile_headers(${target} PRIVATE ${SANSMESH_COMMON_HEADERS})
  else()
    target_precompile_headers(${target} REUSE_FROM sansmesh_core)
  endif()
endfunction()

# sansmesh_sources(source... [ALONE source...]): sources of a room. Those after ALONE share no unit with others where
# several sources make a unit (CMAKE_UNITY_BUILD): kernels are compiled once for every instruction set, others take longest.
function(sansmesh_sources)
  cmake_parse_arguments(of "" "" "ALONE" ${ARGN})
  foreach(source IN LISTS of_UNPARSED_ARGUMENTS of_ALONE)
    get_filename_component(path ${source} ABSOLUTE)
    sansmesh_needed_first(${source} first)
    set(part _later)
    if(first)
      set(part "")
    endif()
    set_property(GLOBAL APPEND PROPERTY SANSMESH_SOURCES_${SANSMESH_ROOM}${part} ${path})
    if(source IN_LIST of_ALONE)
      set_property(GLOBAL APPEND PROPERTY SANSMESH_ALONE_${SANSMESH_ROOM} ${path})
    endif()
  endforeach()
endfunction()

# Defines LIST() of HEADER, the entries of a registry that the library has by itself: those of each SOURCE, in the given
# order. With KINDS as the last word of LIST (own_volume_methods: methods), SOURCE.cpp has SOURCE_KINDS(), or SOURCE() if
# its name ends so. They are named here so that no linker drops a source that nothing else calls. The first picture has a
# list of those entries that it needs.
function(sansmesh_registry entry header list)
  set(first_sources "")
  foreach(source IN LISTS ARGN)
    sansmesh_sources(${source}.cpp)
    sansmesh_needed_first(${source}.cpp first)
    if(first)
      list(APPEND first_sources ${source})
    endif()
  endforeach()
  sansmesh_write_registry(${CMAKE_CURRENT_BINARY_DIR}/${list}.cpp ${entry} ${header} ${list} ${ARGN})
  sansmesh_sources(ALONE ${CMAKE_CURRENT_BINARY_DIR}/${list}.cpp)
  sansmesh_write_registry(${PROJECT_BINARY_DIR}/first_picture/${list}.cpp ${entry} ${header} ${list} ${first_sources})
  set_property(GLOBAL APPEND PROPERTY SANSMESH_FIRST_REGISTRIES ${PROJECT_BINARY_DIR}/first_picture/${list}.cpp)
endfunction()

function(sansmesh_write_registry file entry header list)
  set(declared "")
  set(called "")
  string(REGEX REPLACE ".*_" "" kinds ${list})
  foreach(source IN LISTS ARGN)
    get_filename_component(name ${source} NAME)
    string(REGEX REPLACE "_${kinds}$" "" name ${name})
    string(APPEND declared "std::span<const ${entry}> ${name}_${kinds}();\n")
    string(APPEND called "\n          ${name}_${kinds}(),")
  endforeach()
  file(CONFIGURE OUTPUT ${file} @ONLY CONTENT
"#include \"${header}\"

namespace sansmesh::inline v1 {

${declared}
std::vector<std::span<const ${entry}>> ${list}() {
  return {${called}};
}

}  // namespace sansmesh::inline v1
")
endfunction()

# Public headers of a room, include/sansmesh/NAME.h: installed, and read by scripts/check-includes.
function(sansmesh_headers)
  foreach(name IN LISTS ARGN)
    set_property(GLOBAL APPEND PROPERTY SANSMESH_HEADERS ${PROJECT_SOURCE_DIR}/include/sansmesh/${name}.h)
  endforeach()
endfunction()
