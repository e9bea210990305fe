// SPDX-License-Identifier: MIT
#include "debug_draw.h"

#include "state_guard.h"

namespace kelp::gl {

using namespace constant;

void DebugDraw::destroy(const Api& api) {
  for (const Program* program : {&solids_, &fog_[0], &fog_[1], &line_program_})
    api.DeleteProgram(program->name);
  api.DeleteTextures(RecordTextures::kCount, textures_.names);
}

Result<void> DebugDraw::uploadLines(const Api& api, const View& view, const DrawList& list,
                                    std::span<const runtime::Instance> instances) {
  for (Name& name : textures_.names) {
    if (name == 0) name = makeTexture(api, kTexture2d, "kelp debug lines");
  }
  if (auto good = lines_.build(view, list, instances); !good) return good;
  return uploadRecords(api, textures_, lines_.records());
}

Result<void> DebugDraw::compile(const Api& api, DebugView debug, const DrawList& list, bool fog,
                                const LogSink& log) {
  if (!replacesColors(debug)) return buildOnce(line_program_, [&] { return buildLineProgram(api, log); });
  if (!fog) return buildOnce(solids_, [&] { return buildDebugProgram(api, log); });
  for (std::uint32_t i = 0; i < list.parts(); ++i) {
    const Bend bend = list.fogBend(i);
    if (auto good =
            buildOnce(fog_[bend == Bend::kSweep], [&] { return buildDebugFogProgram(api, bend, log); });
        !good)
      return good;
  }
  return {};
}

void DebugDraw::drawLines(const Api& api) const {
  const DebugGroup group(api, line_program_.label);
  maskOtherBuffers(api);
  bindUnit(api, kRecords, textures_.names[textures_.now]);
  api.Disable(kDepthTest);  // no depth is written either
  api.DrawArraysInstanced(kLines, 0, static_cast<std::int32_t>(lines_.points()), 1);
  api.Enable(kDepthTest);
}

}  // namespace kelp::gl
