// SPDX-License-Identifier: MIT
// The list of what a frame draws. Instances are divided into parts, culled, given a level, and written as the
// records of instance.glsl. Solids are ordered near to far, so that hidden ones are not traced; fog far to
// near, because it is blended.
#pragma once

#include "kelp/formats/sweep.h"
#include "placing.h"
#include "record_cage.h"
#include "residency.h"

namespace kelp::draw {

inline constexpr Error kNoMemoryForFrame{ErrorCode::kOutOfMemory, "no memory for the frame's draw list"};
// A record's palette is that of its instance, and lies among the records.
inline constexpr std::uint32_t kOwnPalette = 0x80000000u;

// The kinds of calls that draw solid parts, in their order: the highest bits of keys. kTraced: parts with
// cages that are drawn by their bounds.
enum class Way : std::uint32_t { kSheared, kSwept, kCaged, kTraced };
inline constexpr std::uint32_t kWays = 4;
// A bit of keys below those that are compared.
inline constexpr std::uint32_t kSweptFog = 1;

// Reused from frame to frame; allocates only to grow.
class DrawList {
 public:
  DrawList(const Allocator& allocator, const Log& log)
      : log_(log),
        worlds_(allocator),
        order_(allocator),
        sorted_(allocator),
        records_(allocator),
        arcs_(allocator),
        allocator_(allocator),
        left_out_(allocator),
        palettes_(allocator) {}

  // Lists the parts of one kind, and tells `store` which levels are wanted. Instances that cannot be drawn
  // are left out. kMisuse for one that the caller should not have passed; then nothing is listed. boxes: all
  // parts are drawn by their bounds.
  Result<void> build(Residency& store, const Projection& projection, const View& view,
                     std::span<const runtime::Instance> instances, PartKind kind, Rays rays, bool boxes);

  // To draw, in order.
  std::uint32_t parts() const { return static_cast<std::uint32_t>(count_); }
  // Of solids: the place of the first that is drawn so, or in a later way.
  std::uint32_t begin(Way way) const { return begins_[static_cast<std::size_t>(way)]; }
  // Faces of the cage of the part at this place, which has one.
  std::uint32_t faces(std::uint32_t place) const {
    return reinterpret_cast<const CageHead&>(records_[order_[place].texel + kHeadTexels]).faces;
  }
  // Rows of kRecordWidth texels.
  std::span<const glm::uvec4> records() const { return records_.span().first(rows_ * kRecordWidth); }
  // Where the numbers of the parts' records begin, four to a texel.
  std::uint32_t firstNumber() const { return static_cast<std::uint32_t>(4 * texels_); }
  void count(Stats& stats) const;
  // The record of the part at this place in the order.
  const RecordHead& record(std::uint32_t place) const {
    return reinterpret_cast<const RecordHead&>(records_[order_[place].texel]);
  }
  // The bend of the fog part at this place in the order, and true if a listed fog part of this bend has heat.
  Bend fogBend(std::uint32_t place) const {
    return order_[count_ - 1 - place].key & kSweptFog ? Bend::kSweep : Bend::kShear;
  }
  bool hasHeat(Bend bend) const { return has_heat_[static_cast<int>(bend)]; }

 private:
  struct Ordered {
    std::uint32_t key = 0;    // ascends with the depth of the part's nearest point
    std::uint32_t texel = 0;  // of the record
  };
  struct Frame {
    const Projection& projection;
    const View& view;
    PartKind kind;
    Rays rays;
    bool uploaded;  // the renderer has uploaded before
    bool rings;     // whether records lead to those of their instance's other parts
    bool boxes;     // all parts are drawn by their bounds
    // True if rays other than those that draw a part may meet its cage.
    bool hasTrees() const {
      return boxes || rays == Rays::kAny || view.quality.self_shadow || view.quality.occlusion_rays > 0;
    }
    // True if records say where the parts were in the frame before.
    bool movesPictures() const { return rays == Rays::kView && view.camera.previous_world_to_clip; }
  };
  // A posed part before it is listed, without what the lanes compute with.
  struct Candidate {
    const runtime::Instance* instance;
    ResidentAsset* asset;
    ResidentPart* resident;
    std::uint32_t index;  // of the instance
    std::uint32_t part;
    std::uint32_t palette;  // as in the record
    Detail detail;
    bool drawn;
    bool recorded;  // drawn, or it may shade other parts of its instance
    bool sound;     // false: its instance is left out
    bool coarse;    // a finer level is wanted than is on the GPU
    // Of a swept part.
    float roll;
    float tolerance;      // of its arcs
    std::size_t arcs_at;  // in arcs_
    std::uint32_t arcs;   // how many; 0: it is no swept one
    // Of a part with cages. Its `detail` begins at the level of the cage that it is drawn through.
    bool caged;
    float level;  // as Detail::of, by where its finest cage is
    runtime::PosedCage posed;
  };
  // The materials of an instance, which follow the records.
  struct Palette {
    std::span<const Material> materials;
    std::size_t texel = 0;  // where it begins, from the first palette on
  };
  // Candidates are computed eight at a time, and a whole block takes each step before the next one. A step is
  // a chain of dependent results, so the processor works on several eights at once. README.md has the gain.
  static constexpr std::size_t kBlock = 32, kEights = kBlock / 8;

  // These return null, or an error that ends the frame.
  const Error* addInstance(const Frame& frame, ResidentAsset& asset, const runtime::Instance& instance,
                           std::uint32_t index);
  const Error* addBlock(const Frame& frame);
  const Error* boundEight(std::size_t eight, std::size_t count);
  const Error* boundSwept(const Frame& frame, std::size_t eight, std::size_t count);
  void judgeAbout(const Frame& frame, std::size_t eight, JudgedParts& judged) const;
  const Error* listArcs(std::size_t eight, std::size_t k, float level);
  const Error* boundCaged(const Frame& frame, std::size_t eight, std::size_t count);
  const Error* poseCage(std::size_t eight, std::size_t k, int level, runtime::CageUse use);
  const Error* place(const Frame& frame, std::size_t eight, std::size_t count);
  const Error* leaveOut(ResidentAsset& asset, std::uint32_t instance, const char* why);
  const runtime::Instance* clampIfUnsound(const Frame& frame, const runtime::Instance& instance,
                                          const Error*& error);
  void tellWaiting(ResidentAsset& asset, bool uploaded) const;
  const Error* addPalette(std::span<const Material> materials, std::uint32_t& word);
  const Error* writePalettes();
  void dropLeftOut();
  std::uint32_t texelOf(const RecordHead& head) const;
  void link(const Candidate& candidate, std::uint32_t record, std::size_t place);
  void choose(const Frame& frame, std::size_t eight, std::size_t count);
  void write(const Frame& frame, std::size_t eight, std::size_t count);
  glm::uvec4* writeSpline(const Frame& frame, const Candidate& candidate, const PosedParts& posed,
                          std::size_t k, bool traced, glm::uvec4* out);
  // Writes what is not computed in lanes.
  void finish(const Frame& frame, const Candidate& candidate, Way way, float nearest, RecordHead& head);
  Result<void> writeOrder(PartKind kind);

  Candidate block_[kBlock]{};  // the first waiting_
  glm::mat4 moved_[kBlock];    // part -> world, of those that move as a whole
  PosedParts posed_[kEights];
  PlacedParts placed_[kEights]{};
  ArcChain chain_;
  std::size_t waiting_ = 0;
  Log log_;
  Buffer<glm::mat4> worlds_;  // part -> world of one instance that moves as a whole
  Buffer<Ordered> order_;     // the first count_
  Buffer<Ordered> sorted_;
  Buffer<glm::uvec4> records_;  // the first texels_
  Buffer<glm::uvec4> arcs_;     // of the block's swept parts, as in the records; the first arc_texels_
  std::size_t arc_texels_ = 0;
  std::size_t cage_texels_ = 0;  // that records of the block's parts with cages may take
  std::size_t count_ = 0;
  std::uint32_t begins_[kWays + 1] = {};
  std::size_t texels_ = 0;
  std::size_t rows_ = 0;
  // The ring of records that is being made: its instance, its first record, where its last record leads on.
  struct Ring {
    std::uint32_t instance = ~0u;
    std::uint32_t first = 0;
    std::size_t last = 0;
  };
  Ring ring_;
  std::uint32_t culled_ = 0, too_small_ = 0, parts_waiting_ = 0, other_kind_ = 0;  // as in Stats
  bool has_heat_[2] = {};                                                          // by bend
  // An instance with a clamped pose, until its block is written.
  Allocator allocator_;
  runtime::Instance clamped_;
  runtime::Pose clamped_pose_;
  runtime::AssetWatch clamped_watch_;  // of the asset that clamped_pose_ was made for
  std::uint32_t clamped_count_ = 0;
  Buffer<std::uint32_t> left_out_;  // the first left_out_count_: indices of instances, ascending
  std::size_t left_out_count_ = 0;
  Error first_left_out_;
  Buffer<Palette> palettes_;  // the first palette_count_
  std::size_t palette_count_ = 0, palette_texels_ = 0;
};

}  // namespace kelp::draw
