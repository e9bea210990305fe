// SPDX-License-Identifier: MIT
#include "commands.h"
#include "json_output.h"
#include "pack_file.h"
#include "summary.h"
#include "text.h"

namespace kelp::dump {

int info(const std::string& path, Format format) {
  PackFile file(path);
  const Summary summary = summarize(file);
  if (format == Format::kJson) print(infoJson(summary));
  else printInfoText(summary);
  return kOk;
}

}  // namespace kelp::dump
