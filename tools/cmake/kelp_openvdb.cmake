# SPDX-License-Identifier: MIT
include_guard(GLOBAL)

# kelp_openvdb(target): a target whose sources include <kelp/common/openvdb.h>. OpenVDB's templates hold
# static members that the program and libopenvdb must share: hidden, half of them would stay unset.
function(kelp_openvdb target)
  target_compile_options(${target} PRIVATE -fvisibility=default -fno-visibility-inlines-hidden)
endfunction()
