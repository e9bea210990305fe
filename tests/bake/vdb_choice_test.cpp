// SPDX-License-Identifier: MIT
// Which grid becomes the part, what it becomes, and what is refused.
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>

#include "import_scratch.h"
#include "support/assets.h"
#include "vdb_peer.h"

namespace kelp::bake::test {
namespace {

VdbSpec ball(const std::string& name, const std::string& type, const std::string& grid_class,
             double background = 0) {
  VdbSpec spec;
  spec.name = name;
  spec.type = type;
  spec.grid_class = grid_class;
  spec.background = glm::dvec3(background);
  spec.low = glm::ivec3(-6);
  spec.high = glm::ivec3(6);
  spec.value = [=](const glm::ivec3& p) -> std::optional<glm::dvec3> {
    const double d = glm::length(glm::dvec3(p)) - 4.2;
    if (background > 0) return d < background ? std::optional(glm::dvec3(d)) : std::nullopt;
    return d < 0 ? std::optional(glm::dvec3(std::ceil(-d))) : std::nullopt;
  };
  return spec;
}

TEST(VdbChoice, SeveralGridsAreListed) {
  const Scratch scratch;
  const auto path = scratch.folder() / "several.vdb";
  VdbSpec heat = ball("temperature", "float", ""), color = ball("Cd", "vec3s", "");
  writeVdb(path, {ball("smoke", "float", "fog volume"), ball("mist", "double", "fog volume"), heat, color});
  const std::string said = refusal(path, Exit::kUsage);
  EXPECT_TRUE(contains(said, "--grid")) << said;
  EXPECT_TRUE(contains(said, "0: 'smoke' (float, fog volume, ")) << said;
  EXPECT_TRUE(contains(said, "1: 'mist' (double, fog volume, ")) << said;
  EXPECT_TRUE(contains(said, " active voxels in 9 x 9 x 9)")) << said;
  EXPECT_FALSE(contains(said, "temperature")) << said;
  EXPECT_FALSE(contains(said, "Cd")) << said;
  writeVdb(path,
           {ball("surface", "float", "level set", 2), ball("density", "double", "fog volume"), heat, color});
  EXPECT_TRUE(importFile(path, with([](Settings& s) { s.grid = "surface"; })).parts[0].grid);
  EXPECT_TRUE(importFile(path, with([](Settings& s) { s.grid = "0"; })).parts[0].grid);
  EXPECT_TRUE(importFile(path, with([](Settings& s) { s.grid = "density"; })).parts[0].fog);
  EXPECT_TRUE(
      contains(refusal(path, Exit::kUsage, with([](Settings& s) { s.grid = "smoke"; })), "'surface'"));
  EXPECT_TRUE(contains(refusal(path, Exit::kUsage, with([](Settings& s) { s.grid = "9"; })), "no such grid"));
  EXPECT_TRUE(
      contains(refusal(path, Exit::kUnsupported, with([](Settings& s) { s.grid = "Cd"; })), "vectors"));
  // A name that is a number counts as a name.
  writeVdb(path, {ball("1", "float", "level set", 2), ball("0", "float", "fog volume")});
  EXPECT_TRUE(importFile(path, with([](Settings& s) { s.grid = "0"; })).parts[0].fog);
  // Grids of one name have a number in brackets.
  writeVdb(path, {ball("a", "float", "level set", 2), ball("a", "float", "fog volume")});
  EXPECT_TRUE(importFile(path, with([](Settings& s) { s.grid = "a[1]"; })).parts[0].fog);
  EXPECT_TRUE(importFile(path, with([](Settings& s) { s.grid = "a"; })).parts[0].grid);
}

TEST(VdbChoice, OfSeveralTheLikelyOneIsTaken) {
  const VdbSpec hull = ball("hull", "float", "level set", 2), body = ball("body", "double", "level set", 2),
                smoke = ball("smoke", "float", "fog volume"), mist = ball("mist", "double", "fog volume"),
                fuel = ball("fuel", "float", ""), mask = ball("inside", "mask", ""),
                density = ball("Density", "float", "");
  struct Case {
    std::vector<VdbSpec> grids;
    std::string taken;  // empty: nothing tells
    std::vector<std::string> others;
    VolumeKind volume = VolumeKind::kAuto;
  };
  const Case cases[] = {
      {{hull, smoke, density, fuel}, "Density", {"hull", "smoke", "fuel"}},
      {{smoke, hull, mist}, "hull", {"smoke", "mist"}},
      {{fuel, hull, mask, smoke}, "hull", {"fuel", "inside", "smoke"}},
      {{hull, body, mist, fuel}, "mist", {"hull", "body", "fuel"}},
      {{fuel, mask, smoke}, "smoke", {"fuel", "inside"}},
      {{smoke, mist}, "", {"smoke", "mist"}},
      {{hull, smoke, body, mist}, "", {"hull", "smoke", "body", "mist"}},
      {{fuel, mask}, "", {"fuel", "inside"}},
      {{density, density, fuel}, "Density", {"Density[1]", "fuel"}},
      // What is no fog is not meant.
      {{hull, mist, body}, "mist", {}, VolumeKind::kFog},
      {{density, hull, body, fuel}, "Density", {"fuel"}, VolumeKind::kFog},
  };
  const Scratch scratch;
  const auto path = scratch.folder() / "several.vdb";
  for (const Case& one : cases) {
    writeVdb(path, one.grids);
    SCOPED_TRACE(one.taken + " of " + std::to_string(one.grids.size()));
    const Settings settings = with([&](Settings& s) { s.volume = one.volume; });
    if (one.taken.empty()) {
      const std::string said = refusal(path, Exit::kUsage, settings);
      for (const std::string& name : one.others) EXPECT_TRUE(contains(said, "'" + name + "'")) << said;
      continue;
    }
    const SourceModel model = importFile(path, settings);
    EXPECT_EQ(model.parts[0].grid.has_value(), one.taken == "hull");
    EXPECT_TRUE(anyContains(model.notices, "baked grid '" + one.taken + "' "));
    for (const std::string& name : one.others) EXPECT_TRUE(anyContains(model.notices, ": '" + name + "' "));
  }
}

// Changes the last grid's type to one of OpenVDB 13. Its own places are behind it.
std::string withHalfGrid(std::string bytes, const std::string& type) {
  const std::string half = "Tree_half_5_4_3";
  const std::size_t at = bytes.rfind(type), less = type.size() - half.size();
  const auto size = static_cast<std::uint32_t>(half.size());
  std::memcpy(bytes.data() + at - sizeof(size), &size, sizeof(size));
  bytes.replace(at, type.size(), half);
  std::int64_t places[3];
  char* const stated = bytes.data() + at + half.size() + 4;
  std::memcpy(places, stated, sizeof(places));
  for (std::int64_t& place : places) place -= static_cast<std::int64_t>(less);
  if (places[2] > 0) std::memcpy(stated, places, sizeof(places));
  bytes[8] = static_cast<char>(225);
  return bytes;
}

TEST(VdbChoice, HalfGridsSayWhatToDo) {
  const Scratch scratch;
  const auto path = scratch.folder() / "a.vdb";
  for (const bool stream : {false, true}) {
    writeVdb(path, {ball("density", "float", "fog volume")}, VdbCodec::kZip, true, stream);
    const std::string said = refusal(
        scratch.write("half.vdb", withHalfGrid(contentOf(path), "Tree_float_5_4_3")), Exit::kUnsupported);
    EXPECT_TRUE(contains(said, "save it as a float grid")) << said;
  }
  // It is meant, though another could be baked.
  writeVdb(path, {ball("temperature", "float", ""), ball("density", "double", "fog volume")});
  const auto both = scratch.write("half.vdb", withHalfGrid(contentOf(path), "Tree_double_5_4_3"));
  EXPECT_TRUE(contains(refusal(both, Exit::kUnsupported), "'density' (half"));
  EXPECT_TRUE(importFile(both, with([](Settings& s) { s.grid = "temperature"; })).parts[0].fog);
}

TEST(VdbChoice, ColorAndHeatDoNotMakeItAmbiguous) {
  const Scratch scratch;
  const auto path = scratch.folder() / "hot.vdb";
  writeVdb(path, {ball("temperature", "float", ""), ball("density", "float", "fog volume"),
                  ball("Cd", "vec3s", ""), ball("v", "vec3s", "staggered")});
  SourceModel model = importFile(path, {});
  ASSERT_TRUE(model.parts[0].fog);
  EXPECT_FALSE(model.parts[0].fog->heat.empty());
  EXPECT_TRUE(anyContains(model.notices, "'Cd' is not used"));
  EXPECT_TRUE(importFile(path, with([](Settings& s) { s.heat_grid = ""; })).parts[0].fog->heat.empty());
  EXPECT_TRUE(
      contains(refusal(path, Exit::kUsage, with([](Settings& s) { s.heat_grid = "Cd"; })), "no numbers"));
  EXPECT_TRUE(
      contains(refusal(path, Exit::kUsage, with([](Settings& s) { s.heat_grid = "fire"; })), "no such grid"));
  EXPECT_TRUE(contains(refusal(path, Exit::kUsage, with([](Settings& s) { s.color_grid = "density"; })),
                       "no colors"));
  EXPECT_TRUE(contains(refusal(path, Exit::kUsage, with([](Settings& s) { s.color_grid = "Cd"; })),
                       "fog has no color"));
  EXPECT_TRUE(contains(
      refusal(path, Exit::kUsage, with([](Settings& s) { s.heat_grid = "temperature", s.isovalue = 1; })),
      "only fog glows"));
  // Heat alone is a density like any other.
  writeVdb(path, {ball("heat", "float", "")});
  EXPECT_TRUE(importFile(path, {}).parts[0].fog->heat.empty());
}

TEST(VdbChoice, WhatANumberMeansIsSaidWhereTheFileDoesNot) {
  const Scratch scratch;
  const auto path = scratch.folder() / "unclassed.vdb";
  for (const char* grid_class : {"", "staggered"}) {
    for (const char* type : {"float", "double", "int32", "int64"}) {
      writeVdb(path, {ball("a", type, grid_class, 2)});
      SourceModel model = importFile(path, {});
      EXPECT_TRUE(model.parts[0].grid) << type;
      EXPECT_TRUE(anyContains(model.notices, "taken for a level set")) << type;
      writeVdb(path, {ball("a", type, grid_class)});
      model = importFile(path, {});
      EXPECT_TRUE(model.parts[0].fog) << type;
      EXPECT_TRUE(anyContains(model.notices, "taken for densities")) << type;
      model = importFile(path, with([](Settings& s) { s.volume = VolumeKind::kSolid; }));
      EXPECT_TRUE(model.parts[0].grid) << type;
      EXPECT_TRUE(anyContains(model.notices, "is solid from 2.5 on, half its greatest value")) << type;
    }
  }
  writeVdb(path, {ball("a", "mask", "")});
  EXPECT_TRUE(importFile(path, {}).notices.empty());
  EXPECT_TRUE(importFile(path, with([](Settings& s) { s.volume = VolumeKind::kFog; })).parts[0].fog);
}

TEST(VdbChoice, SettingsThatDoNotGoTogetherAreRefused) {
  const Scratch scratch;
  const auto path = scratch.folder() / "a.vdb";
  writeVdb(path, {ball("a", "float", "level set", 2)});
  EXPECT_TRUE(contains(refusal(path, Exit::kUsage, with([](Settings& s) { s.volume = VolumeKind::kFog; })),
                       "distances"));
  EXPECT_TRUE(contains(
      refusal(path, Exit::kUsage, with([](Settings& s) { s.volume = VolumeKind::kFog, s.isovalue = 1; })),
      "fog has no surface"));
  EXPECT_TRUE(contains(refusal(path, Exit::kUsage, with([](Settings& s) { s.density = 2; })), "only fog"));
  EXPECT_TRUE(contains(refusal(path, Exit::kUsage, with([](Settings& s) { s.density = 0; })), "above 0"));
  EXPECT_TRUE(
      contains(refusal(path, Exit::kInvalid, with([](Settings& s) { s.isovalue = 2; })), "solid outside"));
  EXPECT_TRUE(contains(refusal(path, Exit::kInvalid, with([](Settings& s) { s.isovalue = -20; })),
                       "nothing is inside"));
  writeVdb(path, {ball("a", "float", "fog volume")});
  EXPECT_TRUE(
      contains(refusal(path, Exit::kInvalid, with([](Settings& s) { s.isovalue = 0; })), "solid outside"));
  VdbSpec endless = ball("a", "float", "fog volume");
  endless.background = glm::dvec3(0.5);
  writeVdb(path, {endless});
  EXPECT_TRUE(contains(refusal(path, Exit::kInvalid), "fog would fill all space"));
  EXPECT_TRUE(importFile(path, with([](Settings& s) { s.isovalue = 0.6; })).parts[0].grid);
  endless.grid_class = "level set";
  endless.background = glm::dvec3(-1);
  writeVdb(path, {endless});
  EXPECT_TRUE(contains(refusal(path, Exit::kInvalid), "inside out"));
  EXPECT_TRUE(contains(refusal(scratch.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), Exit::kUsage,
                               with([](Settings& s) { s.grid = "a"; })),
                       "only .vdb and .nvdb files"));
}

TEST(VdbChoice, WhatCanNotBeBakedIsSaid) {
  const Scratch scratch;
  const auto path = scratch.folder() / "a.vdb";
  VdbSpec empty;
  empty.grid_class = "level set";
  empty.background = glm::dvec3(1);
  writeVdb(path, {empty});
  EXPECT_TRUE(contains(refusal(path, Exit::kUnsupported), "is empty"));
  writeVdb(path, {});
  EXPECT_TRUE(contains(refusal(path, Exit::kUnsupported), "holds no grid"));
  writeVdb(path, {ball("words", "float", ""), ball("v", "vec3s", "")});
  std::string bytes = contentOf(path);
  bytes.replace(bytes.find("Tree_float_5_4_3"), 16, "Tree_strng_5_4_3");
  EXPECT_TRUE(contains(refusal(scratch.write("words.vdb", bytes), Exit::kUnsupported), "'words' (strng"));
  EXPECT_TRUE(contains(refusal(scratch.write("words.vdb", bytes), Exit::kUnsupported,
                               with([](Settings& s) { s.grid = "words"; })),
                       "'words' (strng"));
  // A type that OpenVDB does not know stops nobody from reading the others.
  writeVdb(path, {ball("words", "float", ""), ball("a", "float", "level set", 2), ball("b", "double", "")});
  bytes = contentOf(path);
  bytes.replace(bytes.find("Tree_float_5_4_3"), 16, "Tree_strng_5_4_3");
  bytes.replace(bytes.find("Tree_double_5_4_3"), 17, "Tree_qubits_5_4_3");
  EXPECT_TRUE(importFile(scratch.write("words.vdb", bytes), {}).parts[0].grid);
  EXPECT_TRUE(contains(
      refusal(scratch.write("words.vdb", bytes), Exit::kUnsupported, with([](Settings& s) { s.grid = "b"; })),
      "'b' (qubits"));
  // In a stream what follows it cannot be found.
  writeVdb(path, {ball("words", "float", ""), ball("a", "double", "level set", 2)}, VdbCodec::kBlosc, true,
           true);
  bytes = contentOf(path);
  bytes.replace(bytes.find("Tree_float_5_4_3"), 16, "Tree_strng_5_4_3");
  EXPECT_TRUE(contains(refusal(scratch.write("words.vdb", bytes), Exit::kUnsupported),
                       "has the type strng, and what follows it cannot be found"));
  VdbSpec flat = ball("a", "float", "level set", 2);
  flat.to_world = glm::dmat4(0.5);
  flat.to_world[3][3] = 1;
  writeVdb(path, {flat});
  for (const double scale : {0.0, std::numeric_limits<double>::quiet_NaN()}) {
    bytes = contentOf(path);
    std::memcpy(bytes.data() + bytes.find("UniformScaleMap") + 15, &scale, sizeof(scale));
    EXPECT_TRUE(contains(refusal(scratch.write("flat.vdb", bytes), Exit::kInvalid), "singular"));
  }
  refusal(scratch.write("not.vdb", "v 0 0 0"), Exit::kInvalid);
  KELP_ASSET(smoke, "vdb/openusd_smoke_000001.vdb");
  const std::string said = refusal(smoke, Exit::kUnsupported);
  EXPECT_TRUE(contains(said, "all its grids are empty")) << said;
  EXPECT_TRUE(contains(said, "'obstacles' (int32")) << said;
}

TEST(VdbChoice, GridsThatShareATreeAreReadTwice) {
  const Scratch scratch;
  const auto path = scratch.folder() / "shared.vdb";
  VdbSpec first = ball("a", "float", "fog volume"), second = first;
  second.name = "b";
  second.same_tree_as = 0;
  second.to_world = glm::dmat4(3.0);
  second.to_world[3] = glm::dvec4(0, 0, 0, 1);
  for (const bool stream : {false, true}) {
    writeVdb(path, {first, second}, VdbCodec::kBlosc, true, stream);
    const SourceModel a = importFile(path, with([](Settings&s) { s.grid = "a"; })),
                      b = importFile(path, with([](Settings&s) { s.grid = "b"; }));
    EXPECT_EQ(a.parts[0].fog->density, b.parts[0].fog->density);
    EXPECT_NEAR(b.parts[0].fog->extinction, 3 * a.parts[0].fog->extinction, 1e-5);
  }
}

}  // namespace
}  // namespace kelp::bake::test
