# SPDX-License-Identifier: Apache-2.0
# What `cmake --install build/release --prefix DIR` puts where: the command, the scenes it can render,
# and the documents. Caches and pictures that stand beside the scenes stay behind.
if(TARGET morsel)
  install(TARGETS morsel RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
endif()
install(DIRECTORY "${PROJECT_SOURCE_DIR}/scenes/" DESTINATION "${CMAKE_INSTALL_DATADIR}/morsel/scenes"
        PATTERN "*.topo" EXCLUDE
        PATTERN "*.cache" EXCLUDE
        PATTERN "*.tmp" EXCLUDE
        PATTERN "pictures" EXCLUDE)
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" "${PROJECT_SOURCE_DIR}/CHANGELOG.md"
        DESTINATION "${CMAKE_INSTALL_DOCDIR}")
