# SPDX-License-Identifier: MIT
# Install and export: find_package(kelp) gives the runtime libraries, none of the baker's dependencies.
include(CMakePackageConfigHelpers)
set(kelp_config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/kelp)
configure_package_config_file(${PROJECT_SOURCE_DIR}/tools/cmake/kelpConfig.cmake.in ${PROJECT_BINARY_DIR}/kelpConfig.cmake
  INSTALL_DESTINATION ${kelp_config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/kelpConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/kelpConfig.cmake ${PROJECT_BINARY_DIR}/kelpConfigVersion.cmake
  ${PROJECT_SOURCE_DIR}/tools/cmake/FindKelpZstd.cmake ${PROJECT_SOURCE_DIR}/tools/cmake/FindKelpXxhash.cmake
  DESTINATION ${kelp_config_dir})
install(EXPORT kelpTargets NAMESPACE kelp:: DESTINATION ${kelp_config_dir})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/formats/SPEC.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
