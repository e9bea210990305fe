// SPDX-License-Identifier: MIT
#include "cli/faults.h"

#include <algorithm>

namespace kelp::bake_cli {
namespace {

constexpr std::size_t kMostTold = 1000;  // who has more has one cause for them

}  // namespace

void Faults::add(const ToolError& fault) {
  if (!told_.insert(fault.what()).second) return;
  ++count_;
  highest_ = std::max(highest_, fault.exit);
  if (faults_.size() < kMostTold)
    faults_.push_back(fault);
  else
    told_.erase(fault.what());
}

void Faults::throwIfAny() const {
  if (count_ == 1) throw faults_.front();
  if (count_ > 1) throw SeveralFaults(faults_, count_, highest_);
}

}  // namespace kelp::bake_cli
