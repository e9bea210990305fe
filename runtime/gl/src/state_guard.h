// SPDX-License-Identifier: MIT
// Restores the GL state that kelp changes. One guard for each kind of work. With State::kLeave nothing is
// saved or restored.
#pragma once

#include "gl_api.h"

namespace kelp::gl {

inline constexpr int kTextureUnits = 3;
// The target that kelp binds on each unit it draws with; the order of Unit in program.h.
inline constexpr Enum kUnitTargets[kTextureUnits] = {constant::kTexture2dArray, constant::kTexture2d,
                                                     constant::kTexture2d};
// Binds a texture to one of them, which becomes the active unit.
inline void bindUnit(const Api& api, int unit, Name texture) {
  api.ActiveTexture(constant::kTexture0 + static_cast<Enum>(unit));
  api.BindTexture(kUnitTargets[unit], texture);
}

// State that filling textures changes: pixel store, the pixel unpack buffer, and a 2D texture and a 2D array
// on the active unit. Sets the pixel store to tightly packed rows from client memory.
class UploadGuard {
 public:
  UploadGuard(const Api& api, bool restore);
  ~UploadGuard();
  UploadGuard(const UploadGuard&) = delete;
  UploadGuard& operator=(const UploadGuard&) = delete;

 private:
  static constexpr int kStores = 8;
  const Api& api_;
  bool restore_;
  std::int32_t store_[kStores] = {};
  std::int32_t buffer_ = 0;
  std::int32_t texture_2d_ = 0;
  std::int32_t texture_2d_array_ = 0;
};

// State that compiling and drawing change: program, vertex array, texture units, depth, culling, blending,
// polygon mode, color mask.
class DrawGuard {
 public:
  DrawGuard(const Api& api, bool restore);
  ~DrawGuard();
  DrawGuard(const DrawGuard&) = delete;
  DrawGuard& operator=(const DrawGuard&) = delete;

 private:
  static constexpr int kMaxDrawBuffers = 32;
  const Api& api_;
  bool restore_;
  std::int32_t program_ = 0;
  std::int32_t vertex_array_ = 0;
  std::int32_t active_ = 0;
  std::int32_t texture_[kTextureUnits] = {};
  std::int32_t sampler_[kTextureUnits] = {};
  std::int32_t depth_func_ = 0;
  std::int32_t polygon_mode_[2] = {};  // compatibility contexts answer front and back
  std::uint8_t depth_mask_ = 0;
  bool depth_test_ = false;
  bool cull_face_ = false;
  std::uint32_t blend_ = 0;  // bit i: draw buffer i
  std::uint8_t color_mask_[kMaxDrawBuffers][4] = {};
};

// Masks the colors of all draw buffers but the first, where the context can; DrawGuard restores them.
void maskOtherBuffers(const Api& api);

// State that fog changes in addition, and sets: the blending of the first draw buffer, and the masks of the
// others, which DrawGuard restores. Within a DrawGuard.
class BlendGuard {
 public:
  BlendGuard(const Api& api, bool restore);
  ~BlendGuard();
  BlendGuard(const BlendGuard&) = delete;
  BlendGuard& operator=(const BlendGuard&) = delete;

 private:
  void set(const Enum (&equations)[2], const Enum (&factors)[4]) const;

  const Api& api_;
  bool restore_;
  std::int32_t equations_[2] = {};
  std::int32_t factors_[4] = {};  // source and destination of color, then of alpha
};

}  // namespace kelp::gl
