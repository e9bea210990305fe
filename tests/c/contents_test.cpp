// SPDX-License-Identifier: MIT
// The content of a pack, in C and in C++.
#include "both.h"
#include "kelp/runtime/level.h"

namespace kelp::test {
namespace {

TEST(CContents, InfoAndPalette) {
  const BothAssets assets(packFile("distance"));
  auto info = sized<kelp_asset_info>();
  ASSERT_KELP(kelp_asset_get_info(assets.c, &info));
  const Pack& pack = assets.cpp->pack();
  EXPECT_EQ(pack.minorVersion(), info.format_minor);
  EXPECT_EQ(pack.fileSize(), info.file_size);
  EXPECT_EQ(assets.cpp->memory(), info.memory);
  EXPECT_EQ(pack.infoJson(), toString(info.info_json));
  EXPECT_EQ(pack.parts().size(), info.parts);
  EXPECT_EQ(pack.clips().size(), info.clips);
  EXPECT_EQ(pack.sockets().size(), info.sockets);
  EXPECT_EQ(pack.joints().size(), info.joints);
  EXPECT_EQ(1u, info.has_distances);
  EXPECT_EQ(1u, info.loads_distances);
  ASSERT_EQ(2u, info.palette_count);
  for (std::uint32_t i = 0; i < info.palette_count; ++i) {
    const Material& expected = pack.palette()[i];
    expectSame(info.palette[i].base_color, expected.base_color, "base color");
    expectSame(info.palette[i].emissive, expected.emissive, "emissive");
    EXPECT_EQ(expected.metallic, info.palette[i].metallic);
    EXPECT_EQ(expected.roughness, info.palette[i].roughness);
  }
}

void expectPart(const BothAssets& assets, int index) {
  auto part = sized<kelp_part>();
  ASSERT_KELP(kelp_asset_get_part(assets.c, index, &part));
  const Part& expected = assets.cpp->pack().parts()[static_cast<std::size_t>(index)];
  EXPECT_EQ(expected.name, toString(part.name));
  EXPECT_EQ(expected.parent, part.parent);
  EXPECT_EQ(expected.kind, static_cast<PartKind>(part.kind));
  EXPECT_EQ(expected.bend, static_cast<Bend>(part.bend));
  EXPECT_EQ(expected.levels, part.levels);
  EXPECT_EQ(assets.cpp->pack().distanceLevels(index), part.distance_levels);
  expectSame(part.size, expected.size, "size");
  expectSame(part.to_object, glm::mat4(expected.to_object), "to_object");
  expectSame(part.pivot, glm::mat4(expected.pivot), "pivot");
  EXPECT_EQ(expected.parent_at, part.parent_at);
  EXPECT_EQ(expected.roll, part.roll);
  EXPECT_EQ(expected.automatic_tangents, part.automatic_tangents);
  ASSERT_EQ(expected.knots.size(), part.knot_count);
  for (std::size_t k = 0; k < expected.knots.size(); ++k) {
    EXPECT_EQ(expected.knots[k].at, part.knots[k].at);
    expectSame(part.knots[k].position, expected.knots[k].position, "position");
    expectSame(part.knots[k].tangent, expected.knots[k].tangent, "tangent");
  }
  if (!expected.fog) {
    EXPECT_EQ(nullptr, part.fog_extinction);
    return;
  }
  expectSame(part.fog_color, expected.fog->color, "fog");
  EXPECT_EQ(expected.fog->anisotropy, part.fog_anisotropy);
  EXPECT_EQ(expected.fog->glow, part.fog_glow);
  ASSERT_EQ(expected.fog->ramp.size(), part.fog_ramp_count);
  for (std::size_t i = 0; i < expected.fog->ramp.size(); ++i)
    EXPECT_EQ(expected.fog->ramp[i], glm::make_vec3(part.fog_ramp + 3 * i));
  for (std::size_t i = 0; i < expected.fog->extinction.size(); ++i)
    EXPECT_EQ(expected.fog->extinction[i], part.fog_extinction[i]);
}

TEST(CContents, Parts) {
  for (const char* const name : {"distance", "fog", "solid"}) {
    const BothAssets assets(packFile(name), -1);
    for (std::size_t i = 0; i < assets.cpp->pack().parts().size(); ++i)
      expectPart(assets, static_cast<int>(i));
  }
}

TEST(CContents, Clips) {
  const BothAssets assets(packFile("distance"));
  auto clip = sized<kelp_clip>();
  ASSERT_KELP(kelp_asset_get_clip(assets.c, 0, &clip));
  const Clip& expected = assets.cpp->pack().clips()[0];
  EXPECT_EQ(expected.name, toString(clip.name));
  EXPECT_EQ(expected.duration, clip.duration);
  ASSERT_EQ(expected.waves.size(), clip.waves);
  ASSERT_EQ(expected.tracks.size(), clip.tracks);
  for (std::uint32_t i = 0; i < clip.waves; ++i) {
    auto wave = sized<kelp_wave>();
    ASSERT_KELP(kelp_asset_get_wave(assets.c, 0, static_cast<int>(i), &wave));
    const Wave& from = expected.waves[i];
    EXPECT_EQ(from.part, static_cast<std::uint32_t>(wave.part));
    EXPECT_EQ(from.knot, static_cast<std::uint32_t>(wave.knot));
    EXPECT_EQ(from.target, static_cast<Target>(wave.target));
    expectSame(wave.amplitude, from.amplitude, "amplitude");
    EXPECT_EQ(from.period, wave.period);
    EXPECT_EQ(from.phase, wave.phase);
  }
  for (std::uint32_t i = 0; i < clip.tracks; ++i) {
    auto track = sized<kelp_track>();
    ASSERT_KELP(kelp_asset_get_track(assets.c, 0, static_cast<int>(i), &track));
    const Track& from = expected.tracks[i];
    EXPECT_EQ(from.part, static_cast<std::uint32_t>(track.part));
    EXPECT_EQ(from.knot, static_cast<std::uint32_t>(track.knot));
    EXPECT_EQ(from.target, static_cast<Target>(track.target));
    EXPECT_EQ(from.interpolation, static_cast<Interpolation>(track.interpolation));
    ASSERT_EQ(from.keys.size(), track.key_count);
    for (std::size_t k = 0; k < from.keys.size(); ++k) {
      EXPECT_EQ(from.keys[k].time, track.keys[k].time);
      expectSame(track.keys[k].value, from.keys[k].value, "value");
      expectSame(track.keys[k].in, from.keys[k].in, "in");
      expectSame(track.keys[k].out, from.keys[k].out, "out");
    }
  }
}

TEST(CContents, NamesAreFoundAndAnErrorListsThem) {
  const BothAssets assets(packFile("distance"));
  std::int32_t found = -1;
  ASSERT_KELP(kelp_asset_find_clip(assets.c, "sway", &found));
  EXPECT_EQ(0, found);
  ASSERT_KELP(kelp_asset_find_socket(assets.c, "Bl\xc3\xbcte", -1, &found));
  EXPECT_EQ(1, found);
  EXPECT_KELP(KELP_ERROR_MISUSE, kelp_asset_find_socket(assets.c, "tip", 1, &found));
  EXPECT_KELP(KELP_ERROR_MISUSE, kelp_asset_find_clip(assets.c, "dance", &found));
  EXPECT_NE(nullptr, std::strstr(lastError().text, "sway"));
  const std::string part(assets.cpp->pack().parts()[1].name);
  ASSERT_KELP(kelp_asset_find_part(assets.c, part.c_str(), &found));
  EXPECT_EQ(1, found);
  EXPECT_KELP(KELP_ERROR_MISUSE, kelp_asset_find_part(assets.c, "nobody", &found));
  EXPECT_NE(nullptr, std::strstr(lastError().text, part.c_str()));
  ASSERT_KELP(kelp_asset_find_joint(assets.c,
                                    "H\xc3\xbc"
                                    "fte",
                                    &found));
  EXPECT_EQ(1, found);
  EXPECT_KELP(KELP_ERROR_MISUSE, kelp_asset_find_joint(assets.c, "stem", &found));
  EXPECT_NE(nullptr, std::strstr(lastError().text, "root"));
  EXPECT_EQ(1, found) << "an error changes nothing";
}

TEST(CContents, Sockets) {
  const BothAssets assets(packFile("distance"));
  for (std::size_t i = 0; i < assets.cpp->pack().sockets().size(); ++i) {
    auto socket = sized<kelp_socket>();
    ASSERT_KELP(kelp_asset_get_socket(assets.c, static_cast<int>(i), &socket));
    const Socket& expected = assets.cpp->pack().sockets()[i];
    EXPECT_EQ(expected.name, toString(socket.name));
    EXPECT_EQ(expected.part, static_cast<std::uint32_t>(socket.part));
    EXPECT_EQ(expected.at, socket.at);
    expectSame(socket.offset, expected.offset, "offset");
    EXPECT_EQ(expected.rotation,
              glm::quat(socket.rotation[3], socket.rotation[0], socket.rotation[1], socket.rotation[2]));
  }
}

TEST(CContents, Joints) {
  const BothAssets assets(packFile("distance"));
  const std::span<const Joint> joints = assets.cpp->pack().joints();
  ASSERT_EQ(joints.size(), 3u);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    auto joint = sized<kelp_joint>();
    ASSERT_KELP(kelp_asset_get_joint(assets.c, static_cast<int>(i), &joint));
    EXPECT_EQ(joints[i].name, toString(joint.name));
    EXPECT_EQ(joints[i].parent, joint.parent);
    expectSame(joint.inverse_bind, glm::mat4(joints[i].inverse_bind), "inverse_bind");
    ASSERT_EQ(joints[i].parts.size(), joint.part_count);
    for (std::uint32_t k = 0; k < joint.part_count; ++k)
      EXPECT_EQ(joints[i].parts[k], static_cast<std::uint32_t>(joint.parts[k]));
  }
}

TEST(CContents, Levels) {
  const BothAssets assets(packFile("distance"));
  for (int i = 0; i < 2; ++i) {
    auto level = sized<kelp_level>();
    ASSERT_KELP(kelp_asset_get_level(assets.c, 0, i, &level));
    const runtime::Level& expected = *assets.cpp->level(0, i);
    expectSame(level.size, expected.size, "size");
    expectSame(level.grid, expected.grid, "grid");
    EXPECT_EQ(expected.pages.size(), level.pages);
    EXPECT_EQ(0, std::memcmp(level.cells, expected.cells.data(), expected.cells.size_bytes()));
    std::int32_t resident = -9;
    ASSERT_KELP(kelp_asset_resident_level(assets.c, 0, i, &resident));
    EXPECT_EQ(assets.cpp->residentLevel(0, i).value_or(KELP_NONE), resident);
  }
  for (int i = 0; i < 3; ++i) {
    auto level = sized<kelp_distance_level>();
    ASSERT_KELP(kelp_asset_get_distance_level(assets.c, 0, i, &level));
    const runtime::Level& expected = *assets.cpp->distances(0, i);
    expectSame(level.size, expected.size, "size");
    expectSame(level.grid, expected.grid, "grid");
    EXPECT_EQ(expected.band.outside, level.band_outside);
    EXPECT_EQ(expected.band.inside, level.band_inside);
    EXPECT_EQ(0, std::memcmp(level.cells, expected.cells.data(), expected.cells.size_bytes()));
    ASSERT_EQ(expected.first_slots.size(), level.pages);
    EXPECT_EQ(0,
              std::memcmp(level.first_slots, expected.first_slots.data(), expected.first_slots.size_bytes()));
    ASSERT_EQ(expected.codes.size(), level.code_count);
    EXPECT_EQ(0, std::memcmp(level.codes, expected.codes.data(), expected.codes.size()));
  }
  auto level = sized<kelp_level>();
  EXPECT_KELP(KELP_ERROR_MISUSE, kelp_asset_get_level(assets.c, 0, 2, &level));
  EXPECT_KELP(KELP_ERROR_MISUSE, kelp_asset_get_level(assets.c, 2, 0, &level));
}

TEST(CContents, ALevelThatIsNotLoadedIsNotYet) {
  kelp_asset asset = {};
  ASSERT_KELP(kelp_asset_open_file(packFile("distance").c_str(), nullptr, &asset));
  auto level = sized<kelp_level>();
  EXPECT_KELP(KELP_ERROR_NOT_YET, kelp_asset_get_level(asset, 0, 0, &level));
  auto distances = sized<kelp_distance_level>();
  EXPECT_KELP(KELP_ERROR_NOT_YET, kelp_asset_get_distance_level(asset, 0, 0, &distances));
  EXPECT_KELP(KELP_OK, kelp_asset_destroy(asset));
}

}  // namespace
}  // namespace kelp::test
