// SPDX-License-Identifier: MIT
// Real files for tests. They are not part of the project: found in KELP_ASSETS, or in ../shared/assets beside
// the checkout.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace kelp::test {

// The folder of the assets, or an empty path where there is none.
inline std::filesystem::path assetsFolder() {
  const char* set = std::getenv("KELP_ASSETS");
  const std::filesystem::path folder =
      set ? std::filesystem::path(set) : std::filesystem::path(KELP_SOURCE_DIR) / "../shared/assets";
  return std::filesystem::is_directory(folder) ? folder : std::filesystem::path();
}

}  // namespace kelp::test

// Defines `variable` as the path of an asset; skips the test, by name, where the file is absent. Only inside
// a test's body.
#define KELP_ASSET(variable, relative)                                            \
  const std::filesystem::path variable = kelp::test::assetsFolder() / (relative); \
  if (kelp::test::assetsFolder().empty() || !std::filesystem::exists(variable))   \
  GTEST_SKIP() << "asset " << (relative) << " is absent: set KELP_ASSETS to a folder that holds it"
