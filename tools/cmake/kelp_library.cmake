# SPDX-License-Identifier: MIT
# How kelp makes every library and program: C++20, warnings and floating point set per target, nothing global.
include_guard(GLOBAL)
option(KELP_WERROR "Treat warnings as errors" OFF)

# install(), if KELP_INSTALL is on.
function(kelp_install)
  if(KELP_INSTALL)
    install(${ARGV})
  endif()
endfunction()

function(kelp_target_defaults target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES
    CXX_EXTENSIONS OFF CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  if(MSVC)  # cl, and clang-cl
    target_compile_options(${target} PRIVATE /W4 /permissive- /utf-8 /Zc:__cplusplus /Gy
      $<$<BOOL:${KELP_WERROR}>:/WX> $<$<CXX_COMPILER_ID:Clang>:/clang:-ffp-contract=off>)
    target_compile_definitions(${target} PRIVATE _CRT_SECURE_NO_WARNINGS)
    return()
  endif()
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wnon-virtual-dtor
    -ffunction-sections -fdata-sections $<$<BOOL:${KELP_WERROR}>:-Werror>)
  # No contraction into fused multiply-add: the same input bakes to the same bytes on every machine.
  target_compile_options(${target} PRIVATE -ffp-contract=off)
  # A unity build compiles several sources as one. They see each other's names there, and are included by
  # another source, so -Wshadow and GCC's -Wsubobject-linkage warn of nothing real.
  set(unity $<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>)
  target_compile_options(${target} PRIVATE
    $<IF:${unity},$<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>,-Wshadow>)
  # GCC 12 warns wrongly at -O3 inside the standard library: of overlapping copies in "text" + std::string()
  # (GCC bug 105651), and of freeing the middle of a std::vector. GCC 13 does not, and keeps these warnings.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-Wno-restrict;-Wno-free-nonheap-object>)
  endif()
  # Releases are hardened as Debian does it: a stack or buffer that is overrun ends the program, indirect
  # jumps reach function entries only, and tables of addresses are read-only.
  if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
    set(ships $<CONFIG:Release,RelWithDebInfo,MinSizeRel>)
    set(x86_64 $<STREQUAL:${CMAKE_SYSTEM_PROCESSOR},x86_64>)
    target_compile_options(${target} PRIVATE
      $<${ships}:-fstack-protector-strong;-fstack-clash-protection;-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=2>
      $<$<AND:${ships},${x86_64}>:-fcf-protection>)
    get_target_property(type ${target} TYPE)
    if(type STREQUAL "EXECUTABLE")
      set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
      target_link_options(${target} PRIVATE $<${ships}:-pie;LINKER:-z,relro,-z,now,-z,noexecstack>)
    endif()
  endif()
endfunction()

function(kelp_no_exceptions target)
  if(MSVC)  # no warning of CMake's own flags, which these turn off, nor of the catch in standard headers
    target_compile_options(${target} PRIVATE /EHs-c- /GR- /wd9025 /wd4530)
  else()
    target_compile_options(${target} PRIVATE -fno-exceptions -fno-rtti)
  endif()
endfunction()

# kelp_add_library(NAME INCLUDE_DIR dir HEADERS ... SOURCES ... [DEPENDS public...] [DEPENDS_PRIVATE ...]
#                  [NO_EXCEPTIONS] [INSTALL])
# Makes the static library kelp_NAME with the alias kelp::NAME. Headers are relative to the current folder.
function(kelp_add_library name)
  cmake_parse_arguments(arg "NO_EXCEPTIONS;INSTALL" "INCLUDE_DIR" "HEADERS;SOURCES;DEPENDS;DEPENDS_PRIVATE"
    ${ARGN})
  set(target kelp_${name})
  add_library(${target} STATIC ${arg_SOURCES})
  add_library(kelp::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES
    EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON VERIFY_INTERFACE_HEADER_SETS ON)
  target_sources(${target} PUBLIC
    FILE_SET HEADERS BASE_DIRS "${CMAKE_CURRENT_SOURCE_DIR}/${arg_INCLUDE_DIR}" FILES ${arg_HEADERS})
  target_link_libraries(${target} PUBLIC ${arg_DEPENDS} PRIVATE ${arg_DEPENDS_PRIVATE})
  kelp_target_defaults(${target})
  if(arg_NO_EXCEPTIONS)
    kelp_no_exceptions(${target})
  endif()
  if(arg_INSTALL)
    kelp_install(TARGETS ${target} EXPORT kelpTargets
      ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev
      FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev)
  endif()
endfunction()

# The words that --version prints in brackets: the pack format that the program writes, the libraries in it
# (property KELP_FEATURES of the targets that it links), the compiler.
function(kelp_build_words result)
  file(STRINGS ${PROJECT_SOURCE_DIR}/formats/include/kelp/formats/pack.h lines
    REGEX "kFormat(Major|Minor) = [0-9]+")
  list(TRANSFORM lines REPLACE ".* = ([0-9]+);.*" "\\1")
  list(JOIN lines "." format)
  set(words "format ${format}")
  foreach(target IN LISTS ARGN)
    if(TARGET ${target})
      get_target_property(features ${target} KELP_FEATURES)
      if(features)
        list(JOIN features ", " features)
        string(APPEND words ", ${features}")
      endif()
    endif()
  endforeach()
  string(REPLACE GNU gcc compiler "${CMAKE_CXX_COMPILER_ID}")
  set(${result} "${words}, ${compiler} ${CMAKE_CXX_COMPILER_VERSION}" PARENT_SCOPE)
endfunction()

# kelp_add_tool(NAME SOURCES ... DEPENDS ... VERSION_IN source): an installed program, and the target
# kelp::NAME for builds that run it. VERSION_IN is the source that answers --version; it gets KELP_BUILD.
function(kelp_add_tool name)
  cmake_parse_arguments(arg "" "VERSION_IN" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  add_executable(kelp::${name} ALIAS ${name})
  kelp_build_words(build_words ${arg_DEPENDS})
  set_property(SOURCE ${arg_VERSION_IN} APPEND PROPERTY COMPILE_DEFINITIONS KELP_BUILD="${build_words}")
  target_link_libraries(${name} PRIVATE ${arg_DEPENDS})
  target_compile_definitions(${name} PRIVATE KELP_VERSION="${PROJECT_VERSION}")
  kelp_target_defaults(${name})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")
  kelp_install(TARGETS ${name} EXPORT kelpToolTargets
    RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tools)
endfunction()
