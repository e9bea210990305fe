// SPDX-License-Identifier: MIT
// The published JSON schemas. The build embeds the files of the source tree. Static storage, NUL-terminated.
#pragma once

namespace kelp::dump {

extern const char* const kDumpSchema;      // tools/kelp-dump/kelp-dump.schema.json
extern const char* const kRigSchema;       // tools/rig/rig.schema.json
extern const char* const kReportSchema;    // tools/kelp-bake/kelp-bake-report.schema.json
extern const char* const kProgressSchema;  // tools/kelp-bake/kelp-bake-progress.schema.json

}  // namespace kelp::dump
