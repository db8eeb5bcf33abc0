# SPDX-License-Identifier: Apache-2.0
# Every third-party package in one place. Debian 12 names; Debian 13 brings Embree 4.
find_package(Threads REQUIRED)
find_package(TBB CONFIG REQUIRED)
find_package(Imath 3 CONFIG REQUIRED)
find_package(OpenEXR 3 CONFIG REQUIRED)
find_package(OpenImageIO CONFIG REQUIRED)
find_package(nlohmann_json 3.11 CONFIG REQUIRED)
find_package(fmt CONFIG REQUIRED)
find_package(spdlog CONFIG REQUIRED)
find_package(CLI11 CONFIG REQUIRED)
find_package(assimp CONFIG REQUIRED)
find_package(TinyGLTF CONFIG REQUIRED)
find_package(hwy CONFIG REQUIRED)
find_package(Boost 1.74 REQUIRED)
find_package(Eigen3 3.4 CONFIG REQUIRED)
find_package(nanoflann CONFIG REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(xxhash REQUIRED IMPORTED_TARGET libxxhash)

# Optional: a denoised image layer. Neither Debian 12 nor Debian 13 packages it.
find_package(OpenImageDenoise CONFIG QUIET)

find_package(embree 4 CONFIG QUIET)
if(NOT embree_FOUND)
  find_package(embree 3.13 CONFIG REQUIRED)
endif()
message(STATUS "Embree ${embree_VERSION}")

# Debian's OpenImageIO lists include directories that are not there; generation fails on them.
foreach(target OpenImageIO::OpenImageIO OpenImageIO::OpenImageIO_Util)
  foreach(property INTERFACE_INCLUDE_DIRECTORIES INTERFACE_SYSTEM_INCLUDE_DIRECTORIES)
    get_target_property(directories ${target} ${property})
    if(directories)
      set(existing "")
      foreach(directory IN LISTS directories)
        if(EXISTS "${directory}")
          list(APPEND existing "${directory}")
        endif()
      endforeach()
      set_target_properties(${target} PROPERTIES ${property} "${existing}")
    endif()
  endforeach()
endforeach()

if(MORSEL_BUILD_TESTS)
  find_package(GTest CONFIG REQUIRED)
  find_package(benchmark CONFIG QUIET)  # libbenchmark-dev; benchmarks that are built on request only
endif()
