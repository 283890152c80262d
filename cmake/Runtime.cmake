# lodestone::runtime: opens and streams .lode files, selects and morphs, for engines. Compiled of the same files as the
# layers, without any that builds or draws; links meshoptimizer and nothing else.
lodestone_library(runtime)
set(sources
  core/base/known_names.cpp
  core/files/atomic_file.cpp
  core/files/checksum.cpp
  core/files/input_file.cpp
  core/files/json.cpp
  core/files/json_view.cpp
  core/files/temporaries.cpp
  core/formats/gltf/gltf_surface.cpp
  core/hierarchy/lode/lode_assets.cpp
  core/hierarchy/lode/lode_decode.cpp
  core/hierarchy/lode/lode_encode.cpp
  core/hierarchy/lode/lode_file.cpp
  core/hierarchy/lode/lode_payload.cpp
  core/hierarchy/model/find_signatures.cpp
  core/hierarchy/model/hierarchy.cpp
  core/hierarchy/model/pack_normals.cpp
  core/hierarchy/model/signature_sets.cpp
  core/hierarchy/model/signatures.cpp
  core/hierarchy/model/structure.cpp
  core/math/lattice.cpp
  parallel/streaming/cell_stream.cpp
  render/camera/projection.cpp
  render/lod/blend.cpp
  render/lod/blend_curve.cpp
  render/lod/family_choice.cpp
  render/lod/limits.cpp
  render/lod/morph.cpp
  render/lod/normal_cones.cpp
  render/lod/radii.cpp
  render/lod/residency.cpp
  render/lod/resident_cells.cpp
  render/lod/selection.cpp)
find_package(meshoptimizer REQUIRED)
find_package(nlohmann_json REQUIRED)
list(TRANSFORM sources PREPEND ${PROJECT_SOURCE_DIR}/)
target_sources(lodestone_runtime PRIVATE ${sources})
target_link_libraries(lodestone_runtime PRIVATE meshoptimizer::meshoptimizer $<BUILD_INTERFACE:nlohmann_json::nlohmann_json>)
