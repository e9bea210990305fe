// SPDX-License-Identifier: MIT
#include "reef.h"

namespace underwater {
namespace {

constexpr int kSettling = 120;              // steps before the scene begins
constexpr double kSettlingStep = 1.0 / 30;  // seconds
constexpr int kRounds = 3;       // a plant that gave way to a ball may have touched it elsewhere, too
constexpr float kSkin = 0.015f;  // meters: plants give way a little before they are touched

}  // namespace

kelp::Result<std::unique_ptr<Reef>> Reef::grow(const Library& library, int plants, double start) {
  auto meadow = Meadow::plant(library, plants);
  if (!meadow) return meadow.error();
  auto shoal = Shoal::gather(library);
  if (!shoal) return shoal.error();
  std::unique_ptr<Reef> reef(new Reef);
  reef->meadow_ = *std::move(meadow);
  reef->shoal_ = *std::move(shoal);
  reef->instances_.resize(reef->meadow_->size() + reef->shoal_->size());
  const std::span<kelp::runtime::Instance> all = reef->instances_;
  reef->meadow_->place(all.first(reef->meadow_->size()));
  reef->solids_ = Solids(all.first(reef->meadow_->size()));
  for (int i = kSettling; i >= 0; --i)
    reef->update(start - i * kSettlingStep, static_cast<float>(kSettlingStep), {});
  return reef;
}

void Reef::update(double seconds, float passed, const kelp::runtime::Sphere& player) {
  meadow_->update(seconds, passed, player);
  solids_.look();
  shoal_->update(seconds, passed, solids_);
  for (kelp::runtime::Sphere ball : shoal_->balls()) {
    ball.radius += kSkin;
    solids_.stayWithin({ball.center - ball.radius, ball.center + ball.radius});
    for (int round = 0; round < kRounds; ++round) {
      const auto touch = solids_.touch(ball);
      if (!touch) break;
      meadow_->giveWay(*touch, ball.radius);
      solids_.lookAt(touch->plant);
    }
  }
  const std::span<kelp::runtime::Instance> all = instances_;
  shoal_->place(all.subspan(meadow_->size()));
}

}  // namespace underwater
