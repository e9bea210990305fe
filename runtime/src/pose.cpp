// SPDX-License-Identifier: MIT
#include "kelp/runtime/pose.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "cages/pose_nodes.h"
#include "kelp/formats/sweep.h"
#include "pose_writer.h"
#include "posed_part.h"

namespace kelp::runtime {

static_assert(alignof(Motion) <= 4 && alignof(Knot) <= 4 && alignof(glm::ivec3) <= 4,
              "a pose lays its arrays side by side");

namespace {
constexpr Error kNoKnot{ErrorCode::kMisuse, "there is no such part, or no such knot in it"};
constexpr Error kNotAlike{ErrorCode::kMisuse, "the poses differ in parts, knots or nodes"};
}  // namespace

Result<Pose> Pose::create(const Asset& asset, const Allocator& allocator) {
  return create(asset.pack().parts(), !asset.pack().joints().empty(), allocator);
}

Result<Pose> Pose::create(std::span<const Part> parts, bool joints, const Allocator& allocator) {
  std::size_t total = 0;
  for (const Part& part : parts) total += part.knots.size();
  Pose pose;
  pose.memory_ = Buffer<std::byte>(allocator);
  if (!pose.memory_.reset(2 * (parts.size() * sizeof(Motion) + total * sizeof(Knot)) +
                          (parts.size() + 1) * sizeof(std::uint32_t) +
                          parts.size() * (sizeof(std::uint64_t) + sizeof(Shape)))) {
    return Error{ErrorCode::kOutOfMemory, "no memory for a pose"};
  }
  pose.parts_ = static_cast<std::uint32_t>(parts.size());
  pose.knots_ = static_cast<std::uint32_t>(total);
  pose.knot_data_ = reinterpret_cast<Knot*>(pose.motionData() + parts.size());
  std::fill_n(pose.restMotions(), parts.size(), Motion{});
  std::uint32_t n = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    pose.firstKnots()[i] = n;
    for (const Knot& knot : parts[i].knots) pose.restKnots()[n++] = knot;
    std::memcpy(pose.automaticTangents(static_cast<int>(i)), &parts[i].automatic_tangents,
                sizeof parts[i].automatic_tangents);
    pose.shapes()[i] = {parts[i].size, parts[i].bend, parts[i].roll};
  }
  pose.firstKnots()[parts.size()] = n;
  if (const Result<void> made = PoseCages::create(parts, joints, allocator, pose); !made) return made.error();
  pose.reset();
  return pose;
}

Pose& Pose::operator=(Pose&& other) noexcept {
  memory_ = std::move(other.memory_);
  cages_ = std::move(other.cages_);
  knot_data_ = std::exchange(other.knot_data_, nullptr);
  parts_ = std::exchange(other.parts_, 0u);
  knots_ = std::exchange(other.knots_, 0u);
  return *this;
}

bool Pose::fits(const Asset& asset) const {
  const std::span<const Part> parts = asset.pack().parts();
  if (parts.size() != parts_) return false;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (firstKnots()[i + 1] - firstKnots()[i] != parts[i].knots.size()) return false;
  }
  return PoseCages::fits(*this, parts);
}

bool Pose::hasKnot(int part, int knot) const {
  return knot >= 0 && static_cast<std::size_t>(knot) < knots(part).size();
}

Result<void> Pose::move(int part, int knot, const glm::vec3& offset) {
  if (!hasKnot(part, knot)) return kNoKnot;
  std::uint64_t automatic;
  std::memcpy(&automatic, automaticTangents(part), sizeof automatic);
  const std::span<Knot> mine = writableKnots(part);
  const auto index = static_cast<std::size_t>(knot);
  moveKnot(mine, index, offset, followOf(mine, index, automatic));
  moved(part);
  return {};
}

Result<void> Pose::setTangent(int part, int knot, const glm::vec3& tangent) {
  if (!hasKnot(part, knot)) return kNoKnot;
  writableKnots(part)[static_cast<std::size_t>(knot)].tangent = tangent;
  moved(part);
  return {};
}

Result<void> Pose::setKnots(int part, std::span<const Knot> given) {
  const std::span<Knot> mine = writableKnots(part);
  const bool same = std::equal(mine.begin(), mine.end(), given.begin(), given.end(),
                               [](const Knot& a, const Knot& b) { return a.at == b.at; });
  if (mine.empty() || !same)
    return Error{ErrorCode::kMisuse, "these are not the knots of that part: their number or an `at` differs"};
  std::copy(given.begin(), given.end(), mine.begin());
  moved(part);
  return {};
}

bool Pose::sameShape(const Pose& other) const {
  return other.parts_ == parts_ && other.knots_ == knots_ &&
         std::equal(firstKnots(), firstKnots() + parts_, other.firstKnots()) &&
         PoseCages::alike(*this, other);
}

Result<void> Pose::setJoints(const Asset& asset, std::span<const glm::mat4> matrices) {
  const std::span<const Joint> joints = asset.pack().joints();
  if (!fits(asset) || (!joints.empty() && (!cages() || cages()->rest.empty())))
    return Error{ErrorCode::kMisuse, "the pose is of another asset"};
  if (matrices.size() != joints.size())
    return Error{ErrorCode::kMisuse, "there is not one matrix for each joint of the asset"};
  for (std::size_t i = 0; i < matrices.size(); ++i)
    for (int column = 0; column < 4; ++column) {
      if (!allFinite(glm::vec3(matrices[i][column])))
        return Error{ErrorCode::kMisuse, "the matrix of a joint has a number that is not finite", i,
                     Error::Unit::kJoint};
      if (matrices[i][column].w != (column < 3 ? 0.0f : 1.0f))
        return Error{ErrorCode::kMisuse, "the matrix of a joint is not affine: its last row is not 0 0 0 1",
                     i, Error::Unit::kJoint};
    }
  for (std::size_t i = 0; i < matrices.size(); ++i)
    for (const std::uint32_t part : joints[i].parts)
      PoseCages::drive(*this, static_cast<int>(part), matrices[i]);
  if (!joints.empty()) PoseCages::forgetMotions(*this);
  return {};
}

Result<void> Pose::setSection(int part, int knot, const PartSection& section) {
  const NodesInPose* const nodes = PoseCages::of(*this, part);
  if (!nodes || !hasKnot(nodes->sections, knot))
    return Error{ErrorCode::kMisuse, "the part has no sections, or no such knot of them"};
  const glm::vec2& width = section.width;
  if (!allFinite(glm::vec3(width, section.twist)) || !std::isfinite(section.keep_volume))
    return Error{ErrorCode::kMisuse, "a section has a number that is not finite"};
  Knot& to = writableKnots(nodes->sections)[static_cast<std::size_t>(knot)];
  to.position = {width.x - 1, to.position.y, width.y - 1};
  to.tangent = {section.twist, to.tangent.y, section.keep_volume};
  moved(nodes->sections);
  return {};
}

std::optional<PartSection> Pose::section(int part, int knot) const {
  const NodesInPose* const nodes = PoseCages::of(*this, part);
  if (!nodes || !hasKnot(nodes->sections, knot)) return std::nullopt;
  return sectionOf(knots(nodes->sections)[static_cast<std::size_t>(knot)]);
}

Result<void> Pose::setMorph(const Asset& asset, std::string_view name, float weight) {
  if (!fits(asset)) return Error{ErrorCode::kMisuse, "the pose is of another asset"};
  if (!std::isfinite(weight)) return Error{ErrorCode::kMisuse, "the weight of a morph target is not finite"};
  bool found = false;
  for (const Part& part : asset.pack().parts()) {
    for (const Morph& morph : part.cages.empty() ? std::span<const Morph>() : part.cages[0].morphs) {
      if (asset.pack().parts()[morph.part].name != name) continue;
      motion(static_cast<int>(morph.part))->translation.x = weight;
      found = true;
    }
  }
  return found ? Result<void>() : Error{ErrorCode::kMisuse, "there is no morph target of that name"};
}

void Pose::reset() {
  if (parts_ == 0) return;
  // memmove is slower for some hundred bytes, in thousands of poses a frame. The last step overlaps the one
  // before.
  constexpr std::size_t kStep = 16;
  static_assert(sizeof(Motion) >= kStep);
  std::byte* const to = state();
  const std::byte* const from = restState();
  const std::size_t last = stateBytes() - kStep;
  for (std::size_t i = 0; i < last; i += kStep) std::memcpy(to + i, from + i, kStep);
  std::memcpy(to + last, from + last, kStep);
  if (!cages_.empty()) PoseCages::reset(*this);
}

Result<void> Pose::assign(const Pose& other) {
  if (!sameShape(other)) return kNotAlike;
  if (&other == this) return {};
  if (parts_ > 0) std::copy_n(const_cast<Pose&>(other).state(), stateBytes(), state());
  if (!cages_.empty()) PoseCages::assign(other, *this);
  return {};
}

Result<void> Pose::blend(const Pose& to, float weight, std::span<const float> part_weights) {
  const auto isWeight = [](float w) { return w >= 0.0f && w <= 1.0f; };
  if (!sameShape(to)) return kNotAlike;
  if (!part_weights.empty() && part_weights.size() != parts_)
    return Error{ErrorCode::kMisuse, "a mask needs one weight per part"};
  if (!isWeight(weight) || !std::all_of(part_weights.begin(), part_weights.end(), isWeight)) {
    return Error{ErrorCode::kMisuse, "a weight is outside 0 to 1"};
  }
  const auto weightOf = [&](int part) {
    return part_weights.empty() ? weight : weight * part_weights[static_cast<std::size_t>(part)];
  };
  for (int part = 0; part < parts() && !cages_.empty(); ++part)
    if (weightOf(part) > 0.0f) PoseCages::blend(to, part, weightOf(part), *this);
  if (!cages_.empty()) PoseCages::blendDriven(to, weight, part_weights, *this);
  for (int part = 0; part < parts(); ++part) {
    const float w = weightOf(part);
    if (w == 0.0f) continue;
    moved(part);
    const std::span<Knot> mine = writableKnots(part);
    const std::span<const Knot> theirs = to.knots(part);
    for (std::size_t i = 0; i < mine.size(); ++i) {
      mine[i].position = glm::mix(mine[i].position, theirs[i].position, w);
      mine[i].tangent = glm::mix(mine[i].tangent, theirs[i].tangent, w);
    }
    Motion& motion = *this->motion(part);
    const Motion& other = *to.motion(part);
    motion.translation = glm::mix(motion.translation, other.translation, w);
    motion.scale = glm::mix(motion.scale, other.scale, w);
    motion.roll = glm::mix(motion.roll, other.roll, w);
    motion.rotation = glm::normalize(glm::slerp(motion.rotation, other.rotation, w));
  }
  return {};
}

Result<void> Pose::checkPart(int part) const {
  if (const NodesInPose* const nodes = PoseCages::of(*this, part)) {
    if (nodes->written || nodes->followsParts()) return PoseCages::check(*this, part);
    if (nodes->cages[0].placed.isMade(PoseCages::placedFor(*this, part))) return {};
  }
  const Shape& shape = const_cast<Pose*>(this)->shapes()[part];
  if (const Result<void> rig = checkRig(shape.bend, knots(part), shape.size, shape.roll + motion(part)->roll);
      !rig)
    return rig;
  return PoseCages::checkSections(*this, part);
}

Result<void> Pose::check() const {
  for (int part = 0; part < parts(); ++part) {
    const Result<void> sound = checkPart(part);
    if (!sound)
      return Error{sound.error().code, sound.error().detail, static_cast<std::uint64_t>(part),
                   Error::Unit::kPart};
  }
  return {};
}

void Pose::clamp() {
  for (int part = 0; part < parts(); ++part) {
    if (knots(part).empty() || checkPart(part)) continue;
    const NodesInPose* const nodes = PoseCages::of(*this, part);
    if (!PoseCages::checkSections(*this, part)) {
      const std::span<Knot> sections = writableKnots(nodes->sections);
      std::copy_n(restKnots() + (sections.data() - knotData()), sections.size(), sections.begin());
      moved(part);
      if (checkPart(part)) continue;
    }
    if (nodes && (nodes->written || nodes->followsParts())) {
      PoseCages::clamp(*this, part);
    } else if (shapes()[part].bend == Bend::kSweep) {
      clampSweep(part);
    } else {
      clampShear(part);
    }
    moved(part);
  }
}

// Halves the way to the pose at rest, which is sound, as often as it helps.
void Pose::clampSweep(int part) {
  const std::span<Knot> now = writableKnots(part);
  const Knot* const rest = restKnots() + (now.data() - knotData());
  Motion& motion = motionData()[part];
  Knot wanted[kMaxKnots];
  std::copy(now.begin(), now.end(), wanted);
  const float wanted_roll = motion.roll;
  const auto moveTo = [&](float share) {
    for (std::size_t i = 0; i < now.size(); ++i) {
      now[i].position = glm::mix(rest[i].position, wanted[i].position, share);
      now[i].tangent = glm::mix(rest[i].tangent, wanted[i].tangent, share);
    }
    motion.roll = share * wanted_roll;
  };
  float sound = 0;
  for (float step = 0.5f; step >= 1.0f / 4096; step *= 0.5f) {
    moveTo(sound + step);
    if (checkPart(part)) sound += step;
  }
  if (sound > 0) {
    moveTo(sound);
  } else {  // what was wanted may be no numbers
    std::copy_n(rest, now.size(), now.begin());
    motion.roll = 0;
  }
}

void Pose::clampShear(int part) {
  const std::span<Knot> k = writableKnots(part);
  // Each knot rises by at least a thousandth of its share of the height at rest.
  const Knot* const rest = restKnots() + (k.data() - knotData());
  const float height = rest[k.size() - 1].position.y - rest[0].position.y;
  for (std::size_t i = 1; i < k.size(); ++i) {
    const float least = k[i - 1].position.y + 1e-3f * height * (k[i].at - k[i - 1].at);
    k[i].position.y = std::max(k[i].position.y, least);
  }
  // Fritsch and Carlson 1980: a Hermite cubic of rise d with end slopes m0, m1 >= 0 is monotone if m0^2 +
  // m1^2 <= 9 d^2.
  for (Knot& knot : k) knot.tangent.y = std::max(knot.tangent.y, 0.0f);
  // Shrinking a tangent can make the neighbor segment not monotone if it was outside the circle. A
  // segment inside the circle stays there. So each pass puts at least one more segment inside, or is the
  // last.
  bool mended = true;
  while (mended) {
    mended = false;
    for (std::size_t i = 0; i + 1 < k.size(); ++i) {
      const float share = k[i + 1].at - k[i].at;
      const float rise = (k[i + 1].position.y - k[i].position.y) / share;
      const float length =
          std::sqrt(k[i].tangent.y * k[i].tangent.y + k[i + 1].tangent.y * k[i + 1].tangent.y);
      if (!(length > 3.0f * rise) || isMonotone(makeSegment(k[i], k[i + 1], 1.0f))) continue;
      k[i].tangent.y *= 2.999f * rise / length;
      k[i + 1].tangent.y *= 2.999f * rise / length;
      mended = true;
    }
  }
}

}  // namespace kelp::runtime
