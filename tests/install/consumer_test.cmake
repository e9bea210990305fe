# SPDX-License-Identifier: MIT
# Installs this build, moves the installation elsewhere, and builds and runs a project that knows nothing but
# find_package(kelp).
include(${TEST_DIR}/steps.cmake)
file(REMOVE_RECURSE ${WORK_DIR})
file(MAKE_DIRECTORY ${WORK_DIR})

step("installing" ${CMAKE_COMMAND} --install ${KELP_BUILD_DIR} --prefix ${WORK_DIR}/first)
file(RENAME ${WORK_DIR}/first ${WORK_DIR}/prefix)  # a package must not remember where it was installed

# Neither the exported targets nor the headers may lead to anything but the runtime.
file(GLOB_RECURSE package_files ${WORK_DIR}/prefix/*.cmake)
list(LENGTH package_files count)
if(count LESS 3)
  message(FATAL_ERROR "the package's CMake files are not under ${WORK_DIR}/prefix")
endif()
foreach(file IN LISTS package_files)
  file(READ ${file} text)
  string(TOLOWER "${text}" text)
  foreach(word openvdb openmesh tinygltf draco tbb blosc boost imath hwy meshopt nlohmann ${KELP_SOURCE_DIR}
    ${KELP_BUILD_DIR})
    string(FIND "${text}" "${word}" at)
    if(NOT at EQUAL -1)
      message(FATAL_ERROR "${file} mentions ${word}: the installed runtime must not depend on it")
    endif()
  endforeach()
endforeach()
file(GLOB headers RELATIVE ${WORK_DIR}/prefix/include/kelp ${WORK_DIR}/prefix/include/kelp/*)
foreach(folder IN LISTS headers)
  if(NOT folder MATCHES "^(formats|runtime|gl|shaders|kelp\\.h)$")
    message(FATAL_ERROR "include/kelp/${folder} is installed, but is no part of the runtime")
  endif()
endforeach()

build(${TEST_DIR}/consumer ${WORK_DIR}/build "${BUILD_TYPE}" "${CXX_FLAGS}"
  -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
step("write_pack" ${WORK_DIR}/build/write_pack ${WORK_DIR}/cube.kelp)
step("draw" ${WORK_DIR}/build/draw ${WORK_DIR}/cube.kelp)
string(STRIP "${step_output}" drawn)
step("triangle" ${WORK_DIR}/build/triangle)
file(READ ${WORK_DIR}/cube.kelp head LIMIT 12 HEX)

# The game of README.md: its CMakeLists.txt, word for word, with samples/game_loop against this installation.
if(HAS_GLFW)
  file(READ ${KELP_SOURCE_DIR}/README.md readme)
  set(lists "")
  foreach(begins "cmake_minimum_required" "kelp_add_pack")  # its two blocks of CMake; the second one bakes
    string(FIND "${readme}" "```cmake\n${begins}" begin)
    if(begin EQUAL -1)
      message(FATAL_ERROR "README.md has no block of CMake that begins with ${begins}")
    endif()
    math(EXPR begin "${begin} + 9")
    string(SUBSTRING "${readme}" ${begin} -1 block)
    string(FIND "${block}" "```" end)
    string(SUBSTRING "${block}" 0 ${end} block)
    if(begins STREQUAL "cmake_minimum_required" OR HAS_BAKER)
      string(APPEND lists "${block}")
    endif()
  endforeach()
  file(WRITE ${WORK_DIR}/game/CMakeLists.txt "${lists}")
  file(COPY ${KELP_SOURCE_DIR}/samples/game_loop/main.cpp DESTINATION ${WORK_DIR}/game)
  file(COPY_FILE ${KELP_SOURCE_DIR}/tests/fuzz/seeds/gltf/materials.glb ${WORK_DIR}/game/orange.glb)
  build(${WORK_DIR}/game ${WORK_DIR}/game/build "${BUILD_TYPE}" "${CXX_FLAGS}"
    -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
  if(HAS_BAKER)
    step("the game of README.md" bash ${TEST_DIR}/../samples/with_display.sh ${WORK_DIR}/game/build/game
      ${WORK_DIR}/game/build/orange.kelp --frames 1 ${WORK_DIR}/game.ppm)
  endif()
endif()
message(STATUS "the consumer drew its pack: ${drawn}; file begins ${head}")
