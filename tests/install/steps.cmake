# SPDX-License-Identifier: MIT
# Steps of both tests: run a step and stop with its output when it fails; configure and build a project.

# step(WHAT COMMAND...): the command's output is left in step_output.
function(step what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(NOTICE "${output}")  # unwrapped, unlike an error's text
    message(FATAL_ERROR "${what} failed: ${result}")
  endif()
  set(step_output "${output}" PARENT_SCOPE)
endfunction()

# build(SOURCE_DIR BINARY_DIR BUILD_TYPE FLAGS [cache entries...])
function(build source_dir binary_dir build_type flags)
  string(TOUPPER "${build_type}" type)
  step("configuring ${source_dir}" ${CMAKE_COMMAND} -S ${source_dir} -B ${binary_dir} -G ${GENERATOR}
    -DCMAKE_BUILD_TYPE=${build_type} -DCMAKE_CXX_COMPILER=${CXX_COMPILER}
    -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_CXX_FLAGS=
    "-DCMAKE_CXX_FLAGS_${type}=${flags}" ${ARGN})
  step("building ${source_dir}" ${CMAKE_COMMAND} --build ${binary_dir} --parallel 2)
endfunction()
