// SPDX-License-Identifier: MIT
// A host that has set all there is to set.
#pragma once

#include "gl_state.h"

namespace kelp::test {

enum class Awkward {
  // nothing has its initial value; nothing could be drawn (no pixel is left by scissor, discard, logic
  // operation)
  kEverything,
  // as that, but what runtime/HOST_GUIDE.md leaves to the host or asks of it is as it was: a picture comes
  // out, and the same
  kDrawable,
};

// On the context that is current; what it makes lives as long as that. The framebuffer stays the one that is
// bound in kDrawable.
void setAwkwardState(Awkward how);

// Values that cannot be made to differ from the initial ones, and why; null: they can. `entry` is a name of
// readGlState().
const char* whyInitial(const std::string& entry);

// A program whose vertices capture one vec4 each in transform feedback.
GLuint makeHostProgram();

// Sets what reading the bound framebuffer's pixels depends on.
void setReadable();

}  // namespace kelp::test
