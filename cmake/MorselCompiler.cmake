# SPDX-License-Identifier: Apache-2.0
# Compiler settings shared by every Morsel target; use morsel_target(NAME) on each.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

# A build without a type would be one without optimisation: far too slow to be of use.
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Release, Debug, RelWithDebInfo or MinSizeRel" FORCE)
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CCACHE_PROGRAM}")
endif()

add_library(morsel_options INTERFACE)
# No contraction: the rounding analysis of the local models counts one rounding an operation.
target_compile_options(morsel_options INTERFACE
  -Wall -Wextra -Wshadow $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor> -Wpedantic -ffp-contract=off -fno-math-errno
  # It takes every reference from a function that was also given a temporary for one to that temporary.
  $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<CXX_COMPILER_ID:GNU>,$<VERSION_GREATER_EQUAL:$<CXX_COMPILER_VERSION>,13>>:-Wno-dangling-reference>
  $<$<BOOL:${MORSEL_WARNINGS_AS_ERRORS}>:-Werror>)
# g++ 12's SLP vectoriser drops the rounding of a pair of doubles to float and back (`double(float(x))`
# becomes x), which breaks whatever must see the rounded value; test: Compiler.RoundTripThroughFloatRounds.
target_compile_options(morsel_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize>)
if(MORSEL_SANITIZE)
  target_compile_options(morsel_options INTERFACE -fsanitize=${MORSEL_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(morsel_options INTERFACE -fsanitize=${MORSEL_SANITIZE})
endif()
if(MORSEL_FUZZ)
  target_compile_options(morsel_options INTERFACE -fsanitize=fuzzer-no-link)
endif()

function(morsel_target name)
  target_link_libraries(${name} PRIVATE $<BUILD_INTERFACE:morsel_options>)
  get_target_property(kind ${name} TYPE)
  if(NOT kind STREQUAL "EXECUTABLE")
    target_include_directories(${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
  endif()
endfunction()
