// SPDX-License-Identifier: MIT
#include "draw_list.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/type_precision.hpp>
#include <glm/matrix.hpp>

#include "record_spline.h"

namespace kelp::draw {
namespace {

constexpr Error kUnknownAsset{ErrorCode::kMisuse, "an instance's asset was not added"};
constexpr Error kGoneAsset{ErrorCode::kMisuse, "an instance's asset was destroyed"};
constexpr Error kForeignPose{ErrorCode::kMisuse, "an instance's pose belongs to another asset"};
constexpr Error kForeignPalette{
    ErrorCode::kMisuse, "an instance's palette does not have one material for each entry of its pack"};
// Why instances are left out.
constexpr char kBadMatrix[] = "its to_world is not a finite, invertible, affine matrix";
constexpr char kBadMotion[] = "the motion of a part is not finite";

bool isAffine(const glm::mat4& m) { return m[0][3] == 0 && m[1][3] == 0 && m[2][3] == 0 && m[3][3] == 1; }

// A cache of the assets that the frame's instances name.
class FoundAssets {
 public:
  // Null, and `error` set: it must not be drawn.
  ResidentAsset* find(const Residency& store, const runtime::Asset* asset, const Error*& error) {
    const auto address = reinterpret_cast<std::uintptr_t>(asset);
    One& one = places_[(address >> 4 ^ address >> 8 ^ address >> 12) % kPlaces];
    if (one.asset != asset || !asset) {
      const int index = store.find(asset);
      if (index < 0 || !store.alive(index)) {
        error = index < 0 ? &kUnknownAsset : &kGoneAsset;
        return nullptr;
      }
      one = {asset, &store.at(index)};
    }
    return one.resident;
  }

 private:
  static constexpr std::size_t kPlaces = 64;
  struct One {
    const runtime::Asset* asset = nullptr;
    ResidentAsset* resident = nullptr;
  };
  One places_[kPlaces];
};

// True if a part moves as a whole, by its motion or an ancestor's, or because it hangs on a spline.
bool moves(const runtime::Pose& pose, std::span<const Part> parts, int part) {
  for (int i = part; i >= 0; i = parts[static_cast<std::size_t>(i)].parent) {
    if (*pose.motion(i) != runtime::Motion{} ||
        parts[static_cast<std::size_t>(i)].parent_at != Part::kNotOnSpline)
      return true;
  }
  return false;
}
constexpr glm::mat4x3 kSame(1);

// Of a part that is not drawn in this pass.
Result<void> checkPart(const runtime::Instance& instance, int part, std::span<const Knot> knots) {
  if (!instance.pose) return {};
  const Part& packed = instance.asset->pack().parts()[static_cast<std::size_t>(part)];
  if (packed.cages.empty())
    return checkRig(packed.bend, knots, packed.size, rollOf(packed, instance.pose, part));
  const auto posed = runtime::posedCage(instance, part, static_cast<int>(packed.cages.size()) - 1);
  return posed ? Result<void>() : Result<void>(posed.error());
}

}  // namespace

Result<void> DrawList::build(Residency& store, const Projection& projection, const View& view,
                             std::span<const runtime::Instance> instances, PartKind kind, Rays rays,
                             bool boxes) {
  const Frame frame{
      projection, view, kind, rays, store.uploaded(), kind == PartKind::kSolid && usesDistances(view.quality),
      boxes};
  waiting_ = 0;
  ring_ = {};
  count_ = 0;
  texels_ = 0;
  rows_ = 0;
  clamped_count_ = culled_ = too_small_ = parts_waiting_ = other_kind_ = 0;
  has_heat_[0] = has_heat_[1] = false;
  left_out_count_ = 0;
  first_left_out_ = {};
  palette_count_ = 0;
  palette_texels_ = 0;
  store.beginWants();
  FoundAssets found;
  const Error* error = nullptr;
  std::size_t i = 0;
  for (; i < instances.size() && !error; ++i) {
    ResidentAsset* const asset = found.find(store, instances[i].asset, error);
    const runtime::Instance* const instance = asset ? clampIfUnsound(frame, instances[i], error) : nullptr;
    if (instance) error = addInstance(frame, *asset, *instance, static_cast<std::uint32_t>(i));
  }
  if (error && error->code == ErrorCode::kMisuse) {
    count_ = 0;
    return Error{error->code, error->detail, i - 1, Error::Unit::kInstance};
  }
  if (!error) error = addBlock(frame);
  if (!error) {
    dropLeftOut();
    error = writePalettes();
  }
  if (!error) return writeOrder(kind);
  count_ = 0;
  return *error;
}

const Error* DrawList::addInstance(const Frame& frame, ResidentAsset& asset,
                                   const runtime::Instance& instance, std::uint32_t index) {
  const std::span<const Part> parts = asset.packed;
  if (instance.pose && static_cast<std::size_t>(instance.pose->parts()) != parts.size()) return &kForeignPose;
  if (instance.previous_pose && !instance.previous_pose->fits(*instance.asset)) return &kForeignPose;
  std::uint32_t palette = asset.palette();
  if (!instance.palette.empty()) {
    if (instance.palette.size() != instance.asset->pack().palette().size()) return &kForeignPalette;
    if (const Error* const error = addPalette(instance.palette, palette)) return error;
    palette |= kOwnPalette;
  }
  bool is_drawn = false, is_moved = false;
  for (std::uint32_t part = 0; part < parts.size(); ++part) {
    const std::span<const Knot> knots =
        instance.pose ? instance.pose->knots(static_cast<int>(part)) : parts[part].knots;
    if (knots.size() != parts[part].knots.size()) return &kForeignPose;
    const bool is_moving = instance.pose && moves(*instance.pose, parts, static_cast<int>(part));
    if (is_moving && !std::exchange(is_moved, true)) {
      if (!worlds_.grow(parts.size())) return &kNoMemoryForFrame;
      (void)runtime::partsToWorld(instance, {worlds_.data(), parts.size()});
    }
    if (parts[part].kind != frame.kind) {
      // An instance is drawn with all its parts, of either kind, or not at all.
      const Result<void> good = checkPart(instance, static_cast<int>(part), knots);
      const char* const why = !good                                   ? good.error().detail
                              : !isAffine(instance.to_world)          ? kBadMatrix
                              : is_moving && !isAffine(worlds_[part]) ? kBadMotion
                                                                      : nullptr;
      if (why) {
        if (const Error* const error = leaveOut(asset, index, why)) return error;
      }
      continue;
    }
    if (waiting_ == kBlock) {
      if (const Error* const error = addBlock(frame)) return error;
    }
    is_drawn = true;
    const std::size_t i = waiting_++;
    Candidate& candidate = block_[i];
    candidate.instance = &instance;
    candidate.asset = &asset;
    candidate.resident = &asset.parts[part];
    candidate.index = index;
    candidate.part = part;
    candidate.palette = palette;
    candidate.sound = true;
    candidate.roll = rollOf(parts[part], instance.pose, static_cast<int>(part));
    candidate.arcs = 0;
    candidate.caged = false;
    PosedParts& posed = posed_[i / 8];
    const std::size_t k = i % 8;
    posed.knots[k] = knots;
    posed.extents[k] = &candidate.resident->extent;
    posed.to_world[k] = &instance.to_world;
    posed.to_object[k] = &parts[part].to_object;
    if (is_moving) {
      moved_[i] = worlds_[part];
      posed.to_world[k] = &moved_[i];
      posed.to_object[k] = &kSame;
      // place() checks the others' matrices.
      candidate.sound = isAffine(instance.to_world);
      if (!candidate.sound) {
        if (const Error* const error = leaveOut(asset, index, kBadMatrix)) return error;
      }
    }
  }
  other_kind_ += !is_drawn;
  return nullptr;
}

const Error* DrawList::addBlock(const Frame& frame) {
  const std::size_t count = std::exchange(waiting_, 0);
  if (count == 0) return nullptr;
  const std::size_t eights = (count + 7) / 8;
  for (std::size_t i = count; i < 8 * eights; ++i)
    posed_[i / 8].repeat(i % 8);  // pad the last group to eight
  const auto countOf = [count](std::size_t eight) { return std::min<std::size_t>(count - 8 * eight, 8); };
  std::size_t segments = 0;
  arc_texels_ = cage_texels_ = 0;
  for (std::size_t i = 0; i < eights; ++i) {
    for (const std::span<const Knot>& knots : posed_[i].knots) segments += knots.size() - 1;
    if (const Error* const error = boundEight(i, countOf(i))) return error;
    if (const Error* const error = boundSwept(frame, i, countOf(i))) return error;
    if (const Error* const error = boundCaged(frame, i, countOf(i))) return error;
  }
  for (std::size_t i = 0; i < eights; ++i) {
    if (const Error* const error = place(frame, i, countOf(i))) return error;
  }
  for (std::size_t i = 0; i < eights; ++i) choose(frame, i, countOf(i));
  // Parts that stood otherwise in the frame before may have had more arcs.
  const std::size_t before = arc_texels_ > 0 && frame.movesPictures() ? count * (arcTexels(kMaxArcs) + 1) : 0;
  // One texel more, because writeSegments writes one number too many.
  if (!order_.grow(count_ + count) ||
      !records_.grow(texels_ + count * (kHeadTexels + kMotionTexels + 1) + 2 * 3 * segments + arc_texels_ +
                     cage_texels_ + before + 1))
    return &kNoMemoryForFrame;
  for (std::size_t i = 0; i < eights; ++i) write(frame, i, countOf(i));
  return nullptr;
}

const Error* DrawList::place(const Frame& frame, std::size_t eight, std::size_t count) {
  placeParts(frame.projection, posed_[eight], placed_[eight]);
  const PlacedParts& placed = placed_[eight];
  if (placed.affine == 255 && placed.invertible == 255) return nullptr;
  for (std::size_t k = 0; k < count; ++k) {
    Candidate& candidate = block_[8 * eight + k];
    const char* why = nullptr;
    if (!(placed.affine >> k & 1)) {
      // addInstance checked the host's matrix of parts that move. Their product is affine if the motion is
      // finite.
      why = posed_[eight].to_object[k] == &kSame ? kBadMotion : kBadMatrix;
    } else if (!(placed.invertible >> k & 1) && !isInvertible(candidate.instance->to_world)) {
      // (A motion may scale a part to nothing: then it shows no voxel.)
      why = kBadMatrix;
    }
    if (!why) continue;
    candidate.sound = false;
    if (const Error* const error = leaveOut(*candidate.asset, candidate.index, why)) return error;
  }
  return nullptr;
}

void DrawList::choose(const Frame& frame, std::size_t eight, std::size_t count) {
  JudgedParts judged;
  judgeParts(frame.projection, frame.view, frame.rays, placed_[eight], judged);
  for (std::size_t k = 0; k < count; ++k) {
    Candidate& candidate = block_[8 * eight + k];
    ResidentPart& resident = *candidate.resident;
    const bool is_seen = judged.seen >> k & 1;
    candidate.drawn = candidate.recorded = false;
    if (!candidate.sound) continue;
    const Detail wanted = Detail::of(candidate.caged ? candidate.level : judged.level.of[k]);
    if (placed_[eight].invertible >> k & 1)
      Residency::want(resident, wanted.level, std::min(judged.pixels.of[k], 1e4f));
    candidate.coarse = wanted.level < resident.finest;
    // (Nothing of a part may be there. In the ring of its instance it is recorded then, too.)
    candidate.detail = candidate.coarse ? Detail{std::min(resident.finest, resident.levels - 1), 0} : wanted;
    candidate.drawn = is_seen && resident.finest != resident.levels;
    candidate.recorded = candidate.drawn || (frame.rings && candidate.asset->packed.size() > 1 &&
                                             (placed_[eight].invertible >> k & 1));
    culled_ += !is_seen;
    too_small_ += judged.small >> k & 1;
    if (!is_seen || candidate.drawn) continue;
    ++parts_waiting_;
    tellWaiting(*candidate.asset, frame.uploaded);
  }
}

}  // namespace kelp::draw
