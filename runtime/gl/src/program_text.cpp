// SPDX-License-Identifier: MIT
#include "program_text.h"

#include "kelp/shaders/shaders.h"

namespace kelp::gl {
namespace {

#define KELP_ES_PRECISIONS                         \
  "precision highp float;\nprecision highp int;\n" \
  "precision highp sampler2D;\nprecision highp usampler2D;\nprecision highp usampler2DArray;\n"

const char* preludeOf(Dialect dialect) {
  switch (dialect) {
    case Dialect::kGl330:
      return "#version 330 core\n";
    case Dialect::kEs300:
      return "#version 300 es\n" KELP_ES_PRECISIONS;
    case Dialect::kVulkan:
      return "#version 450\n#extension GL_EXT_samplerless_texture_functions : require\n#define KELP_VULKAN\n";
  }
  return "";
}

void add(ShaderText& to, const char* text) {
  if (to.count < to.strings.size()) to.strings[to.count++] = text;
}
void addIf(ShaderText& to, bool wanted, const char* text) {
  if (wanted) add(to, text);
}
void addPieces(ShaderText& to, std::span<const shaders::Piece> pieces, const char* surface = nullptr) {
  for (const shaders::Piece& piece : pieces) {
    add(to, piece.line);
    add(to, piece.text ? piece.text : surface ? surface : "");
  }
}
void addFeatures(ShaderText& to, Features features) {
  addIf(to, has(features, Features::kSecondaryRays), "#define KELP_SECONDARY_RAYS\n");
  addIf(to, has(features, Features::kDistances), "#define KELP_DISTANCES\n");
  addIf(to, has(features, Features::kGradientOnly), "#define KELP_GRADIENT_ONLY\n");
}
void addBend(ShaderText& to, Bend bend) {
  add(to, bend == Bend::kSweep ? "#define KELP_SWEPT_ONLY\n" : "#define KELP_SHEARED_ONLY\n");
}
ShaderText textOf(Dialect dialect, std::span<const shaders::Piece> pieces) {
  ShaderText text;
  add(text, preludeOf(dialect));
  addPieces(text, pieces);
  return text;
}
constexpr char kDebugDefine[] = "#define KELP_DEBUG\n";

}  // namespace

ProgramText solidProgramText(Dialect dialect, const char* surface, Features features,
                             std::optional<Bend> bend) {
  ShaderText fragment;
  add(fragment, preludeOf(dialect));
  addIf(fragment, surface != nullptr, "#define KELP_HOST_SURFACE\n");
  addFeatures(fragment, features);
  if (bend) addBend(fragment, *bend);
  addPieces(fragment, shaders::kFragment, surface);
  return {textOf(dialect, shaders::kVertex), fragment};
}

ProgramText fogProgramText(Dialect dialect, Bend bend, bool heat, bool shadow) {
  ShaderText fragment;
  add(fragment, preludeOf(dialect));
  addIf(fragment, heat, "#define KELP_FOG_HEAT\n");
  addIf(fragment, shadow, "#define KELP_FOG_SHADOW\n");
  addBend(fragment, bend);
  addPieces(fragment, shaders::kFogFragment);
  return {textOf(dialect, shaders::kVertex), fragment};
}

ProgramText debugProgramText(Dialect dialect) {
  ShaderText fragment;
  add(fragment, preludeOf(dialect));
  add(fragment, kDebugDefine);
  addPieces(fragment, shaders::kFragment);
  return {textOf(dialect, shaders::kVertex), fragment};
}

ProgramText debugFogProgramText(Dialect dialect, Bend bend) {
  ShaderText fragment;
  add(fragment, preludeOf(dialect));
  add(fragment, kDebugDefine);
  addBend(fragment, bend);
  addPieces(fragment, shaders::kFogFragment);
  return {textOf(dialect, shaders::kVertex), fragment};
}

ProgramText lineProgramText(Dialect dialect) {
  return {textOf(dialect, shaders::kLineVertex), textOf(dialect, shaders::kLineFragment)};
}

ShaderText traceText(Dialect dialect, Features features) {
  ShaderText text;
  addIf(text, dialect == Dialect::kEs300, KELP_ES_PRECISIONS);
  addFeatures(text, features);
  for (const shaders::Piece& piece : shaders::kScene) add(text, piece.text);
  return text;
}

}  // namespace kelp::gl
