# SPDX-License-Identifier: MIT
include_guard(GLOBAL)
find_package(GTest REQUIRED)
include(GoogleTest)

# kelp_add_test(NAME SOURCES ... DEPENDS ... [LABELS ...] [ENVIRONMENT name=value] [DRIVES]): one GoogleTest
# program, every case a ctest entry. One that DRIVES another program computes nothing itself, so it is not
# optimised: that would take longer than it runs. Built for another system, a program is one entry, because
# its emulator takes longer to start than most cases to run. KELP_TEST_ARGUMENTS (preset web) leaves out what
# cannot run there: cases that start threads of their own. Tests that need the shared assets use
# tests/support/assets.h, which skips (and says so) where they are absent.
function(kelp_add_test name)
  cmake_parse_arguments(arg "DRIVES" "ENVIRONMENT" "SOURCES;DEPENDS;LABELS" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ${arg_DEPENDS} kelp_test_support GTest::gtest_main)
  kelp_target_defaults(${name})
  if(arg_DRIVES)
    target_compile_options(${name} PRIVATE -O0 -U_FORTIFY_SOURCE)
  endif()
  set(properties TIMEOUT 900)
  if(arg_LABELS)
    list(APPEND properties LABELS "${arg_LABELS}")
  endif()
  if(arg_ENVIRONMENT)
    list(APPEND properties ENVIRONMENT "${arg_ENVIRONMENT}")
  endif()
  if("once" IN_LIST arg_LABELS AND CMAKE_CXX_FLAGS_DEV MATCHES "-fsanitize")  # not run, so not built
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
  elseif(CMAKE_CROSSCOMPILING)
    add_test(NAME ${name} COMMAND ${name} ${KELP_TEST_ARGUMENTS})
    set_tests_properties(${name} PROPERTIES ${properties})
  else()
    gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES ${properties})
  endif()
endfunction()
