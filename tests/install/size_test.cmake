# SPDX-License-Identifier: MIT
# The size that linking kelp adds to a stripped program, zstd included: the consumer's draw against its
# triangle, which is the same without kelp.
include(${TEST_DIR}/steps.cmake)
set(limit 1048576)
file(MAKE_DIRECTORY ${WORK_DIR})
file(REMOVE_RECURSE ${WORK_DIR}/prefix)  # the rest is kept, so that a second run has little to build

build(${KELP_SOURCE_DIR} ${WORK_DIR}/kelp Release "-O2 -DNDEBUG"
  -DKELP_BAKER=OFF -DKELP_TOOLS=OFF -DKELP_SAMPLES=OFF -DKELP_TESTS=OFF)
step("installing" ${CMAKE_COMMAND} --install ${WORK_DIR}/kelp --prefix ${WORK_DIR}/prefix)
build(${TEST_DIR}/consumer ${WORK_DIR}/consumer Release "-O2 -DNDEBUG -ffunction-sections -fdata-sections"
  -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix
  "-DCMAKE_EXE_LINKER_FLAGS=-static-libstdc++ -static-libgcc -Wl,--gc-sections")

foreach(program draw triangle)
  step("stripping" ${STRIP} -o ${WORK_DIR}/${program}.stripped ${WORK_DIR}/consumer/${program})
  file(SIZE ${WORK_DIR}/${program}.stripped ${program}_size)
endforeach()
math(EXPR added "${draw_size} - ${triangle_size}")

# Were zstd a shared library, its size would be missing from the sum.
step("reading draw's libraries" ldd ${WORK_DIR}/draw.stripped)
if(step_output MATCHES "zstd|stdc\\+\\+")
  message(FATAL_ERROR "draw is not static, so its size says nothing: ${step_output}")
endif()

math(EXPR kib "${added} / 1024")
message(STATUS "kelp adds ${added} bytes (${kib} KiB) to a stripped program: ${draw_size} against "
  "${triangle_size}; at most ${limit}")
if(added GREATER limit)
  message(FATAL_ERROR "kelp adds ${added} bytes, more than ${limit}")
endif()
if(added LESS 65536)
  message(FATAL_ERROR "kelp adds only ${added} bytes: the measurement is wrong")
endif()
