// SPDX-License-Identifier: MIT
// Output that is either the old file or the new one, whole.
#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <fstream>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "kelp/bake/bake.h"
#include "kelp/bake/hash.h"
#include "kelp/bake/output_file.h"
#include "memory_estimate.h"
#include "parallel.h"

namespace kelp::bake {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what, int error, const std::string& remedy) {
  throw BakeError(Exit::kIo, path.string() + ": " + what + (error != 0 ? ": " + std::generic_category().message(error) : std::string()) + "; " + remedy);
}

// The stream of this process that a path names, such as /dev/stdout: a file that is open already, which is written on and not replaced.
std::optional<int> streamOf(std::filesystem::path path) {
  std::error_code error;
  for (int hops = 0; hops < 40; ++hops) {
    const std::string folder = path.parent_path().string(), name = path.filename().string();
    const bool is_stream = folder == "/dev/fd" || (folder.rfind("/proc/", 0) == 0 && folder.size() > 3 && folder.compare(folder.size() - 3, 3, "/fd") == 0);
    int number = 0;
    if (is_stream && std::from_chars(name.data(), name.data() + name.size(), number).ptr == name.data() + name.size() && !name.empty()) return number;
    if (!std::filesystem::is_symlink(path, error)) return {};
    path = path.parent_path() / std::filesystem::read_symlink(path, error);
  }
  return {};
}

// Where a symbolic link leads, so that it stays one.
std::filesystem::path followed(std::filesystem::path real) {
  std::error_code error;
  for (int hops = 0; hops < 40 && std::filesystem::is_symlink(real, error); ++hops) real = real.parent_path() / std::filesystem::read_symlink(real, error);
  return real;
}

// Where the bytes go.
std::filesystem::path target(const std::filesystem::path& path) {
  if (path.filename().empty()) fail(path, "is the name of a folder", 0, "name a file in it");
  if (streamOf(path)) fail(path, "is an open stream, which is no place for a file that is replaced when the new one is complete", 0, "name a file");
  return followed(path);
}

struct Output {
  OutputFile& file;
  const Progress& progress;
  std::uint64_t bytes = 0;
  Hash hash;
  bool interrupted = false;
};

bool receive(void* user, std::span<const std::byte> bytes) {
  Output& output = *static_cast<Output*>(user);
  output.bytes += bytes.size();
  output.hash.add(bytes);
  if (output.progress && !output.progress("write", 0.5)) output.interrupted = true;
  return !output.interrupted && output.file.write(bytes);
}

// What the names of a process's temporary files for a path begin with.
std::string temporaryOf(const std::filesystem::path& path, long process) { return "." + path.filename().string().substr(0, 200) + "." + std::to_string(process) + "-"; }

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& path) : final_(target(path)), folder_(final_.has_parent_path() ? final_.parent_path() : ".") {
  struct stat status {};
  const bool replaces = ::stat(final_.c_str(), &status) == 0;
  if (replaces && !S_ISREG(status.st_mode)) {
    fail(final_, S_ISDIR(status.st_mode) ? "is a folder" : "is not a regular file", 0, "name a file for the output");
  }
  if (!replaces && errno == ENAMETOOLONG) fail(final_, "can not be written", errno, "choose a shorter name");  // the file beside it has one
  static std::atomic<unsigned> counter{0};
  for (int attempt = 0; attempt < 100; ++attempt) {
    const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
    path_ = folder_ / (temporaryOf(final_, ::getpid()) + std::to_string(now % 1000000) + "-" + std::to_string(counter++) + ".tmp");
    file_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file_ >= 0) {
      // A pack that others may not read stays so. Where a file system knows no modes there is none to keep.
      if (replaces) static_cast<void>(::fchmod(file_, status.st_mode & 0777));
      return;
    }
    if (errno != EEXIST) break;
  }
  fail(final_, "can not be written", errno, "choose a folder that exists and that you may write to");
}

OutputFile::~OutputFile() {
  if (file_ >= 0) ::close(file_);
  if (!path_.empty()) ::unlink(path_.c_str());
}

bool OutputFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      error_ = written < 0 ? errno : ENOSPC;
      return false;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

void OutputFile::commit() {
  if (error_ != 0) fail(final_, "can not be written", error_, "free some space or choose another disk");
  if (::fsync(file_) != 0) fail(final_, "can not be flushed to disk", errno, "free some space or choose another disk");
  const int closed = ::close(std::exchange(file_, -1));
  if (closed != 0) fail(final_, "can not be written", errno, "free some space or choose another disk");
  if (::rename(path_.c_str(), final_.c_str()) != 0) fail(final_, "can not be replaced", errno, "choose another name");
  path_.clear();
  const int folder = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    ::fsync(folder);  // some file systems have no such call for folders: the file itself is safe
    ::close(folder);
  }
}

void OutputFile::removeLeftBy(long process, const std::filesystem::path& path) {
  if (streamOf(path)) return;  // it had none
  const std::filesystem::path final = followed(path), folder = final.has_parent_path() ? final.parent_path() : ".";
  const std::string begin = temporaryOf(final, process);
  std::error_code error;
  for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (at->path().filename().string().rfind(begin, 0) == 0 && at->path().extension() == ".tmp") ::unlink(at->path().c_str());
  }
}

void checkOutput(const std::filesystem::path& path) { const OutputFile probe(path); }

void checkTextOutput(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (streamOf(path) || (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) && !std::filesystem::is_directory(status))) return;
  checkOutput(path);
}

void writeTextFile(const std::filesystem::path& path, std::string_view text) {
  std::error_code error;
  if (const std::optional<int> stream = streamOf(path)) {
    while (!text.empty()) {
      const ssize_t written = ::write(*stream, text.data(), text.size());
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) fail(path, "can not be written", errno, "free some space or choose another file");
      text.remove_prefix(static_cast<std::size_t>(written));
    }
    return;
  }
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error) && !std::filesystem::is_directory(path, error)) {
    errno = 0;
    std::ofstream file(path, std::ios::binary);
    file << text;
    file.close();
    if (!file) fail(path, "can not be written", errno, "free some space or choose another file");
    return;
  }
  OutputFile file(path);
  file.write(std::as_bytes(std::span(text.data(), text.size())));
  file.commit();
}

void writePackFile(const RawPack& pack, const std::filesystem::path& path, int threads, Report& report, const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  OutputFile file(path);
  Output output{file, progress, 0, {}, false};
  const Result<void> written = writePack(pack, Sink{receive, &output}, threadCount(threads));
  if (output.interrupted || (progress && !progress("write", 1.0))) throw BakeError(Exit::kInterrupted, "interrupted");
  if (!written) {
    if (written.error().code == ErrorCode::kIo) fail(path, "can not be written", file.error(), "free some space or choose another disk");
    if (written.error().code == ErrorCode::kOutOfMemory) throw std::bad_alloc();
    throw BakeError(Exit::kRuntime, path.string() + ": the model makes no valid pack (" + written.error().detail + "); try another --resolution, and report this as a defect of kelp-bake");
  }
  file.commit();
  report.pack_bytes = output.bytes;
  report.pack_hash = output.hash.text();
  report.stages.push_back({"write", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), peakMemory()});
}

}  // namespace kelp::bake
