// SPDX-License-Identifier: MIT
#include "kelp/common/output_file.h"

#include <bit>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "file_system.h"
#include "kelp/common/console.h"
#include "kelp/common/error.h"

namespace kelp {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little,
              "OutputFile::number writes numbers as they are in memory");

constexpr std::size_t kBuffer = std::size_t{1} << 18;
constexpr std::size_t kMostOfName = 200;  // of the 255 bytes that a name may have
// Processes in containers share numbers, so temporaries that killed ones left can be in the way.
constexpr int kMostTemporaries = 10'000;
constexpr const char* kMakeRoom = "free some space or choose another disk";

[[noreturn]] void fail(const fs::path& path, const std::string& what, const std::string& remedy) {
  const std::string name = path.empty() ? "standard output" : console::nameOf(path);
  throw ToolError(Exit::kIo, name + ": " + what + "; " + remedy);
}

[[noreturn]] void fail(const fs::path& path, const std::string& what, const std::error_code& reason,
                       const std::string& remedy) {
  fail(path, what + ": " + reason.message(), remedy);
}

fs::path folderOf(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : "."; }

// The names of this process's temporary files for a path begin with this; a number and ".tmp" follow.
std::string temporaryStem(const fs::path& path) {
  std::string name = console::nameOf(path.filename());
  if (name.size() > kMostOfName) {
    std::size_t end = kMostOfName;
    while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xc0) == 0x80) --end;  // whole characters
    name.resize(end);
  }
  return "." + name + "." + std::to_string(processId()) + "-";
}

bool isDevice(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

constexpr int kMostLinks = 40;  // as many as Linux follows

// Follows links until `done(path)` holds, or the path is no link.
template <class Done>
fs::path follow(fs::path path, const Done& done) {
  std::error_code error;
  for (int links = 0; links < kMostLinks && !done(path) && fs::is_symlink(path, error); ++links)
    path = path.parent_path() / fs::read_symlink(path, error);
  return path;
}

// N of /dev/fd/N and /proc/PROCESS/fd/N.
std::optional<int> streamNumber(const fs::path& path) {
  const std::string folder = path.parent_path().generic_string(), name = path.filename().generic_string();
  if (folder != "/dev/fd" && !(folder.starts_with("/proc/") && folder.ends_with("/fd"))) return {};
  int number = 0;
  const char* const end = name.data() + name.size();
  const auto [stop, problem] = std::from_chars(name.data(), end, number);
  return problem == std::errc() && stop == end ? std::optional(number) : std::nullopt;
}

}  // namespace

OutputFile::OutputFile() { buffer_.reserve(kBuffer); }

OutputFile OutputFile::orStandardOutput(const fs::path& path) {
  return path == "-" ? OutputFile() : OutputFile(path);
}

OutputFile::OutputFile(const fs::path& path) : path_(path) {
  buffer_.reserve(kBuffer);
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) fail(path, "is a folder", "name a file for the output");
  if (path.filename().empty()) fail(path, "is the name of a folder", "name a file in it");
  if (streamOf(path))
    fail(path, "is an open stream, but the output replaces a file when it is complete", "name a file");
  if (isDevice(path)) fail(path, "is not a regular file", "name a file for the output");
  // The temporary file has a shorter name, so it would be found out last.
  if (error == std::errc::filename_too_long) fail(path, "cannot be written", error, "choose a shorter name");
  final_ = followLinks(path);
  create();
}

void OutputFile::create() {
  const std::string stem = temporaryStem(final_);
  std::error_code problem = std::make_error_code(std::errc::file_exists);
  const InterruptsWait wait;
  for (int i = 0; problem == std::errc::file_exists && i < kMostTemporaries; ++i) {
    temporary_ = folderOf(final_) / console::pathOf(stem + std::to_string(i) + ".tmp");
    problem = createFile(temporary_, file_);
  }
  if (problem)
    fail(path_, "cannot be written", problem, "choose a folder that exists and that you may write to");
  guardFile(temporary_, file_);
  keepPermissions(final_, file_);
}

OutputFile::~OutputFile() {
  if (temporary_.empty()) return;
  if (file_ >= 0) closeFile(file_);
  std::error_code ignored;
  fs::remove(temporary_, ignored);
  unguardFile(temporary_);
}

void OutputFile::put(std::span<const std::byte> bytes) {
  if (isStandardOutput())
    problem_ = console::writeOut({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  else if (const std::error_code problem = writeAll(file_, bytes))
    problem_ = problem.message();
}

void OutputFile::putBuffer() {
  if (!failed()) put(buffer_);
  buffer_.clear();
}

void OutputFile::flush() {
  putBuffer();
  throwIfFailed();
}

bool OutputFile::tryWrite(std::span<const std::byte> bytes) {
  if (buffer_.size() + bytes.size() > kBuffer) putBuffer();
  if (failed()) return false;
  if (bytes.size() < kBuffer)
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  else
    put(bytes);
  return !failed();
}

void OutputFile::write(std::span<const std::byte> bytes) {
  if (!tryWrite(bytes)) throwIfFailed();
}

void OutputFile::throwIfFailed() const {
  if (failed()) fail(path_, "cannot be written: " + problem_, kMakeRoom);
}

void OutputFile::writeBy(const std::function<void(std::ostream&)>& write) {
  std::ofstream stream;
  stream.exceptions(std::ios::failbit | std::ios::badbit);
  errno = 0;
  try {
    stream.open(temporary_, std::ios::binary);
    write(stream);
    stream.close();
  } catch (const std::ios_base::failure&) {
    problem_ = std::strerror(errno != 0 ? errno : EIO);
  }
  throwIfFailed();
}

void OutputFile::commit() {
  flush();
  if (isStandardOutput()) return;
  if (const std::error_code problem = flushToDisk(file_))
    fail(path_, "cannot be flushed to disk", problem, kMakeRoom);
  if (const std::error_code problem = closeFile(std::exchange(file_, -1)))
    fail(path_, "cannot be written", problem, kMakeRoom);
  if (const std::error_code problem = replaceFile(temporary_, final_))
    fail(path_, "cannot be replaced", problem, "choose another name");
  unguardFile(temporary_);
  temporary_.clear();
  flushFolder(folderOf(final_));
}

void checkOutput(const fs::path& path) { const OutputFile probe(path); }

void checkNotOverwritten(const fs::path& output, const fs::path& input) {
  std::error_code error;
  if (!fs::equivalent(output, input, error)) return;
  throw ToolError(Exit::kUsage, console::nameOf(output) + ": would overwrite " + console::nameOf(input) +
                                    ", which is read; name another file");
}

void checkTextOutput(const fs::path& path) {
  if (!streamOf(path) && !isDevice(path)) checkOutput(path);
}

void writeTextFile(const fs::path& path, std::string_view text) {
  const std::span<const std::byte> bytes = std::as_bytes(std::span(text.data(), text.size()));
  if (const std::optional<int> stream = streamOf(path)) {
    if (const std::error_code problem = writeAll(*stream, bytes))
      fail(path, "cannot be written", problem, kMakeRoom);
    return;
  }
  if (isDevice(path)) {
    errno = 0;
    std::ofstream device(path, std::ios::binary);
    device << text;
    device.close();
    if (!device) fail(path, std::string("cannot be written: ") + std::strerror(errno), kMakeRoom);
    return;
  }
  OutputFile file(path);
  file.write(bytes);
  file.commit();
}

fs::path followLinks(const fs::path& path) {
  return follow(path, [](const fs::path&) { return false; });
}

std::optional<int> streamOf(const fs::path& path) {
  std::optional<int> number;
  follow(path, [&](const fs::path& at) { return (number = streamNumber(at)).has_value(); });
  return number;
}

}  // namespace kelp
