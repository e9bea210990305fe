// SPDX-License-Identifier: MIT
#include "reef.h"

#include <algorithm>

namespace underwater {

kelp::Result<std::unique_ptr<Reef>> Reef::grow(const Library& library, int plants) {
  auto meadow = Meadow::plant(library, plants);
  if (!meadow) return meadow.error();
  auto shoal = Shoal::gather(library);
  if (!shoal) return shoal.error();
  std::unique_ptr<Reef> reef(new Reef);
  reef->meadow_ = *std::move(meadow);
  reef->shoal_ = *std::move(shoal);
  reef->visitors_.resize(reef->shoal_->size() + 1);
  reef->instances_.resize(reef->meadow_->size() + reef->shoal_->size());
  reef->update(0, 0, {});
  return reef;
}

void Reef::update(double seconds, float passed, const Visitor& player) {
  shoal_->update(seconds);
  const std::span<const Visitor> fish = shoal_->visitors();
  std::copy(fish.begin(), fish.end(), visitors_.begin());
  visitors_.back() = player;
  meadow_->update(seconds, passed, visitors_);
  const std::span<kelp::runtime::Instance> all = instances_;
  meadow_->place(all.first(meadow_->size()));
  shoal_->place(all.subspan(meadow_->size()));
}

}  // namespace underwater
