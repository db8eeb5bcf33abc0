# SPDX-License-Identifier: Apache-2.0
# What `cmake --install build/release --prefix DIR` puts where: the command, the scenes it can render,
# the C library with what other programs find it by, and the documents. Caches and pictures that stand
# beside the scenes stay behind.
# Components: program, and library, which the target `morsel` does not build.
include(CMakePackageConfigHelpers)

# Before anything is copied.
install(CODE "
if(NOT EXISTS \"$<TARGET_FILE:morsel_c>\")
  message(FATAL_ERROR \"$<TARGET_FILE:morsel_c> is not built. Build everything first (cmake --build ${PROJECT_BINARY_DIR}), \"
                      \"or install the program alone (cmake --install ${PROJECT_BINARY_DIR} --component program).\")
endif()" COMPONENT library)
if(TARGET morsel)
  install(TARGETS morsel RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT program)
  install(TARGETS morsel-render RUNTIME DESTINATION "${CMAKE_INSTALL_LIBEXECDIR}/morsel" COMPONENT program)
endif()
install(DIRECTORY "${PROJECT_SOURCE_DIR}/scenes/" DESTINATION "${CMAKE_INSTALL_DATADIR}/morsel/scenes"
        COMPONENT program
        PATTERN "*.topo" EXCLUDE
        PATTERN "*.cache" EXCLUDE
        PATTERN "*.tmp" EXCLUDE
        PATTERN "pictures" EXCLUDE)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs/" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program)
install(FILES "${PROJECT_SOURCE_DIR}/tools/man/morsel.1" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" COMPONENT program)
install(FILES "${PROJECT_SOURCE_DIR}/tools/completion/morsel.bash"
        DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" COMPONENT program RENAME morsel)
install(FILES "${PROJECT_SOURCE_DIR}/tools/completion/_morsel"
        DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions" COMPONENT program)
install(FILES "${PROJECT_SOURCE_DIR}/tools/completion/morsel.fish"
        DESTINATION "${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d" COMPONENT program)
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" "${PROJECT_SOURCE_DIR}/CHANGELOG.md"
        DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program)

# The C library.
# The version of Embree may be known as a whole only.
string(REGEX MATCH "^[0-9]+" embree_VERSION_MAJOR "${embree_VERSION}")
set(package_folder "${CMAKE_INSTALL_LIBDIR}/cmake/Morsel")
install(TARGETS morsel_c EXPORT MorselTargets LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT library
        NAMELINK_COMPONENT library)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/hypertexture_geom/include/" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
        COMPONENT library
        FILES_MATCHING PATTERN "*.h")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/hypertexture_geom/docs/" DESTINATION "${CMAKE_INSTALL_DOCDIR}/api" COMPONENT library)
install(EXPORT MorselTargets NAMESPACE Morsel:: DESTINATION "${package_folder}" COMPONENT library)
configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/MorselConfig.cmake.in"
                              "${PROJECT_BINARY_DIR}/MorselConfig.cmake"
                              INSTALL_DESTINATION "${package_folder}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/MorselConfigVersion.cmake"
                                 COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/MorselConfig.cmake" "${PROJECT_BINARY_DIR}/MorselConfigVersion.cmake"
        DESTINATION "${package_folder}" COMPONENT library)
configure_file("${PROJECT_SOURCE_DIR}/cmake/morsel.pc.in" "${PROJECT_BINARY_DIR}/morsel.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/morsel.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT library)
