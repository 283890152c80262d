# `cpack` in the build folder makes lodestone_VERSION_ARCH.deb (the program), lodestone-dev_VERSION_ARCH.deb (the
# libraries), lodestone-mpi_VERSION_ARCH.deb and python3-lodestone_VERSION_ARCH.deb, of what is built. `cpack --config
# CPackSourceConfig.cmake` makes a tarball of what is committed.
set(CPACK_PACKAGE_NAME lodestone)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_VENDOR "The Lodestone authors")
set(CPACK_PACKAGE_CONTACT "The Lodestone authors <lodestone@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "level of detail of large triangle surfaces")
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL program development)
if(TARGET lodestone-mpi)
  list(APPEND CPACK_COMPONENTS_ALL distributed)
endif()
if(lodestone_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
if(NOT LODESTONE_EXPERIMENTS)
  set(CPACK_COMPONENTS_ALL development)
endif()

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME lodestone)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "python3, python3-jinja2, python3-matplotlib")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "command, manual and completions
 Builds and draws levels of detail of scans, terrains and CAD models without
 cracks between cells and without pops over time, and proves both for every
 frame. Progressive meshes, closed shells, seamless textures, web pages, and
 experiments over all parameters.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME lodestone-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS ${BUILD_SHARED_LIBS})
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "libraries and headers
 The libraries core, parallel, render and experiments of Lodestone, with
 files for find_package of CMake and for pkg-config.")
set(CPACK_DEBIAN_DISTRIBUTED_PACKAGE_NAME lodestone-mpi)
set(CPACK_DEBIAN_DISTRIBUTED_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_DISTRIBUTED_PACKAGE_RECOMMENDS "openmpi-bin")
set(CPACK_COMPONENT_DISTRIBUTED_DESCRIPTION "command for the processes of an MPI job
 Builds levels of detail by several machines, to the bytes of one, for models
 that do not fit its memory.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-lodestone)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Python package
 Levels of detail with numpy arrays in and out: build, select and morph, render,
 measure, reconstruct, progressive meshes, experiments and their rows.")
if(lodestone_python)
  # The module is of one minor version of Python, and needs it.
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${next_minor}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-pandas, python3-matplotlib, python3-jinja2")
endif()
# A program that links the libraries links their dependencies.
set(development_needs)
foreach(layer ${LODESTONE_LAYERS})
  lodestone_needs(${layer} debian needs)
  list(APPEND development_needs ${needs})
endforeach()
list(REMOVE_DUPLICATES development_needs)
list(JOIN development_needs ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS)

set(CPACK_SOURCE_GENERATOR TGZ)
set(CPACK_SOURCE_PACKAGE_FILE_NAME lodestone-${PROJECT_VERSION})
set(CPACK_SOURCE_INSTALLED_DIRECTORIES "${PROJECT_BINARY_DIR}/source;/")
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_CURRENT_LIST_DIR}/PackageFiles.cmake)
set(CPACK_LODESTONE_SOURCE ${PROJECT_SOURCE_DIR})
set(CPACK_LODESTONE_BINARY ${PROJECT_BINARY_DIR})
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/DebianFiles.cmake)
include(CPack)
