# SPDX-License-Identifier: MIT
# The Debian packages of this build: what they hold and need, and that they work, unpacked into a folder (no
# rights needed; tests/ports.sh debian installs them into a fresh Debian).
include(${TEST_DIR}/steps.cmake)
file(REMOVE_RECURSE ${WORK_DIR})
file(MAKE_DIRECTORY ${WORK_DIR})
step("packing" ${CMAKE_CPACK_COMMAND} --config ${KELP_BUILD_DIR}/CPackConfig.cmake -B ${WORK_DIR}/packages)

# expect(TEXT PATTERN...): each pattern is somewhere in the text.
function(expect text)
  foreach(pattern IN LISTS ARGN)
    if(NOT text MATCHES "${pattern}")
      message(NOTICE "${text}")
      message(FATAL_ERROR "the package lacks '${pattern}'")
    endif()
  endforeach()
endfunction()

foreach(package kelp-tools libkelp-dev libkelp0 python3-kelp)
  file(GLOB deb ${WORK_DIR}/packages/${package}_*.deb)
  step("reading ${package}" ${DPKG_DEB} --info ${deb})
  set(${package}_info "${step_output}")
  expect("${step_output}" "Maintainer: .+ <.+@.+>" "Version: [0-9.]+-1\n"
    "Description: voxel models that bend - ")
  step("listing ${package}" ${DPKG_DEB} --contents ${deb})
  set(${package}_files "${step_output}")
  expect("${step_output}" "root/root.*/doc/${package}/copyright" "/doc/${package}/changelog.gz")
  step("unpacking ${package}" ${DPKG_DEB} --extract ${deb} ${WORK_DIR}/root)
  file(READ ${WORK_DIR}/root/usr/share/doc/${package}/copyright copyright)
  expect("${copyright}" "The kelp authors.*Permission is hereby granted")
  if(NOT package STREQUAL "python3-kelp")
    expect("${copyright}" "libxxhash-dev")
  endif()
endforeach()
expect("${kelp-tools_info}" "Depends: .*libc6 .*libfmt.*libstdc[+][+]6")
expect("${kelp-tools_files}" "bin/kelp-dump" "kelpToolTargets.cmake")
if(HAS_MANUAL)
  expect("${kelp-tools_files}" "man/man1/kelp-dump.1.gz" "completions/kelp-dump\n" "zsh/.*/_kelp-dump\n"
    "vendor_completions.d/kelp-dump.fish")
endif()
if(HAS_VIEW)
  expect("${kelp-tools_files}" "bin/kelp-view" "applications/kelp-view.desktop" "mime/packages/kelp.xml"
    "scalable/apps/kelp-view.svg")
  expect("${kelp-tools_info}" "Depends: .*libglfw3")
endif()
expect("${libkelp-dev_info}" "Depends: libglm-dev, libzstd-dev, libxxhash-dev" "Recommends: kelp-tools")
expect("${libkelp-dev_files}" "libkelp_runtime_draw.a" "libkelp_runtime_gl.a" "kelp/gl/renderer.h"
  "kelp/draw/planner.h" "kelpConfig.cmake"
  "kelp_add_pack.cmake")
expect("${libkelp-dev_files}" "kelp/kelp.h\n" "kelpCTargets.cmake" "pkgconfig/kelp.pc"
  "libkelp.a" "libkelp.so ->")
expect("${libkelp-dev_info}" "Depends: [^\n]*libkelp0 [(]= ")
expect("${libkelp0_files}" "libkelp.so.0 ->" "libkelp.so.0.[0-9.]+\n")
expect("${libkelp0_info}" "Depends: [^\n]*libc6 [^\n]*libstdc[+][+]6" "Section: libs")
expect("${python3-kelp_files}" "lib/python3/dist-packages/kelp/__init__.py" "kelp/py.typed")
expect("${python3-kelp_info}" "Architecture: all" "Depends: [^\n]*libkelp0 [^\n]*python3-numpy")
if("${libkelp0_files}" MATCHES "[.]h\n|[.]a\n|libkelp.so ->|/bin/|[.]cmake\n" OR
   "${kelp-tools_files}" MATCHES "[.]a\n|[.]h\n" OR
   "${libkelp-dev_files}" MATCHES "/bin/")
  message(FATAL_ERROR "a file is in the wrong package")
endif()

# One program is enough to see that the package is whole; install.consumer builds them all.
step("configuring the consumer" ${CMAKE_COMMAND} -S ${TEST_DIR}/consumer -B ${WORK_DIR}/build -G ${GENERATOR}
  -DCMAKE_CXX_COMPILER=${CXX_COMPILER} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
  "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}" -DCMAKE_PREFIX_PATH=${WORK_DIR}/root/usr)
step("building write_pack" ${CMAKE_COMMAND} --build ${WORK_DIR}/build --target write_pack)
step("write_pack" ${WORK_DIR}/build/write_pack ${WORK_DIR}/cube.kelp)
step("configuring the consumer in C" ${CMAKE_COMMAND} -S ${TEST_DIR}/consumer_c -B ${WORK_DIR}/c
  -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${WORK_DIR}/root/usr)
step("building ask" ${CMAKE_COMMAND} --build ${WORK_DIR}/c)
step("ask" ${WORK_DIR}/c/ask ${WORK_DIR}/cube.kelp)
step("kelp-dump" ${WORK_DIR}/root/usr/bin/kelp-dump verify ${WORK_DIR}/cube.kelp)
