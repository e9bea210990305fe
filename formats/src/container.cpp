// SPDX-License-Identifier: MIT
#include "container.h"

#include <algorithm>
#include <array>

#include "coding_libraries.h"
#include "layout.h"

namespace kelp {
namespace {

using ChunkInfo = Pack::ChunkInfo;

// A pack can be drawn without INFO, CLIP, SOCK, JNTS, CAGE and distances, but not without the others.
bool mustBeRequired(std::uint32_t fourcc) {
  return fourcc != layout::kInfo && fourcc != layout::kClip && fourcc != layout::kSock &&
         fourcc != layout::kJnts && fourcc != layout::kCage && fourcc != layout::kDgrd &&
         fourcc != layout::kDist;
}

std::uint64_t entryOffset(std::size_t index) {
  return layout::kHeaderBytes + index * layout::kIndexEntryBytes;
}

// Checks a known chunk by itself.
Result<void> checkKnownChunk(const ChunkInfo& chunk, const PackLimits& limits, std::uint64_t at) {
  const bool level_chunk = layout::isGrid(chunk.fourcc) || layout::isPages(chunk.fourcc);
  if (chunk.flags & ~layout::kKnownFlags)
    return Error{ErrorCode::kUnsupportedFeature, "a chunk has a flag that this version does not know",
                 at + 4};
  if (((chunk.flags & layout::kFlagRequired) != 0) != mustBeRequired(chunk.fourcc)) {
    return Error{ErrorCode::kCorrupt, "a chunk's required flag is wrong for its kind", at + 4};
  }
  if (!level_chunk && (chunk.level != 0 || chunk.part != 0))
    return Error{ErrorCode::kCorrupt, "a metadata chunk names a level or part", at + 8};
  if (chunk.raw == 0) return Error{ErrorCode::kCorrupt, "a chunk is empty", at + 32};
  if (chunk.flags & layout::kFlagZstd) {
    if (layout::isPages(chunk.fourcc))
      return Error{ErrorCode::kCorrupt, "a chunk of pages has the zstd flag", at + 4};
    if (chunk.raw / layout::kMaxExpansion > chunk.stored)
      return Error{ErrorCode::kCorrupt, "a chunk's raw size is more than zstd can produce", at + 32};
  } else if (chunk.raw != chunk.stored) {
    return Error{ErrorCode::kCorrupt, "an uncompressed chunk's two sizes differ", at + 32};
  }
  if (!layout::isPages(chunk.fourcc) && chunk.raw > limits.max_decoded_bytes) {
    return Error{ErrorCode::kLimit, "a chunk is larger than the limits allow", at + 32};
  }
  return {};
}

Result<void> checkIndex(const Container& container, const PackLimits& limits) {
  std::uint64_t end = entryOffset(container.chunks.size());
  for (std::size_t i = 0; i < container.chunks.size(); ++i) {
    const ChunkInfo& chunk = container.chunks[i];
    const std::uint64_t at = entryOffset(i);
    if (chunk.offset != layout::align(end, layout::kAlignment))
      return Error{ErrorCode::kCorrupt, "a chunk does not start where the previous one ends", at + 16};
    if (chunk.stored == 0) return Error{ErrorCode::kCorrupt, "a chunk is empty", at + 24};
    if (chunk.offset > container.file_size || chunk.stored > container.file_size - chunk.offset) {
      return Error{ErrorCode::kCorrupt, "a chunk reaches beyond the end of the file", at + 24};
    }
    end = chunk.offset + chunk.stored;
    if (layout::isKnown(chunk.fourcc)) {
      if (const Result<void> checked = checkKnownChunk(chunk, limits, at); !checked) return checked;
    } else if (chunk.flags & layout::kFlagRequired) {
      return Error{ErrorCode::kUnsupportedFeature,
                   "a required chunk has a kind that this version does not know", at};
    }
  }
  if (end != container.file_size)
    return Error{ErrorCode::kCorrupt, "the last chunk does not end at the end of the file", 16};
  return {};
}

}  // namespace

Result<void> readBytes(const Source& source, std::uint64_t offset, std::span<std::byte> bytes) {
  switch (source.read(source.user, offset, bytes)) {
    case Read::kDone:
      return {};
    case Read::kNotYet:
      return Error{ErrorCode::kNotYet, "the source has not got the bytes yet", offset};
    case Read::kFailed:
      break;
  }
  return Error{ErrorCode::kIo, "the source could not be read", offset};
}

Result<void> readContainer(const Source& source, const PackLimits& limits, const Allocator& allocator,
                           Container& out) {
  using namespace layout;
  if (!source.read) return Error{ErrorCode::kMisuse, "the source has no read function"};
  std::array<std::byte, kHeaderBytes> header{};
  const std::size_t there = static_cast<std::size_t>(std::min<std::uint64_t>(source.size, kHeaderBytes));
  if (const Result<void> read = readBytes(source, 0, std::span(header).first(there)); !read) return read;
  // Even the first bytes of the identifier distinguish a truncated pack from another kind of file.
  const std::size_t compared = std::min(there, kIdentifier.size());
  if (compared == 0 || std::memcmp(header.data(), kIdentifier.data(), compared) != 0) {
    return Error{ErrorCode::kNotAPack, "the file does not start like a .kelp pack", 0};
  }
  if (there < kHeaderBytes) return Error{ErrorCode::kTruncated, "the file ends within its header", there};
  if (load<std::uint16_t>(header, 12) > kFormatMajor)
    return Error{ErrorCode::kUnsupportedVersion, "the pack was written by a newer kelp; update kelp", 12};
  if (load<std::uint16_t>(header, 12) < kFormatMajor)
    return Error{ErrorCode::kUnsupportedVersion, "the pack has the layout of an older kelp; bake it again",
                 12};
  out.minor = load<std::uint16_t>(header, 14);
  out.file_size = load<std::uint64_t>(header, 16);
  if (source.size < out.file_size)
    return Error{ErrorCode::kTruncated, "the file is shorter than its header says", source.size};
  if (source.size > out.file_size)
    return Error{ErrorCode::kCorrupt, "the file is longer than its header says", out.file_size};
  for (std::size_t i = 28; i < kHeaderChecksum; ++i) {
    if (header[i] != std::byte{0})
      return Error{ErrorCode::kCorrupt, "a reserved byte of the header is not zero", i};
  }
  const std::uint32_t count = load<std::uint32_t>(header, 24);
  if (count < 1 || count > (out.file_size - kHeaderBytes) / kIndexEntryBytes) {
    return Error{ErrorCode::kCorrupt, "the index does not fit into the file", 24};
  }
  const std::uint64_t index_bytes = std::uint64_t{count} * kIndexEntryBytes;
  if (index_bytes > limits.max_decoded_bytes)
    return Error{ErrorCode::kLimit, "the index is larger than the limits allow", 24};

  Buffer<std::byte> index(allocator);
  if (!index.reset(index_bytes) || !out.chunks.reset(count)) {
    return Error{ErrorCode::kOutOfMemory, "no memory for the index"};
  }
  if (const Result<void> read = readBytes(source, kHeaderBytes, index.span()); !read) return read;
  const std::uint64_t stated = load<std::uint64_t>(header, kHeaderChecksum);
  store(header, kHeaderChecksum, std::uint64_t{0});
  RunningChecksum running;
  running.add(header);
  running.add(index.span());
  if (running.value() != stated)
    return Error{ErrorCode::kChecksum, "the header and the index differ from their checksum",
                 kHeaderChecksum};

  for (std::size_t i = 0; i < count; ++i) out.chunks[i] = loadIndexEntry(index.span(), i * kIndexEntryBytes);
  return checkIndex(out, limits);
}

Result<void> readChunk(const Source& source, const ChunkInfo& chunk, const PackLimits& limits,
                       Buffer<std::byte>& out, const Allocator& allocator) {
  if (chunk.raw > limits.max_decoded_bytes)
    return Error{ErrorCode::kLimit, "a chunk is larger than the limits allow", chunk.offset};
  const bool compressed = (chunk.flags & layout::kFlagZstd) != 0;
  Buffer<std::byte> frame(allocator);
  Buffer<std::byte>& stored = compressed ? frame : out;
  if (!stored.reset(chunk.stored))
    return Error{ErrorCode::kOutOfMemory, "no memory for a chunk", chunk.offset};
  if (const Result<void> read = readBytes(source, chunk.offset, stored.span()); !read) return read;
  if (checksum(stored.span()) != chunk.checksum)
    return Error{ErrorCode::kChecksum, "a chunk differs from its checksum", chunk.offset};
  if (!compressed) return {};

  Buffer<std::byte> workspace(allocator);
  if (!out.reset(chunk.raw) || !workspace.reset(decodeWorkspaceBytes())) {
    return Error{ErrorCode::kOutOfMemory, "no memory for a chunk", chunk.offset};
  }
  if (!decodeFrame(frame.span(), out.span(), workspace.span())) {
    return Error{ErrorCode::kCorrupt, "a chunk does not decompress to its raw size", chunk.offset};
  }
  return {};
}

Error inFile(const Error& error, const ChunkInfo& chunk) {
  const bool compressed = (chunk.flags & layout::kFlagZstd) != 0;
  const ErrorCode code =
      // In a pack these are corruption; only a pose may turn back or fold.
      error.code == ErrorCode::kNotMonotone || error.code == ErrorCode::kFolds ? ErrorCode::kCorrupt
                                                                               : error.code;
  return {code, error.detail,
          chunk.offset + (compressed || error.offset == Error::kNoOffset ? 0 : error.offset)};
}

}  // namespace kelp
