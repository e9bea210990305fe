// SPDX-License-Identifier: MIT
#include "kelp/formats/source.h"

#include <gtest/gtest.h>

#include <array>
#ifdef _WIN32
#include <io.h>
#else
#include <unistd.h>
#endif

#include <cerrno>
#include <cstring>
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
  ASSERT_EQ(source.read(source.user, 50, got), Read::kDone);
  EXPECT_TRUE(std::equal(got.begin(), got.end(), bytes.begin() + 50));
  EXPECT_EQ(source.read(source.user, bytes.size() - 100, got), Read::kDone);
  EXPECT_TRUE(std::equal(got.begin(), got.end(), bytes.end() - 100));
  EXPECT_EQ(source.read(source.user, bytes.size(), {}), Read::kDone);
}

TEST(MemorySource, ReadsItsBytesWhereverItWasMoved) {
  const std::vector<std::byte> bytes = counting(1000);
  const Source source = MemorySource(bytes).source();
  expectReads(source, bytes);
}

TEST(FileSource, ReadsWithinItsBytesOnly) {
  const std::vector<std::byte> bytes = counting(1000);
  const TemporaryFile file(bytes);
  Result<FileSource> opened = FileSource::open(file.path.string().c_str());
  ASSERT_TRUE(opened);
  FileSource moved;
  moved = *std::move(opened);
  const Source source = moved.source();
  expectReads(source, bytes);
  std::vector<std::byte> got(100);
  EXPECT_EQ(source.read(source.user, bytes.size() - 99, got), Read::kFailed);
  EXPECT_EQ(source.read(source.user, ~std::uint64_t{0}, got), Read::kFailed);  // offset + size wraps around
}

// The natural std::vector<Model>: a source that was moved, or destroyed, leaves what reads it whole.
TEST(FileSource, MayMoveAndGoBeforeWhatReadsIt) {
  const std::vector<std::byte> bytes = counting(1000);
  const TemporaryFile file(bytes);
  Source source;
  {
    std::vector<FileSource> sources;
    sources.push_back(*FileSource::open(file.path.string().c_str()));
    source = sources[0].source();
    source.acquire(source.user);
    for (int i = 0; i < 10; ++i) sources.push_back(*FileSource::open(file.path.string().c_str()));
    expectReads(source, bytes);
  }
  expectReads(source, bytes);
  source.release(source.user);
}

// No file stays open: the process has as many as before.
TEST(FileSource, IsClosedAfterTheLastUse) {
  const TemporaryFile file(counting(1000));
  const auto lowestFree = [] {
    const int free = ::dup(0);
    ::close(free);
    return free;
  };
  const int before = lowestFree();
  {
    FileSource source = *FileSource::open(file.path.string().c_str());
    const Source used = source.source();
    used.acquire(used.user);
    source = *FileSource::open(file.path.string().c_str());
    used.release(used.user);
  }
  EXPECT_EQ(lowestFree(), before);
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
        if (source.read(source.user, offset, got) != Read::kDone ||
            !std::equal(got.begin(), got.end(), bytes.begin() + offset))
          ++wrong[worker];
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, (std::array<int, 4>{}));
}

TEST(FileSource, FailsWhenTheFileShrinks) {
  const TemporaryFile file(counting(1000));
  Result<FileSource> opened = FileSource::open(file.path.string().c_str());
  ASSERT_TRUE(opened);
  std::filesystem::resize_file(file.path, 10);
  std::array<std::byte, 64> got;
  const Source source = opened->source();
  EXPECT_EQ(source.read(source.user, 0, got), Read::kFailed);
}

TEST(FileSource, RefusesWhatIsNoRegularFile) {
  const Result<FileSource> missing = FileSource::open("/nonexistent/kelp/pack.kelp");
  EXPECT_EQ(errno, ENOENT);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kIo);
  const std::string text = missing.error().detail;
  EXPECT_NE(text.find("/nonexistent/kelp/pack.kelp: "), std::string::npos) << text;
  EXPECT_TRUE(text.ends_with(std::strerror(ENOENT))) << text;
  const std::string deep = FileSource::open((std::string(2000, 'x') + "/pack.kelp").c_str()).error().detail;
  EXPECT_NE(deep.find("xx/pack.kelp: "), std::string::npos) << "of a long path the end is named: " << deep;
  EXPECT_TRUE(deep.ends_with(std::strerror(ENAMETOOLONG))) << deep;
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
