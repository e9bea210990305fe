// SPDX-License-Identifier: MIT
// In place of extract_proxy.cpp where OpenMesh is not installed.
#include "extract/extract.h"

namespace kelp::dump {

constinit const Writer kProxyWriter{.needs = "OpenMesh"};

}  // namespace kelp::dump
