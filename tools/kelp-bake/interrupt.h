// SPDX-License-Identifier: MIT
#pragma once

namespace kelp::bake_cli {

// From now on Ctrl-C, SIGTERM and SIGHUP ask for an orderly end; a second one ends the program at once.
void catchInterrupts();
bool interrupted();

}  // namespace kelp::bake_cli
