// SPDX-License-Identifier: MIT
#include "state_guard.h"

#include <algorithm>

namespace kelp::gl {
namespace {

using namespace constant;

struct Store {
  Enum name;
  std::int32_t tight;  // the value for tightly packed rows
  bool desktop;        // not in OpenGL ES 3.0
};
constexpr Store kStoreTable[] = {{kUnpackAlignment, 1, false},   {kUnpackRowLength, 0, false},
                                 {kUnpackImageHeight, 0, false}, {kUnpackSkipRows, 0, false},
                                 {kUnpackSkipPixels, 0, false},  {kUnpackSkipImages, 0, false},
                                 {kUnpackSwapBytes, 0, true},    {kUnpackLsbFirst, 0, true}};

void setEnabled(const Api& api, Enum what, bool on) { on ? api.Enable(what) : api.Disable(what); }

int drawBuffers(const Api& api, int most) { return std::clamp(api.draw_buffers, 1, most); }

}  // namespace

UploadGuard::UploadGuard(const Api& api, bool restore) : api_(api), restore_(restore) {
  static_assert(sizeof kStoreTable / sizeof *kStoreTable == kStores);
  if (restore) {
    api.GetIntegerv(kPixelUnpackBufferBinding, &buffer_);
    api.GetIntegerv(kTextureBinding2d, &texture_2d_);
    api.GetIntegerv(kTextureBinding2dArray, &texture_2d_array_);
  }
  api.BindBuffer(kPixelUnpackBuffer, 0);
  for (int i = 0; i < kStores; ++i) {
    if (kStoreTable[i].desktop && api.es) continue;
    if (restore) api.GetIntegerv(kStoreTable[i].name, &store_[i]);
    api.PixelStorei(kStoreTable[i].name, kStoreTable[i].tight);
  }
}

UploadGuard::~UploadGuard() {
  if (!restore_) return;
  for (int i = 0; i < kStores; ++i) {
    if (!(kStoreTable[i].desktop && api_.es)) api_.PixelStorei(kStoreTable[i].name, store_[i]);
  }
  api_.BindBuffer(kPixelUnpackBuffer, static_cast<Name>(buffer_));
  api_.BindTexture(kTexture2d, static_cast<Name>(texture_2d_));
  api_.BindTexture(kTexture2dArray, static_cast<Name>(texture_2d_array_));
}

DrawGuard::DrawGuard(const Api& api, bool restore) : api_(api), restore_(restore) {
  if (!restore) return;
  api.GetIntegerv(kCurrentProgram, &program_);
  api.GetIntegerv(kVertexArrayBinding, &vertex_array_);
  api.GetIntegerv(kActiveTexture, &active_);
  for (int i = 0; i < kTextureUnits; ++i) {
    api.ActiveTexture(kTexture0 + static_cast<Enum>(i));
    api.GetIntegerv(kUnitTargets[i] == kTexture2dArray ? kTextureBinding2dArray : kTextureBinding2d,
                    &texture_[i]);
    api.GetIntegerv(kSamplerBinding, &sampler_[i]);
  }
  api.ActiveTexture(static_cast<Enum>(active_));
  depth_test_ = api.IsEnabled(kDepthTest);
  api.GetIntegerv(kDepthFunc, &depth_func_);
  api.GetBooleanv(kDepthWritemask, &depth_mask_);
  cull_face_ = api.IsEnabled(kCullFace);
  if (!api.es) api.GetIntegerv(kPolygonMode, polygon_mode_);
  if (!api.Enablei) {
    blend_ = api.IsEnabled(kBlend);
    api.GetBooleanv(kColorWritemask, color_mask_[0]);
    return;
  }
  for (int i = 0; i < drawBuffers(api, kMaxDrawBuffers); ++i) {
    const Name buffer = static_cast<Name>(i);
    if (api.IsEnabledi(kBlend, buffer)) blend_ |= 1u << i;
    api.GetBooleani_v(kColorWritemask, buffer, color_mask_[i]);
  }
}

DrawGuard::~DrawGuard() {
  if (!restore_) return;
  // One that the host had deleted while it was current went when kelp's took its place.
  api_.UseProgram(api_.IsProgram(static_cast<Name>(program_)) ? static_cast<Name>(program_) : 0);
  api_.BindVertexArray(static_cast<Name>(vertex_array_));
  for (int i = 0; i < kTextureUnits; ++i) {
    api_.ActiveTexture(kTexture0 + static_cast<Enum>(i));
    api_.BindTexture(kUnitTargets[i], static_cast<Name>(texture_[i]));
    api_.BindSampler(static_cast<Name>(i), static_cast<Name>(sampler_[i]));
  }
  api_.ActiveTexture(static_cast<Enum>(active_));
  setEnabled(api_, kDepthTest, depth_test_);
  api_.DepthFunc(static_cast<Enum>(depth_func_));
  api_.DepthMask(depth_mask_);
  setEnabled(api_, kCullFace, cull_face_);
  if (!api_.es) api_.PolygonMode(kFrontAndBack, static_cast<Enum>(polygon_mode_[0]));
  if (!api_.Enablei) {
    setEnabled(api_, kBlend, blend_ != 0);
    api_.ColorMask(color_mask_[0][0], color_mask_[0][1], color_mask_[0][2], color_mask_[0][3]);
    return;
  }
  for (int i = 0; i < drawBuffers(api_, kMaxDrawBuffers); ++i) {
    const Name buffer = static_cast<Name>(i);
    if (blend_ >> i & 1u) api_.Enablei(kBlend, buffer);  // drawing disabled it for all
    api_.ColorMaski(buffer, color_mask_[i][0], color_mask_[i][1], color_mask_[i][2], color_mask_[i][3]);
  }
}

void maskOtherBuffers(const Api& api) {
  if (!api.ColorMaski) return;
  for (int i = 1; i < api.draw_buffers; ++i) api.ColorMaski(static_cast<Name>(i), 0, 0, 0, 0);
}

BlendGuard::BlendGuard(const Api& api, bool restore) : api_(api), restore_(restore) {
  if (restore) {
    api.GetIntegerv(kBlendEquationRgb, &equations_[0]);
    api.GetIntegerv(kBlendEquationAlpha, &equations_[1]);
    const Enum names[4] = {kBlendSrcRgb, kBlendDstRgb, kBlendSrcAlpha, kBlendDstAlpha};
    for (int i = 0; i < 4; ++i) api.GetIntegerv(names[i], &factors_[i]);
  }
  set({kFuncAdd, kFuncAdd}, {kOne, kOneMinusSrcAlpha, kOne, kOneMinusSrcAlpha});
  if (!api.Enablei) {
    api.Enable(kBlend);
    return;
  }
  api.Enablei(kBlend, 0);
  maskOtherBuffers(api);
}

BlendGuard::~BlendGuard() {
  api_.Disable(kBlend);  // as every other draw leaves it
  if (!restore_) return;
  const auto asEnum = [](std::int32_t value) { return static_cast<Enum>(value); };
  set({asEnum(equations_[0]), asEnum(equations_[1])},
      {asEnum(factors_[0]), asEnum(factors_[1]), asEnum(factors_[2]), asEnum(factors_[3])});
}

void BlendGuard::set(const Enum (&equations)[2], const Enum (&factors)[4]) const {
  if (api_.BlendFuncSeparatei) {
    api_.BlendEquationSeparatei(0, equations[0], equations[1]);
    api_.BlendFuncSeparatei(0, factors[0], factors[1], factors[2], factors[3]);
  } else {
    api_.BlendEquationSeparate(equations[0], equations[1]);
    api_.BlendFuncSeparate(factors[0], factors[1], factors[2], factors[3]);
  }
}

}  // namespace kelp::gl
