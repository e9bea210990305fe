// SPDX-License-Identifier: MIT
// Springs on the knots of an asset, and on the nodes of parts with cages. Pushed by the player, a blow or the
// wind, they swing back. They work on top of any pose:
//
//   pose.reset();  addClip(asset, clip, seconds, 1, pose);       the pose without the spring
//   spring.step(frame_seconds);
//   spring.pushAway({&asset, &pose, to_world}, player, 0.4f);    a player who walks through
//   spring.addTo(pose);                                          the pose to draw
#pragma once

#include <optional>

#include "kelp/runtime/instance.h"

namespace kelp::runtime {

struct PosedPart;

struct SpringOptions {
  float frequency = 1.0f;  // of the undamped swing, in Hz; > 0
  // Damping ratio, >= 0. 0: swings for ever. 1: returns fastest without overshoot. More: returns slowly.
  float damping = 0.25f;
  // The farthest that pushes or wind move a knot, or pushes a node, in heights of its part; > 0.
  float reach = 0.6f;
  // True: the first knot of a part is fixed, and the part bends like a beam: the farther from there, the
  // more. The lowest nodes of its cage are fixed, too. False: nothing is fixed, and all knots are pushed
  // alike. A part with a parent is fixed in any case, at the end where its pivot is: an arm that hangs down
  // at its top.
  bool rooted = true;
  // The parts that give way to pushAway(), in any order; nullopt: all. Of a cage whose nodes follow parts, as
  // a skin's follow joints, list the cage's part, or some that its nodes follow: then each node gives way by
  // the weight with which it follows these. Blows and wind name their part themselves. Copied by create().
  std::optional<std::span<const int>> parts = std::nullopt;
};

// The movement of a knot or a node relative to its pose.
struct Swing {
  glm::vec3 offset{0};    // heights of the part
  glm::vec3 velocity{0};  // heights per second
};

// Each knot is a damped harmonic oscillator about its place in the pose or, in wind, about the place where
// the wind holds it. Each node of a part's finest cage is one about the place where pose and knots put it.
// Blows and wind move knots, spheres the knots of parts without cages and the nodes of parts with.
// Children follow: a part goes with the place where it hangs on its parent, the origin of its pivot, as far
// as springs move that, and turns with it; there it stays joined, however it bends itself. On a part that
// nodes of a cage follow, a joint of a skin, it goes with these. Joints stay where clips and the host put
// them, and sockets on them.
// Keeps no pointer to its asset. Only create() allocates. Not thread-safe: use a spring on one thread at a
// time. Different springs may be used on different threads at the same time. Functions that return a Result
// return kMisuse, with nothing changed, for a part that does not exist, a pose or asset that does not fit,
// and numbers that are not finite. The state stays finite for any pushes and time steps.
class Spring {
 public:
  Spring() = default;  // of no part; fits no asset
  // A spring at rest, without wind. kMisuse for options out of range, for an empty list of parts and one
  // with a part that does not exist (`offset`: the part's place in the list); kOutOfMemory.
  static Result<Spring> create(const Asset& asset, const SpringOptions& options = {},
                               const Allocator& allocator = {});
  Spring(Spring&&) noexcept = default;
  Spring& operator=(Spring&&) noexcept = default;

  int parts() const { return static_cast<int>(bodies_.size()); }
  // The state of the knots of a part. Empty for a part that does not exist.
  std::span<const Swing> knots(int part) const;
  // The same of the nodes of the part's finest cage. Empty also for a part without cages.
  std::span<const Swing> nodes(int part) const;
  void reset();  // to rest, without wind

  // A blow: adds `velocity` (heights of the part per second, in its axes) to the free end of the part, and
  // less to the other knots, in proportion to the bend of a beam under an even load. The velocity is cut so
  // that no knot swings farther than `reach` from where the wind holds it.
  Result<void> push(int part, const glm::vec3& velocity);
  // The same, with a velocity in world space (meters per second if the world is in meters). The instance says
  // how the part stands in the world.
  Result<void> pushInWorld(const Instance& instance, int part, const glm::vec3& velocity);
  // Wind from now on: the acceleration that it would give the free end if nothing held it (heights of the
  // part per second squared, in its axes). It leans the free end by acceleration / (2 pi frequency)^2, at
  // most `reach`. For gusts, set it each frame.
  Result<void> setWind(int part, const glm::vec3& acceleration);
  // The same, with an acceleration in world space.
  Result<void> setWindInWorld(const Instance& instance, int part, const glm::vec3& acceleration);
  // The player's body, a sphere in world space. Pushes the middle line of every part that has voxels, and is
  // listed if SpringOptions::parts lists some, out of it, as a beam bends under a load at the deepest
  // contact, and stops knots that move towards it. instance.pose is the pose without the spring; null means
  // rest. The lowest quarter of a part yields only in part, and no knot moves beyond `reach`. A radius of 0
  // or less has no effect. A part that hangs on another is pushed where that takes it with the spring. A part
  // with cages yields as a soft body: all cells leave the sphere, or as far as `reach` lets them. Nodes
  // around a contact go with it, the less the farther away, up to 2.5 radii or cells; the others stay as they
  // are, to the last bit. Where the sphere's center is in the cells, they go to the side where most of them
  // are. Takes time in proportion to the cells of parts that the sphere may touch. kOutOfMemory: for the pose
  // of an instance without one, which the asset makes at its first use.
  Result<void> pushAway(const Instance& instance, const glm::vec3& center, float radius);

  // Advances the springs by `seconds` >= 0. The solution is exact for any step: two half steps equal one
  // whole. When all nodes of a part are nearly at rest, to a millionth of its height, they are at rest.
  Result<void> step(float seconds);

  // Adds the offsets to the knots' positions, and the slopes of the curve through the offsets to their
  // tangents. The slope is 0 at a fixed root, and free ends have no curvature, so a rig of two knots bends
  // exactly like a beam that is loaded at its end. Then calls pose.clamp(), which changes nothing if
  // a sheared part was pushed sideways. Nodes that follow their spline go where it takes them now; those that
  // the host wrote move with the curve of the knots' offsets. Then adds the offsets of nodes that swing: all
  // nodes of such a part are the host's from then on, until pose.reset(). Last, changes the motions of parts
  // that hang on what moved, but of those that the host's joints drive.
  Result<void> addTo(Pose& pose) const;

 private:
  enum class Root : std::uint8_t { kNone, kBottom, kTop };  // the end of a part that is fixed
  struct Body {                                             // of a part
    std::uint32_t first = 0;                                // the index of its first knot
    std::uint32_t knots = 0;
    float height = 0;     // voxels
    glm::vec3 middle{0};  // from the spline to the volume's middle line, voxels
    glm::vec3 lean{0};    // where the wind holds the free end, heights
    std::uint32_t first_node = 0;
    std::uint32_t nodes = 0;  // of its finest cage
    // All others are at rest: indices from first_node.
    std::uint32_t moved = 0, moved_end = 0;
    Root root = Root::kNone;
    bool yields = true;     // to spheres
    float least_share = 0;  // of the nodes of cells that spheres meet
  };
  // A place on a part whose frame springs move.
  struct Spot {
    int part = 0;
    glm::vec3 rest{0};  // part space
    // Of a part with a cage: the nodes of its tetrahedron there, in the order of their corners, and the axes
    // from one to the next.
    bool is_caged = false;
    std::uint32_t nodes[4] = {};
    int axes[3] = {};
    glm::vec3 corner{0};  // at rest
    float side = 0;
  };
  // A part on what holds it: at its pivot.
  struct Hang {
    Spot holder, own;
    int part = 0, parent = 0;
    bool is_on_spline = false;  // of its parent, whose knots move it
    // While addTo() runs: without the spring.
    bool moves = false;
    glm::mat4 before{1};
    glm::vec3 own_before{0};
  };
  Result<glm::vec3> fromWorld(const Instance& instance, int part, const glm::vec3& vector) const;
  static Error foreign();  // for a pose or asset that does not fit
  bool fits(const Pose& pose) const;
  bool fits(const Asset& asset) const;
  float share(const Body& body, std::uint32_t knot) const;
  float shareOfNode(const Body& body, float at) const;
  float energyOf(const Swing& swing, const glm::vec3& held) const;
  void limit(Swing& swing, const glm::vec3& held, float reach, float energy_before) const;
  void addTo(const Body& body, std::span<Knot> knots) const;
  // True: something was pushed.
  bool pushAway(const Body& body, const Part& part, std::span<const Knot> pose, const glm::mat4& to_world,
                const glm::vec3& center, float radius);
  // Of lists, and of parts that hang on others:
  Result<void> list(std::span<const Part> parts, std::span<const int> listed, const Allocator& allocator);
  Result<void> hang(const Asset& asset, const Allocator& allocator);
  glm::mat4 frameAt(const Spot& spot, const Pose& pose) const;
  bool isStill(const Body& body) const;
  void beforeKnots(const Pose& pose) const;
  void beforeNodes(const Pose& pose) const;
  void follow(Pose& pose) const;
  // Of nodes:
  struct Ball;
  bool movesOf(const Body& body, int side, const PosedPart* followed, std::span<glm::mat4x3> moves) const;
  Result<bool> pushNodesAway(Body& body, const Instance& instance, int part, const glm::mat4& to_world,
                             const glm::vec3& center, float radius);
  void pushNodes(Body& body, const Cage& cage, const Ball& ball, const glm::vec3& at, const glm::vec3& out,
                 float range);
  void stepNodes(Body& body, float a, float b, float c, float d);
  bool addToNodes(const Body& body, int part, Pose& pose) const;

  SpringOptions options_;
  float omega_ = 0;  // radians per second
  Buffer<Body> bodies_;
  Buffer<Swing> swings_;
  Buffer<Part> rest_;     // copies without names, levels and cages
  Buffer<Knot> at_rest_;  // their knots
  Buffer<Swing> node_swings_;
  Buffer<float> node_shares_;      // by which nodes give way; empty: all by 1
  Buffer<glm::vec3> node_places_;  // while nodes are pushed
  mutable Buffer<Hang> hangs_;     // ascending by part
  Pose with_;                      // while parts are pushed: with the spring; only if some hang
};

}  // namespace kelp::runtime
