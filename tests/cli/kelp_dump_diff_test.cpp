// SPDX-License-Identifier: MIT
// kelp-dump diff: what it counts against what the test has changed, voxel by voxel; what it must not see;
// what it refuses.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "../formats/pack_surgeon.h"
#include "extract_packs.h"
#include "support/fog_pack.h"
#include "support/json_schema.h"

namespace kelp {
namespace {

using nlohmann::json;
using test::KnownPart;
using test::ProcessResult;

constexpr int kColors = 5;

RawPack ballPack() {
  RawPack pack;
  pack.info_json = R"({"tool": "kelp-bake 0.1.0", "options": {"resolution": 64, "pad": 1}})";
  pack.palette = test::paletteOf(kColors);
  pack.parts = {test::rawPart(test::ball(test::scaled(0.01f), kColors), "ball"),
                test::rawPart(test::ball(test::scaled(0.02f, {1, 2, 3}), kColors, {45, 56, 40}), "twin")};
  pack.parts[1].parent = 0;
  RawTrack turn;
  turn.part = 1;
  turn.target = Target::kPartRotation;
  turn.keys = {{0, {0, 0, 0, 1}, glm::vec4(0), glm::vec4(0)},
               {1.5f, {0, 0.6f, 0, 0.8f}, glm::vec4(0), glm::vec4(0)}};
  pack.clips = {
      {"sway",
       3,
       {{0, 1, Target::kKnotOffset, {1, 0, 2}, 3, 0}, {0, 1, Target::kKnotTangent, {0, 0, 4}, 1.5f, 0.25f}},
       {}},
      {"turn", 1.5f, {}, {turn}}};
  return pack;
}

class Diff : public testing::Test {
 protected:
  std::string file(const std::string& name, const RawPack& pack) const {
    return folder_.write(name, std::span<const std::byte>(test::writeToMemory(pack)));
  }
  // As JSON, checked against the schema and against what the text says.
  json diff(const std::string& a, const std::string& b, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"diff", a, b};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProcessResult text = test::dump(arguments);
    arguments.insert(arguments.end(), {"--format", "json"});
    const ProcessResult result = test::dump(arguments);
    EXPECT_EQ(result.err + text.err, "");
    const json report = json::parse(result.out, nullptr, false);
    EXPECT_EQ(schema_.check(report), "") << result.out;
    const json& differences = report.at("differences");
    const bool same = std::all_of(differences.begin(), differences.end(),
                                  [](const json& d) { return d.at("kind") == "info"; });
    EXPECT_EQ(report.at("same"), same);
    EXPECT_EQ(result.exit, same ? 0 : 7);
    EXPECT_EQ(text.exit, result.exit);
    EXPECT_LT(std::count(text.out.begin(), text.out.end(), '\n'), 60);
    for (const json& d : differences)
      if (differences.size() < 30) {
        EXPECT_NE(text.out.find(d.at("text")), std::string::npos) << d << "\n" << text.out;
      }
    return differences;
  }
  json diff(const RawPack& a, const RawPack& b, const std::vector<std::string>& more = {}) {
    return diff(file("a.kelp", a), file("b.kelp", b), more);
  }
  // The only difference.
  json only(const RawPack& b, const std::string& kind, const std::vector<std::string>& more = {}) {
    const json found = diff(ballPack(), b, more);
    EXPECT_EQ(found.size(), 1u) << found.dump(1);
    if (found.empty()) return json::object();
    EXPECT_EQ(found[0].at("kind"), kind) << found.dump(1);
    return found[0];
  }
  bool same(const RawPack& b, const std::vector<std::string>& more = {}) {
    const json found = diff(ballPack(), b, more);
    return found.empty() ? true : (ADD_FAILURE() << found.dump(1), false);
  }

  test::Scratch folder_;
  test::JsonSchema schema_{std::string(KELP_SOURCE_DIR) + "/tools/kelp-dump/kelp-dump.schema.json"};
};

TEST_F(Diff, APackIsTheSameAsItselfHoweverItIsStored) {
  const RawPack pack = ballPack();
  EXPECT_TRUE(same(pack));
  // Other frames: level 3 where the writer takes another, unknown chunks, metadata that is not compressed.
  test::PackSurgeon surgeon(test::writeToMemory(pack));
  for (auto& chunk : surgeon.chunks) {
    if (chunk.fourcc == test::PackSurgeon::fourcc("PART") ||
        chunk.fourcc == test::PackSurgeon::fourcc("GRID"))
      chunk.flags ^= 2;
  }
  test::PackSurgeon::Chunk note;
  note.fourcc = test::PackSurgeon::fourcc("NOTE");
  note.content = test::Bytes(3, std::byte{1});
  surgeon.chunks.push_back(note);
  const test::Bytes bytes = surgeon.build();
  const std::string a = file("a.kelp", pack),
                    other = folder_.write("other.kelp", std::span<const std::byte>(bytes));
  ASSERT_NE(test::readWhole(a), test::readWhole(other));
  EXPECT_EQ(diff(a, other), json::array());
}

TEST_F(Diff, OrderIsNoDifference) {
  RawPack pack = ballPack();
  std::swap(pack.parts[0], pack.parts[1]);
  pack.parts[0].parent = -1;  // no part follows a later one
  RawPack straight = ballPack();
  straight.parts[1].parent = -1;
  std::swap(pack.clips[0], pack.clips[1]);
  std::swap(pack.clips[1].waves[0], pack.clips[1].waves[1]);
  for (RawClip& clip : pack.clips) {
    for (Wave& wave : clip.waves) wave.part ^= 1;
    for (RawTrack& track : clip.tracks) track.part ^= 1;
  }
  std::swap(pack.palette[0], pack.palette[3]);
  for (RawPart& part : pack.parts)
    for (RawLevel& level : part.levels)
      for (std::uint32_t& attribute : level.attributes) {
        const std::uint8_t entry = attributePalette(attribute);
        attribute = makeAttribute(entry == 0 ? 3 : entry == 3 ? 0 : entry, attributeNormal(attribute));
      }
  EXPECT_EQ(diff(straight, pack), json::array());
}

TEST_F(Diff, VoxelsAreCounted) {
  // One ball has a hole, a dent in its colors and a turned normal that the other has not.
  KnownPart known = test::ball(test::scaled(0.01f), kColors);
  RawPack a = ballPack(), b = ballPack();
  a.parts[0].levels.resize(1);
  std::uint64_t gone = 0, colored = 0, turned = 0;
  known.eachVoxel(0, [&](const glm::ivec3& v) {
    const std::size_t i = known.occupancy.index(v);
    std::int64_t& attribute = known.attribute[i];
    if (attribute < 0) return;
    if (v.x == 17 && v.z == 30 && v.y > 50) {
      known.occupancy.solid[i] = 0;
      attribute = -1;
      ++gone;
    } else if (v.y == 20) {
      attribute = makeAttribute(
          static_cast<std::uint8_t>((attributePalette(static_cast<std::uint32_t>(attribute)) + 1) % kColors),
          attributeNormal(static_cast<std::uint32_t>(attribute)));
      ++colored;
    } else if (v.y == 10) {
      const glm::vec3 n = decodeNormal(attributeNormal(static_cast<std::uint32_t>(attribute)));
      attribute = makeAttribute(attributePalette(static_cast<std::uint32_t>(attribute)),
                                encodeNormal({n.z, n.y, -n.x}));
      ++turned;
    }
  });
  ASSERT_GT(gone, 5u);
  ASSERT_GT(colored, 50u);
  ASSERT_GT(turned, 50u);
  const RawPart changed = test::rawPart(known, "ball");
  b.parts[0].levels = {changed.levels[0]};
  const json found = diff(a, b);
  ASSERT_EQ(found.size(), 3u) << found.dump(1);
  EXPECT_EQ(found[0]["kind"], "occupancy");
  EXPECT_EQ(found[0]["only_a"], gone);
  EXPECT_EQ(found[0]["only_b"], 0);
  EXPECT_EQ(found[0]["first"], json({17, 51, 30}));
  EXPECT_EQ(found[0]["name"], "ball");
  EXPECT_EQ(found[0]["level"], 0);
  EXPECT_EQ(found[1]["kind"], "colour");
  EXPECT_EQ(found[1]["count"], colored);
  EXPECT_EQ(found[1]["first"][1], 20);
  EXPECT_EQ(found[2]["kind"], "normal");
  EXPECT_GT(found[2]["count"], turned / 2);  // at the poles a quarter turn is none
  EXPECT_LE(found[2]["count"], turned);
  EXPECT_GT(found[2]["largest"], 45.0);
  // The other way round.
  const json back = diff(b, a);
  EXPECT_EQ(back[0]["only_b"], gone);
  EXPECT_EQ(back[1]["count"], colored);
}

TEST_F(Diff, AttributesThatOneLacks) {
  KnownPart known = test::ball(test::scaled(0.01f), kColors);
  RawPack b = ballPack();
  const auto attributeAt = [&](const glm::ivec3& v) -> std::int64_t& {
    return known.attribute[known.occupancy.index(v)];
  };
  std::optional<glm::ivec3>
      where;  // an inner voxel beside a surface voxel, so that the coarser one is surface
  known.eachVoxel(0, [&](const glm::ivec3& v) {
    if (!where && v.x % 2 == 0 && known.occupancy.solid[known.occupancy.index(v)] && attributeAt(v) < 0 &&
        attributeAt(v + glm::ivec3(1, 0, 0)) >= 0)
      where = v;
  });
  ASSERT_TRUE(where);
  attributeAt(*where) = makeAttribute(1, 0);
  b.parts[0].levels[0] = test::rawPart(known, "ball").levels[0];
  const json one = only(b, "surface");
  EXPECT_EQ(one["only_a"], 0);
  EXPECT_EQ(one["only_b"], 1);
  EXPECT_EQ(one["first"], json({where->x, where->y, where->z}));
}

// A block with a hole in its middle, as large as a brick that is inside.
TEST_F(Diff, BricksThatAreInside) {
  const auto blockPack = [](bool hollow) {
    fields::Occupancy block{glm::ivec3(40), std::vector<std::uint8_t>(40 * 40 * 40, 1)};
    for (int i = 0; hollow && i < 512; ++i)
      block.solid[block.index(glm::ivec3(16 + i % 8, 16 + i / 8 % 8, 16 + i / 64))] = 0;
    RawPack pack = test::packOf(block);
    pack.parts[0].levels.resize(1);
    return pack;
  };
  const json found = diff(blockPack(false), blockPack(true));
  ASSERT_GE(found.size(), 2u) << found.dump(1);
  EXPECT_EQ(found[0]["kind"], "occupancy");
  EXPECT_EQ(found[0]["only_a"], 512);
  EXPECT_EQ(found[0]["only_b"], 0);
  EXPECT_EQ(found[0]["first"], json({16, 16, 16}));
  EXPECT_EQ(found[1]["kind"], "surface");
  EXPECT_EQ(found[1]["only_b"], 10 * 10 * 10 - 8 * 8 * 8);
}

TEST_F(Diff, WhatPartsAndClipsSay) {
  RawPack b = ballPack();
  b.info_json = R"({"tool": "kelp-bake 0.1.0", "options": {"resolution": 65, "pad": 1}})";
  json one = only(b, "info");
  EXPECT_EQ(one["name"], "/options/resolution");
  EXPECT_EQ(one["a"], "64");
  EXPECT_EQ(one["b"], "65");
  b.info_json = R"({"tool": "kelp-bake 0.1.0", "options": {"resolution": 64}})";
  one = only(b, "info");
  EXPECT_EQ(one["only_in"], "a");
  EXPECT_EQ(one["name"], "/options/pad");
  b.info_json.clear();
  only(b, "info");
  b.info_json = "not JSON";
  only(b, "info");

  b = ballPack();
  b.palette.push_back({{0.5f, 0.5f, 0.5f, 1}, {0, 0, 0}, 0, 1});
  one = only(b, "palette");
  EXPECT_EQ(one["only_in"], "b");
  EXPECT_EQ(one["count"], 1);
  b = ballPack();
  b.parts[1].name = "other";
  json found = diff(ballPack(), b);
  ASSERT_EQ(found.size(), 3u) << found.dump(1);  // and the clip that turned it turns another part
  EXPECT_EQ(found[0]["kind"], "part");
  EXPECT_EQ(found[0]["only_in"], "a");
  EXPECT_EQ(found[1]["name"], "other");
  EXPECT_EQ(found[2]["kind"], "motion");
  b = ballPack();
  b.parts[1].parent = -1;
  EXPECT_EQ(only(b, "parent")["a"], "'ball'");
  b = ballPack();
  b.parts[0].knots[0].tangent.x += 0.5f / 62;
  EXPECT_NEAR(only(b, "rig")["largest"].get<double>(), 0.5 / 62, 1e-6);
  b.parts[0].knots = {{0, {0, 0, 0}, {0, 1, 0}}, {0.5f, {0, 0.5f, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}};
  only(b, "rig");
  b = ballPack();
  b.parts[0].to_object[3].x += 0.062f;
  EXPECT_NEAR(only(b, "place")["largest"].get<double>(), 0.1, 1e-4);
  b = ballPack();
  b.parts[1].pivot[3].y = 1;
  only(b, "pivot");
  b = ballPack();
  b.parts[0].levels.pop_back();
  EXPECT_EQ(only(b, "levels")["b"], "1");
  b = ballPack();
  b.parts[0] = test::rawPart(test::ball(test::scaled(0.01f), kColors, {45, 62, 40}), "ball");
  found = diff(ballPack(), b);
  EXPECT_EQ(found[0]["kind"], "size");
  // voxels of other sizes are not compared
  for (const json& d : found) EXPECT_FALSE(d.contains("level")) << d;
  b = ballPack();
  b.clips[0].waves[1].phase = 0.5f;
  EXPECT_EQ(only(b, "motion")["name"], "sway");
  b = ballPack();
  b.clips[1].tracks[0].keys[1].time = 1.25f;
  EXPECT_EQ(only(b, "motion")["name"], "turn");
  b = ballPack();
  b.clips[1].tracks[0].keys[1].value = -b.clips[1].tracks[0].keys[1].value;  // the same rotation
  EXPECT_TRUE(same(b));
  b.clips[1].duration = 2;
  only(b, "motion");
  b.clips.pop_back();
  one = only(b, "clip");
  EXPECT_EQ(one["only_in"], "a");
  EXPECT_EQ(one["name"], "turn");
}

TEST_F(Diff, SocketsAndWherePartsHang) {
  RawPack before = ballPack();
  before.parts[1].parent_at = 0.5f;
  before.sockets = {{"tip", 0, 1, {0, 0}, {1, 0, 0, 0}}, {"tip", 1, 1, {0, 0}, {1, 0, 0, 0}}};
  const std::string a = file("a.kelp", before);
  RawPack other = before;
  std::swap(other.sockets[0], other.sockets[1]);
  other.sockets[0].rotation = {-1, 0, 0, 0};  // the same rotation
  EXPECT_TRUE(diff(a, file("order.kelp", other)).empty());

  RawPack after = before;
  after.parts[1].parent_at = 0.75f;
  after.sockets[0].name = "top";
  after.sockets[1].offset = {0, 0.25f};
  const json differences = diff(a, file("b.kelp", after));
  ASSERT_EQ(differences.size(), 4u) << differences;
  EXPECT_EQ(differences[0].at("kind"), "rig");
  EXPECT_EQ(differences[0].at("name"), "twin");
  EXPECT_EQ(differences[1].at("kind"), "socket");
  EXPECT_EQ(differences[1].at("only_in"), "a");
  EXPECT_EQ(differences[1].at("name"), "tip");
  EXPECT_EQ(differences[2].at("largest"), 0.25);
  EXPECT_EQ(differences[3].at("only_in"), "b");
  EXPECT_EQ(differences[3].at("name"), "top");
  EXPECT_TRUE(diff(a, file("c.kelp", after), {"--tolerance", "0.3"}).size() == 2u);

  const json info = json::parse(test::dump({"info", a, "--format", "json"}).out);
  EXPECT_EQ(info.at("parts")[0].at("parent_at"), nullptr);
  EXPECT_EQ(info.at("parts")[1].at("parent_at"), 0.5);
  ASSERT_EQ(info.at("sockets").size(), 2u);
  EXPECT_EQ(
      info.at("sockets")[1],
      json::parse(
          R"({"name": "tip", "part": 1, "at": 1.0, "offset": [0.0, 0.0], "rotation": [0.0, 0.0, 0.0, 1.0]})"));
}

TEST_F(Diff, HowPartsBend) {
  RawPack before = ballPack();
  before.parts[1].bend = Bend::kSweep;
  const std::string a = file("a.kelp", before);
  RawPack after = before;
  after.parts[0].bend = Bend::kSweep;
  after.parts[1].roll = 0.785398163f;
  const json differences = diff(a, file("b.kelp", after));
  ASSERT_EQ(differences.size(), 2u) << differences;
  for (const json& difference : differences) EXPECT_EQ(difference.at("kind"), "rig");
  EXPECT_EQ(differences[0].at("a"), "shear");
  EXPECT_EQ(differences[0].at("b"), "sweep");
  EXPECT_EQ(differences[1].at("name"), "twin");
  EXPECT_NEAR(differences[1].at("largest").get<double>(), 0.25, 1e-6);
  EXPECT_NE(differences[1].dump().find("rolls of 0 and 45 degrees"), std::string::npos);
  EXPECT_EQ(diff(a, file("b.kelp", after), {"--tolerance", "0.3"}).size(), 1u);

  const json info = json::parse(test::dump({"info", file("b.kelp", after), "--format", "json"}).out);
  EXPECT_EQ(info.at("parts")[0].at("bend"), "sweep");
  EXPECT_EQ(info.at("parts")[0].at("roll"), 0);
  EXPECT_NEAR(info.at("parts")[1].at("roll").get<double>(), 45, 1e-5);
  EXPECT_EQ(json::parse(test::dump({"info", file("c.kelp", ballPack()), "--format", "json"}).out)
                .at("parts")[0]
                .at("bend"),
            "shear");
  const std::string text = test::dump({"info", file("b.kelp", after)}).out;
  EXPECT_NE(text.find("; swept\n"), std::string::npos) << text;
  EXPECT_NE(text.find("; swept, turned by 45 degrees"), std::string::npos) << text;
}

TEST_F(Diff, ToleranceIsAShareOfTheRange) {
  const auto within = [&](const RawPack& b, const std::string& kind, const char* too_little,
                          const char* enough) {
    EXPECT_EQ(only(b, kind, {"--tolerance", too_little}).value("kind", ""), kind);
    EXPECT_TRUE(same(b, {"--tolerance", enough})) << kind;
  };
  RawPack b = ballPack();
  b.parts[0].knots[0].tangent.x += 0.01f;
  within(b, "rig", "0.009", "0.011");
  b = ballPack();
  b.parts[0].to_object[3].x += 0.0062f;  // of 0.62 m
  within(b, "place", "0.009", "0.011");
  b = ballPack();
  b.clips[0].waves[0].amplitude.x += 0.01f;
  within(b, "motion", "0.009", "0.011");
  b = ballPack();
  for (std::uint32_t& attribute : b.parts[0].levels[0].attributes) {  // some 3 degrees of 180
    const glm::vec3 n = decodeNormal(attributeNormal(attribute));
    const glm::vec3 aside =
        glm::normalize(glm::cross(n, std::abs(n.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0)));
    attribute = makeAttribute(attributePalette(attribute),
                              encodeNormal(glm::normalize(n + aside * std::tan(glm::radians(3.0f)))));
  }
  within(b, "normal", "0.016", "0.0172");
  EXPECT_NEAR(only(b, "normal")["largest"].get<double>(), 3, 0.1);
  EXPECT_EQ(only(b, "normal")["count"], b.parts[0].levels[0].attributes.size());

  b = ballPack();
  b.palette[2].base_color.g += 0.01f;
  json found = diff(ballPack(), b, {"--tolerance", "0.009"});
  EXPECT_EQ(found[0]["kind"], "palette");
  std::set<std::string> kinds;
  for (const json& d : found) kinds.insert(d["kind"]);
  EXPECT_EQ(kinds, (std::set<std::string>{"palette", "colour"}));
  EXPECT_TRUE(same(b, {"--tolerance", "0.011"}));
}

TEST_F(Diff, FogIsComparedSampleBySample) {
  const glm::ivec3 size(33, 40, 25);
  fields::FogSamples fog = test::fogOf(size, test::puffs, [](const glm::dvec3& p) { return 1 - p.y; });
  const RawPack a = test::fogPack(fog, 0.5f);
  EXPECT_EQ(diff(a, a), json::array());
  // Level 0 alone: a sample in a brick's corner, which eight bricks hold, one at the end of the level, and
  // one in the midst of a brick.
  std::uint64_t changed = 0;
  for (const glm::ivec3 at : {glm::ivec3(16, 16, 8), glm::ivec3(20, 39, 12), glm::ivec3(12, 10, 11)}) {
    std::uint8_t& code = fog.density[static_cast<std::size_t>(at.x + size.x * (at.y + size.y * at.z))];
    code = static_cast<std::uint8_t>(code > 128 ? code - 100 : code + 100);
    ++changed;
  }
  RawPack b = a;
  const float extinction = b.parts[0].levels[0].extinction;
  b.parts[0].levels[0] = fields::buildFogLevel(fog, 1);
  b.parts[0].levels[0].extinction = extinction;
  json found = diff(a, b);
  ASSERT_EQ(found.size(), 1u) << found.dump(1);
  EXPECT_EQ(found[0]["kind"], "density");
  EXPECT_EQ(found[0]["count"], changed);
  EXPECT_EQ(found[0]["level"], 0);
  EXPECT_EQ(diff(a, b, {"--tolerance", "1"}), json::array());
  b = a;
  b.parts[0].levels[1].extinction *= 1.01f;
  b.parts[0].fog->anisotropy = 0.5f;
  found = diff(a, b);
  ASSERT_EQ(found.size(), 2u) << found.dump(1);
  EXPECT_EQ(found[0]["kind"], "look");
  EXPECT_EQ(found[1]["kind"], "extinction");
  EXPECT_EQ(diff(a, b, {"--tolerance", "0.6"}), json::array());
  found = diff(a, test::fogPack(test::fogOf(size, test::puffs), 0.5f));  // without heat

  ASSERT_EQ(found.size(), 1u) << found.dump(1);
  EXPECT_EQ(found[0]["kind"], "look");
}

TEST_F(Diff, RandomPacksDifferFromEachOtherOnly) {
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const RawPack pack = test::makeRandomPack(seed);
    EXPECT_EQ(diff(pack, pack), json::array()) << seed;
    EXPECT_FALSE(diff(pack, test::makeRandomPack(seed + 100)).empty()) << seed;
  }
}

TEST_F(Diff, ManyDifferencesFitAScreen) {
  RawPack a = ballPack(), b = ballPack();
  a.parts.resize(1);
  a.clips.clear();
  b = a;
  for (int i = 0; i < 200; ++i) {
    a.parts.push_back(a.parts[0]);
    a.parts.back().name = "a" + std::to_string(i);
  }
  const ProcessResult text = test::dump({"diff", file("a.kelp", a), file("b.kelp", b)});
  EXPECT_EQ(text.exit, 7);
  EXPECT_LT(std::count(text.out.begin(), text.out.end(), '\n'), 50);
  EXPECT_NE(text.out.find("... and 160 more (--format json lists all)"), std::string::npos) << text.out;
  EXPECT_EQ(diff(a, b).size(), 200u);
}

TEST_F(Diff, Refusals) {
  const std::string a = file("a.kelp", ballPack());
  const auto check = [&](const std::vector<std::string>& arguments, int exit, const std::string& says) {
    std::vector<std::string> all{"diff"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const ProcessResult result = test::dump(all);
    EXPECT_EQ(result.exit, exit) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  };
  check({a, a, "--tolerance", "-0.1"}, 1, "0 to 1");
  check({a, a, "--tolerance", "nan"}, 1, "0 to 1");
  check({a, a, "--tolerance", "some"}, 1, "--help");
  // A page that is damaged in one of them: no answer, not "different".
  std::string bytes = test::readWhole(a);
  bytes[bytes.size() - 70] ^= 1;
  check({a, folder_.write("hurt.kelp", bytes)}, 3, "hurt.kelp: part 1 'twin', level 0: byte");
}

}  // namespace
}  // namespace kelp
