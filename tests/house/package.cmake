# Installs the package to a temporary prefix and builds and runs consumers that know nothing but that prefix, by CMake, by
# pkg-config, and by components, examples/ among them; takes the sources into another project; makes and unpacks the
# packages of cpack.
set(package_folder ${CMAKE_CURRENT_BINARY_DIR}/package)
set(consumer_flags)
if(LODESTONE_SANITIZE)   # sanitized static libraries link only into a sanitized program
  set(consumer_flags -DCMAKE_CXX_FLAGS=-fsanitize=${LODESTONE_SANITIZE})
endif()

# package_step(NAME [AFTER step] [SAYS text] COMMAND ...)
function(package_step name)
  cmake_parse_arguments(arg "" "AFTER;SAYS" "COMMAND" ${ARGN})
  add_test(NAME package.${name} COMMAND ${arg_COMMAND})
  set_tests_properties(package.${name} PROPERTIES LABELS package TIMEOUT 300 COST 60 FIXTURES_SETUP package_${name})
  if(arg_SAYS)
    set_tests_properties(package.${name} PROPERTIES PASS_REGULAR_EXPRESSION "${arg_SAYS}")
  endif()
  if(arg_AFTER)
    set_tests_properties(package.${name} PROPERTIES FIXTURES_REQUIRED package_${arg_AFTER})
  endif()
endfunction()

package_step(clean COMMAND ${CMAKE_COMMAND} -E rm -rf ${package_folder})
package_step(install AFTER clean COMMAND ${CMAKE_COMMAND} --install ${CMAKE_BINARY_DIR} --prefix ${package_folder}/prefix)
package_step(configure AFTER install
             COMMAND ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_SOURCE_DIR}/consumer -B ${package_folder}/build
                     -G ${CMAKE_GENERATOR} -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH=${package_folder}/prefix
                     -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER} ${consumer_flags})
package_step(build AFTER configure COMMAND ${CMAKE_COMMAND} --build ${package_folder}/build)
package_step(run AFTER build COMMAND ${package_folder}/build/consumer)
# The installed program finds the installed package of the report, not that of the sources.
package_step(report AFTER install
             COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/tests/commands/test_installed_report.py
                     ${package_folder}/prefix/${CMAKE_INSTALL_BINDIR}/lodestone)

# One layer, on a machine that lacks what the others need.
set(configure_consumer ${CMAKE_COMMAND} -G ${CMAKE_GENERATOR} -DCMAKE_BUILD_TYPE=Release
                       "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG" ${consumer_flags}
                       -DCMAKE_PREFIX_PATH=${package_folder}/prefix -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER})
set(without)
foreach(other TBB OpenEXR glfw3 fmt OpenSSL CLI11)
  list(APPEND without -DCMAKE_DISABLE_FIND_PACKAGE_${other}=ON)
endforeach()
package_step(core AFTER install COMMAND ${configure_consumer} -DLAYER=core ${without} -B ${package_folder}/core
                                        -S ${CMAKE_CURRENT_SOURCE_DIR}/component)
package_step(core_build AFTER core COMMAND ${CMAKE_COMMAND} --build ${package_folder}/core)
package_step(core_run AFTER core_build COMMAND ${package_folder}/core/component)
package_step(no_layer AFTER install SAYS "no component engine"
             COMMAND ${configure_consumer} -DLAYER=engine -B ${package_folder}/no_layer
                     -S ${CMAKE_CURRENT_SOURCE_DIR}/component)
package_step(no_dependency AFTER install SAYS "for module TBB"
             COMMAND ${configure_consumer} -DLAYER=parallel ${without} -B ${package_folder}/no_dependency
                     -S ${CMAKE_CURRENT_SOURCE_DIR}/component)

# The examples for engines, where nothing that builds or draws can be found.
package_step(examples AFTER install COMMAND ${configure_consumer} ${without} -DCMAKE_DISABLE_FIND_PACKAGE_glfw3=OFF
                                            -B ${package_folder}/examples -S ${PROJECT_SOURCE_DIR}/examples/runtime)
package_step(examples_build AFTER examples COMMAND ${CMAKE_COMMAND} --build ${package_folder}/examples)
package_step(examples_model AFTER examples_build
  COMMAND sh -ec "$1 generate sphere --triangles 100000 -o $2.ply --quiet && $1 build $2.ply -o $2.lode --quiet"
          sh $<TARGET_FILE:lodestone> ${package_folder}/examples/sphere)
set(sphere ${package_folder}/examples/sphere.lode)
package_step(examples_fly AFTER examples_model COMMAND ${package_folder}/examples/fly ${sphere})
package_step(examples_stream AFTER examples_model COMMAND ${package_folder}/examples/stream ${sphere} 1)

# Programs of one idea each, and the command with parts of one's own.
foreach(kind library extending)
  package_step(${kind} AFTER install COMMAND ${configure_consumer} -B ${package_folder}/${kind}
                                             -S ${PROJECT_SOURCE_DIR}/examples/${kind})
  package_step(${kind}_build AFTER ${kind} COMMAND ${CMAKE_COMMAND} --build ${package_folder}/${kind})
endforeach()
package_step(library_run AFTER library_build
             COMMAND ${Python3_EXECUTABLE} -B ${CMAKE_CURRENT_SOURCE_DIR}/test_examples.py ${package_folder}/library Library)
package_step(extending_run AFTER extending_build
             COMMAND ${Python3_EXECUTABLE} -B ${CMAKE_CURRENT_SOURCE_DIR}/test_examples.py ${package_folder}/extending Extending)

find_program(XVFB_RUN xvfb-run)
if(XVFB_RUN AND NOT LODESTONE_SANITIZE)
  package_step(examples_window AFTER examples_model SAYS "the last frame is [1-9]"
               COMMAND ${XVFB_RUN} -a -s "-screen 0 1280x1024x24" ${package_folder}/examples/window ${sphere} 3)
endif()

# The same consumer without CMake.
find_program(PKG_CONFIG_PROGRAM pkg-config)
if(PKG_CONFIG_PROGRAM AND NOT LODESTONE_SANITIZE)
  package_step(pkg_config AFTER install
    COMMAND sh -c "${CMAKE_CXX_COMPILER} -O1 $2 $(PKG_CONFIG_PATH=$1 pkg-config --cflags --libs lodestone-render) -o $3 && $3" sh
            ${package_folder}/prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig ${CMAKE_CURRENT_SOURCE_DIR}/consumer/main.cpp
            ${package_folder}/by_pkg_config)
endif()

# Within another project: no warning, and nothing to install.
package_step(embedded AFTER clean
  COMMAND sh -c "! ($1 -S $2 -B $3 -DLODESTONE_SOURCE=$4 2>&1 >/dev/null | grep .) && $1 --install $3 --prefix $3/prefix && test ! -e $3/prefix"
          sh ${CMAKE_COMMAND} ${CMAKE_CURRENT_SOURCE_DIR}/embedded ${package_folder}/embedded ${PROJECT_SOURCE_DIR})
# The libraries alone, where what the command needs is missing.
package_step(without_experiments AFTER clean
  COMMAND ${CMAKE_COMMAND} -G ${CMAKE_GENERATOR} -S ${PROJECT_SOURCE_DIR} -B ${package_folder}/libraries
          -DLODESTONE_EXPERIMENTS=OFF -DCMAKE_DISABLE_FIND_PACKAGE_CLI11=ON -DCMAKE_DISABLE_FIND_PACKAGE_fmt=ON
          -DCMAKE_DISABLE_FIND_PACKAGE_OpenSSL=ON -DCMAKE_DISABLE_FIND_PACKAGE_GTest=ON)

# The packages of cpack, unpacked and run.
find_program(DPKG_DEB dpkg-deb)
if(DPKG_DEB AND NOT LODESTONE_SANITIZE AND NOT BUILD_SHARED_LIBS)
  package_step(debian AFTER clean COMMAND ${CMAKE_CPACK_COMMAND} -G DEB -B ${package_folder}/packages
                                          --config ${PROJECT_BINARY_DIR}/CPackConfig.cmake)
  package_step(debian_run AFTER debian COMMAND ${Python3_EXECUTABLE} -B ${CMAKE_CURRENT_SOURCE_DIR}/test_packages.py
                                               ${package_folder}/packages ${PROJECT_VERSION})
  package_step(source AFTER clean COMMAND ${CMAKE_CPACK_COMMAND} -B ${package_folder}/source
                                          --config ${PROJECT_BINARY_DIR}/CPackSourceConfig.cmake)
  package_step(source_unpack AFTER source
    COMMAND ${CMAKE_COMMAND} -E chdir ${package_folder}/source ${CMAKE_COMMAND} -E tar xf lodestone-${PROJECT_VERSION}.tar.gz)
  package_step(source_configure AFTER source_unpack
    COMMAND ${CMAKE_COMMAND} --preset release -S ${package_folder}/source/lodestone-${PROJECT_VERSION})
endif()
