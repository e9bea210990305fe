# SPDX-License-Identifier: MIT
# Debian packages of the components: kelp-tools (the programs), libkelp-dev (libraries, headers, the CMake
# package), libkelp0 (the shared library) and python3-kelp. `cmake --workflow --preset package` makes them as
# they ship, in build/package.
set(KELP_PACKAGE_CONTACT "The kelp authors <kelp@kelp.invalid>" CACHE STRING
  "The maintainer of the packages that this build makes: Name <mail address>")
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME kelp)
set(CPACK_PACKAGE_VENDOR kelp)
set(CPACK_PACKAGE_CONTACT "${KELP_PACKAGE_CONTACT}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # CPack would put it before the components' own
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ
  GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_COMPONENTS_ALL dev)
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libkelp-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(depends "libglm-dev, libzstd-dev, libxxhash-dev")
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS "kelp-tools (= ${PROJECT_VERSION}-1), cmake (>= 3.25)")
set(CPACK_DEBIAN_DEV_DESCRIPTION "voxel models that bend - development files of the runtime
Static libraries, headers and the CMake package of the kelp runtime: packs
read from files that need not be trusted, poses and clips, ray casts, and a
renderer for OpenGL 3.3 core and OpenGL ES 3.0 with its shaders embedded.
For C, the header kelp/kelp.h.")

if(TARGET kelp_c)
  list(APPEND CPACK_COMPONENTS_ALL lib)
  set(lib_package libkelp${PROJECT_VERSION_MAJOR})
  string(APPEND depends ", ${lib_package} (= ${PROJECT_VERSION}-1)")
  set(CPACK_DEBIAN_LIB_PACKAGE_NAME ${lib_package})
  set(CPACK_DEBIAN_LIB_PACKAGE_SECTION libs)
  set(CPACK_DEBIAN_LIB_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
  file(WRITE ${PROJECT_BINARY_DIR}/papers/triggers "activate-noawait ldconfig\n")
  set(CPACK_DEBIAN_LIB_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/papers/triggers)
  set(CPACK_DEBIAN_LIB_DESCRIPTION "voxel models that bend - shared library
The kelp runtime behind its C interface: packs, poses and clips, ray casts,
distances, and a renderer for OpenGL 3.3 core and OpenGL ES 3.0. Programs in
C, and in any language that calls C, use it.")
endif()
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "${depends}")

if(TARGET kelp_c)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-kelp)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "python3 (>= 3.9), ${lib_package} (>= ${PROJECT_VERSION}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "libegl1, libgl1-mesa-dri")
  # As Debian's own: compiled when it is installed, so that nothing is left when it is removed.
  file(WRITE ${PROJECT_BINARY_DIR}/papers/postinst
    "#!/bin/sh\nset -e\nif command -v py3compile >/dev/null 2>&1; then py3compile -p python3-kelp; fi\n")
  file(WRITE ${PROJECT_BINARY_DIR}/papers/prerm
    "#!/bin/sh\nset -e\nif command -v py3clean >/dev/null 2>&1; then py3clean -p python3-kelp; fi\n")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
    "${PROJECT_BINARY_DIR}/papers/postinst;${PROJECT_BINARY_DIR}/papers/prerm")
  set(CPACK_DEBIAN_PYTHON_DESCRIPTION "voxel models that bend - for Python
The kelp runtime for Python, by its shared library: packs, poses and clips,
springs, ray casts and distances with NumPy arrays, and pictures drawn by
OpenGL without a window.")
endif()

if(KELP_BAKER OR KELP_TOOLS)
  list(APPEND CPACK_COMPONENTS_ALL tools)
  set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME kelp-tools)
  set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION graphics)
  set(CPACK_DEBIAN_TOOLS_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_TOOLS_PACKAGE_RECOMMENDS libgl1-mesa-dri)  # for kelp-render and kelp-view
  set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS "libkelp-dev (= ${PROJECT_VERSION}-1)")
  set(CPACK_DEBIAN_TOOLS_DESCRIPTION "voxel models that bend - baker, inspector, renderer and viewer
kelp-bake turns meshes and volumes into voxel packs that bend by splines in
real time, kelp-dump says what is in a pack and whether it is sound,
kelp-render draws pictures of packs without a display, and kelp-view shows
packs in a window and edits their rigs.")
endif()

# A package's papers: kelp's license, the licenses of the code that is compiled into it (from Debian's own
# packages), and the changes.
function(kelp_package_papers component package)
  set(papers ${PROJECT_BINARY_DIR}/papers/${package})
  file(READ ${PROJECT_SOURCE_DIR}/LICENSE copyright)
  foreach(part IN LISTS ARGN)
    if(EXISTS /usr/share/doc/${part}/copyright)
      file(READ /usr/share/doc/${part}/copyright text)
      string(APPEND copyright "\n\nThis package contains code of ${part}:\n\n${text}")
    endif()
  endforeach()
  file(WRITE ${papers}/copyright "${copyright}")
  string(TIMESTAMP now "%a, %d %b %Y %H:%M:%S +0000" UTC)  # SOURCE_DATE_EPOCH, if set
  file(WRITE ${papers}/changelog.Debian
    "${package} (${PROJECT_VERSION}-1) unstable; urgency=medium\n\n  * See changelog.gz.\n\n"
    " -- ${KELP_PACKAGE_CONTACT}  ${now}\n")
  configure_file(${PROJECT_SOURCE_DIR}/CHANGELOG.md ${papers}/changelog COPYONLY)
  execute_process(COMMAND ${KELP_GZIP} -9nf ${papers}/changelog.Debian ${papers}/changelog
    COMMAND_ERROR_IS_FATAL ANY)
  install(FILES ${papers}/copyright ${papers}/changelog.gz ${papers}/changelog.Debian.gz
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/${package} COMPONENT ${component} EXCLUDE_FROM_ALL)
endfunction()
find_program(KELP_GZIP gzip)
mark_as_advanced(KELP_GZIP)
if(KELP_GZIP)
  kelp_package_papers(dev libkelp-dev libglm-dev libxxhash-dev)
  if(TARGET kelp_c)
    kelp_package_papers(lib ${lib_package} libglm-dev libxxhash-dev libzstd-dev)
    kelp_package_papers(python python3-kelp)
  endif()
  kelp_package_papers(tools kelp-tools libglm-dev libxxhash-dev libzstd-dev libcli11-dev nlohmann-json3-dev
    libtinygltf-dev libopenmesh-dev libstb-dev libnanovdb-dev libimgui-dev)
endif()
include(CPack)
