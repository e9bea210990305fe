// SPDX-License-Identifier: MIT
// All that is wrong at once, so that whoever wrote a manifest mends it in one go.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "cli/values.h"

namespace kelp::bake_cli {

// Several faults as one. what() is the first; `exit` the highest of all.
struct SeveralFaults : ToolError {
  SeveralFaults(std::vector<ToolError> told, std::size_t all, Exit highest)
      : ToolError(highest, told.front().what()), faults(std::move(told)), count(all) {}
  std::vector<ToolError> faults;
  std::size_t count;  // of all, those that are too many to be told included
};

// Collects faults instead of stopping at the first. The first thousand are kept; a fault that is told already
// is not told again.
class Faults {
 public:
  void add(const ToolError& fault);
  void add(const Place& place, const std::string& what) { add(faultAt(place, what)); }
  // Runs what may throw one or several, and keeps them. Whether there was none.
  template <class Work>
  bool keep(const Work& work) {
    try {
      work();
      return true;
    } catch (const SeveralFaults& several) {
      for (const ToolError& fault : several.faults) add(fault);
      count_ += several.count - several.faults.size();
    } catch (const ToolError& fault) {
      add(fault);
    }
    return false;
  }
  bool any() const { return count_ > 0; }
  // SeveralFaults, or the only one as it is, if there is any.
  void throwIfAny() const;

 private:
  std::vector<ToolError> faults_;
  std::set<std::string> told_;
  std::size_t count_ = 0;
  Exit highest_ = Exit::kOk;
};

}  // namespace kelp::bake_cli
