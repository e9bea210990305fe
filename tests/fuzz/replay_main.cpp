// SPDX-License-Identifier: MIT
// A plain main for fuzzers, so that they are built and run by every ordinary test run: PROGRAM INPUTS
// FOLDER... runs each file of the folders, and about INPUTS of their truncations and of copies with a few
// changed bytes, evenly shared; with KELP_ALL_TESTS ten times as many.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int main(int count, char** arguments) {
  if (count < 3) {
    std::fprintf(stderr, "%s INPUTS FOLDER...\n", arguments[0]);
    return 1;
  }
  std::vector<std::filesystem::path> paths;
  for (int i = 2; i < count; ++i) {
    std::error_code error;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(arguments[i], error))
      if (entry.is_regular_file()) paths.push_back(entry.path());
    if (error) std::fprintf(stderr, "%s: %s\n", arguments[i], error.message().c_str());
    if (error) return 1;
  }
  std::sort(paths.begin(), paths.end());
  const std::size_t inputs =
      std::strtoull(arguments[1], nullptr, 10) * (std::getenv("KELP_ALL_TESTS") ? 10 : 1);
  const std::size_t share = inputs / std::max<std::size_t>(paths.size(), 1) / 2;
  std::size_t runs = 0;
  for (const std::filesystem::path& path : paths) {
    std::ifstream file(path, std::ios::binary);
    const std::vector<std::uint8_t> bytes((std::istreambuf_iterator<char>(file)), {});
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
    ++runs;
    const std::size_t step = std::max<std::size_t>(1, bytes.size() / std::max<std::size_t>(share, 1));
    for (std::size_t size = 0; size < bytes.size() && share > 0; size += step, ++runs)
      LLVMFuzzerTestOneInput(bytes.data(), size);
    std::mt19937 random(1);
    for (std::size_t n = 0; n < share && !bytes.empty(); ++n, ++runs) {
      std::vector<std::uint8_t> changed = bytes;
      for (unsigned k = 0; k <= random() % 3; ++k)
        changed[random() % changed.size()] = static_cast<std::uint8_t>(random());
      LLVMFuzzerTestOneInput(changed.data(), changed.size());
    }
  }
  std::printf("%zu inputs of %zu files\n", runs, paths.size());
  return runs > 0 ? 0 : 1;
}
