// SPDX-License-Identifier: MIT
// The content of a pack as the writer takes it, to compare packs written and read.
#pragma once

#include "kelp/formats/raw_pack.h"

// All of it; what cannot be read is answered as an error. `allocator`: for pages as they are read.
kelp::Result<kelp::RawPack> rawOf(const kelp::Pack& pack, const kelp::Allocator& allocator = {});

// The first thing in which two packs differ, to the bit; nullptr if there is none.
const char* differenceOf(const kelp::RawPack& a, const kelp::RawPack& b);
