// SPDX-License-Identifier: MIT
// Sockets, and parts that hang on their parent's spline, against the map's own formula in double precision.
#include <gtest/gtest.h>

#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "kelp/runtime/spring.h"
#include "loaded.h"

namespace kelp::runtime {
namespace {

constexpr float kTilt = 0.7f;

// A stem of 24 x 48 x 24 voxels, one meter high, and a leaf that hangs on it at 3/4.
RawPack stemAndLeaf(bool hangs = true) {
  RawPack pack = test::packOf(test::ballClump({24, 48, 24}, 8, 1), straight({0, 0.5f, 1}));
  pack.parts[0].name = "stem";
  pack.parts[0].automatic_tangents = 7;
  RawPart leaf = test::partOf(test::ballClump({16, 16, 16}, 5, 2), straight({0, 1}), "leaf");
  leaf.to_object[3] += glm::vec3(0.4f, 0.7f, 0.1f);
  leaf.pivot = leaf.to_object;
  leaf.parent = 0;
  if (hangs) leaf.parent_at = 0.75f;
  pack.parts.push_back(leaf);
  const glm::quat turned = glm::angleAxis(kTilt, glm::normalize(glm::vec3(1, 2, 3)));
  pack.sockets = {{"tip", 0, 1, {0, 0}, {1, 0, 0, 0}}, {"side", 0, 0.6f, {0.2f, -0.1f}, turned}};
  return pack;
}

struct Scene {
  Loaded loaded;
  Pose pose;
  Instance instance;
  explicit Scene(const RawPack& pack) : loaded(pack), pose(*Pose::create(*loaded.asset)) {
    instance = {loaded.asset.get(), &pose};
    instance.to_world = glm::rotate(glm::translate(glm::mat4(1), {3, 1, -2}), 0.8f, {0, 1, 0});
  }
  void bend() {
    ASSERT_TRUE(pose.move(0, 1, {0.1f, 0.02f, -0.05f}));
    ASSERT_TRUE(pose.move(0, 2, {0.5f, -0.06f, 0.2f}));
  }
};

// The deformed middle line in double precision, by bisection of the spline's height: where a rest height of
// `at` is, and its tangent. Meters of the model.
struct OnLine {
  glm::dvec3 place, tangent;
};
OnLine middleLine(const Pose& pose, double at, const glm::dvec2& offset = {}) {
  const std::span<const Knot> knots = pose.knots(0);
  const double low = knots.front().position.y, high = knots.back().position.y;
  const double height = low + at * (high - low);
  std::size_t i = 0;
  while (i + 2 < knots.size() && height > double{knots[i + 1].position.y}) ++i;
  const double w = double{knots[i + 1].at} - double{knots[i].at};
  const glm::dvec3 p0(knots[i].position), p1(knots[i + 1].position),
      m0 = w * glm::dvec3(knots[i].tangent), m1 = w * glm::dvec3(knots[i + 1].tangent);
  const auto place = [&](double t) {
    return (2 * t * t * t - 3 * t * t + 1) * p0 + (t * t * t - 2 * t * t + t) * m0 +
           (3 * t * t - 2 * t * t * t) * p1 + (t * t * t - t * t) * m1;
  };
  double from = 0, to = 1;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (from + to);
    (place(middle).y < height ? from : to) = middle;
  }
  const double t = 0.5 * (from + to);
  const glm::dvec3 tangent =
      (6 * t * t - 6 * t) * (p0 - p1) + (3 * t * t - 4 * t + 1) * m0 + (3 * t * t - 2 * t) * m1;
  return {place(t) + glm::dvec3(offset.x, 0, offset.y), glm::normalize(tangent)};
}

void expectNear(const glm::vec3& a, const glm::dvec3& b, double tolerance, const char* what) {
  EXPECT_LT(glm::distance(glm::dvec3(a), b), tolerance) << what;
}

TEST(Sockets, AreFoundByName) {
  Scene scene(stemAndLeaf());
  const Asset& asset = *scene.loaded.asset;
  EXPECT_EQ(findSocket(asset, "tip").value(), 0);
  EXPECT_EQ(findSocket(asset, "side", 0).value(), 1);
  for (const Result<int>& absent : {findSocket(asset, "hand"), findSocket(asset, "tip", 1)}) {
    ASSERT_FALSE(absent);
    EXPECT_EQ(absent.error().code, ErrorCode::kMisuse);
    EXPECT_STREQ(absent.error().detail, "there is no socket of that name; there are: tip, side");
  }
  const std::span<const Part> parts = asset.pack().parts();
  for (std::size_t i = 0; i < parts.size(); ++i)
    EXPECT_EQ(findPart(asset, parts[i].name).value(), static_cast<int>(i));
  const Result<int> root = findPart(asset, "root");
  ASSERT_FALSE(root);
  EXPECT_EQ(root.error().code, ErrorCode::kMisuse);
  EXPECT_NE(std::string_view(root.error().detail).find(parts[1].name), std::string_view::npos);
  EXPECT_STREQ(findJoint(asset, "tip").error().detail, "there is no joint of that name; the pack has none");
  EXPECT_STREQ(findClip(asset, "sway").error().detail, "there is no clip of that name; the pack has none");
  EXPECT_EQ(socketToWorld(scene.instance, 2).error().code, ErrorCode::kMisuse);
  EXPECT_EQ(socketToWorld(scene.instance, -1).error().code, ErrorCode::kMisuse);
  EXPECT_EQ(socketToWorld({}, 0).error().code, ErrorCode::kMisuse);
  for (const int part : {-1, 2}) {
    EXPECT_EQ(partToWorld(scene.instance, part).error().code, ErrorCode::kMisuse);
    EXPECT_EQ(toWorld(scene.instance, part, {}).error().code, ErrorCode::kMisuse);
    EXPECT_EQ(frameAt(scene.instance, part, {}).error().code, ErrorCode::kMisuse);
    EXPECT_FALSE(toRest(scene.instance, part, {}));
  }
  std::vector<glm::mat4> many(3);
  EXPECT_EQ(partsToWorld(scene.instance, many).error().code, ErrorCode::kMisuse);
  // The pose of an asset with fewer parts.
  RawPack one = stemAndLeaf();
  one.parts.resize(1);
  one.sockets.clear();
  const Scene other(one);
  const Pose foreign = Pose::create(*other.loaded.asset).value();
  scene.instance.pose = &foreign;
  for (const int part : {0, 1}) {
    EXPECT_EQ(partToWorld(scene.instance, part).error().code, ErrorCode::kMisuse);
    EXPECT_EQ(toWorld(scene.instance, part, {}).error().code, ErrorCode::kMisuse);
    EXPECT_EQ(frameAt(scene.instance, part, {}).error().code, ErrorCode::kMisuse);
    EXPECT_FALSE(toRest(scene.instance, part, {}));
  }
  many.resize(2);
  EXPECT_EQ(partsToWorld(scene.instance, many).error().code, ErrorCode::kMisuse);
  EXPECT_EQ(socketToWorld(scene.instance, 0).error().code, ErrorCode::kMisuse);
}

TEST(Joints, TheFirstOfANameIsFound) {
  RawPack pack = stemAndLeaf();
  for (const char* const name : {"hip", "knee", "knee"})
    pack.joints.push_back({name, static_cast<int>(pack.joints.size()) - 1, glm::mat4x3(1), {}});
  const Scene scene(pack);
  const Asset& asset = *scene.loaded.asset;
  EXPECT_EQ(findJoint(asset, "hip").value(), 0);
  EXPECT_EQ(findJoint(asset, "knee").value(), 1);
  EXPECT_EQ(findJoint(asset, "ankle").error().code, ErrorCode::kMisuse);
  EXPECT_STREQ(findJoint(asset, "ankle").error().detail,
               "there is no joint of that name; there are: hip, knee, knee");
}

TEST(Sockets, ManyNamesAreCutShort) {
  RawPack pack = stemAndLeaf();
  pack.sockets.clear();
  for (int i = 0; i < 300; ++i) pack.sockets.push_back({std::string(200, 'a'), 0, 0, {0, 0}, {1, 0, 0, 0}});
  Scene scene(pack);
  const std::string text = findSocket(*scene.loaded.asset, "b").error().detail;
  EXPECT_LT(text.size(), 1024u);
  EXPECT_EQ(text.substr(text.size() - 5), ", ...");
}

TEST(Sockets, FollowTheSpline) {
  Scene scene(stemAndLeaf());
  for (const bool bent : {false, true}) {
    if (bent) scene.bend();
    for (int socket = 0; socket < 2; ++socket) {
      const Socket& on = scene.loaded.asset->pack().sockets()[static_cast<std::size_t>(socket)];
      const glm::mat4 frame = socketToWorld(scene.instance, socket).value();
      const OnLine truth = middleLine(scene.pose, double{on.at}, on.offset);
      const glm::dmat4 to_world(scene.instance.to_world);
      expectNear(glm::vec3(frame[3]), glm::dvec3(to_world * glm::dvec4(truth.place, 1)), 1e-5, "place");
      // Without the artist's rotation, y runs along the spline and x is the model's made perpendicular.
      const glm::dmat3 plain = glm::dmat3(frame) * glm::transpose(glm::dmat3(glm::mat3_cast(on.rotation)));
      const glm::dvec3 up = glm::dmat3(to_world) * truth.tangent, x = glm::dmat3(to_world)[0];
      expectNear(glm::vec3(plain[1]), up, 2e-4, "y");
      expectNear(glm::vec3(plain[0]), glm::normalize(x - glm::dot(x, up) * up), 2e-4, "x");
      EXPECT_NEAR(glm::determinant(plain), 1.0, 1e-5);
    }
  }
}

// A child moves as a rigid body with the place on the spline where it hangs: there its frame is that of a
// socket.
TEST(PartsOnSplines, MoveWithThePlaceWhereTheyHang) {
  Scene scene(stemAndLeaf());
  const glm::mat4 rest = partToWorld(scene.instance, 1).value();
  RawPack with_socket = stemAndLeaf();
  with_socket.sockets.push_back({"hook", 0, 0.75f, {0, 0}, {1, 0, 0, 0}});
  Scene hook(with_socket);
  const glm::mat4 hook_rest = socketToWorld(hook.instance, 2).value();
  scene.bend();
  hook.bend();
  // The pose moves the parent as a whole, too.
  for (Pose* pose : {&scene.pose, &hook.pose})
    pose->motion(0)->rotation = glm::angleAxis(0.4f, glm::vec3(0, 0, 1));
  const glm::dmat4 moved =
      glm::dmat4(socketToWorld(hook.instance, 2).value()) * glm::inverse(glm::dmat4(hook_rest));
  const glm::dmat4 wanted = moved * glm::dmat4(rest), got(partToWorld(scene.instance, 1).value());
  for (int column = 0; column < 4; ++column)
    EXPECT_LT(glm::distance(wanted[column], got[column]), 1e-4) << column;
  EXPECT_GT(glm::distance(got[3], glm::dmat4(rest)[3]), 0.2) << "it moved";

  // Its own motion comes before: about its pivot.
  const glm::mat4 before = partToWorld(scene.instance, 1).value();
  scene.pose.motion(1)->translation = {0, 2, 0};  // two voxels of the leaf, along its own y
  EXPECT_LT(glm::distance(partToWorld(scene.instance, 1).value()[3], before * glm::vec4(0, 2, 0, 1)), 1e-4f);
}

TEST(PartsOnSplines, AreBoundedAndHitWhereTheyAre) {
  Scene hanging(stemAndLeaf()), rigid(stemAndLeaf(false));
  hanging.bend();
  rigid.bend();
  EXPECT_GT(
      glm::distance(partToWorld(hanging.instance, 1).value()[3], partToWorld(rigid.instance, 1).value()[3]),
      0.1f);
  const glm::vec3 center =
      toWorld(hanging.instance, 1,
              glm::vec3(hanging.loaded.asset->pack().parts()[1].to_object * glm::vec4(8, 8, 8, 1)))
          .value();
  const Box box = bounds(hanging.instance);
  EXPECT_TRUE(glm::all(glm::lessThan(box.min, center)) && glm::all(glm::lessThan(center, box.max)));
  const glm::vec3 eye = center + glm::vec3(3, 0.2f, 0);
  const auto hit = raycast(hanging.instance, {eye, center - eye});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->part, 1);
  const Instance both[] = {rigid.instance, hanging.instance};
  const auto nearest = raycast(both, {eye, center - eye});
  ASSERT_TRUE(nearest);
  EXPECT_EQ(nearest->instance, 1);
  EXPECT_EQ(nearest->voxel, hit->voxel);
  // The nearer one wins, wherever it is in the list.
  Instance behind = hanging.instance;
  behind.to_world[3].x -= 0.5f;
  for (const int first : {0, 1}) {
    const Instance row[] = {first == 0 ? hanging.instance : behind, first == 0 ? behind : hanging.instance};
    const auto found = raycast(row, {eye, center - eye});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->instance, first);
    EXPECT_EQ(found->t, hit->t);
  }
}

TEST(PlayOnce, HoldsItsEnds) {
  RawPack pack = reed({0, 1});
  RawClip clip;
  clip.name = "nod";
  clip.duration = 2;
  RawTrack track;
  track.knot = 1;
  track.keys = {{0, {0.1f, 0, 0, 0}, {}, {}}, {2, {0.5f, 0, 0, 0}, {}, {}}};
  clip.tracks = {track};
  clip.waves = {{0, 0, Target::kKnotOffset, {0.1f, 0, 0}, 3, 0}};
  pack.clips = {clip};
  Loaded loaded(pack);
  Pose pose = *Pose::create(*loaded.asset);
  const auto at = [&](double seconds, Play play) {
    pose.reset();
    EXPECT_TRUE(addClip(*loaded.asset, 0, seconds, 1, pose, play));
    return pose.knots(0)[1].position.x;
  };
  EXPECT_FLOAT_EQ(at(-5, Play::kOnce), 0.1f);
  EXPECT_FLOAT_EQ(at(1, Play::kOnce), 0.3f);
  EXPECT_FLOAT_EQ(at(2, Play::kOnce), 0.5f);
  EXPECT_FLOAT_EQ(at(1e9, Play::kOnce), 0.5f);
  EXPECT_FLOAT_EQ(at(2, Play::kLoop), 0.1f);
  for (const double after : {2.0, 2.5, 1e9}) {  // waves stop, too
    at(after, Play::kOnce);
    EXPECT_NEAR(double{pose.knots(0)[0].position.x}, 0.1 * std::sin(2 * 3.14159265358979 * 2 / 3), 1e-6);
  }
}

// Poses and springs are members and elements; assets outlive the objects that opened them.
TEST(Lifetimes, ModelsMoveInAVector) {
  struct Model {
    std::unique_ptr<Asset> asset;
    Pose pose;
    Spring spring;
  };
  const std::vector<std::byte> bytes = test::bytesOf(reed({0, 1}));
  std::vector<Model> models;
  for (int i = 0; i < 20; ++i) {
    Model model;
    EXPECT_EQ(model.pose.parts(), 0);
    EXPECT_FALSE(model.pose.move(0, 0, {}));
    model.asset = Asset::open(MemorySource(bytes).source()).value();
    EXPECT_FALSE(model.pose.fits(*model.asset));
    EXPECT_TRUE(model.spring.step(0.1f));
    model.pose = Pose::create(*model.asset).value();
    EXPECT_FALSE(model.spring.addTo(model.pose)) << "no spring yet";
    model.spring = Spring::create(*model.asset).value();
    models.push_back(std::move(model));
  }
  for (Model& model : models) {
    ASSERT_TRUE(model.asset->loadAll());
    EXPECT_TRUE(model.pose.move(0, 1, {0.1f, 0, 0}));
    EXPECT_TRUE(model.spring.addTo(model.pose));
    EXPECT_TRUE(model.pose.check());
  }
}

// More leaves than are remembered, on two stems in turn, with a bud on each: one call gives what many give.
TEST(Hanging, AllPartsAtOnceAreWhereEachIs) {
  RawPack pack = stemAndLeaf();
  RawPart stem = pack.parts[0];
  stem.name = "swept stem";
  stem.bend = Bend::kSweep;
  stem.knots = straight({0, 0.5f, 1});
  RawPart leaf = pack.parts[1];
  pack.parts.push_back(stem);
  for (int i = 0; i < 45; ++i) {
    leaf.name = "leaf " + std::to_string(i);
    leaf.parent = i % 3 == 0 ? 0 : 2;
    leaf.parent_at = static_cast<float>(i % 10) / 10;
    pack.parts.push_back(leaf);
    RawPart bud = leaf;
    bud.name = "bud " + std::to_string(i);
    bud.parent = static_cast<int>(pack.parts.size()) - 1;
    bud.parent_at = i % 2 ? 0.5f : Part::kNotOnSpline;
    pack.parts.push_back(bud);
  }
  Scene scene(pack);
  scene.bend();
  ASSERT_TRUE(scene.pose.move(2, 2, {0.2f, -0.05f, 0.1f}));
  std::vector<glm::mat4> worlds(pack.parts.size());
  partsToWorld(scene.instance, worlds).value();
  for (std::size_t i = 0; i < pack.parts.size(); ++i)
    EXPECT_EQ(worlds[i], partToWorld(scene.instance, static_cast<int>(i)).value()) << pack.parts[i].name;
  // The leaves on the swept stem went with it.
  const Pose rest = *Pose::create(*scene.loaded.asset);
  Instance still = scene.instance;
  still.pose = &rest;
  EXPECT_GT(glm::distance(worlds[11][3], partToWorld(still, 11).value()[3]), 0.01f);
  EXPECT_EQ(pack.parts[11].parent, 2);
}

}  // namespace
}  // namespace kelp::runtime
