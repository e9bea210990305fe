// SPDX-License-Identifier: MIT
// Packs that lie under right checksums: a sound pack is taken apart, changed as the input says, and put
// together again, so that what is behind the checksums is reached. The input is a choice of the sound pack,
// then records of eight bytes: what to do (3 bits) with which chunk (13 bits), where (16 bits), and a number.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "../formats/pack_surgeon.h"
#include "exercise_pack.h"

namespace {

using kelp::test::Bytes;
using kelp::test::PackSurgeon;

Bytes readGolden(const char* name) {
  std::ifstream file(std::string(KELP_GOLDEN_PACKS "/") + name, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  if (text.empty()) {
    std::fprintf(stderr, "%s/%s: cannot be read\n", KELP_GOLDEN_PACKS, name);
    std::abort();
  }
  const auto* const bytes = reinterpret_cast<const std::byte*>(text.data());
  return Bytes(bytes, bytes + text.size());
}

struct Record {
  std::uint16_t what_and_chunk, at;
  std::uint32_t number;
};

void setLittleEndian(Bytes& bytes, std::size_t at, std::uint32_t number, std::size_t size) {
  for (std::size_t i = 0; i < size && at + i < bytes.size(); ++i)
    bytes[at + i] = static_cast<std::byte>(number >> (8 * i));
}

// Changes bytes in one of the ways that keep a table's shape, or do not.
void change(Bytes& bytes, const Record& record) {
  if (bytes.empty()) return;
  const std::size_t at = record.at % bytes.size();
  switch (record.what_and_chunk & 3) {
    case 0:
      return setLittleEndian(bytes, at, record.number, 1);
    case 1:
      return setLittleEndian(bytes, at & ~std::size_t{3}, record.number, 4);
    case 2:
      return static_cast<void>(bytes.erase(
          bytes.begin() + static_cast<std::ptrdiff_t>(at),
          bytes.begin() + static_cast<std::ptrdiff_t>(std::min(bytes.size(), at + record.number % 65))));
    default:
      return static_cast<void>(bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                                            record.number % 65, static_cast<std::byte>(record.number >> 8)));
  }
}

void apply(PackSurgeon& surgeon, const Record& record) {
  if (surgeon.chunks.empty()) return;
  const std::size_t c = (record.what_and_chunk >> 3) % surgeon.chunks.size();
  PackSurgeon::Chunk& chunk = surgeon.chunks[c];
  if (!(record.what_and_chunk & 4)) return change(chunk.content, record);
  // Inside a page, below zstd: where a grid and its one page stand one after the other.
  const bool is_grid =
      chunk.fourcc == PackSurgeon::fourcc("GRID") || chunk.fourcc == PackSurgeon::fourcc("DGRD");
  const bool has_page = c + 1 < surgeon.chunks.size() && is_grid && chunk.content.size() >= 32 &&
                        kelp::test::get<std::uint32_t>(chunk.content, chunk.content.size() - 24) ==
                            surgeon.chunks[c + 1].content.size();
  switch (record.at % 16) {
    case 0:
      chunk.level = record.number;
      break;
    case 1:
      chunk.part = record.number;
      break;
    case 2:
      chunk.flags ^= record.number & 7;
      break;
    case 3:
      chunk.raw_lie = record.number;
      break;
    case 4:
      chunk.gap = record.number % 256;
      break;
    case 5:
      std::swap(chunk, surgeon.chunks[record.number % surgeon.chunks.size()]);
      break;
    case 6:
      surgeon.chunks.erase(surgeon.chunks.begin() + static_cast<std::ptrdiff_t>(c));
      break;
    case 7:
      chunk.fourcc = record.number;
      break;
    case 8:
      chunk.offset_lie = record.number;
      break;
    case 9:
      surgeon.major = static_cast<std::uint16_t>(record.number);
      break;
    case 10:
      surgeon.minor = static_cast<std::uint16_t>(record.number);
      break;
    case 11:  // bricks of nothing
      if (has_page)
        surgeon.editPage(c, [](Bytes& page) { page.assign(page.size() / 512 * 512, std::byte{0}); });
      break;
    default:
      if (has_page)
        surgeon.editPage(c, [&](Bytes& page) {
          change(page, {static_cast<std::uint16_t>(record.number >> 30),
                        static_cast<std::uint16_t>(record.number), record.number >> 16});
        });
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const PackSurgeon sound[] = {
      PackSurgeon(readGolden("solid.kelp")), PackSurgeon(readGolden("fog.kelp")),
      PackSurgeon(readGolden("distance.kelp")), PackSurgeon(readGolden("joints.kelp")),
      PackSurgeon(readGolden("cage.kelp"))};
  if (size == 0) return 0;
  PackSurgeon surgeon = sound[data[0] % std::size(sound)];
  for (std::size_t at = 1; at + sizeof(Record) <= std::min<std::size_t>(size, 1 + 32 * sizeof(Record));
       at += sizeof(Record)) {
    Record record;
    std::memcpy(&record, data + at, sizeof record);
    apply(surgeon, record);
  }
  exercisePack(surgeon.build());
  return 0;
}
