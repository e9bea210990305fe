// SPDX-License-Identifier: MIT
#include "record_textures.h"

#include <algorithm>

#include "kelp/draw/planner.h"

namespace kelp::gl {

using namespace constant;

Result<void> uploadRecords(const Api& api, RecordTextures& textures, const char* label,
                           std::span<const glm::uvec4> records) {
  if (records.empty()) return {};
  constexpr auto kWidth = static_cast<std::int32_t>(draw::kRecordWidth);
  const std::size_t rows = records.size() / draw::kRecordWidth;
  const auto most = static_cast<std::size_t>(api.max_texture_size);
  if (rows > most) return Error{ErrorCode::kLimit, "more instances than a texture of this context holds"};
  if (rows > textures.rows) {
    const std::size_t fresh = std::min(std::max(rows, 2 * textures.rows), most);
    textures.rows = 0;
    drainErrors(api);
    for (Name& name : textures.names) {
      if (name == 0) name = makeTexture(api, kTexture2d, label);
      api.BindTexture(kTexture2d, name);
      api.TexImage2D(kTexture2d, 0, kRgba32ui, kWidth, static_cast<std::int32_t>(fresh), 0, kRgbaInteger,
                     kUnsignedInt, nullptr);
    }
    if (auto good = checkErrors(api, "OpenGL refused the texture of the frame's instances"); !good)
      return good;
    textures.rows = fresh;
  }
  textures.now = (textures.now + 1) % RecordTextures::kCount;
  api.BindTexture(kTexture2d, textures.names[textures.now]);
  api.TexSubImage2D(kTexture2d, 0, 0, 0, kWidth, static_cast<std::int32_t>(rows), kRgbaInteger, kUnsignedInt,
                    records.data());
  return {};
}

}  // namespace kelp::gl
