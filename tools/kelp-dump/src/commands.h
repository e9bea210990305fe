// SPDX-License-Identifier: MIT
// The sub-commands. Each prints its data to stdout and answers the exit code; DumpError for what keeps it from answering.
#pragma once

#include <stdexcept>
#include <string>

namespace kelp::dump {

enum Exit : int { kOk = 0, kUsage = 1, kIo = 2, kInvalid = 3, kFailure = 4, kUnsupported = 5 };

// what() is the line for stderr, without the program's name.
struct DumpError : std::runtime_error {
  DumpError(Exit code, const std::string& message) : std::runtime_error(message), exit(code) {}
  Exit exit;
};

enum class Format { kText, kJson };

int info(const std::string& path, Format format);
int verify(const std::string& path, bool deep, Format format);
// `part` is a name or an index; empty: the first. `axis`: the spline's, in the file that the rig is for.
int rig(const std::string& path, const std::string& part, const std::string& axis);
// `part` is a name or an index; empty: all. `format` is vox, ply, slices, vdb or nvdb.
int extract(const std::string& path, const std::string& format, const std::string& output, const std::string& part, int level);
// The formats that this program was built with: "vox, ply, ...".
std::string extractFormats();

}  // namespace kelp::dump
