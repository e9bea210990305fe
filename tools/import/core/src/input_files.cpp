// SPDX-License-Identifier: MIT
#include "kelp/import/core/input_files.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <new>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "kelp/common/hash.h"
#include "kelp/common/memory.h"
#include "kelp/formats/pack.h"
#include "kelp/import/core/memory_estimate.h"

namespace kelp::bake {
namespace {

constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{4} << 30;
// The most files beside the input, read or missing. A pack's INFO, reports and make rules list all of them.
constexpr std::size_t kMostFiles = 4000;
// The bytes that may be read again where a file is named more than once, such as a picture by many images.
constexpr std::uint64_t kUsualAgain = std::uint64_t{1} << 30, kTimesAgain = 64;

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

// The bytes of the first character of a text that is not empty; none if they are not UTF-8.
std::string_view firstLetter(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::size_t length = byte(0) < 0x80   ? 1
                             : byte(0) < 0xc2 ? 0
                             : byte(0) < 0xe0 ? 2
                             : byte(0) < 0xf0 ? 3
                             : byte(0) < 0xf5 ? 4
                                              : 0;
  if (text.size() < length) return {};
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xc0) != 0x80) return {};
  // Overlong forms, surrogates, beyond the last code point.
  const unsigned char second = length > 1 ? byte(1) : 0;
  if ((byte(0) == 0xe0 && second < 0xa0) || (byte(0) == 0xed && second > 0x9f) ||
      (byte(0) == 0xf0 && second < 0x90) || (byte(0) == 0xf4 && second > 0x8f))
    return {};
  return text.substr(0, length);
}

bool saysNoSuchFile(const std::error_code& error) {
  return error == std::errc::no_such_file_or_directory || error == std::errc::not_a_directory ||
         error == std::errc::filename_too_long || error == std::errc::too_many_symbolic_link_levels;
}

// The general remedy, for errors that name no better one.
const char* remedyOf(Exit code) {
  switch (code) {
    case Exit::kIo:
      return "; check the path and its permissions";
    case Exit::kInvalid:
      return "; repair the file there or export it again";
    case Exit::kRuntime:
      return "; raise --max-memory, free memory, or bake a smaller model";
    default:
      return "; export it in another way";
  }
}

}  // namespace

std::string oneLine(std::string_view text, std::size_t limit) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::string_view letter = firstLetter(text.substr(at));
    if (at + std::max<std::size_t>(letter.size(), 1) > limit) break;  // never half of a character
    at += std::max<std::size_t>(letter.size(), 1);
    const auto first = static_cast<unsigned char>(letter.empty() ? '?' : letter[0]);
    const bool control =
        first < 0x20 || first == 0x7f || (first == 0xc2 && static_cast<unsigned char>(letter[1]) < 0xa0);
    if (letter.empty()) {
      out += '?';
    } else if (!control) {
      out += letter;
    } else if (!out.empty() && out.back() != ' ') {
      out += ' ';
    }
  }
  while (!out.empty() && out.back() == ' ') out.pop_back();
  if (text.size() > limit) out += "...";
  return out;
}

ToolError inPlace(const InputFiles& files, std::string_view place, const ToolError& error) {
  const std::string input = oneLine(files.input().string(), 4096) + ": ", what = error.what();
  return {error.exit,
          input + std::string(place) + ": " + (what.rfind(input, 0) == 0 ? what.substr(input.size()) : what)};
}

std::optional<std::string> percentDecode(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    const int high = i + 1 < text.size() ? hexDigit(text[i + 1]) : -1;
    const int low = i + 2 < text.size() ? hexDigit(text[i + 2]) : -1;
    if (high < 0 || low < 0) return std::nullopt;
    out += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return out;
}

void refuseThrown(const std::filesystem::path& file) {
  try {
    throw;
  } catch (const ToolError&) {
    throw;
  } catch (const std::bad_alloc&) {
    refuse(Exit::kRuntime, file, "", "does not fit into memory");
  } catch (const std::logic_error& error) {
    refuse(Exit::kRuntime, file, "",
           std::string("kelp fails at it (") + error.what() +
               "); please report this as a defect, with the file");
  } catch (const std::exception& error) {
    refuse(Exit::kInvalid, file, "", std::string("cannot be read: ") + error.what());
  }
}

bool isDataUri(std::string_view uri) {
  constexpr std::string_view kScheme = "data:";
  return uri.size() >= kScheme.size() &&
         std::equal(kScheme.begin(), kScheme.end(), uri.begin(),
                    [](char a, char b) { return a == (b >= 'A' && b <= 'Z' ? b - 'A' + 'a' : b); });
}

std::string placeOf(std::string_view array, std::size_t index) {
  return std::string(array) + '[' + std::to_string(index) + ']';
}

void checkPartCount(const InputFiles& files, std::size_t parts, std::string_view join) {
  const std::size_t most = PackLimits{}.max_parts;
  if (parts > most)
    refuse(Exit::kUnsupported, files.input(), "scene",
           "makes " + std::to_string(parts) + " parts, and packs of more than " + std::to_string(most) +
               " are not read by default; leave --parts out, or join " + std::string(join));
}

std::string lowerExtension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c); });
  return extension;
}

void refuse(Exit code, const std::filesystem::path& file, std::string_view place, std::string_view what) {
  std::string line = oneLine(file.string(), 4096);
  if (!place.empty()) line += ": " + oneLine(place);
  line += ": " + oneLine(what, 1000);
  if (what.find("; ") == std::string_view::npos) line += remedyOf(code);
  throw ToolError(code, line);
}

bool isOfTheMachine(const ToolError& error) {
  return error.exit == Exit::kRuntime || dynamic_cast<const UnreadableFile*>(&error) != nullptr;
}

std::vector<std::uint8_t> InputFiles::readHead(std::size_t most) const { return readFirst(input_, most); }

std::vector<std::uint8_t> InputFiles::readFile(const std::filesystem::path& path) const {
  std::error_code error;
  if (const std::uintmax_t size = std::filesystem::file_size(path, error); !error && size > kMaxFileBytes)
    refuse(Exit::kUnsupported, path, "", "is larger than 4 GiB; split it");
  return readFirst(path, kMaxFileBytes);
}

std::vector<std::uint8_t> InputFiles::readFirst(const std::filesystem::path& path,
                                                std::uintmax_t most) const {
  const auto fail = [&](const std::string& what) {
    noteMissing(path);
    refuse(Exit::kIo, path, "", what);
  };
  const auto failToRead = [&](const std::string& what) {
    noteMissing(path);
    throw UnreadableFile(Exit::kIo, oneLine(path.string(), 4096) + ": " + what +
                                        "; check the file's permissions and the disk");
  };
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) fail("no such file; check the path");
  if (error) failToRead("cannot be read: " + error.message());
  if (std::filesystem::is_directory(status)) fail("is a folder; name a file");
  if (!std::filesystem::is_regular_file(status))
    fail("is a pipe or a device; write it to a file first, as inputs are read more than once");
  const std::uintmax_t whole = std::filesystem::file_size(path, error), size = std::min(whole, most);
  if (error) failToRead("cannot be read: " + error.message());
  countRead(path, size);
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) failToRead(std::string("cannot be opened: ") + std::strerror(errno));
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::uintmax_t>(in.gcount()) != size) failToRead("could not be read to its end");
  if (used_ && !isListedRead(path))
    used_->read.push_back({path, size < whole ? hashFile(path) : hashBytes(bytes)});
  return bytes;
}

void InputFiles::countRead(const std::filesystem::path& path, std::uint64_t size) const {
  if (counted_.insert(path).second) {
    checkFileCount();
    bytes_read_ += size;
    return;
  }
  bytes_again_ += size;
  if (const std::uint64_t most = kUsualAgain + kTimesAgain * bytes_read_; bytes_again_ > most)
    refuse(Exit::kInvalid, path, "",
           "is named too often by the input: more than " + printBytes(most) +
               " would be read again; name each file once");
}

bool InputFiles::isListedRead(const std::filesystem::path& path) const {
  while (read_.entries < used_->read.size()) read_.paths.insert(used_->read[read_.entries++].path);
  return read_.paths.count(path) > 0;
}

void InputFiles::noteMissing(const std::filesystem::path& path) const {
  if (!used_) return;
  while (missing_.entries < used_->missing.size()) missing_.paths.insert(used_->missing[missing_.entries++]);
  if (missing_.paths.count(path) > 0) return;
  used_->missing.push_back(path);
  checkFileCount();
}

// kRuntime, so that no caller takes this for one optional file that is missing.
void InputFiles::checkFileCount() const {
  if (counted_.size() + (used_ ? used_->missing.size() : 0) > 1 + kMostFiles)  // with the input
    refuse(Exit::kRuntime, input_, "",
           "names more than " + std::to_string(kMostFiles) +
               " other files; put several pictures into one, or split the model");
}

bool InputFiles::isThere(const std::filesystem::path& path) const {
  std::error_code error;
  if (std::filesystem::is_regular_file(path, error)) return true;
  if (error && !saysNoSuchFile(error))
    throw UnreadableFile(Exit::kIo, oneLine(path.string(), 4096) + ": cannot be read: " + error.message() +
                                        "; check its permissions and the disk");
  noteMissing(path);
  return false;
}

std::filesystem::path InputFiles::resolve(std::string_view reference, Reference kind) const {
  const std::string shown = "reference '" + oneLine(reference, 120) + "'";
  std::string text(reference);
  if (kind == Reference::kUri) {
    std::optional<std::string> decoded = percentDecode(reference);
    if (!decoded)
      refuse(Exit::kInvalid, input_, shown, "has a broken percent encoding; write a percent sign as %25");
    text = *std::move(decoded);
  } else {
    std::replace(text.begin(), text.end(), '\\', '/');
  }
  if (text.empty() || text.find('\0') != std::string::npos)
    refuse(Exit::kInvalid, input_, shown, "is empty or holds a zero byte");
  const std::size_t colon = text.find(':');
  if (colon != std::string::npos && text.find('/') >= colon)
    refuse(Exit::kInvalid, input_, shown,
           "names a drive or a URI scheme; only files beside the input are read: put the file there");
  const std::filesystem::path relative(text);
  if (relative.is_absolute() || text.front() == '/' || text.front() == '\\')
    refuse(Exit::kInvalid, input_, shown,
           "is an absolute path; only files beside the input are read: put the file there and name it "
           "relatively");
  // Dots are removed as in RFC 3986, section 5.2.4, before the file system resolves links.
  const std::filesystem::path normal = relative.lexically_normal();
  if (*normal.begin() == ".." || text.find('\\') != std::string::npos)
    refuse(Exit::kInvalid, input_, shown,
           "leaves the input's folder; only files beside the input are read: put the file there");
  const std::filesystem::path folder = input_.parent_path();
  std::error_code error;
  const std::filesystem::path home = std::filesystem::canonical(folder.empty() ? "." : folder, error);
  const std::filesystem::path real = error ? home : std::filesystem::weakly_canonical(home / normal, error);
  if (error && !saysNoSuchFile(error))
    throw UnreadableFile(Exit::kIo, oneLine((folder / normal).string(), 4096) + ": cannot be read: " +
                                        error.message() + "; check its permissions and the disk");
  if (error) refuse(Exit::kIo, folder / normal, "", "cannot be read: " + error.message());
  if (std::mismatch(home.begin(), home.end(), real.begin(), real.end()).first != home.end())
    refuse(Exit::kInvalid, input_, shown,
           "leaves the input's folder by a link; only files beside the input are read: put the file itself "
           "there");
  return folder / normal;
}

std::filesystem::path InputFiles::resolveOrBeside(std::string_view reference, Reference kind) const {
  try {
    return resolve(reference, kind);
  } catch (const ToolError& error) {
    const std::string text =
        kind == Reference::kUri ? percentDecode(reference).value_or("") : std::string(reference);
    const std::string name = text.substr(text.find_last_of("/\\") + 1);  // 0 if there is none
    if (error.exit != Exit::kInvalid || name.size() == text.size()) throw;
    try {
      const std::filesystem::path beside = resolve(name, Reference::kPath);
      if (isThere(beside)) return beside;
    } catch (const ToolError& second) {
      if (isOfTheMachine(second)) throw;
    }
    throw;
  }
}

std::vector<std::uint8_t> InputFiles::readPicture(std::string_view reference, Reference kind) const {
  return readFile(resolveOrBeside(reference, kind));
}

std::uint64_t memoryAllowed(const InputFiles& files, std::uint64_t max_memory, std::uint64_t usual,
                            std::uint64_t per_byte_read) {
  return max_memory > 0 ? max_memory : std::min(physicalMemory(), usual + per_byte_read * files.bytesRead());
}

void DataBudget::take(std::uint64_t bytes, std::string_view place) {
  if (const std::uint64_t most = memoryAllowed(files_, max_memory_, kUsual, kPerByteRead);
      bytes > most || taken_ > most - bytes)
    refuse(Exit::kRuntime, files_.input(), place,
           "with its " + printBytes(bytes) + ", the model's data need more than " + printBytes(most) +
               " of memory, unpacked; name no data twice, or give a larger --max-memory");
  taken_ += bytes;
}

}  // namespace kelp::bake
