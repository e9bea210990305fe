// SPDX-License-Identifier: MIT
// The files an importer may open: the input, and files in its folder or below. References inside a file are hostile until resolved here.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "kelp/bake/bake.h"

namespace kelp::bake {

// Throws a BakeError that reads "FILE: PLACE: WHAT". `place` may be empty. `what` ends in "; " and the remedy, or gets the general one. Control characters and overlong texts are made harmless.
[[noreturn]] void refuse(Exit code, const std::filesystem::path& file, std::string_view place, std::string_view what);

// For a catch block of an importer: the BakeError there is, or one of what else was thrown. Logic errors (std::length_error, std::out_of_range) are kelp's own defects, and said to be.
[[noreturn]] void refuseThrown(const std::filesystem::path& file);

// A file that is there and can not be read: no reason to bake as if it were not there.
struct UnreadableFile : BakeError {
  using BakeError::BakeError;
};

// Whether an error says nothing of the file it is about: too little memory, a disk that fails.
bool isOfTheMachine(const BakeError& error);

class InputFiles;

// An error about what `place` in the input names, as one of that place: "INPUT: PLACE: " and the error's text, which may begin with another file.
BakeError inPlace(const InputFiles& files, std::string_view place, const BakeError& error);

// A text from a file or a library, fit for one line of a message and for a name in a pack: printable UTF-8, of at most `limit` of its bytes.
std::string oneLine(std::string_view text, std::size_t limit = 200);

// "name[index]", the way glTF's own validator names places.
std::string placeOf(std::string_view array, std::size_t index);

// kUnsupported for more parts than formats' Limits accept by default. `join` is what the user could join: "meshes".
void checkPartCount(const InputFiles& files, std::size_t parts, std::string_view join);

// RFC 3986, section 2.1; nullopt if an escape is broken.
std::optional<std::string> percentDecode(std::string_view text);

// Whether a URI names what is no file beside the input: "http:", "data:". RFC 3986, section 3.1; a single letter is a drive.
bool hasScheme(std::string_view uri);

// Whether a URI is its own data. RFC 2397.
bool isDataUri(std::string_view uri);

// File extension in lower case, with its dot.
std::string lowerExtension(const std::filesystem::path& path);

class InputFiles {
 public:
  // `used` may be null; every file opened, or found missing, is appended to it once.
  InputFiles(std::filesystem::path input, FilesUsed* used) : input_(std::move(input)), used_(used) {}

  const std::filesystem::path& input() const { return input_; }
  // The whole input. kIo when it can not be read or is larger than 4 GiB.
  std::vector<std::uint8_t> readInput() const { return readFile(input_); }
  // Its first bytes alone, for importers whose library opens the file itself.
  std::vector<std::uint8_t> readHead(std::size_t most) const;
  // The place of a file named inside the input, relative to the input's folder. A reference that leaves the folder, by ".." or by a link, is absolute or
  // names another scheme is refused (kInvalid); links that stay inside are followed. kIo when the folder can not be read.
  enum class Reference { kUri, kPath };  // percent-encoded (glTF), or as it stands with either slash (MTL)
  std::filesystem::path resolve(std::string_view reference, Reference kind) const;
  // Its content. kIo when it can not be read.
  std::vector<std::uint8_t> readReference(std::string_view reference, Reference kind) const;
  // Any other file that the user named (a rig).
  std::vector<std::uint8_t> readFile(const std::filesystem::path& path) const;
  // Whether it is there, which the bake depends on.
  bool isThere(const std::filesystem::path& path) const;
  // What was read so far, each file once: what a model may ask of memory is measured by it.
  std::uint64_t bytesRead() const { return bytes_read_; }

 private:
  std::vector<std::uint8_t> readFirst(const std::filesystem::path& path, std::uintmax_t most) const;

  // Entries of FilesUsed that are here: whoever else adds to it is caught up with.
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

// The memory that one kind of content may take: what was asked for (`max_memory` as in Settings), else `usual` and so much for every byte read, within the machine's.
std::uint64_t memoryAllowed(const InputFiles& files, std::uint64_t max_memory, std::uint64_t usual, std::uint64_t per_byte_read);

// What the data of a model may take together, read and unpacked. Few bytes can be unpacked to many, and be named again and again: so the bound is that of a
// large model for files that are large themselves, and less for small ones.
class DataBudget {
 public:
  static constexpr std::uint64_t kUsual = std::uint64_t{256} << 20;
  static constexpr std::uint64_t kPerByteRead = 256;  // twice what meshopt makes of a byte of zeros at most

  // `max_memory` as in Settings: what was asked for holds whatever the files' size.
  DataBudget(const InputFiles& files, std::uint64_t max_memory) : files_(files), max_memory_(max_memory) {}
  // Counts bytes that `place` takes. BakeError kRuntime if that is too much.
  void take(std::uint64_t bytes, std::string_view place);

 private:
  const InputFiles& files_;
  std::uint64_t max_memory_, taken_ = 0;
};

}  // namespace kelp::bake
