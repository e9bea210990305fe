# SPDX-License-Identifier: MIT
# make_copies(FOLDER): copies of GLM (marked), xxHash and zstd, as a game that brings its own has them.
function(make_copies folder)
  file(COPY ${GLM_INCLUDE_DIR}/glm DESTINATION ${folder}/glm)
  file(APPEND ${folder}/glm/glm/glm.hpp "\n#define COPY_OF_GLM\n")
  file(COPY ${XXHASH_INCLUDE_DIR}/xxhash.h DESTINATION ${folder}/xxhash)
  if(ZSTD_SOURCE)
    file(COPY ${ZSTD_SOURCE}/lib DESTINATION ${folder}/zstd)
  else()
    file(COPY ${ZSTD_INCLUDE_DIR}/zstd.h ${ZSTD_INCLUDE_DIR}/zstd_errors.h DESTINATION ${folder}/zstd/lib)
    file(WRITE ${folder}/zstd/lib/common/stand_in.c
      "#include \"../zstd.h\"\nint kelp_stand_in = ZSTD_VERSION_NUMBER;\n")
  endif()
endfunction()
