// SPDX-License-Identifier: MIT
#include "png_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <fmt/format.h>
#include <png.h>
#include <unistd.h>

#include "render_error.h"

namespace kelp::render {
namespace {

namespace fs = std::filesystem;

// All of the picture, encoded. libpng's simplified interface reports errors as values.
std::vector<std::uint8_t> encode(const Picture& picture) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.size.x);
  image.height = static_cast<png_uint_32>(picture.size.y);
  image.format = PNG_FORMAT_RGBA;
  png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<std::uint8_t> out(bytes);
  if (!png_image_write_to_memory(&image, out.data(), &bytes, 0, picture.rgba.data(), 0, nullptr)) {
    throw RenderError(kFailure, fmt::format("libpng: {}; please report this as a fault of kelp-render", image.message));
  }
  out.resize(bytes);
  return out;
}

bool writeAll(int file, const std::vector<std::uint8_t>& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::write(file, bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    done += static_cast<std::size_t>(count);
  }
  return ::fsync(file) == 0;
}

}  // namespace

void checkPng(const std::string& path, const std::vector<std::string>& inputs) {
  std::error_code none;
  for (const std::string& input : inputs)
    if (fs::equivalent(path, input, none)) throw RenderError(kUsage, fmt::format("{}: would overwrite {}, which is read; name another file", path, input));
  if (const fs::file_status status = fs::status(path, none); fs::exists(status) && !fs::is_regular_file(status))
    throw RenderError(kIo, fmt::format("{}: is {}; name a file for the picture", path, fs::is_directory(status) ? "a folder" : "no regular file"));
}

void writePng(const std::string& path, const Picture& picture) {
  const std::vector<std::uint8_t> bytes = encode(picture);
  // A link stays one.
  std::error_code none;
  fs::path target = path;
  for (int hops = 0; hops < 40 && fs::is_symlink(target, none); ++hops) target = target.parent_path() / fs::read_symlink(target, none);
  const std::string temporary = fmt::format("{}.{}.tmp", target.string(), ::getpid());
  const auto fail = [&](const char* what) {
    const int reason = errno;
    ::unlink(temporary.c_str());
    throw RenderError(kIo, fmt::format("{}: {}: {}; check that the folder exists, is writable and has room", path, what, std::strerror(reason)));
  };
  ::unlink(temporary.c_str());  // what a run of this number left, or somebody put there
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0) fail("can not be written");
  const bool written = writeAll(file, bytes);
  const int reason = errno;
  ::close(file);
  errno = reason;
  if (!written) fail("can not be written");
  if (::rename(temporary.c_str(), target.c_str()) != 0) fail("can not be replaced");
}

}  // namespace kelp::render
