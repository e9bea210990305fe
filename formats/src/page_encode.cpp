// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstring>

#include "kelp/formats/brick.h"
#include "page_attributes.h"
#include "page_codec.h"
#include "page_occupancy.h"
#include "page_state.h"

namespace kelp {
namespace {

using coding::PageHeader;
using coding::PageState;

// More than any page of 64 KiB takes.
constexpr std::size_t kMostCoded = 256 * 1024, kMostPlain = 65535;

struct Page {
  const PageShape& shape;
  std::span<const std::uint8_t> codes;
  std::span<const std::uint32_t> attributes;
};

// Null, or what is wrong with the sizes and single values.
const char* findFault(const Page& page) {
  if (!coding::isPageShape(page.shape)) return "a page's bricks are impossible";
  if (page.codes.size() != page.shape.bricks.size() * 512 || page.attributes.size() > kMaxPageAttributes)
    return "a page's sizes are impossible";
  std::size_t surface = 0;
  for (std::size_t i = 0; i < page.codes.size(); i += 512) {
    const std::size_t before = surface;
    for (std::size_t j = i; j < i + 512; ++j) {
      const std::uint8_t code = page.codes[j];
      if (code != 0 && code != kSurfaceCode && code != kInnerCode) return "a page holds a reserved code";
      surface += code == kSurfaceCode;
    }
    if (surface == before) return "a stored brick has no surface voxel";
  }
  if (surface != page.attributes.size()) return "a page does not have one attribute for each surface voxel";
  for (const std::uint32_t attribute : page.attributes)
    if (attributePalette(attribute) >= page.shape.palette) return "a palette index is beyond the palette";
  return nullptr;
}

void readCodes(const Page& page, PageState& state) {
  for (std::size_t i = 0; i < page.codes.size(); i += 64) {
    std::uint64_t solid = 0, surface = 0;
    for (std::size_t bit = 0; bit < 64; ++bit) {
      solid |= std::uint64_t{page.codes[i + bit] != 0} << bit;
      surface |= std::uint64_t{page.codes[i + bit] == kSurfaceCode} << bit;
    }
    state.solid[i / 512][i / 64 % 8] = solid;
    state.surface[i / 512][i / 64 % 8] = surface;
  }
}

// True if the solid voxels agree with the coarser level and the level's size.
bool followsFromAbove(const PageShape& shape, const PageState& state) {
  for (std::size_t b = 0; b < shape.bricks.size(); ++b) {
    std::array<std::uint64_t, 4> blocks{};  // rows of 4 x 4 blocks with a solid voxel
    for (std::size_t row = 0; row < 64; ++row) {
      const std::uint32_t known = state.rows[b][row];
      const auto solid = static_cast<std::uint32_t>(state.solid[b][row / 8] >> (8 * (row % 8)) & 0xff);
      const std::uint32_t bits = coding::spreadRow(solid);
      if ((known & bits) != 0 || ((known >> 1) & ~bits & 0x5555) != 0) return false;
      const std::uint32_t pairs = (bits | bits >> 2) & 0x1111;
      for (std::size_t x = 0; x < 4; ++x)
        blocks[row / 16] |= std::uint64_t{pairs >> (4 * x) & 1} << (x + 4 * (row / 2 % 4));
    }
    for (std::size_t z = 0; z < 4 && !shape.above.empty(); ++z)
      if ((shape.above[b].solid >> (16 * z) & 0xffff & ~blocks[z]) != 0) return false;
  }
  return true;
}

// True if the surface voxels follow the rules; exact: these rules alone give them. All rows are
// known.
bool isSurfaceRight(const PageShape& shape, const PageState& state, bool& exact) {
  coding::Window window;
  exact = true;
  for (std::size_t b = 0; b < shape.bricks.size(); ++b) {
    coding::lookAround(state, b, window);
    const coding::Around around = coding::findAround(window);
    for (std::size_t z = 0; z < 8; ++z) {
      const std::uint64_t inner = coding::innerByCoarse(shape, b, z), surface = state.surface[b][z];
      if ((state.solid[b][z] & around.empty[z] & ~surface) != 0 || (surface & inner) != 0) return false;
      if ((surface & ~around.empty[z] & ~around.unknown[z]) != 0) exact = false;
    }
  }
  return true;
}

void findDropped(std::span<const std::uint32_t> attributes, PageHeader& header) {
  std::uint32_t differ = 0;
  for (const std::uint32_t attribute : attributes) differ |= (attribute ^ attributes[0]) >> 8;
  header.dropped = static_cast<std::uint32_t>(
      std::min(std::countr_zero(((differ | differ >> 12) & 0xfff) | 1u << coding::kMostDropped), 12));
  header.pattern = attributes[0] >> 8 & coding::droppedBits(header.dropped);
}

void writePage(const PageHeader& header, std::span<const std::byte> plain, std::span<const std::byte> coded,
               std::byte* out) {
  *out++ = static_cast<std::byte>((header.limit - coding::kLeastLimit) | (header.exact ? 4u : 0u) |
                                  header.dropped << 4);
  *out++ = static_cast<std::byte>(plain.size());
  *out++ = static_cast<std::byte>(plain.size() >> 8);
  for (std::size_t i = 0; i < coding::kPatternBytes && header.dropped > 0; ++i)
    *out++ = static_cast<std::byte>(header.pattern >> (8 * i));
  if (!plain.empty()) std::memcpy(out, plain.data(), plain.size());
  std::memcpy(out + plain.size(), coded.data(), coded.size());
}

// Codes the page with one limit. Replaces `out` if this is shorter, or the first.
Result<void> tryLimit(const Page& page, PageHeader header, Buffer<std::byte>& workspace,
                      std::span<std::byte> scratch, Buffer<std::byte>& out, bool first) {
  const Error no_memory{ErrorCode::kOutOfMemory, "no memory for a page"};
  PageState* const state = coding::prepareState(page.shape, workspace);
  if (!state) return no_memory;
  readCodes(page, *state);
  coding::startRows(page.shape, *state);
  if (!followsFromAbove(page.shape, *state))
    return Error{ErrorCode::kMisuse, "a level does not follow from the next coarser one"};
  coding::Encoder encoder(scratch.first(kMostCoded), scratch.subspan(kMostCoded, kMostPlain), header.limit);
  coding::codeSolid(encoder, page.shape, *state);
  if (!isSurfaceRight(page.shape, *state, header.exact))
    return Error{ErrorCode::kMisuse, "a voxel beside an empty one is not surface, or one within a body is"};
  coding::codeSurface(encoder, page.shape, *state, header.exact);
  // The coder only reads the attributes of an encoder.
  coding::codeAttributes(encoder, header, page.shape, *state, page.attributes);
  encoder.finish();
  if (!encoder.fits()) return Error{ErrorCode::kMisuse, "a page is too long"};
  const std::size_t bytes = coding::kHeaderBytes + (header.dropped > 0 ? coding::kPatternBytes : 0) +
                            encoder.plainBytes() + encoder.codedBytes();
  if (!first && bytes >= out.size()) return {};
  if (!out.reuse(bytes)) return no_memory;
  writePage(header, scratch.subspan(kMostCoded, encoder.plainBytes()), scratch.first(encoder.codedBytes()),
            out.data());
  return {};
}

}  // namespace

Result<void> encodeSolidPage(const PageShape& shape, std::span<const std::uint8_t> codes,
                             std::span<const std::uint32_t> attributes, Effort effort,
                             Buffer<std::byte>& workspace, Buffer<std::byte>& out) {
  const Page page{shape, codes, attributes};
  if (const char* const fault = findFault(page)) return Error{ErrorCode::kMisuse, fault};
  Buffer<std::byte> scratch(workspace.allocator());
  if (!scratch.reuse(kMostCoded + kMostPlain)) return Error{ErrorCode::kOutOfMemory, "no memory for a page"};
  PageHeader header;
  findDropped(attributes, header);
  const std::uint32_t usual = header.limit;
  if (const Result<void> coded = tryLimit(page, header, workspace, scratch.span(), out, true); !coded)
    return coded;
  for (header.limit = coding::kLeastLimit; effort == Effort::kBest && header.limit < coding::kLeastLimit + 4;
       ++header.limit) {
    if (header.limit == usual) continue;
    if (const Result<void> coded = tryLimit(page, header, workspace, scratch.span(), out, false); !coded)
      return coded;
  }
  return {};
}

}  // namespace kelp
