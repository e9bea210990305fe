// SPDX-License-Identifier: MIT
// Any bytes as a pack, on a host that now and then is short of memory or cannot read: verify it, open it,
// decode all of it, cast rays through it, play its clips, draw it. Must not crash, hang or take more memory
// than the limits say.
#pragma once

#include <cstddef>
#include <span>

void exercisePack(std::span<const std::byte> bytes);
