// SPDX-License-Identifier: MIT
// A plain main for fuzzers: runs each file of the folders given, every truncation of the small ones and a few thousand changed bytes, so that
// fuzzers are built and run by every ordinary test run.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int main(int count, char** arguments) {
  std::size_t runs = 0;
  for (int i = 1; i < count; ++i) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(arguments[i])) {
      if (!entry.is_regular_file()) continue;
      std::ifstream file(entry.path(), std::ios::binary);
      std::vector<std::uint8_t> bytes((std::istreambuf_iterator<char>(file)), {});
      LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
      ++runs;
      for (std::size_t size = 0; size < bytes.size() && bytes.size() < 8192; ++size, ++runs) LLVMFuzzerTestOneInput(bytes.data(), size);
      std::mt19937 random(1);
      for (int n = 0; n < 3000 && !bytes.empty(); ++n, ++runs) {
        std::vector<std::uint8_t> changed = bytes;
        for (unsigned k = 0; k <= random() % 3; ++k) changed[random() % changed.size()] = static_cast<std::uint8_t>(random());
        LLVMFuzzerTestOneInput(changed.data(), changed.size());
      }
    }
  }
  std::printf("%zu inputs\n", runs);
  return runs > 0 ? 0 : 1;
}
