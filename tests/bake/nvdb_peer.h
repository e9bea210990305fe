// SPDX-License-Identifier: MIT
// NanoVDB's own library: turns OpenVDB files into its own.
#pragma once

#include <filesystem>
#include <string>

namespace kelp::bake::test {

enum class NvdbCodec { kNone, kZip, kBlosc };
enum class NvdbSum { kNone, kHead, kAll };
// Every grid of a .vdb; `as`: fp4, fp8, fp16 or fpn for grids of float, which lose something by it, or empty.
// With `back`, what NanoVDB reads in its file becomes a .vdb again.
void writeNvdb(const std::filesystem::path& path, const std::filesystem::path& vdb,
               const std::string& as = "", NvdbCodec codec = NvdbCodec::kNone, NvdbSum sum = NvdbSum::kAll,
               const std::filesystem::path& back = {});

}  // namespace kelp::bake::test
