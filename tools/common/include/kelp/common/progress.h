// SPDX-License-Identifier: MIT
// How long work reports its progress and is stopped.
#pragma once

#include <functional>
#include <string_view>

namespace kelp {

// Called with a stage's name and how far it is, 0 to 1. Returns false to stop: the stage then throws
// ToolError kInterrupted. Called on the thread that started the work only.
using Progress = std::function<bool(std::string_view stage, double done)>;

// The same within one stage: how far it is, 0 to 1. May throw, which ends the stage.
using Step = std::function<void(double done)>;

}  // namespace kelp
