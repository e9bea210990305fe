// SPDX-License-Identifier: MIT
// The GLSL files of src/glsl, and shaders/reference/paper.glsl, as text, embedded at build time.
#pragma once

namespace kelp::render::glsl {

extern const char* const kRectangle;   // rectangle.vert: a rectangle of the picture
extern const char* const kPaper;       // shaders/reference/paper.glsl: the paper's method
extern const char* const kPaperPart;   // paper_part.glsl: a part as the paper stores it
extern const char* const kPaperRay;    // paper_ray.glsl: rays by the paper's method
extern const char* const kPaperDraw;   // paper_draw.frag: draws a part
extern const char* const kPaperCount;  // paper_count.frag: counts its steps
extern const char* const kKelpCount;   // kelp_count.frag: counts the steps of kelp's own method

}  // namespace kelp::render::glsl
