// SPDX-License-Identifier: MIT
#pragma once

namespace kelp::bake_cli {

// From now on Ctrl-C, SIGTERM and SIGHUP set interrupted(), unless the program was started with them ignored
// (nohup). A second one ends the program at once, without a file left behind. Writing to a closed pipe
// becomes an error instead of a signal.
void catchInterrupts();
bool interrupted();
// For a child process: ignores those signals and takes SIGUSR1 from the parent instead.
void hearParentOnly();

}  // namespace kelp::bake_cli
