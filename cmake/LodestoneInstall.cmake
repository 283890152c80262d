# `cmake --install` gives a package that find_package(lodestone) uses: targets lodestone::core, ::parallel, ::render and
# ::experiments, headers below include/lodestone in the folders they have here, and the command.
include(CMakePackageConfigHelpers)

set(package_layers core parallel render experiments)

# The libraries may be static: a program that links them links their dependencies, too, also PRIVATE ones. This table says
# which package provides a target; linking to one that is missing here stops the configuration, so that the installed
# package can never lack a dependency.
set(lodestone_provider_TBB::tbb "find_dependency(TBB)")
set(lodestone_provider_TBB::tbbmalloc "find_dependency(TBB)")
set(lodestone_provider_Threads::Threads "find_dependency(Threads)")
set(lodestone_provider_Eigen3::Eigen "find_dependency(Eigen3)")
set(lodestone_provider_OpenMeshCore "find_dependency(OpenMesh)")
set(lodestone_provider_OpenMeshTools "find_dependency(OpenMesh)")
set(lodestone_provider_glm::glm "find_dependency(glm)")
set(lodestone_provider_glfw "find_dependency(glfw3)")
set(lodestone_provider_OpenGL::EGL "find_dependency(OpenGL COMPONENTS OpenGL EGL)")
set(lodestone_provider_OpenGL::OpenGL "find_dependency(OpenGL COMPONENTS OpenGL EGL)")
set(lodestone_provider_PNG::PNG "find_dependency(PNG)")
set(lodestone_provider_OpenEXR::OpenEXR "find_dependency(OpenEXR)")
set(lodestone_provider_libjpeg-turbo::turbojpeg "find_dependency(libjpeg-turbo)")
set(lodestone_provider_draco::draco "find_dependency(draco)")
set(lodestone_provider_meshoptimizer::meshoptimizer "find_dependency(meshoptimizer)")
set(lodestone_provider_nlohmann_json::nlohmann_json "find_dependency(nlohmann_json)")
set(lodestone_provider_OpenSSL::Crypto "find_dependency(OpenSSL COMPONENTS Crypto)")
set(lodestone_provider_fmt::fmt "find_dependency(fmt)")
set(lodestone_provider_CLI11::CLI11 "find_dependency(CLI11)")
set(lodestone_provider_zstd::libzstd_shared "find_dependency(zstd)")

# Targets that pkg_check_modules(... IMPORTED_TARGET name) made; the package makes them again under the same name.
function(lodestone_pkg_config_line target out)
  string(REPLACE "PkgConfig::" "" prefix ${target})
  set(modules "${${prefix}_MODULE_NAME}")
  if(NOT modules)
    string(TOLOWER ${prefix} modules)
  endif()
  set(${out} "find_dependency(PkgConfig)\npkg_check_modules(${prefix} REQUIRED QUIET IMPORTED_TARGET ${modules})"
      PARENT_SCOPE)
endfunction()

# find_dependency lines for everything that the installed targets link.
function(lodestone_dependencies out)
  set(lines)
  foreach(layer ${package_layers})
    get_target_property(linked lodestone_${layer} LINK_LIBRARIES)
    get_target_property(interface lodestone_${layer} INTERFACE_LINK_LIBRARIES)
    foreach(library ${linked} ${interface})
      string(REGEX REPLACE "^\\$<(LINK_ONLY|BUILD_INTERFACE):(.*)>$" "\\2" name "${library}")
      # "::@" marks what a subfolder linked to its parent's target.
      if(NOT library OR name MATCHES "^(lodestone::|::@)" OR name MATCHES "^(m|dl|rt|pthread)$" OR
         library MATCHES "BUILD_INTERFACE")
        continue()
      endif()
      if(DEFINED lodestone_provider_${name})
        list(APPEND lines "${lodestone_provider_${name}}")
      elseif(name MATCHES "^PkgConfig::")
        lodestone_pkg_config_line(${name} line)
        list(APPEND lines "${line}")
      else()
        message(FATAL_ERROR "lodestone::${layer} links ${name}: say in cmake/LodestoneInstall.cmake which package "
                            "provides it")
      endif()
    endforeach()
  endforeach()
  list(REMOVE_DUPLICATES lines)
  list(JOIN lines "\n" joined)
  set(${out} "${joined}" PARENT_SCOPE)
endfunction()

foreach(layer ${package_layers})
  install(TARGETS lodestone_${layer} EXPORT lodestoneTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(DIRECTORY ${layer} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lodestone FILES_MATCHING PATTERN "*.h")
endforeach()
if(TARGET lodestone)
  install(TARGETS lodestone RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  install(DIRECTORY python DESTINATION ${CMAKE_INSTALL_DATADIR}/lodestone PATTERN __pycache__ EXCLUDE)
endif()

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/lodestone)
install(EXPORT lodestoneTargets NAMESPACE lodestone:: DESTINATION ${package_folder})

lodestone_dependencies(LODESTONE_DEPENDENCIES)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/lodestoneConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/lodestoneConfig.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/lodestoneConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/lodestoneConfig.cmake ${PROJECT_BINARY_DIR}/lodestoneConfigVersion.cmake
        DESTINATION ${package_folder})
