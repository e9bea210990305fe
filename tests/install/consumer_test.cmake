# SPDX-License-Identifier: MIT
# Installs this build, moves the installation elsewhere, and builds and runs a project that knows nothing but
# find_package(kelp).
include(${TEST_DIR}/steps.cmake)
include(${TEST_DIR}/copies.cmake)
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
  if(NOT folder MATCHES "^(formats|runtime|draw|gl|shaders|c|kelp\\.h|kelp\\.hpp)$")
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

# A project in C alone, and the same by pkg-config, shared and static. A sanitizer's runtime is not for it.
if(C_COMPILER AND NOT CXX_FLAGS MATCHES "-fsanitize")
  set(c_consumer ${TEST_DIR}/consumer_c)
  step("configuring ${c_consumer}" ${CMAKE_COMMAND} -S ${c_consumer} -B ${WORK_DIR}/c -G ${GENERATOR}
    -DCMAKE_C_COMPILER=${C_COMPILER} -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
  step("building ${c_consumer}" ${CMAKE_COMMAND} --build ${WORK_DIR}/c)
  step("ask" ${WORK_DIR}/c/ask ${WORK_DIR}/cube.kelp)
  step("pkg-config" bash ${c_consumer}/pkg_config.sh ${C_COMPILER} ${WORK_DIR}/prefix ${WORK_DIR}/cube.kelp)
  step("pkg-config for C++" bash ${TEST_DIR}/host/pkg_config.sh ${CXX_COMPILER} ${WORK_DIR}/prefix
    ${WORK_DIR}/cube.kelp)
endif()

# The package takes the targets of a project that has them, and does not search then.
make_copies(${WORK_DIR}/copies)
build(${TEST_DIR}/host ${WORK_DIR}/host "${BUILD_TYPE}" "${CXX_FLAGS}" -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix
  -DKELP_FROM=installed -DDEPENDENCIES=own -DCOPIES=${WORK_DIR}/copies -DZSTD_LIBRARY=${ZSTD_LIBRARY}
  -DCMAKE_DISABLE_FIND_PACKAGE_glm=ON)
step("host" ${WORK_DIR}/host/host ${WORK_DIR}/cube.kelp)

# shaders/translate.sh reads what lies beside it (shaders.vulkan runs it): here lies the same.
file(GLOB shaders RELATIVE ${KELP_SOURCE_DIR}/shaders ${KELP_SOURCE_DIR}/shaders/*.glsl
  ${KELP_SOURCE_DIR}/shaders/*.vert ${KELP_SOURCE_DIR}/shaders/*.frag)
foreach(file IN LISTS shaders ITEMS translate.sh)
  step("comparing ${file}" ${CMAKE_COMMAND} -E compare_files ${KELP_SOURCE_DIR}/shaders/${file}
    ${WORK_DIR}/prefix/share/kelp/shaders/${file})
endforeach()
step("the installed translate.sh" ${WORK_DIR}/prefix/share/kelp/shaders/translate.sh --help)
if(PYTHON)
  step("checking the headers" ${PYTHON} -B ${TEST_DIR}/check_installed.py ${WORK_DIR}/prefix ${CXX_COMPILER})
endif()
if(NUMPY_PYTHON AND NOT CXX_FLAGS MATCHES "-fsanitize")
  step("kelp.py" ${CMAKE_COMMAND} -E env PYTHONPATH=${WORK_DIR}/prefix/lib/python3/dist-packages
    ${NUMPY_PYTHON} -B ${KELP_SOURCE_DIR}/samples/python/picture.py ${WORK_DIR}/cube.kelp
    ${WORK_DIR}/cube.png)
endif()
if(HAS_VIEW)
  step("kelp-view" ${WORK_DIR}/prefix/bin/kelp-view --version)
endif()

# The installed example as it is; then with the lines of CMake in samples/README.md, which bake.
file(COPY ${WORK_DIR}/prefix/share/doc/kelp/examples/game_loop DESTINATION ${WORK_DIR})
if(HAS_GLFW)
  build(${WORK_DIR}/game_loop ${WORK_DIR}/game_loop/build "${BUILD_TYPE}" "${CXX_FLAGS}"
    -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
  step("the installed example" bash ${TEST_DIR}/../samples/with_display.sh ${WORK_DIR}/game_loop/build/game
    ${WORK_DIR}/cube.kelp --frames 1 ${WORK_DIR}/game.ppm)
endif()
if(HAS_GLFW AND HAS_BAKER)
  file(READ ${KELP_SOURCE_DIR}/samples/README.md readme)
  if(NOT readme MATCHES "```cmake\n(kelp_add_pack[^`]*)```")
    message(FATAL_ERROR "samples/README.md has no block of CMake that begins with kelp_add_pack")
  endif()
  file(APPEND ${WORK_DIR}/game_loop/CMakeLists.txt "${CMAKE_MATCH_1}")
  file(COPY_FILE ${KELP_SOURCE_DIR}/tests/fuzz/seeds/gltf/materials.glb ${WORK_DIR}/game_loop/orange.glb)
  step("building with a pack" ${CMAKE_COMMAND} --build ${WORK_DIR}/game_loop/build)
  step("the game of samples/README.md" bash ${TEST_DIR}/../samples/with_display.sh
    ${WORK_DIR}/game_loop/build/game ${WORK_DIR}/game_loop/build/orange.kelp --frames 1 ${WORK_DIR}/game.ppm)
endif()
message(STATUS "the consumer drew its pack: ${drawn}; file begins ${head}")
