// SPDX-License-Identifier: MIT
#include "commands.h"
#include "json_output.h"
#include "pack_file.h"
#include "summary.h"
#include "text.h"

namespace kelp::dump {

int info(const std::string& path, bool count, Format format) {
  PackFile file(path);
  const Summary summary = summarize(file, count);
  if (format == Format::kJson) print(infoJson(summary));
  else printInfoText(summary);
  return kOk;
}

}  // namespace kelp::dump
