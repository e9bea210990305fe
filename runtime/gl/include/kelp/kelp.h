// SPDX-License-Identifier: MIT
// All of kelp that a game uses: packs in memory, poses, springs, queries, and the renderer.
#pragma once

#include "kelp/gl/renderer.h"
#include "kelp/runtime/asset.h"
#include "kelp/runtime/instance.h"
#include "kelp/runtime/pose.h"
#include "kelp/runtime/spring.h"
