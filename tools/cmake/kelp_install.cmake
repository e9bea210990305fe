# SPDX-License-Identifier: MIT
# Install and export: find_package(kelp) gives the runtime libraries, none of the baker's dependencies, and
# the programs where they are built. Components: `dev` (libraries, headers, the CMake package; needs `lib`),
# `tools` (the programs), `lib` (libkelp.so, for programs that were built with it), and `python` (kelp.py;
# needs `lib`).
include(CMakePackageConfigHelpers)
set(kelp_config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/kelp)
configure_package_config_file(${PROJECT_SOURCE_DIR}/tools/cmake/kelpConfig.cmake.in
  ${PROJECT_BINARY_DIR}/kelpConfig.cmake
  INSTALL_DESTINATION ${kelp_config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/kelpConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/kelpConfig.cmake ${PROJECT_BINARY_DIR}/kelpConfigVersion.cmake
  ${PROJECT_SOURCE_DIR}/tools/cmake/FindKelpGlm.cmake ${PROJECT_SOURCE_DIR}/tools/cmake/FindKelpZstd.cmake
  ${PROJECT_SOURCE_DIR}/tools/cmake/FindKelpXxhash.cmake ${PROJECT_SOURCE_DIR}/tools/cmake/kelp_add_pack.cmake
  DESTINATION ${kelp_config_dir} COMPONENT dev)
install(EXPORT kelpTargets NAMESPACE kelp:: DESTINATION ${kelp_config_dir} COMPONENT dev)
if(TARGET kelp_c)
  install(EXPORT kelpCTargets NAMESPACE kelp:: DESTINATION ${kelp_config_dir} COMPONENT dev)
endif()
if(KELP_BAKER OR KELP_TOOLS)
  install(EXPORT kelpToolTargets NAMESPACE kelp:: DESTINATION ${kelp_config_dir} COMPONENT tools)
endif()
# pkg-config: kelp-runtime for C++, kelp for C.
file(RELATIVE_PATH KELP_PC_PREFIX /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
string(REGEX REPLACE "/$" "" KELP_PC_PREFIX ${KELP_PC_PREFIX})
set(KELP_PC_CXX stdc++)
if("c++" IN_LIST CMAKE_CXX_IMPLICIT_LINK_LIBRARIES)
  set(KELP_PC_CXX c++)
endif()
set(pc_files runtime/kelp-runtime.pc)
if(TARGET kelp_c)
  list(APPEND pc_files runtime/c/kelp.pc)
endif()
foreach(file IN LISTS pc_files)
  configure_file(${PROJECT_SOURCE_DIR}/${file}.in ${PROJECT_BINARY_DIR}/${file} @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${file} DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
endforeach()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
# The documents that headers cite, in the folders of the sources, so that names and links lead there.
foreach(document formats/SPEC.md formats/README.md runtime/README.md runtime/HOST_GUIDE.md
  runtime/DRAW_DATA.md runtime/MISTAKES.md runtime/c/README.md runtime/draw/README.md
  runtime/gl/README.md shaders/README.md shaders/METHOD.md shaders/BINDINGS.md tools/rig/README.md
  tools/rig/LANGUAGE.md)
  cmake_path(GET document PARENT_PATH folder)
  install(FILES ${PROJECT_SOURCE_DIR}/${document} DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder}
    COMPONENT dev)
endforeach()
# The shaders for a host that draws by itself: translate.sh reads them.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/shaders/ DESTINATION ${CMAKE_INSTALL_DATADIR}/kelp/shaders
  COMPONENT dev USE_SOURCE_PERMISSIONS
  FILES_MATCHING PATTERN *.glsl PATTERN *.vert PATTERN *.frag PATTERN translate.sh PATTERN BINDINGS.md
  PATTERN reference EXCLUDE PATTERN include EXCLUDE)
install(FILES ${PROJECT_SOURCE_DIR}/samples/sdl_c/main.c
  DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples/sdl_c COMPONENT dev)
# A game that builds as it is: cmake -S share/doc/kelp/examples/game_loop
install(FILES ${PROJECT_SOURCE_DIR}/samples/game_loop/CMakeLists.txt
  ${PROJECT_SOURCE_DIR}/samples/game_loop/main.cpp
  DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples/game_loop COMPONENT dev)
if(PROJECT_IS_TOP_LEVEL)
  include(kelp_package)
endif()
