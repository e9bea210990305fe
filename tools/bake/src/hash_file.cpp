// SPDX-License-Identifier: MIT
#include "hash_file.h"

#include <cstdio>
#include <fstream>
#include <new>
#include <vector>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "kelp/bake/bake.h"

namespace kelp::bake {
namespace {

std::string hexadecimal(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace

HashStream::HashStream() : state_(XXH3_createState()) {
  if (!state_) throw std::bad_alloc();
  XXH3_64bits_reset(static_cast<XXH3_state_t*>(state_));
}

HashStream::~HashStream() { XXH3_freeState(static_cast<XXH3_state_t*>(state_)); }

void HashStream::add(std::span<const std::byte> bytes) { XXH3_64bits_update(static_cast<XXH3_state_t*>(state_), bytes.data(), bytes.size()); }

std::uint64_t HashStream::value() const { return XXH3_64bits_digest(static_cast<const XXH3_state_t*>(state_)); }

std::string hashBytes(std::span<const std::uint8_t> bytes) { return hexadecimal(XXH3_64bits(bytes.data(), bytes.size())); }

std::string hashFile(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw BakeError(Exit::kIo, path.string() + ": can not be read again; keep the file in place while it is baked");
  HashStream hash;
  std::vector<char> block(1 << 20);
  while (file) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    hash.add(std::as_bytes(std::span(block.data(), static_cast<std::size_t>(file.gcount()))));
  }
  return hexadecimal(hash.value());
}

}  // namespace kelp::bake
