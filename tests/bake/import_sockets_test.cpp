// SPDX-License-Identifier: MIT
// Empties socket.NAME in glTF files, and parts that hang on their parent's spline. The truth is the place of
// the empty in the world, worked out here from the nodes.
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "import_scratch.h"

namespace kelp::bake::test {
namespace {

// A post of 0.2 x 2 x 0.2 along +y whose foot is at its origin.
std::string post(const std::string& nodes) {
  GltfMaker maker;
  maker.addBox();
  return maker.text(GltfMaker::boxMesh() + R"(,"scenes":[{"nodes":[0]}],"nodes":)" + nodes);
}

RawPack baked(const Scratch& scratch, const std::string& text, const Settings& settings, Report& report) {
  Settings coarse = settings;
  coarse.resolution = 160;
  return bake(scratch.write("post.gltf", text), coarse, report);
}

// Where a socket of a pack is in the object, as SPEC.md 4.7 has it.
glm::dmat4 seatOf(const RawPack& pack, const RawSocket& socket) {
  const RawPart& part = pack.parts[socket.part];
  const glm::dvec3 size(part.size);
  glm::dmat4 seat = glm::mat4_cast(glm::dquat(socket.rotation));
  seat[3] = glm::dvec4(size.x / 2 + static_cast<double>(socket.offset.x) * size.y,
                       static_cast<double>(socket.at) * size.y,
                       size.z / 2 + static_cast<double>(socket.offset.y) * size.y, 1);
  glm::dmat4 to_object(1);
  for (int i = 0; i < 4; ++i) to_object[i] = glm::dvec4(glm::dvec3(part.to_object[i]), i == 3 ? 1 : 0);
  return to_object * seat;
}

// The place is the empty's up to rounding, its axes point where the empty's do.
void expectSeat(const RawPack& pack, const std::string& name, const glm::dmat4& world) {
  SCOPED_TRACE(name);
  for (const RawSocket& socket : pack.sockets) {
    if (socket.name != name) continue;
    const glm::dmat4 seat = seatOf(pack, socket);
    EXPECT_LT(glm::distance(glm::dvec3(seat[3]), glm::dvec3(world[3])), 1e-4);
    for (int i = 0; i < 3; ++i)
      EXPECT_LT(glm::distance(glm::normalize(glm::dvec3(seat[i])), glm::normalize(glm::dvec3(world[i]))),
                1e-5);
    return;
  }
  ADD_FAILURE() << "there is no such socket";
}

const char* const kNodes =
    R"([{"name":"Post","mesh":0,"children":[1,2,3],"translation":[3,1,-2],"rotation":[0,0.6,0,0.8],"scale":[2,2,2]},
  {"name":"socket.hand","translation":[0.3,1.5,-0.2],"rotation":[0.48,0,0.36,0.8]},
  {"name":"grip","translation":[0,1,0],"rotation":[0,0,0.6,0.8],"children":[4]},
  {"name":"socket_foot","rotation":[0.6,0,0,0.8]},
  {"name":"socket-elbow","translation":[0.1,0,0.05],"scale":[1,3,0.5]}])";

glm::dmat4 local(const glm::dvec3& translation, const glm::dquat& rotation, double scale = 1) {
  return glm::translate(glm::dmat4(1), translation) * glm::mat4_cast(rotation) *
         glm::scale(glm::dmat4(1), glm::dvec3(scale));
}

TEST(ImportSockets, StandWhereTheirEmptiesDoForEveryAxis) {
  const Scratch scratch;
  const glm::dmat4 world = local({3, 1, -2}, glm::dquat(0.8, 0, 0.6, 0), 2);
  for (const char* axis : {"+x", "-x", "+y", "-y", "+z", "-z"}) {
    for (const Parts parts : {Parts::kOne, Parts::kNodes}) {
      SCOPED_TRACE(axis);
      Report report;
      const RawPack pack = baked(scratch, post(kNodes), with([&](Settings& s) {
                                   s.axis = parseAxis(axis);
                                   s.parts = parts;
                                 }),
                                 report);
      ASSERT_EQ(pack.parts.size(), 1u) << "empties are no parts";
      ASSERT_EQ(pack.sockets.size(), 3u);
      expectSeat(pack, "elbow",
                 world * local({0, 1, 0}, glm::dquat(0.8, 0, 0, 0.6)) *
                     local({0.1, 0, 0.05}, glm::dquat(1, 0, 0, 0)));
      if (std::string(axis) == "+y") {
        expectSeat(pack, "hand", world * local({0.3, 1.5, -0.2}, glm::dquat(0.8, 0.48, 0, 0.36)));
        expectSeat(pack, "foot", world * local({0, 0, 0}, glm::dquat(0.8, 0.6, 0, 0)));
        EXPECT_EQ(report.notices, std::vector<std::string>{});
        EXPECT_EQ(report.parts[0].sockets, (std::vector<std::string>{"hand", "foot", "elbow"}));
      }
    }
  }
}

TEST(ImportSockets, BeyondTheEndIsTakenToTheEndWithANotice) {
  const Scratch scratch;
  Report report;
  const RawPack pack = baked(scratch, post(R"([{"name":"Post","mesh":0,"children":[1,2]},
    {"name":"socket.near","translation":[0,2.03,0]},{"name":"socket.far","translation":[0,2.5,0]}])"),
                             {}, report);
  ASSERT_EQ(pack.sockets.size(), 2u);
  EXPECT_EQ(pack.sockets[0].at, 1.0f);
  EXPECT_EQ(pack.sockets[1].at, 1.0f);
  ASSERT_EQ(report.notices.size(), 1u);
  EXPECT_TRUE(contains(report.notices[0], "'socket.far' lies 25 % of the mesh's length beyond its end"))
      << report.notices[0];
}

TEST(ImportSockets, BlendersNumbersGoWhereTheNameIsFree) {
  const Scratch scratch;
  const SourceModel model = importText(scratch, post(R"([{"name":"Post","mesh":0,"children":[1,2,3,4,5,6]},
    {"name":"socket.hand.001"},{"name":"socket.tip.002"},{"name":"socket.hand"},{"name":"socket.tip.002"},
    {"name":"sockets"},{"name":"socket."}])"));
  std::vector<std::string> names;
  for (const auto& socket : model.parts.at(0).rig.sockets) names.push_back(socket.name);
  EXPECT_EQ(names, (std::vector<std::string>{"hand", "hand.001", "tip", "tip.002"}));
}

TEST(ImportSockets, SocketsOfTheRigCountInsteadOfNodes) {
  const Scratch scratch;
  const std::string text = post(
      R"([{"name":"Post","mesh":0,"children":[1],"extras":{"kelp":{"kelp":1,"sockets":{"top":{"at":1}}}}},{"name":"socket.hand"}])");
  const SourceModel model = importText(scratch, text);
  ASSERT_EQ(model.parts.at(0).rig.sockets.size(), 1u);
  EXPECT_EQ(model.parts[0].rig.sockets[0].name, "top");
  EXPECT_TRUE(anyContains(model.notices, "has sockets: they count, not the 1 of nodes"));
}

// A lantern below a post, with an animated empty between them: where the two meet is the empty's, so the
// lantern hangs by it.
TEST(ImportSockets, AChildHangsOnItsParentsSpline) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  maker.floats({0, 1}, 1);
  maker.floats({0, 0, 0, 0, 1, 0}, 3);
  const auto text = [&](const std::string& animations) {
    return maker.text(GltfMaker::boxMesh() + R"(,"scenes":[{"nodes":[0]}],"nodes":[
      {"name":"Post","mesh":0,"children":[1]},{"name":"swing","children":[2]},
      {"name":"Lantern","mesh":0,"scale":[0.25,0.25,0.25],"extras":{"kelp":{"kelp":1,"parent_at":0.75}}}])" +
                      animations);
  };
  Report report;
  RawPack pack = baked(scratch, text(""), with([](Settings& s) {
                         s.parts = Parts::kNodes;
                         s.pad = 3;
                       }),
                       report);
  ASSERT_EQ(pack.parts.size(), 2u);
  EXPECT_EQ(pack.parts[0].parent_at, Part::kNotOnSpline);
  EXPECT_EQ(pack.parts[1].parent, 0);
  EXPECT_EQ(pack.parts[1].parent_at, 0.75f);
  EXPECT_EQ(report.parts[1].parent_at, 0.75f);
  EXPECT_EQ(pack.parts[0].size.y, 160) << "padding would move the place on the spline";
  EXPECT_EQ(pack.parts[0].size.x, 16 + 6);

  pack = baked(scratch, text(R"(,"animations":[{"name":"sway","samplers":[{"input":2,"output":3}],"channels":[
      {"sampler":0,"target":{"node":1,"path":"translation"}},{"sampler":0,"target":{"node":2,"path":"translation"}}]}])"),
               with([](Settings& s) { s.parts = Parts::kNodes; }), report = {});
  ASSERT_EQ(pack.parts.size(), 3u);
  EXPECT_EQ(pack.parts[1].parent, 0);
  EXPECT_EQ(pack.parts[1].parent_at, 0.75f);
  EXPECT_EQ(pack.parts[2].parent, 1);
  EXPECT_EQ(pack.parts[2].parent_at, Part::kNotOnSpline);
}

// extras.kelp says it for its node; Settings::bend for all that do not.
TEST(ImportSockets, PartsBendAsTheirNodesSay) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const std::string text = maker.text(GltfMaker::boxMesh() + R"(,"scenes":[{"nodes":[0,1,2]}],"nodes":[
      {"name":"a","mesh":0,"extras":{"kelp":{"kelp":1,"bend":"sweep","roll":90}}},
      {"name":"b","mesh":0,"translation":[3,0,0],"extras":{"kelp":{"kelp":1,"bend":"shear"}}},
      {"name":"c","mesh":0,"translation":[6,0,0],"extras":{"kelp":{"kelp":1}}}])");
  for (const std::optional<Bend> asked : {std::optional<Bend>(), std::optional(Bend::kSweep)}) {
    Report report;
    const RawPack pack = baked(scratch, text, with([&](Settings& s) {
                                 s.parts = Parts::kNodes;
                                 s.bend = asked;
                               }),
                               report);
    ASSERT_EQ(pack.parts.size(), 3u);
    EXPECT_EQ(pack.parts[0].bend, Bend::kSweep);
    EXPECT_FLOAT_EQ(pack.parts[0].roll, 1.57079633f);
    EXPECT_EQ(pack.parts[1].bend, Bend::kShear);
    EXPECT_EQ(pack.parts[2].bend, asked.value_or(kDefaultBend));
    EXPECT_TRUE(report.parts[0].swept);
    EXPECT_FLOAT_EQ(report.parts[0].roll, 1.57079633f);
    EXPECT_EQ(report.parts[2].swept, pack.parts[2].bend == Bend::kSweep);
    EXPECT_EQ(pack.info_json.find("\"bend\":\"sweep\"") != std::string::npos, asked == Bend::kSweep);
  }
}

TEST(ImportSockets, NothingHangsOnAParentThatIsNotThere) {
  const Scratch scratch;
  const std::string text = post(R"([{"name":"Post","mesh":0,"extras":{"kelp":{"kelp":1,"parent_at":0.5}}}])");
  Report report;
  try {
    baked(scratch, text, {}, report);
    ADD_FAILURE() << "accepted";
  } catch (const ToolError& error) {
    EXPECT_EQ(error.exit, Exit::kInvalid);
    EXPECT_TRUE(contains(error.what(), "/parent_at: the part has no parent part")) << error.what();
    EXPECT_TRUE(contains(error.what(), "'Post'")) << error.what();
  }
}

}  // namespace
}  // namespace kelp::bake::test
