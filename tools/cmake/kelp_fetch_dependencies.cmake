# SPDX-License-Identifier: MIT
# KELP_FETCH_DEPENDENCIES: downloads the dependencies of the runtime whose targets the host does not bring, in
# the versions of Debian 12. Their own CMake projects do not run, and no name of theirs is taken: a host may
# fetch the same ones for itself. FETCHCONTENT_SOURCE_DIR_KELP_GLM, _KELP_ZSTD and
# _KELP_XXHASH name local copies.
include(FetchContent)

# kelp_fetch(NAME URL SHA256): sets NAME_SOURCE_DIR.
macro(kelp_fetch name url hash)
  FetchContent_Declare(${name} URL ${url} URL_HASH SHA256=${hash} DOWNLOAD_EXTRACT_TIMESTAMP ON
    SOURCE_SUBDIR no_project)
  FetchContent_MakeAvailable(${name})
endmacro()

if(NOT TARGET glm::glm)
  kelp_fetch(kelp_glm https://github.com/g-truc/glm/releases/download/0.9.9.8/glm-0.9.9.8.zip
    37e2a3d62ea3322e43593c34bae29f57e3e251ea89f4067506c94043769ade4c)
  add_library(kelp_deps::glm INTERFACE IMPORTED)
  target_include_directories(kelp_deps::glm INTERFACE "${kelp_glm_SOURCE_DIR}")
endif()

if(NOT TARGET xxHash::xxhash)
  kelp_fetch(kelp_xxhash https://github.com/Cyan4973/xxHash/archive/refs/tags/v0.8.1.tar.gz
    3bb6b7d6f30c591dd65aaaff1c8b7a5b94d81687998ca9400082c739a690436c)
  add_library(kelp_deps::xxhash INTERFACE IMPORTED)
  target_include_directories(kelp_deps::xxhash INTERFACE "${kelp_xxhash_SOURCE_DIR}")
endif()

if(NOT TARGET zstd::libzstd_static AND NOT TARGET zstd::libzstd AND NOT TARGET zstd::libzstd_shared AND
   NOT TARGET libzstd_static AND NOT TARGET libzstd_shared)
  enable_language(C)
  kelp_fetch(kelp_zstd https://github.com/facebook/zstd/releases/download/v1.5.4/zstd-1.5.4.tar.gz
    0f470992aedad543126d06efab344dc5f3e171893810455787d38347343a4424)
  file(GLOB sources "${kelp_zstd_SOURCE_DIR}/lib/common/*.c"
    "${kelp_zstd_SOURCE_DIR}/lib/compress/*.c" "${kelp_zstd_SOURCE_DIR}/lib/decompress/*.c")
  add_library(kelp_zstd STATIC EXCLUDE_FROM_ALL ${sources})
  set_target_properties(kelp_zstd PROPERTIES POSITION_INDEPENDENT_CODE ON UNITY_BUILD OFF)
  target_compile_definitions(kelp_zstd PRIVATE ZSTD_DISABLE_ASM)  # only the sources in C
  add_library(kelp_deps::zstd INTERFACE IMPORTED)
  target_link_libraries(kelp_deps::zstd INTERFACE kelp_zstd)
  target_include_directories(kelp_deps::zstd INTERFACE "${kelp_zstd_SOURCE_DIR}/lib")
endif()
