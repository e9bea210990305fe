// SPDX-License-Identifier: MIT
// All of kelp that a game uses: packs in memory, poses, springs, queries, and the renderer. Start reading
// with kelp/runtime/asset.h and kelp/gl/renderer.h. Other files that headers name, such as
// runtime/HOST_GUIDE.md, formats/SPEC.md and shaders/surface.glsl, lie in kelp's source tree, and in
// share/doc/kelp where kelp is installed.
#pragma once

#include "kelp/gl/renderer.h"
#include "kelp/runtime/asset.h"
#include "kelp/runtime/distance.h"
#include "kelp/runtime/instance.h"
#include "kelp/runtime/pose.h"
#include "kelp/runtime/soft_body.h"
#include "kelp/runtime/spring.h"
