// SPDX-License-Identifier: MIT
// All that is wrong at once, so that whoever wrote a manifest mends it in one go.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "values.h"

namespace kelp::bake_cli {

// Several faults as one. what() is the first; `exit` the highest of all.
struct SeveralFaults : bake::BakeError {
  SeveralFaults(std::vector<bake::BakeError> told, std::size_t all, bake::Exit highest) : bake::BakeError(highest, told.front().what()), faults(std::move(told)), count(all) {}
  std::vector<bake::BakeError> faults;
  std::size_t count;  // of all, those that are too many to be told included
};

// Collects faults instead of stopping at the first. The first thousand are kept; a fault that is told already is not told again.
class Faults {
 public:
  void add(const bake::BakeError& fault);
  void add(const Place& place, const std::string& what) { add(faultAt(place, what)); }
  // Runs what may throw one or several, and keeps them. Whether there was none.
  template <class Work>
  bool keep(const Work& work) {
    try {
      work();
      return true;
    } catch (const SeveralFaults& several) {
      for (const bake::BakeError& fault : several.faults) add(fault);
      count_ += several.count - several.faults.size();
    } catch (const bake::BakeError& fault) {
      add(fault);
    }
    return false;
  }
  bool any() const { return count_ > 0; }
  // SeveralFaults, or the only one as it is, if there is any.
  void throwIfAny() const;

 private:
  std::vector<bake::BakeError> faults_;
  std::set<std::string> told_;
  std::size_t count_ = 0;
  bake::Exit highest_ = bake::Exit::kOk;
};

}  // namespace kelp::bake_cli
