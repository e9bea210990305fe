// SPDX-License-Identifier: MIT
#include <bit>

#include "kelp/formats/brick.h"
#include "page_attributes.h"
#include "page_codec.h"
#include "page_occupancy.h"
#include "page_state.h"

namespace kelp {
namespace {

using coding::PageHeader;
using coding::PageState;

// The header; what follows it stays in `stored`. False: it is not one.
bool readHeader(std::span<const std::byte>& stored, PageHeader& header) {
  if (stored.size() < coding::kHeaderBytes) return false;
  const auto at = [&](std::size_t i) { return std::to_integer<std::uint32_t>(stored[i]); };
  header.limit = coding::kLeastLimit + (at(0) & 3);
  header.exact = (at(0) & 4) != 0;
  header.dropped = at(0) >> 4;
  header.plain_bytes = at(1) | at(2) << 8;
  if ((at(0) & 8) != 0 || header.dropped > coding::kMostDropped) return false;
  std::size_t bytes = coding::kHeaderBytes;
  if (header.dropped > 0) {
    if (stored.size() < bytes + coding::kPatternBytes) return false;
    header.pattern = at(bytes) | at(bytes + 1) << 8 | at(bytes + 2) << 16;
    bytes += coding::kPatternBytes;
    if ((header.pattern & ~coding::droppedBits(header.dropped)) != 0) return false;
  }
  stored = stored.subspan(bytes);
  return header.plain_bytes <= stored.size() && (stored.size() - header.plain_bytes) % 2 == 0;
}

// Returns the number of surface voxels.
std::size_t takeShapes(const PageState& state, std::span<BrickShape> shapes) {
  std::size_t count = 0;
  for (std::size_t brick = 0; brick < shapes.size(); ++brick) {
    for (std::size_t z = 0; z < kBrickSide; ++z) {
      shapes[brick].solid.slices[z] = state.solid[brick][z];
      shapes[brick].surface.slices[z] = state.surface[brick][z];
      count += static_cast<std::size_t>(std::popcount(state.surface[brick][z]));
    }
  }
  return count;
}

}  // namespace

Result<void> decodeSolidPage(const PageShape& shape, std::span<const std::byte> stored,
                             Buffer<std::byte>& workspace, std::span<BrickShape> shapes,
                             std::span<std::uint32_t> attributes) {
  if (!coding::isPageShape(shape) || shapes.size() != shape.bricks.size() ||
      attributes.size() > kMaxPageAttributes)
    return Error{ErrorCode::kMisuse, "sizes of a page do not match"};
  PageHeader header;
  if (!readHeader(stored, header)) return Error{ErrorCode::kCorrupt, "a page's header is impossible"};
  PageState* const state = coding::prepareState(shape, workspace);
  if (!state) return Error{ErrorCode::kOutOfMemory, "no memory for a page"};
  coding::Decoder decoder(stored.subspan(header.plain_bytes), stored.first(header.plain_bytes), header.limit);
  coding::startRows(shape, *state);
  coding::codeSolid(decoder, shape, *state);
  if (!coding::codeSurface(decoder, shape, *state, header.exact))
    return Error{ErrorCode::kCorrupt, "a stored brick has no surface voxel"};
  if (takeShapes(*state, shapes) != attributes.size())
    return Error{ErrorCode::kCorrupt, "a page does not have one attribute for each surface voxel"};
  if (!coding::codeAttributes(decoder, header, shape, *state, attributes))
    return Error{ErrorCode::kCorrupt, "a palette index is beyond the palette"};
  if (!decoder.isAtEnd()) return Error{ErrorCode::kCorrupt, "a page does not end where its voxels end"};
  return {};
}

}  // namespace kelp
