// SPDX-License-Identifier: MIT
#include "cache/cache_entry.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <vector>

#include "kelp/bake/bake.h"
#include "kelp/common/hash.h"

namespace kelp::bake_cli {
namespace {

constexpr const char* kMagic = "kelp-cache 1 ";
constexpr std::size_t kBlock = std::size_t{1} << 20;
constexpr std::uint64_t kMaxReport = std::uint64_t{256} << 20;

// Calls `use` with all of a stream up to `bytes`; false if there is less.
template <class Use>
bool readBlocks(std::istream& in, std::uint64_t bytes, const Use& use) {
  std::vector<char> block(kBlock);
  while (bytes > 0) {
    in.read(block.data(), static_cast<std::streamsize>(std::min<std::uint64_t>(block.size(), bytes)));
    const auto got = static_cast<std::size_t>(in.gcount());
    if (got == 0) return false;
    use(std::as_bytes(std::span(block.data(), got)));
    bytes -= got;
  }
  return true;
}

[[noreturn]] void failToRead(const std::filesystem::path& file) {
  throw ToolError(Exit::kIo,
                  file.string() + ": cannot be read again; keep the pack in place while it is baked");
}

// "SIZE " from the front of a text.
std::optional<std::uint64_t> takeNumber(std::string_view& text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end == text.data() + text.size() || *end != ' ') return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end + 1 - text.data()));
  return number;
}

}  // namespace

void writeEntry(const std::filesystem::path& entry, const std::string& report,
                const std::filesystem::path& pack, const std::string& pack_hash) {
  std::ifstream in(pack, std::ios::binary | std::ios::ate);
  if (!in) failToRead(pack);
  const auto bytes = static_cast<std::uint64_t>(in.tellg());
  Hash hash;
  hash.add(report);
  in.seekg(0);
  Hash hash_of_pack;
  const auto add = [&](std::span<const std::byte> block) {
    hash.add(block);
    hash_of_pack.add(block);
  };
  // others may write to the same place
  if (!readBlocks(in, bytes, add) || hash_of_pack.text() != pack_hash) failToRead(pack);
  const std::string head =
      kMagic + std::to_string(report.size()) + " " + std::to_string(bytes) + " " + hash.text() + "\n";
  OutputFile file(entry);
  file.write(head);
  file.write(report);
  in.clear();
  in.seekg(0);
  if (!readBlocks(in, bytes, [&](std::span<const std::byte> block) { file.write(block); })) failToRead(pack);
  file.commit();
}

std::optional<Entry> readEntry(const std::filesystem::path& entry, OutputFile& pack) {
  std::ifstream in(entry, std::ios::binary);
  char line[128];
  if (!in.getline(line, sizeof line)) return std::nullopt;
  std::string_view head(line);
  if (head.rfind(kMagic, 0) != 0) return std::nullopt;
  head.remove_prefix(std::string_view(kMagic).size());
  const std::optional<std::uint64_t> report_bytes = takeNumber(head), pack_bytes = takeNumber(head);
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(entry, error);
  if (error || !report_bytes || !pack_bytes || *report_bytes > std::min<std::uint64_t>(size, kMaxReport) ||
      *pack_bytes > size)
    return std::nullopt;
  Entry out;
  out.pack_bytes = *pack_bytes;
  Hash hash;
  const auto keep = [&](std::span<const std::byte> block) {
    out.report.append(reinterpret_cast<const char*>(block.data()), block.size());
  };
  if (!readBlocks(in, *report_bytes, keep)) return std::nullopt;
  hash.add(out.report);
  const auto copy = [&](std::span<const std::byte> block) {
    hash.add(block);
    pack.write(block);
  };
  if (!readBlocks(in, *pack_bytes, copy) || in.peek() != std::ifstream::traits_type::eof() ||
      hash.text() != head)
    return std::nullopt;
  return out;
}

}  // namespace kelp::bake_cli
