// SPDX-License-Identifier: MIT
#include "kelp/formats/source.h"

#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "support/scratch.h"

namespace kelp {
namespace {

std::vector<std::byte> counting(std::size_t size) {
  std::vector<std::byte> bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(i * 7 + i / 256);
  return bytes;
}

// A file that goes with the test.
struct TemporaryFile {
  explicit TemporaryFile(const std::vector<std::byte>& bytes) : path(scratch.write("source.bin", bytes)) {}
  test::Scratch scratch;
  std::filesystem::path path;
};

void expectReads(const Source& source, const std::vector<std::byte>& bytes) {
  ASSERT_EQ(source.size, bytes.size());
  std::vector<std::byte> got(100);
  ASSERT_TRUE(source.read(source.user, 50, got));
  EXPECT_TRUE(std::equal(got.begin(), got.end(), bytes.begin() + 50));
  EXPECT_TRUE(source.read(source.user, bytes.size() - 100, got));
  EXPECT_FALSE(source.read(source.user, bytes.size() - 99, got));
  EXPECT_TRUE(source.read(source.user, bytes.size(), {}));
  EXPECT_FALSE(source.read(source.user, bytes.size() + 1, {}));
  EXPECT_FALSE(source.read(source.user, ~std::uint64_t{0}, got));  // offset + size would wrap around
}

TEST(MemorySource, ReadsWithinItsBytesOnly) {
  const std::vector<std::byte> bytes = counting(1000);
  MemorySource memory(bytes);
  expectReads(memory.source(), bytes);
}

TEST(FileSource, ReadsWithinItsBytesOnly) {
  const std::vector<std::byte> bytes = counting(1000);
  const TemporaryFile file(bytes);
  Result<FileSource> opened = FileSource::open(file.path.string().c_str());
  ASSERT_TRUE(opened);
  FileSource moved;
  moved = *std::move(opened);
  expectReads(moved.source(), bytes);
}

TEST(FileSource, TakesPathsAsUtf8) {
  const std::vector<std::byte> bytes = counting(1000);
  const test::Scratch scratch;
  const std::filesystem::path path = scratch.folder() / u8"s\u00f6-\u6d77\u85fb-\U0001f33f.kelp";
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  const std::u8string name = path.u8string();
  Result<FileSource> opened = FileSource::open(reinterpret_cast<const char*>(name.c_str()));
  ASSERT_TRUE(opened) << errno;
  expectReads(opened->source(), bytes);
#ifdef _WIN32
  EXPECT_FALSE(FileSource::open("\xff\xfe.kelp"));
  EXPECT_EQ(errno, EILSEQ);
#endif
}

TEST(FileSource, LetsOthersReplaceTheFile) {
  const std::vector<std::byte> bytes = counting(1000);
  const TemporaryFile file(bytes);
  Result<FileSource> opened = FileSource::open(file.path.string().c_str());
  ASSERT_TRUE(opened);
  const std::filesystem::path newer = file.scratch.write("newer.bin", counting(10)),
                              aside = file.scratch / "aside.bin";
  std::filesystem::rename(file.path, aside);
  std::filesystem::rename(newer, file.path);
  expectReads(opened->source(), bytes);
}

TEST(FileSource, ReadsFromManyThreadsAtOnce) {
  const std::vector<std::byte> bytes = counting(100000);
  const TemporaryFile file(bytes);
  Result<FileSource> opened = FileSource::open(file.path.string().c_str());
  ASSERT_TRUE(opened);
  const Source source = opened->source();
  std::array<int, 4> wrong{};
  std::vector<std::thread> threads;
  for (std::size_t worker = 0; worker < wrong.size(); ++worker) {
    threads.emplace_back([&, worker] {
      std::array<std::byte, 64> got;
      for (std::size_t i = 0; i < 500; ++i) {
        const std::size_t offset = (i * 7919 + worker * 104729) % (bytes.size() - got.size());
        if (!source.read(source.user, offset, got) ||
            !std::equal(got.begin(), got.end(), bytes.begin() + offset))
          ++wrong[worker];
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, (std::array<int, 4>{}));
}

TEST(FileSource, AnswersFalseWhenTheFileShrinks) {
  const TemporaryFile file(counting(1000));
  Result<FileSource> opened = FileSource::open(file.path.string().c_str());
  ASSERT_TRUE(opened);
  std::filesystem::resize_file(file.path, 10);
  std::array<std::byte, 64> got;
  const Source source = opened->source();
  EXPECT_FALSE(source.read(source.user, 0, got));
}

TEST(FileSource, RefusesWhatIsNoRegularFile) {
  const Result<FileSource> missing = FileSource::open("/nonexistent/kelp/pack.kelp");
  ASSERT_FALSE(missing);
  EXPECT_EQ(errno, ENOENT);
  EXPECT_EQ(missing.error().code, ErrorCode::kIo);
  const test::Scratch scratch;  // removing it may touch errno
  const Result<FileSource> folder = FileSource::open(scratch.folder().string().c_str());
  ASSERT_FALSE(folder);
  EXPECT_EQ(errno, EISDIR);
  EXPECT_EQ(folder.error().code, ErrorCode::kIo);
  const Result<FileSource> null = FileSource::open(nullptr);
  ASSERT_FALSE(null);
  EXPECT_EQ(null.error().code, ErrorCode::kMisuse);
}

}  // namespace
}  // namespace kelp
