// SPDX-License-Identifier: MIT
#pragma once

namespace kelp::test {

// Calls of operator new since the program began: kelp's, GoogleTest's, and those of the C++ parts of the GL
// driver.
long newCalls();

}  // namespace kelp::test
