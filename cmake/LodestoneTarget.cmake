# Compiler options of every target of the project, in one place.

if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
if(LODESTONE_ASSERTIONS)
  foreach(config RELEASE RELWITHDEBINFO)
    string(REPLACE "-DNDEBUG" "" CMAKE_CXX_FLAGS_${config} "${CMAKE_CXX_FLAGS_${config}}")
  endforeach()
endif()
find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # The cache serves precompiled headers only when told so; these hold no time of day.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE})
endif()

# Contraction is off everywhere: the crack-free guarantee compares distances and positions bit for bit, and a fused
# multiply-add in one place but not in the other would break it (docs/architecture.md). Users of the installed package
# get the flag, too: they compile the inline distance functions.
function(lodestone_properties target)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion)
  # Clang compares names with those of other files of a merged object, and warns of vectors that no library passes on.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:Clang>:-Wno-psabi>
                                           $<$<AND:$<CXX_COMPILER_ID:Clang>,$<BOOL:${LODESTONE_MERGE}>>:-Wno-shadow>)
  target_compile_options(${target} PUBLIC -ffp-contract=off)
  if(LODESTONE_SANITIZE)
    target_compile_options(${target} PUBLIC $<BUILD_INTERFACE:-fsanitize=${LODESTONE_SANITIZE}>
                                            $<BUILD_INTERFACE:-fno-omit-frame-pointer>
                                            $<BUILD_INTERFACE:-fno-sanitize=vptr>)
    target_link_options(${target} PUBLIC $<BUILD_INTERFACE:-fsanitize=${LODESTONE_SANITIZE}>)
  endif()
endfunction()

# One folder, one library: lodestone_core is lodestone::core, and so on; shared if BUILD_SHARED_LIBS is on.
function(lodestone_library name)
  add_library(lodestone_${name})
  add_library(lodestone::${name} ALIAS lodestone_${name})
  set_target_properties(lodestone_${name} PROPERTIES EXPORT_NAME ${name} DEFINE_SYMBOL "")
  target_include_directories(lodestone_${name} INTERFACE $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
                                                         $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  lodestone_properties(lodestone_${name})
endfunction()
