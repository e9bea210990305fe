// SPDX-License-Identifier: MIT
#include "kernels.h"

namespace kelp::fields {

const Kernels& fastKernels() { return plainKernels(); }

}  // namespace kelp::fields
