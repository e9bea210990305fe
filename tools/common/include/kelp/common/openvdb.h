// SPDX-License-Identifier: MIT
// OpenVDB, for targets that call kelp_openvdb(). libopenvdb holds these classes; without this, every source
// that makes a grid compiles all that its tree can do. clang -O1 and gcc -O0 call what it lacks, and so may a
// libopenvdb that was built without its explicit instantiations.
#pragma once

#include <openvdb/openvdb.h>
#if defined(OPENVDB_USE_EXPLICIT_INSTANTIATION) && defined(NDEBUG) && defined(__OPTIMIZE__) && \
    !defined(__clang__)
#define KELP_IN_LIBOPENVDB(Type)                                          \
  extern template class openvdb::tree::Tree<openvdb::Type::RootNodeType>; \
  extern template class openvdb::Grid<openvdb::Type>;
KELP_IN_LIBOPENVDB(FloatTree)
KELP_IN_LIBOPENVDB(DoubleTree)
KELP_IN_LIBOPENVDB(Int32Tree)
KELP_IN_LIBOPENVDB(Int64Tree)
KELP_IN_LIBOPENVDB(BoolTree)
KELP_IN_LIBOPENVDB(Vec3STree)
KELP_IN_LIBOPENVDB(Vec3DTree)
#endif
