// SPDX-License-Identifier: MIT
#include <chrono>
#include <new>
#include <span>

#include "kelp/bake/bake.h"
#include "kelp/common/console.h"
#include "kelp/common/memory.h"
#include "kelp/common/output_file.h"
#include "kelp/common/parallel.h"

namespace kelp::bake {
namespace {

struct Output {
  OutputFile& file;
  const Progress& progress;
  std::uint64_t bytes = 0;
  bool interrupted = false;
};

Result<void> receive(void* user, std::span<const std::byte> bytes) {
  Output& output = *static_cast<Output*>(user);
  output.bytes += bytes.size();
  if (output.progress && !output.progress("write", 0.5)) output.interrupted = true;
  if (!output.interrupted && output.file.tryWrite(bytes)) return {};
  return Error{ErrorCode::kIo, "the file cannot be written"};
}

}  // namespace

void writePackInto(const RawPack& pack, OutputFile& file, int threads, Report& report,
                   const Progress& progress, Effort effort) {
  const auto start = std::chrono::steady_clock::now();
  Output output{file, progress};
  const Result<void> written = writePack(pack, Sink{receive, &output}, threadCount(threads), effort);
  if (output.interrupted || (progress && !progress("write", 1.0)))
    throw ToolError(Exit::kInterrupted, "interrupted");
  if (!written) {
    if (file.failed()) file.flush();  // throws the reason
    if (written.error().code == ErrorCode::kOutOfMemory) throw std::bad_alloc();
    throw ToolError(Exit::kRuntime,
                    console::nameOf(file.path()) + ": the model makes no valid pack (" +
                        written.error().detail +
                        "); try another --resolution, and report this as a defect of kelp-bake");
  }
  file.flush();
  report.pack_bytes = output.bytes;
  report.stages.push_back({"write",
                           std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
                           peakMemory()});
}

void writePackFile(const RawPack& pack, const std::filesystem::path& path, int threads, Report& report,
                   const Progress& progress, Effort effort) {
  OutputFile file(path);
  writePackInto(pack, file, threads, report, progress, effort);
  file.commit();
}

}  // namespace kelp::bake
