// SPDX-License-Identifier: MIT
#include "depth_copy.h"

#include <algorithm>

namespace kelp::gl {

using namespace constant;

// A blit copies depth only between buffers of the same format, and OpenGL tells only the bits of an
// attachment, not its format. So the candidates are tried in turn, those without stencil first unless the
// attachment has one.
struct DepthCopy::Format {
  Enum internal, layout, type;
  std::int32_t bits;
  bool is_float, stencil, desktop;
};
constexpr DepthCopy::Format DepthCopy::kFormats[6] = {
    {kDepthComponent24, kDepthComponent, kUnsignedInt, 24, false, false, false},
    {kDepth24Stencil8, kDepthStencil, kUnsignedInt248, 24, false, true, false},
    {kDepthComponent32f, kDepthComponent, kFloat, 32, true, false, false},
    {kDepth32fStencil8, kDepthStencil, kFloat32UnsignedInt248Rev, 32, true, true, false},
    {kDepthComponent16, kDepthComponent, kUnsignedShort, 16, false, false, false},
    {kDepthComponent32, kDepthComponent, kUnsignedInt, 32, false, false, true}};

void DepthCopy::create(const Api& api) {
  texture_ = makeTexture(api, kTexture2d, "kelp depth copy");
  api.GenFramebuffers(1, &framebuffer_);
}

void DepthCopy::destroy(const Api& api) {
  api.DeleteFramebuffers(1, &framebuffer_);
  api.DeleteTextures(1, &texture_);
}

DepthCopy::Source DepthCopy::sourceOf(const Api& api, std::int32_t framebuffer) {
  Source source;
  source.framebuffer = framebuffer;
  const Enum attachment = framebuffer == 0 ? kDepth : kDepthAttachment;
  const auto ask = [&](Enum what, std::int32_t& answer) {
    api.GetFramebufferAttachmentParameteriv(kDrawFramebuffer, attachment, what, &answer);
  };
  ask(kAttachmentObjectType, source.type);
  if (source.type == static_cast<std::int32_t>(kNone)) return source;
  if (framebuffer != 0) ask(kAttachmentObjectName, source.object);
  ask(kAttachmentDepthSize, source.bits);
  ask(kAttachmentStencilSize, source.stencil);
  ask(kAttachmentComponentType, source.kind);
  return source;
}

bool DepthCopy::allocate(const Api& api, const glm::ivec2& size, const Format& format) {
  api.BindTexture(kTexture2d, texture_);
  api.TexImage2D(kTexture2d, 0, static_cast<std::int32_t>(format.internal), size.x, size.y, 0, format.layout,
                 format.type, nullptr);
  api.BindFramebuffer(kDrawFramebuffer, framebuffer_);
  api.BindFramebuffer(kReadFramebuffer, framebuffer_);
  label(api, kLabelFramebuffer, framebuffer_, "kelp depth copy");
  // The format tried before may have had a stencil. Before OpenGL 4.1 draw buffers that are named must exist.
  api.FramebufferTexture2D(kDrawFramebuffer, kDepthStencilAttachment, kTexture2d, 0, 0);
  api.FramebufferTexture2D(kDrawFramebuffer, format.stencil ? kDepthStencilAttachment : kDepthAttachment,
                           kTexture2d, texture_, 0);
  const Enum nothing = kNone;
  api.DrawBuffers(1, &nothing);
  api.ReadBuffer(kNone);
  api.BindFramebuffer(kReadFramebuffer, static_cast<Name>(read_));
  api.BindFramebuffer(kDrawFramebuffer, static_cast<Name>(source_.framebuffer));
  size_ = api.GetError() == kNoError ? size : glm::ivec2(0);
  return size_.x > 0;
}

bool DepthCopy::works(const Api& api) const {
  copy(api);
  return api.GetError() == kNoError;
}

bool DepthCopy::prepare(const Api& api) {
  std::int32_t draw = 0, samples = 0;
  api.GetIntegerv(kDrawFramebufferBinding, &draw);
  api.GetIntegerv(kReadFramebufferBinding, &read_);
  api.GetIntegerv(kViewport, &viewport_.x);
  api.GetIntegerv(kSamples, &samples);
  const Source source = sourceOf(api, draw);
  const glm::ivec2 needed = glm::ivec2(viewport_.x + viewport_.z, viewport_.y + viewport_.w);
  if (samples > 0 || source.bits == 0 || needed.x <= 0 || needed.y <= 0 ||
      std::max(needed.x, needed.y) > api.max_texture_size)
    return false;
  const bool fits = needed.x <= size_.x && needed.y <= size_.y;
  if (source == source_ && (fits || !good_)) return good_;

  drainErrors(api);
  const glm::ivec2 size = fits ? size_ : glm::ivec2(std::max(needed.x, size_.x), std::max(needed.y, size_.y));
  source_ = source;
  good_ = fits && works(api);
  for (const bool stencil : {source.stencil != 0, source.stencil == 0}) {
    for (const Format& format : kFormats) {
      const bool same = format.bits == source.bits &&
                        format.is_float == (source.kind == static_cast<std::int32_t>(kFloat)) &&
                        format.stencil == stencil;
      if (good_ || !same || (format.desktop && api.es)) continue;
      drainErrors(api);
      good_ = allocate(api, size, format) && works(api);
    }
  }
  drainErrors(api);
  return good_;
}

void DepthCopy::copy(const Api& api) const {
  const DebugGroup group(api, "kelp depth copy");
  const int x0 = std::max(viewport_.x, 0), y0 = std::max(viewport_.y, 0), x1 = viewport_.x + viewport_.z,
            y1 = viewport_.y + viewport_.w;
  api.BindFramebuffer(kReadFramebuffer, static_cast<Name>(source_.framebuffer));
  api.BindFramebuffer(kDrawFramebuffer, framebuffer_);
  api.BlitFramebuffer(x0, y0, x1, y1, x0, y0, x1, y1, kDepthBufferBit, kNearest);
  api.BindFramebuffer(kReadFramebuffer, static_cast<Name>(read_));
  api.BindFramebuffer(kDrawFramebuffer, static_cast<Name>(source_.framebuffer));
}

}  // namespace kelp::gl
