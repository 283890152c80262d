# A program elsewhere includes "lodestone/render/lod/morph.h" and the like: these headers and those that they
# include, copied below build/PRESET/include with the prefix before every name. No other header is installed, and the
# sources, which use the names without prefix, never see the copies. lodestone/lodestone.h has them all,
# lodestone/runtime.h those of the component runtime. To keep them few, they declare in advance what they only point to,
# and leave the steps of a kernel and the parts of a class to headers of their own. There may be this many:
set(max_public_headers 63)
set(public_runtime
  core/base/error_kinds.h
  core/hierarchy/lode/lode_file.h
  parallel/streaming/cell_stream.h
  render/lod/morph.h
  render/lod/resident_cells.h
  render/lod/selection.h)
set(public_core
  core/base/error_kinds.h
  core/base/version.h
  core/formats/mesh_file.h
  core/hierarchy/lode/lode_file.h
  core/hierarchy/model/hierarchy.h
  core/hierarchy/model/level_mesh.h
  core/hierarchy/verify/verify.h
  core/mesh/generate.h
  core/progressive/mesh/level.h
  core/progressive/progressive_file.h
  core/simplify/simplifiers.h)
set(public_parallel
  parallel/clean/prepare.h
  parallel/hierarchy/build.h
  parallel/hierarchy/measure_errors.h
  parallel/hierarchy/save.h
  parallel/mesh/compare.h
  parallel/mesh/load.h
  parallel/out_of_core/build_model.h
  parallel/progressive/make_progressive.h
  parallel/scheduler/scheduler.h
  parallel/spherical/make_spherical.h
  parallel/streaming/cell_stream.h)
set(public_render
  render/backends/make_renderer.h
  render/camera/camera.h
  render/frame/image.h
  render/lod/morph.h
  render/lod/resident_cells.h
  render/lod/selection.h
  render/reconstruct/reconstruct.h)
set(public_experiments
  experiments/program.h
  experiments/metrics/cracks/cracks.h
  experiments/metrics/pictures/picture_metric.h
  experiments/metrics/pops/pops.h
  experiments/studies/experiment.h
  experiments/systems/lod_system.h)

set(public_layers core parallel render)
if(LODESTONE_EXPERIMENTS)
  list(APPEND public_layers experiments)
endif()

# The headers named, and all that they include from here.
function(lodestone_with_included out)
  set(found)
  set(open ${ARGN})
  while(open)
    list(POP_FRONT open header)
    if(header IN_LIST found)
      continue()
    endif()
    list(APPEND found ${header})
    file(STRINGS ${PROJECT_SOURCE_DIR}/${header} lines REGEX "^#include \"")
    list(TRANSFORM lines REPLACE "^#include \"(.*)\".*" "\\1")
    list(APPEND open ${lines})
  endwhile()
  list(SORT found)
  set(${out} ${found} PARENT_SCOPE)
endfunction()

set(LODESTONE_INCLUDE_DIR ${PROJECT_BINARY_DIR}/include)
function(lodestone_umbrella name)
  set(text "// All public headers of ${name}.\n#pragma once\n\n")
  foreach(header ${ARGN})
    string(APPEND text "#include \"lodestone/${header}\"\n")
  endforeach()
  file(CONFIGURE OUTPUT ${LODESTONE_INCLUDE_DIR}/lodestone/${name}.h CONTENT "${text}" @ONLY)
endfunction()

set(named)
foreach(layer ${public_layers})
  list(APPEND named ${public_${layer}})
endforeach()
lodestone_umbrella(lodestone ${named})
lodestone_umbrella(runtime ${public_runtime})
lodestone_with_included(LODESTONE_PUBLIC_HEADERS ${named})
list(LENGTH LODESTONE_PUBLIC_HEADERS count)
if(count GREATER max_public_headers)
  message(FATAL_ERROR "${count} public headers; at most ${max_public_headers} (cmake/PublicHeaders.cmake)")
endif()

list(TRANSFORM LODESTONE_PUBLIC_HEADERS PREPEND ${LODESTONE_INCLUDE_DIR}/lodestone/ OUTPUT_VARIABLE copies)
list(TRANSFORM LODESTONE_PUBLIC_HEADERS PREPEND ${PROJECT_SOURCE_DIR}/ OUTPUT_VARIABLE originals)
add_custom_command(OUTPUT ${copies} DEPENDS ${originals} ${CMAKE_CURRENT_LIST_DIR}/CopyHeaders.cmake VERBATIM
  COMMAND ${CMAKE_COMMAND} -P ${CMAKE_CURRENT_LIST_DIR}/CopyHeaders.cmake ${PROJECT_SOURCE_DIR}
          ${LODESTONE_INCLUDE_DIR}/lodestone ${LODESTONE_PUBLIC_HEADERS}
  COMMENT "Copying public headers")
add_custom_target(lodestone_headers DEPENDS ${copies})
foreach(layer runtime ${public_layers})
  add_dependencies(lodestone_${layer} lodestone_headers)
endforeach()
