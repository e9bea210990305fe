// SPDX-License-Identifier: MIT
// The sub-commands. Each prints its data to stdout and answers the exit code; DumpError for what keeps it from answering. "-" for a pack is standard input.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

namespace kelp::dump {

enum Exit : int { kOk = 0, kUsage = 1, kIo = 2, kInvalid = 3, kFailure = 4, kUnsupported = 5, kDifference = 7 };

// what() is the line for stderr, without the program's name.
struct DumpError : std::runtime_error {
  DumpError(Exit code, const std::string& message) : std::runtime_error(message), exit(code) {}
  Exit exit;
};

enum class Format { kText, kJson };

// `count`: read every page, too, and count voxels.
int info(const std::string& path, bool count, Format format);
int verify(const std::string& path, bool deep, Format format);
// kDifference if the packs differ. `tolerance`: share of the full range, 0 to 1, that numbers may be apart (diff.h).
int diff(const std::string& a, const std::string& b, double tolerance, Format format);
// `part` is a name or an index; empty: the first. `axis`: the spline's, in the file that the rig is for; empty: as baked.
int rig(const std::string& path, const std::string& part, const std::string& axis);
// Gives a part another rig, which is a file or a preset's name. `part` as above, but it must be given where there are several. `axis`: of a rig that names none; empty: what kelp-bake would take.
// `output` empty: the pack itself is replaced.
int setRig(const std::string& path, const std::string& part, const std::string& rig, const std::string& axis, const std::string& output);
// `part` is a name or an index; empty: all. `format` is vox, ply, slices, vdb or nvdb.
int extract(const std::string& path, const std::string& format, const std::string& output, const std::string& part, int level);
// The formats that this program was built with: "vox, ply, ...".
std::string extractFormats();

struct SliceOptions {
  std::string part;          // name or index; empty: the first
  int level = 0;
  char axis = 'y';           // across the layer
  std::optional<int> at;     // which layer; the middle one
  std::string what;          // occupancy, clearance, normals, colour; of fog density, heat; empty: occupancy or density
  int scale = 1;             // pixels a voxel
};
int slice(const std::string& path, const SliceOptions& options, const std::string& output);

// Prints a published JSON schema: "" for all that --format json prints, or the name of one.
int schema(const std::string& name);

}  // namespace kelp::dump
