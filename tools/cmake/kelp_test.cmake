# SPDX-License-Identifier: MIT
include_guard(GLOBAL)
find_package(GTest REQUIRED)
include(GoogleTest)

# The tests of code that reads untrusted bytes: the target that builds them, and their label in ctest. Preset
# asan builds and runs these alone.
add_custom_target(untrusted)

# kelp_untrusted(TEST... [NEEDS target...]): gives tests of scripts that label.
function(kelp_untrusted)
  cmake_parse_arguments(arg "" "" "NEEDS" ${ARGN})
  set_property(TEST ${arg_UNPARSED_ARGUMENTS} APPEND PROPERTY LABELS untrusted)
  if(arg_NEEDS)
    add_dependencies(untrusted ${arg_NEEDS})
  endif()
endfunction()

# kelp_add_test(NAME SOURCES ... DEPENDS ... [RUNS program...] [LABELS ...] [ENVIRONMENT name=value] [DRIVES]
#               [UNTRUSTED filter]): one GoogleTest program, every case a ctest entry.
# RUNS: programs of this build whose paths its sources know, kelp-dump's as KELP_DUMP.
# UNTRUSTED: the cases that read untrusted bytes, as GoogleTest's --gtest_filter: "A.*:B.*", "*-A.*:B.*" (all
# but these) or "*".
# DRIVES: it computes little itself, so it is not optimized: that would take longer than it gains.
# Built for another system, a program is one entry, because its emulator takes longer to start than most cases
# to run; KELP_TEST_ARGUMENTS (preset web) leaves out what cannot run there: cases that start threads.
function(kelp_add_test name)
  cmake_parse_arguments(arg "DRIVES" "ENVIRONMENT;UNTRUSTED" "SOURCES;DEPENDS;RUNS;LABELS" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ${arg_DEPENDS} kelp_test_support GTest::gtest_main)
  kelp_target_defaults(${name})
  if(arg_DRIVES)
    target_compile_options(${name} PRIVATE -O0 -U_FORTIFY_SOURCE)
  endif()
  foreach(program IN LISTS arg_RUNS)
    string(MAKE_C_IDENTIFIER "${program}" macro)
    string(TOUPPER "${macro}" macro)
    target_compile_definitions(${name} PRIVATE ${macro}="$<TARGET_FILE:${program}>")
    add_dependencies(${name} ${program})
  endforeach()
  set(properties TIMEOUT 900)
  if(arg_ENVIRONMENT)
    list(APPEND properties ENVIRONMENT "${arg_ENVIRONMENT}")
  endif()
  set(labels)
  if(arg_LABELS)
    set(labels LABELS "${arg_LABELS}")
  endif()
  if(CMAKE_CROSSCOMPILING)
    add_test(NAME ${name} COMMAND ${name} ${KELP_TEST_ARGUMENTS})
    set_tests_properties(${name} PROPERTIES ${properties} ${labels})
    return()
  endif()
  if(arg_UNTRUSTED)
    add_dependencies(untrusted ${name})
    gtest_discover_tests(${name} TEST_FILTER "${arg_UNTRUSTED}" DISCOVERY_TIMEOUT 60
      PROPERTIES ${properties} LABELS untrusted)
  endif()
  if(NOT arg_UNTRUSTED STREQUAL "*")
    string(REPLACE "-*-" "" others "-${arg_UNTRUSTED}")
    gtest_discover_tests(${name} TEST_FILTER "${others}" DISCOVERY_TIMEOUT 60
      PROPERTIES ${properties} ${labels})
  endif()
endfunction()

# kelp_numpy_python(OUT): a Python that has NumPy, for kelp.py: the one that CMake finds, or Debian's own
# (python3-numpy); empty if neither has.
function(kelp_numpy_python out)
  find_package(Python3 QUIET COMPONENTS Interpreter)
  foreach(python ${Python3_EXECUTABLE} /usr/bin/python3)
    execute_process(COMMAND ${python} -c "import numpy" RESULT_VARIABLE absent OUTPUT_QUIET ERROR_QUIET)
    if(absent EQUAL 0)
      set(${out} ${python} PARENT_SCOPE)
      return()
    endif()
  endforeach()
  set(${out} "" PARENT_SCOPE)
endfunction()
