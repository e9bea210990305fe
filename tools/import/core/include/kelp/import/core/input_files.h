// SPDX-License-Identifier: MIT
// The files an importer may open: the input, and files in its folder or below. References inside a file are
// hostile until resolved here.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "kelp/common/error.h"
#include "kelp/import/core/files_used.h"

namespace kelp::bake {

// Throws a ToolError that reads "FILE: PLACE: WHAT; REMEDY". `place` may be empty. If `what` holds no "; ", a
// general remedy for the exit code is added. Control characters are removed and long texts cut.
[[noreturn]] void refuse(Exit code, const std::filesystem::path& file, std::string_view place,
                         std::string_view what);

// For the catch block of an importer: rethrows a ToolError, and turns any other exception into one. Logic
// errors (std::length_error, std::out_of_range) are reported as defects of kelp.
[[noreturn]] void refuseThrown(const std::filesystem::path& file);

// A file that exists but cannot be read. Callers must not go on as if it did not exist.
struct UnreadableFile : ToolError {
  using ToolError::ToolError;
};

// True for errors of the machine, not of the file: too little memory, a disk that fails.
bool isOfTheMachine(const ToolError& error);

class InputFiles;

// An error about a file that `place` in the input names, as an error of that place: "INPUT: PLACE: " and the
// error's own text.
ToolError inPlace(const InputFiles& files, std::string_view place, const ToolError& error);

// A text from a file or a library, made fit for one line of a message and for a name in a pack: printable
// UTF-8, cut to `limit` bytes.
std::string oneLine(std::string_view text, std::size_t limit = 200);

// "name[index]", the way glTF's own validator names places.
std::string placeOf(std::string_view array, std::size_t index);

// ToolError kUnsupported for more parts than the pack reader accepts by default. `join` is what the user
// could join: "meshes".
void checkPartCount(const InputFiles& files, std::size_t parts, std::string_view join);

// RFC 3986, section 2.1; nullopt if an escape is broken.
std::optional<std::string> percentDecode(std::string_view text);

// True if a URI holds its data itself ("data:"). RFC 2397.
bool isDataUri(std::string_view uri);

// File extension in lower case, with its dot.
std::string lowerExtension(const std::filesystem::path& path);

class InputFiles {
 public:
  // `used` may be null. Every file that is opened or missing is appended to it once.
  InputFiles(std::filesystem::path input, FilesUsed* used) : input_(std::move(input)), used_(used) {}

  const std::filesystem::path& input() const { return input_; }
  // The whole input. ToolError kIo if it cannot be read, kUnsupported if it is larger than 4 GiB.
  std::vector<std::uint8_t> readInput() const { return readFile(input_); }
  // Only its first `most` bytes.
  std::vector<std::uint8_t> readHead(std::size_t most) const;
  // The path of a file that the input names, relative to the input's folder. A reference is refused
  // (kInvalid) if it is absolute, has a scheme, or leaves the folder by ".." or by a link. Links that stay
  // inside are followed. ToolError kIo if the folder cannot be read.
  enum class Reference { kUri, kPath };  // percent-encoded (glTF), or as written with either slash (MTL)
  std::filesystem::path resolve(std::string_view reference, Reference kind) const;
  // The same; a reference that is refused is tried by its last component (after either slash) in the input's
  // folder, and nowhere else.
  std::filesystem::path resolveOrBeside(std::string_view reference, Reference kind) const;
  // The content of a picture, found as resolveOrBeside() does. ToolError kIo if it cannot be read.
  std::vector<std::uint8_t> readPicture(std::string_view reference, Reference kind) const;
  // Any other file that the user named, such as a rig.
  std::vector<std::uint8_t> readFile(const std::filesystem::path& path) const;
  // True if a file exists. A missing one is noted in FilesUsed: the bake depends on it.
  bool isThere(const std::filesystem::path& path) const;
  // The bytes read so far, each file counted once. The memory that a model may use is measured by it.
  std::uint64_t bytesRead() const { return bytes_read_; }

 private:
  std::vector<std::uint8_t> readFirst(const std::filesystem::path& path, std::uintmax_t most) const;

  // The entries of FilesUsed that are in `paths`; others may have added entries since.
  struct Listed {
    std::set<std::filesystem::path> paths;
    std::size_t entries = 0;
  };

  bool isListedRead(const std::filesystem::path& path) const;
  void noteMissing(const std::filesystem::path& path) const;
  void countRead(const std::filesystem::path& path, std::uint64_t size) const;
  void checkFileCount() const;

  std::filesystem::path input_;
  FilesUsed* used_;
  mutable std::set<std::filesystem::path> counted_;
  mutable std::uint64_t bytes_read_ = 0, bytes_again_ = 0;
  mutable Listed read_, missing_;
};

// The memory that one kind of content may take: `max_memory` if it is not 0 (see ImportSettings), else
// `usual` and `per_byte_read` for every byte read, but no more than the machine has.
std::uint64_t memoryAllowed(const InputFiles& files, std::uint64_t max_memory, std::uint64_t usual,
                            std::uint64_t per_byte_read);

// Bounds the memory for all data of a model, read and unpacked. A few bytes can unpack to many, and can be
// named again and again, so a small file gets less than a large one.
class DataBudget {
 public:
  static constexpr std::uint64_t kUsual = std::uint64_t{256} << 20;
  static constexpr std::uint64_t kPerByteRead = 256;  // twice the most that meshopt makes of one byte

  // `max_memory` as in ImportSettings: if it is given, it is the bound for files of any size.
  DataBudget(const InputFiles& files, std::uint64_t max_memory) : files_(files), max_memory_(max_memory) {}
  // Counts the bytes that `place` takes. ToolError kRuntime if the sum is too large.
  void take(std::uint64_t bytes, std::string_view place);
  std::uint64_t maxMemory() const { return max_memory_; }

 private:
  const InputFiles& files_;
  std::uint64_t max_memory_, taken_ = 0;
};

}  // namespace kelp::bake
