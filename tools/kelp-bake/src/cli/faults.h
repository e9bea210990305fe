// SPDX-License-Identifier: MIT
// Collects all faults of a manifest, so that its author can mend them in one go.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "cli/values.h"

namespace kelp::bake_cli {

// Several faults in one exception. what() is the first fault, `exit` the highest code.
struct SeveralFaults : ToolError {
  SeveralFaults(std::vector<ToolError> told, std::size_t all, Exit highest)
      : ToolError(highest, told.front().what()), faults(std::move(told)), count(all) {}
  std::vector<ToolError> faults;
  std::size_t count;  // all faults, also those beyond the limit
};

// Collects faults instead of stopping at the first. Keeps the first 1,000, each once.
class Faults {
 public:
  void add(const ToolError& fault);
  void add(const Place& place, const std::string& what) { add(faultAt(place, what)); }
  // Runs a function and keeps the faults it throws. Returns true if there were none.
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
  // Throws the only fault, or SeveralFaults. Does nothing if there are none.
  void throwIfAny() const;

 private:
  std::vector<ToolError> faults_;
  std::set<std::string> told_;
  std::size_t count_ = 0;
  Exit highest_ = Exit::kOk;
};

}  // namespace kelp::bake_cli
