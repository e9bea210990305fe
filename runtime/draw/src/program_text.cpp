// SPDX-License-Identifier: MIT
#include "kelp/draw/program_text.h"

#include "kelp/shaders/shaders.h"

namespace kelp::draw {
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
      return "#version 450\n#define KELP_VULKAN\n";
  }
  return "";
}

void add(ShaderText& to, const char* text) {
  if (to.count < to.strings.size())
    to.strings[to.count++] = text;
  else
    to.strings.back() = "#error kelp: more texts than ShaderText holds\n";
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
}  // namespace

ProgramText programText(Program program, Dialect dialect, Features features, const char* surface) {
  const auto is = [program](Program bit) { return has(program, bit); };
  const bool fog = is(Program::kFog), debug = is(Program::kDebug), lines = is(Program::kLines);
  constexpr const char* kOnly[] = {"#define KELP_SHEARED_ONLY\n", "#define KELP_SWEPT_ONLY\n",
                                   "#define KELP_CAGED_ONLY\n", ""};
  const auto bend = static_cast<std::size_t>(bendOf(program));
  ProgramText text;
  add(text.vertex, preludeOf(dialect));
  addIf(text.vertex, bendOf(program) == Program::kCaged, kOnly[bend]);
  addPieces(text.vertex, lines ? std::span(shaders::kLineVertex) : std::span(shaders::kVertex));
  add(text.fragment, preludeOf(dialect));
  if (lines) {
    addPieces(text.fragment, shaders::kLineFragment);
    return text;
  }
  addIf(text.fragment, debug, "#define KELP_DEBUG\n");
  addIf(text.fragment, is(Program::kFogHeat), "#define KELP_FOG_HEAT\n");
  addIf(text.fragment, is(Program::kFogShadow), "#define KELP_FOG_SHADOW\n");
  if (!fog && !debug) {
    addIf(text.fragment, surface != nullptr, "#define KELP_HOST_SURFACE\n");
    addFeatures(text.fragment, features);
  }
  addIf(text.fragment, bendOf(program) != Program::kAnyBend, kOnly[bend]);
  addPieces(text.fragment, fog ? std::span(shaders::kFogFragment) : std::span(shaders::kFragment), surface);
  return text;
}

ShaderText traceText(Dialect dialect, Features features) {
  ShaderText text;
  addIf(text, dialect == Dialect::kEs300, KELP_ES_PRECISIONS);
  addFeatures(text, features);
  for (const shaders::Piece& piece : shaders::kScene) add(text, piece.text);
  return text;
}

}  // namespace kelp::draw
