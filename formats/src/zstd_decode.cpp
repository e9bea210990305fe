// SPDX-License-Identifier: MIT
#include "coding_libraries.h"

#include <cstdint>
#include <cstring>

#define ZSTD_STATIC_LINKING_ONLY  // for contexts in our own memory
#include <zstd.h>

namespace kelp {

std::size_t decodeWorkspaceBytes() { return ZSTD_estimateDCtxSize(); }

bool decodeFrame(std::span<const std::byte> frame, std::span<std::byte> out, std::span<std::byte> workspace) {
  // zstd would also accept skippable frames and, in some builds, frames of its first versions.
  std::uint32_t magic = 0;
  if (frame.size() < sizeof(magic)) return false;
  std::memcpy(&magic, frame.data(), sizeof(magic));
  if (magic != ZSTD_MAGICNUMBER) return false;
  if (ZSTD_getFrameContentSize(frame.data(), frame.size()) != out.size()) return false;
  if (ZSTD_findFrameCompressedSize(frame.data(), frame.size()) != frame.size()) return false;
  ZSTD_DCtx* context = ZSTD_initStaticDCtx(workspace.data(), workspace.size());
  if (!context) return false;
  return ZSTD_decompressDCtx(context, out.data(), out.size(), frame.data(), frame.size()) == out.size();
}

}  // namespace kelp
