// SPDX-License-Identifier: MIT
// Views of kelp.h -> those of C++; statistics the other way.
#pragma once

#include "kelp/c/view.h"
#include "kelp/gl/renderer.h"
#include "structs.h"

namespace kelp::c {

template <>
inline constexpr std::size_t kFirstSize<kelp_stats> = offsetof(kelp_stats, too_small);

kelp_result readView(const kelp_view* from, gl::View& to);
kelp_result checkFeatures(kelp_features features);
kelp_result checkPass(kelp_pass pass);
// stats may be null.
kelp_result checkStats(const kelp_stats* stats);
kelp_result answerStats(const Result<draw::Stats>& result, kelp_stats* stats);

}  // namespace kelp::c
