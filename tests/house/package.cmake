# Installs the package to a temporary prefix and builds and runs a consumer that knows nothing but that prefix.
set(package_folder ${CMAKE_CURRENT_BINARY_DIR}/package)
set(consumer_flags)
if(LODESTONE_SANITIZE)   # sanitized static libraries link only into a sanitized program
  set(consumer_flags -DCMAKE_CXX_FLAGS=-fsanitize=${LODESTONE_SANITIZE})
endif()

# package_step(NAME [AFTER step] COMMAND ...)
function(package_step name)
  cmake_parse_arguments(arg "" "AFTER" "COMMAND" ${ARGN})
  add_test(NAME package.${name} COMMAND ${arg_COMMAND})
  set_tests_properties(package.${name} PROPERTIES LABELS package TIMEOUT 300 FIXTURES_SETUP package_${name})
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
