// SPDX-License-Identifier: MIT
#include "output_file.h"

#include <bit>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "commands.h"
#include "kelp/console/console.h"

namespace kelp::dump {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "OutputFile::number writes numbers as they are in memory");

constexpr std::size_t kBuffer = std::size_t{1} << 18;

// Through symbolic links, so that a link stays one.
std::string target(const std::string& path) {
  fs::path real = console::pathOf(path);
  std::error_code error;
  for (int hops = 0; hops < 40 && fs::is_symlink(real, error); ++hops) {
    // The file of an open stream would be replaced beneath who else writes to it.
    const std::string folder = real.parent_path().generic_string();
    if (folder == "/dev/fd" || (folder.rfind("/proc/", 0) == 0 && real.parent_path().filename() == "fd")) throw DumpError(kIo, fmt::format("{}: is an open stream; give - for standard output, or name a file", path));
    real = real.parent_path() / fs::read_symlink(real, error);
  }
  return console::nameOf(real);
}

}  // namespace

void checkOutput(const std::string& output, const std::string& input, const char* what) {
  if (output == "-") {
    if (!console::isTerminal(console::Stream::kOut)) return;
    throw DumpError(kUsage, fmt::format("-: {} is nothing that a terminal can show; redirect it (> FILE, or | PROGRAM), or name a file", what));
  }
  std::error_code error;
  if (input == "-" || !fs::equivalent(console::pathOf(output), console::pathOf(input), error)) return;
  throw DumpError(kUsage, fmt::format("{}: would overwrite {}, which is read; name another file", output, input));
}

OutputFile::OutputFile(const std::string& path) : path_(path == "-" ? path : target(path)) {
  buffer_.reserve(kBuffer);
  if (path_ == "-") return;
  std::error_code error;
  const fs::file_status status = fs::status(console::pathOf(path_), error);
  if (fs::exists(status) && !fs::is_regular_file(status)) throw DumpError(kIo, fmt::format("{}: is {}; name a file for the output", path_, fs::is_directory(status) ? "a folder" : "no regular file"));
  check("can not be written", file_.create(path_));
}

void OutputFile::check(const char* what, const std::string& problem) const {
  if (problem.empty()) return;
  if (path_ == "-") throw DumpError(kIo, fmt::format("standard output {}: {}; free space or choose another file", what, problem));
  throw DumpError(kIo, fmt::format("{}: {}: {}; check that the folder exists, is writable and has room", path_, what, problem));
}

void OutputFile::write(std::span<const std::byte> bytes) {
  if (buffer_.size() + bytes.size() > kBuffer) flush();
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

void OutputFile::flush() {
  if (path_ == "-") {
    check("can not be written", console::writeOut({reinterpret_cast<const char*>(buffer_.data()), buffer_.size()}));
  } else {
    check("can not be written", file_.write(buffer_));
  }
  buffer_.clear();
}

void OutputFile::writeBy(const std::function<void(std::ostream&)>& write) {
  std::ofstream stream;
  stream.exceptions(std::ios::failbit | std::ios::badbit);
  errno = 0;
  try {
    stream.open(console::pathOf(file_.name()), std::ios::binary);
    write(stream);
    stream.close();
  } catch (const std::ios_base::failure&) {
    check("can not be written", std::strerror(errno != 0 ? errno : EIO));
  }
}

void OutputFile::commit() {
  flush();
  if (path_ != "-") check("can not be put in place", file_.commit());
}

}  // namespace kelp::dump
