// SPDX-License-Identifier: MIT
// Some frames of a pack on an OpenGL that does nothing but keep what is uploaded. Aborts where the pool does
// not hold what the asset does, or a budget is passed.
#pragma once

#include <cstdint>
#include <memory>

#include "kelp/runtime/asset.h"

// The asset is pumped between the frames, and may be gone at the end. `choice`: what the host is like.
// `allocator`: the renderer's.
void exerciseRenderer(std::unique_ptr<kelp::runtime::Asset> asset, std::uint64_t choice,
                      const kelp::Allocator& allocator);
