# The packages that an installed library depends on. The libraries may be static: a program that links them links their
# dependencies, too, also PRIVATE ones. Linking to a target that is missing here stops the configuration, so that the
# installed package can never lack a dependency.

# lodestone_provider(TARGET FIND_ARGUMENTS PKG_CONFIG DEBIAN_PACKAGE): who provides a target to find_package, to pkg-config
# (modules, or flags of the linker) and to Debian.
function(lodestone_provider target find pkg_config debian)
  if(find)
    set(lodestone_find_${target} "find_dependency(${find})" PARENT_SCOPE)
  else()
    set(lodestone_find_${target} "# ${target}: by its name alone" PARENT_SCOPE)
  endif()
  set(lodestone_pkg_config_${target} "${pkg_config}" PARENT_SCOPE)
  set(lodestone_debian_${target} "${debian}" PARENT_SCOPE)
endfunction()

lodestone_provider(TBB::tbb "TBB" tbb libtbb-dev)
lodestone_provider(OpenMeshCore "OpenMesh" openmesh libopenmesh-dev)
lodestone_provider(OpenMeshTools "OpenMesh" openmesh libopenmesh-dev)
lodestone_provider(glfw "glfw3" glfw3 libglfw3-dev)
lodestone_provider(PNG::PNG "PNG" libpng libpng-dev)
lodestone_provider(OpenEXR::OpenEXR "OpenEXR" OpenEXR libopenexr-dev)
lodestone_provider(draco::draco "draco" draco libdraco-dev)
lodestone_provider(meshoptimizer::meshoptimizer "meshoptimizer" -lmeshoptimizer libmeshoptimizer-dev)
lodestone_provider(metis "" -lmetis libmetis-dev)
lodestone_provider(nlohmann_json::nlohmann_json "nlohmann_json" nlohmann_json nlohmann-json3-dev)
lodestone_provider(OpenSSL::Crypto "OpenSSL COMPONENTS Crypto" libcrypto libssl-dev)
lodestone_provider(tomlplusplus::tomlplusplus "tomlplusplus" tomlplusplus libtomlplusplus-dev)
lodestone_provider(fmt::fmt "fmt" fmt libfmt-dev)
lodestone_provider(PkgConfig::LIBWEBP "PkgConfig" libwebp "libwebp-dev;pkg-config")
lodestone_provider(PkgConfig::LIBWEBPMUX "PkgConfig" libwebpmux "libwebp-dev;pkg-config")
lodestone_provider(PkgConfig::TURBOJPEG "PkgConfig" libturbojpeg "libturbojpeg0-dev;pkg-config")
lodestone_provider(PkgConfig::EPOXY "PkgConfig" epoxy "libepoxy-dev;pkg-config")
lodestone_provider(PkgConfig::IMGUI "PkgConfig" imgui "libimgui-dev;pkg-config")

# A target that pkg_check_modules(... IMPORTED_TARGET name) made is made again under the same name.
foreach(prefix LIBWEBP LIBWEBPMUX TURBOJPEG EPOXY IMGUI)
  set(target PkgConfig::${prefix})
  string(APPEND lodestone_find_${target}
         "\n  pkg_check_modules(${prefix} REQUIRED QUIET IMPORTED_TARGET ${lodestone_pkg_config_${target}})")
endforeach()

# Names of the targets of other packages that the library of a layer links.
function(lodestone_linked layer out)
  set(names)
  get_target_property(linked lodestone_${layer} LINK_LIBRARIES)
  get_target_property(interface lodestone_${layer} INTERFACE_LINK_LIBRARIES)
  foreach(library ${linked} ${interface})
    string(REGEX REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1" name "${library}")
    # "::@" marks what a subfolder linked to its parent's target.
    if(NOT library OR name MATCHES "^(lodestone::|::@)" OR name MATCHES "^(m|dl|rt|pthread)$" OR name MATCHES "BUILD_INTERFACE")
      continue()
    endif()
    if(NOT DEFINED lodestone_find_${name})
      message(FATAL_ERROR "lodestone::${layer} links ${name}: say in cmake/LodestoneDependencies.cmake which package "
                          "provides it")
    endif()
    list(APPEND names ${name})
  endforeach()
  list(REMOVE_DUPLICATES names)
  set(${out} "${names}" PARENT_SCOPE)
endfunction()

# The entries of the table for the targets that a layer links; KIND is find, pkg_config or debian.
function(lodestone_needs layer kind out)
  set(needs)
  lodestone_linked(${layer} names)
  foreach(name ${names})
    list(APPEND needs ${lodestone_${kind}_${name}})
  endforeach()
  list(REMOVE_DUPLICATES needs)
  set(${out} "${needs}" PARENT_SCOPE)
endfunction()
