# Sources of the library that the first picture of ./run needs (target sansmesh_first): those whose path in sansmesh/ matches
# one of SANSMESH_FIRST and none of SANSMESH_LATER. They make libraries of their own, which the whole tool links as well, so
# that nothing is compiled twice. A source that is missing here shows when sansmesh_first is linked.
set(SANSMESH_FIRST
    "^(core|schema|data|search|field|points|triangulation|partition|meshing|model|render)/"
    "^approximation/(orthogonal|polynomial)"
    "^io/([a-z_]+|(points|meshes|laz|e57)/.*)\\.cpp"
    "^mesh/([a-z_]+|edit/(clip|collapse|edge_collapses|simplify|tubes).*|repair/(components|cut_handles|handle_loops|hole_(loops|patch)|self_intersections))\\.cpp"
    "^polygonize/(creases/crease_edges|editable_surface|lattice/(extraction|lattice|walk_surface)|polygonize|surface_chain|vertex_placement)"
    "^surface/(bilateral|candidates|curvature|sample_|surface_samples|vertex_curvature)"
    "^function/(fit_options|fitted_function|function_cut|function_domain|function_file|mesh_function|surface_function)"
    "^jobs/(files/(frame_names|normals|split|tile_names)|pictures/(color_bar|draw_|line_picture|picture_(checks|curvature|options|report)|render|splat_points)|surfaces/(fit_words|height_grid|reconstruct))"
    "^(io/grids/geotiff_write|measure/(contours|mesh_heights))\\.cpp"
    "^io/grids/(nek|plot3d)_read"  # told apart from points by name or content
    "^(volume/volume_method|flow/flow_integrator|dynamics/body_integrator)\\.cpp")  # registries that `sansmesh schema` lists
set(SANSMESH_LATER "^meshing/mesh_csg" "^model/methods/(implicit|projection|mpu)" "^render/(scene/flow_texture|splat/splat_scene)")

# Sets RESULT to whether the first picture needs SOURCE, a path as target_sources() takes it.
function(sansmesh_needed_first source result)
  get_filename_component(source ${source} ABSOLUTE)
  file(RELATIVE_PATH source ${PROJECT_SOURCE_DIR}/sansmesh ${source})
  set(needed OFF)
  foreach(pattern IN LISTS SANSMESH_FIRST)
    if(source MATCHES "${pattern}")
      set(needed ON)
    endif()
  endforeach()
  foreach(pattern IN LISTS SANSMESH_LATER)
    if(source MATCHES "${pattern}")
      set(needed OFF)
    endif()
  endforeach()
  set(${result} ${needed} PARENT_SCOPE)
endfunction()
