// SPDX-License-Identifier: MIT
#include "png_file.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <png.h>
#include <unistd.h>

#include "render_error.h"

namespace kelp::render {
namespace {

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

void writePng(const std::string& path, const Picture& picture) {
  const std::vector<std::uint8_t> bytes = encode(picture);
  const std::string temporary = fmt::format("{}.{}.tmp", path, ::getpid());
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
  if (::rename(temporary.c_str(), path.c_str()) != 0) fail("can not be replaced");
}

}  // namespace kelp::render
