// SPDX-License-Identifier: MIT
// Turns exceptions of the libraries into kelp's.
#pragma once

#include <cstring>
#include <exception>
#include <new>
#include <string>

#include "byte_stream.h"
#include "kelp/common/error.h"
#include "kelp/import/core/input_files.h"

namespace kelp::bake {

// Calls work(). ToolError kInvalid, std::bad_alloc.
template <class Work>
auto callLibrary(const InputFiles& files, const std::string& place, const Work& work) {
  constexpr std::size_t kMost = 300;  // texts of OpenVDB have no bound on their length
  try {
    return work();
  } catch (const ToolError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    std::string what = oneLine({error.what(), strnlen(error.what(), kMost)});
    for (char& c : what)
      if (c == ';') c = ',';
    refuse(Exit::kInvalid, files.input(), place,
           "cannot be read (" + what + "); the file is damaged: export the volume again");
  }
}

// The same for work that reads from `stream`.
template <class Work>
auto readByLibrary(const InputFiles& files, const std::string& place, const ByteStream& stream,
                   const Work& work) {
  return callLibrary(files, place, [&] {
    try {
      return work();
    } catch (const std::ios_base::failure&) {
      if (stream.end() < stream.size())
        refuse(Exit::kInvalid, files.input(), place,
               "goes on beyond byte " + std::to_string(stream.end()) +
                   ", where the file says that it ends; the file is damaged: export the volume again");
      refuse(Exit::kInvalid, files.input(), place,
             "ends in the middle; it is truncated or damaged: export the volume again");
    }
  });
}

}  // namespace kelp::bake
