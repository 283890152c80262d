# `cmake --install` gives four components. `program`: the command with its manual, its completions, the report's package
# and the web page. `development`: a package that find_package(lodestone) and pkg-config use, with targets
# lodestone::runtime, ::core, ::parallel, ::render and ::experiments, each with its own dependencies alone, and the
# public headers below include/lodestone. `distributed`, where MPI is found: lodestone-mpi, and its script for Slurm.
# `python`, where it is built: lodestone and lodestone_report, for Python (python/CMakeLists.txt).
include(CMakePackageConfigHelpers)
include(LodestoneDependencies)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/lodestone)
set(LODESTONE_LAYERS runtime ${public_layers})

# The libraries of a layer, its headers, and files that find them.
file(RELATIVE_PATH LODESTONE_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)   # an installed tree may be moved
set(LODESTONE_NEEDS)
set(before)
foreach(layer ${LODESTONE_LAYERS})
  install(TARGETS lodestone_${layer} EXPORT lodestone_${layer} COMPONENT development
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT lodestone_${layer} FILE lodestone_${layer}.cmake NAMESPACE lodestone:: DESTINATION ${package_folder}
          COMPONENT development)

  lodestone_needs(${layer} find needs)
  list(JOIN needs "\n  " lines)
  string(APPEND LODESTONE_NEEDS "\nif(${layer} IN_LIST lodestone_layers)\n  ${lines}\n"
                                "  include(\"\${CMAKE_CURRENT_LIST_DIR}/lodestone_${layer}.cmake\")\n"
                                "  set(lodestone_${layer}_FOUND TRUE)\nendif()\n")

  lodestone_needs(${layer} pkg_config needs)
  set(LODESTONE_LAYER ${layer})
  set(LODESTONE_FLAGS ${needs})
  list(FILTER LODESTONE_FLAGS INCLUDE REGEX "^-")
  list(FILTER needs EXCLUDE REGEX "^-")
  list(JOIN LODESTONE_FLAGS " " LODESTONE_FLAGS)
  list(JOIN needs " " LODESTONE_REQUIRES)
  string(PREPEND LODESTONE_REQUIRES "${before} ")
  configure_file(${CMAKE_CURRENT_LIST_DIR}/lodestone.pc.in ${PROJECT_BINARY_DIR}/lodestone-${layer}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/lodestone-${layer}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
          COMPONENT development)
  if(NOT layer STREQUAL runtime)   # which no other stands on
    set(before lodestone-${layer})
  endif()
endforeach()

install(DIRECTORY ${LODESTONE_INCLUDE_DIR}/lodestone DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/lodestoneConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/lodestoneConfig.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/lodestoneConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/lodestoneConfig.cmake ${PROJECT_BINARY_DIR}/lodestoneConfigVersion.cmake
        DESTINATION ${package_folder} COMPONENT development)

if(LODESTONE_EXPERIMENTS)
  install(TARGETS lodestone RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
  install(DIRECTORY python/lodestone_report DESTINATION ${CMAKE_INSTALL_DATADIR}/lodestone/python COMPONENT program
          PATTERN __pycache__ EXCLUDE)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/page DESTINATION ${CMAKE_INSTALL_DATADIR}/lodestone COMPONENT program OPTIONAL)
  # The program itself writes its manual and its completions.
  install(SCRIPT ${CMAKE_CURRENT_LIST_DIR}/InstallManual.cmake COMPONENT program)
  install(CODE "lodestone_install_manual(\"$<TARGET_FILE:lodestone>\" \"${CMAKE_INSTALL_MANDIR}\" \"${CMAKE_INSTALL_DATADIR}\")"
          COMPONENT program)
endif()
if(TARGET lodestone-mpi)
  install(TARGETS lodestone-mpi RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT distributed)
  install(FILES experiments/cluster/lodestone-mpi.sbatch DESTINATION ${CMAKE_INSTALL_DATADIR}/lodestone COMPONENT distributed)
endif()
install(FILES README.md CHANGELOG.md NOTICE.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
