// SPDX-License-Identifier: MIT
// The editor's rigs of several parts: saved part by part, they are in the pack after the next bake, whatever
// has become of the model.
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>

#include "../bake/vox_truth.h"
#include "../cli/process.h"
#include "kelp/common/error.h"
#include "rig_packs.h"
#include "save_rig.h"

namespace kelp::view {
namespace {

using bake::test::VoxMaker;

const std::vector<std::string> kHero{"body", "head", "arm_l", "arm_r", "leg_l", "leg_r"};

// Posts side by side, of the color `index`.
std::string hero(const std::vector<std::string>& names, int index) {
  VoxMaker maker;
  std::vector<int> children;
  maker.transform(0, 1, {{}});
  for (std::size_t i = 0; i < names.size(); ++i) {
    maker.filled({3, 4, 10 + static_cast<int>(i)}, index);
    children.push_back(2 + 2 * static_cast<int>(i));
  }
  maker.group(1, children);
  for (std::size_t i = 0; i < names.size(); ++i) {
    maker.transform(children[i], children[i] + 1, {{{"_t", std::to_string(20 * i) + " 0 9"}}},
                    {{"_name", names[i]}});
    maker.shape(children[i] + 1, {{static_cast<int>(i), {}}});
  }
  return maker.bytes();
}

std::string refusalOf(const std::string& path, const RigEditor& editor, int part) {
  try {
    saveRig(path, editor, part);
  } catch (const ToolError& error) {
    return error.what();
  }
  return "";
}

class SavedParts : public ::testing::Test {
 protected:
  std::string bake(const std::string& source, const std::vector<std::string>& options) {
    std::vector<std::string> words{KELP_BAKE, source, "-o", scratch_ / "out.kelp", "--progress", "none"};
    words.insert(words.end(), options.begin(), options.end());
    const test::ProcessResult result = test::runProcess(words);
    EXPECT_EQ(result.exit, 0) << result.err;
    return test::readWhole(scratch_ / "out.kelp");
  }
  std::string rigOfPart(const std::string& name) const {
    return test::runProcess({KELP_DUMP, "rig", scratch_ / "out.kelp", "--part", name}).out;
  }

  // Edits one part after the other. Each is saved, the model changes, and it is baked again.
  void editAndBake(const std::string& source, const std::function<std::string(int)>& model,
                   const std::vector<std::string>& options, const std::vector<std::string>& names) {
    const std::string saved = std::filesystem::path(source).replace_extension(".rig.json");
    scratch_.write(std::filesystem::path(source).filename(), model(0));
    const std::string first = bake(source, options);
    const MemorySource memory(std::as_bytes(std::span(first)));
    const auto pack = Pack::open(memory.source());
    ASSERT_TRUE(pack);
    RigEditor editor(*pack);
    ASSERT_EQ(editor.parts(), static_cast<int>(names.size()));
    std::vector<std::string> dumped;
    for (int part = 0; part < editor.parts(); ++part) {
      const auto at = static_cast<std::size_t>(part);
      SCOPED_TRACE(names[at]);
      ASSERT_EQ(editor.name(part), names[at]);
      EXPECT_EQ(editor.axes(part).trouble, "");
      // By mouse, in the part's voxels, and by numbers.
      ASSERT_EQ(editor.pull({part, 1, Handle::Kind::kKnot}, {0.03f, 0.02f, -0.01f * (1 + part)}), "");
      RigDescription rig = editor.rig(part);
      rig.clips.push_back(
          {"wave", 4.0f, {{1, Target::kKnotTangent, {0.01f, 0.02f, 0.03f}, 1.5f + part, 0}}, {}});
      ASSERT_EQ(editor.change(part, rig), "");
      editor.endGesture();
      saveRig(saved, editor, part);
      editor.markSaved(part);
      const std::string again = bake(source, options);
      dumped.push_back(rigOfPart(names[at]));
      EXPECT_EQ(parseRigFile(test::readWhole(saved)).parts.size(), at + 1);
      EXPECT_NE(dumped.back().find("\"wave\""), std::string::npos) << dumped.back();

      // The pack has what was shown, and other unsaved changes stay.
      const MemorySource changed(std::as_bytes(std::span(again)));
      const auto after = Pack::open(changed.source());
      ASSERT_TRUE(after);
      EXPECT_TRUE(editor.isIn(*after));
      EXPECT_TRUE(editor.follow(*after));
      EXPECT_FALSE(editor.unsaved());

      scratch_.write(std::filesystem::path(source).filename(), model(1 + part));
      EXPECT_NE(bake(source, options), again) << "the model has changed";
      for (std::size_t other = 0; other <= at; ++other) EXPECT_EQ(rigOfPart(names[other]), dumped[other]);
    }
    // Rigs that are printed are read back to the same bytes.
    const std::string all = test::runProcess({KELP_DUMP, "rig", scratch_ / "out.kelp"}).out;
    EXPECT_EQ(parseRigFile(all).parts.size(), names.size());
    scratch_.write(std::filesystem::path(saved).filename(), all);
    bake(source, options);
    EXPECT_EQ(test::runProcess({KELP_DUMP, "rig", scratch_ / "out.kelp"}).out, all);
  }

  const test::Scratch scratch_;
};

TEST_F(SavedParts, SixObjectsOfAVoxFile) {
  editAndBake(
      scratch_ / "hero.vox", [](int change) { return hero(kHero, 7 + change); }, {"--parts", "nodes"}, kHero);
}

TEST_F(SavedParts, ObjectsAlongAnotherAxisWithNamesOfAnotherProgram) {
  std::vector<std::string> names{"Left Arm", "wheel", "wheel", "a/\"b\""};
  const auto model = [names](int change) { return hero(names, 90 + change); };
  names[2] = "wheel.2";
  editAndBake(scratch_ / "my car.vox", model, {"--parts", "nodes", "--axis", "-x", "--unit", "0.1"}, names);
}

// A turned node, one that hangs below an empty that turns, and one with a rig along -x.
TEST_F(SavedParts, NodesOfAGltfFile) {
  std::string bytes;
  const auto put = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (int corner = 0; corner < 8; ++corner)
    for (const float at : {corner & 1 ? 0.2f : 0, corner & 2 ? 2.0f : 0, corner & 4 ? 0.3f : 0}) put(at);
  for (const int index : {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                          2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5})
    put(static_cast<std::uint16_t>(index));
  for (const float value : {0.0f, 1.3f, 0.0f, 0.0f, 0.0f, 1.0f, 0.36f, 0.48f, 0.0f, 0.8f}) put(value);
  scratch_.write("machine.bin", bytes);
  const auto model = [](int change) {
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":"base","mesh":0,"scale":[1,)" +
           std::to_string(1 + change) + R"(,1],"children":[1,3]},{"name":"swing","children":[2]},
  {"name":"blade","mesh":0,"rotation":[0,0,0.70710678,0.70710678]},{"name":"tail","mesh":0,"rotation":[0.6,0,0,0.8],"extras":{"kelp":
  {"kelp":1,"axis":"-x","bend":"shear"}}}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
  "animations":[{"name":"turn","samplers":[{"input":2,"output":3}],"channels":[{"sampler":0,"target":{"node":1,"path":"rotation"}}]}],
  "accessors":[{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3","min":[0,0,0],"max":[0.2,2,0.3]},
  {"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"},{"bufferView":2,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[1.3]},
  {"bufferView":3,"componentType":5126,"count":2,"type":"VEC4"}],"bufferViews":[{"buffer":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":72},
  {"buffer":0,"byteOffset":168,"byteLength":8},{"buffer":0,"byteOffset":176,"byteLength":32}],"buffers":[{"byteLength":208,"uri":"machine.bin"}]})";
  };
  editAndBake(scratch_ / "machine.gltf", model, {"--parts", "nodes", "--resolution", "32"},
              {"base", "tail", "blade"});
}

// A side is edited as the part that it is in the pack, and saved in the rig of the part that has it.
TEST_F(SavedParts, SidesAreSavedInTheRigOfTheirPart) {
  const std::string sides =
      R"("axis": "+z", "sides": {"+x-y": {}, "-x+y": {"knots": [{"at": 0}, {"at": 1}]}})";
  for (const bool alone : {false, true}) {
    const std::string source = scratch_ / "wall.vox", saved = scratch_ / "wall.rig.json";
    scratch_.write("wall.vox", hero(alone ? std::vector<std::string>{"wall"} : kHero, 7));
    const std::string name = alone ? "wall" : "head";
    scratch_.write("wall.rig.json", alone ? "{\"kelp\": 1, " + sides + "}"
                                          : "{\"kelp\": 1, \"parts\": {\"head\": {" + sides + "}}}");
    const std::vector<std::string> options =
        alone ? std::vector<std::string>{} : std::vector<std::string>{"--parts", "nodes"};
    const std::string first = bake(source, options);
    const MemorySource memory(std::as_bytes(std::span(first)));
    const auto pack = Pack::open(memory.source());
    ASSERT_TRUE(pack);
    RigEditor editor(*pack);
    const auto partNamed = [&](const std::string& wanted) {
      for (int part = 0; part < editor.parts(); ++part)
        if (editor.name(part) == wanted) return part;
      ADD_FAILURE() << wanted;
      return 0;
    };
    const int body = partNamed(name), side = partNamed(name + " -x+y"), own = partNamed(name + " own");
    ASSERT_EQ(editor.pull({side, 1, Handle::Kind::kKnot}, {0.1f, 0.05f, 0}), "");
    editor.endGesture();
    EXPECT_NE(editor.pull({own, 1, Handle::Kind::kKnot}, {0.1f, 0, 0}).find("'" + name + "'"),
              std::string::npos);
    ASSERT_EQ(editor.pull({body, 1, Handle::Kind::kKnot}, {0, 0.1f, 0.07f}), "");
    editor.endGesture();
    EXPECT_EQ(editor.rig(own).knots, editor.rig(body).knots) << "what is shown is what is baked";
    saveRig(saved, editor, side);
    EXPECT_TRUE(editor.unsaved());
    editor.markSaved(side);
    EXPECT_FALSE(editor.unsaved());
    const RigFile file = parseRigFile(test::readWhole(saved));
    EXPECT_EQ(file.parts.size(), alone ? 0u : 1u);
    EXPECT_EQ((alone ? file.whole : file.parts.at(0).rig).sides.size(), 2u);

    const std::string again = bake(source, options);
    EXPECT_NE(again, first);
    const MemorySource changed(std::as_bytes(std::span(again)));
    const auto after = Pack::open(changed.source());
    ASSERT_TRUE(after);
    EXPECT_TRUE(editor.isIn(*after));
    EXPECT_TRUE(editor.follow(*after));
    EXPECT_FALSE(editor.unsaved());
  }
}

TEST(SaveRig, OfOnePartTheFileIsTheRigItself) {
  const test::Scratch scratch;
  const std::string path = scratch / "reed.rig.json";
  const OpenPack open(packWith(parseRig(R"({"kelp": 1, "axis": "+y"})")));
  const RigEditor editor(*open.pack);
  for (const char* before : {"", "{\"kelp\": 1", R"({"kelp": 1, "bend": "sweep"})"}) {
    if (*before) scratch.write("reed.rig.json", before);
    EXPECT_EQ(refusalOf(path, editor, 0), "");
    EXPECT_EQ(test::readWhole(path), printRig(editor.rig(0)));
  }
  const std::string parts = R"({"kelp": 1, "parts": {"a": {}}})";
  scratch.write("reed.rig.json", parts);
  EXPECT_NE(refusalOf(path, editor, 0).find("rigs of parts"), std::string::npos);
  EXPECT_EQ(test::readWhole(path), parts) << "nothing is lost";
}

TEST(SaveRig, NothingThatAFileHoldsIsLost) {
  const test::Scratch scratch;
  const std::string path = scratch / "hero.rig.json";
  RawPack raw = packWith(parseRig(R"({"kelp": 1, "axis": "+y"})"));
  raw.parts.push_back(raw.parts[0]);
  raw.parts[0].name = "arm";
  raw.parts[1].name = "leg";
  const OpenPack open(raw);
  const RigEditor editor(*open.pack);
  const auto saved = [&] { return parseRigFile(test::readWhole(path)); };
  EXPECT_EQ(refusalOf(path, editor, 1), "");
  EXPECT_EQ(saved().parts, (std::vector<RigFile::PartRig>{{"leg", editor.rig(1)}}));

  scratch.write("hero.rig.json", R"({"kelp": 1, "parts": {"old": {"roll": 3, "bend": "sweep"}, "arm": {}}})");
  EXPECT_EQ(refusalOf(path, editor, 0), "");
  const RigFile file = saved();
  ASSERT_EQ(file.parts.size(), 2u);
  EXPECT_EQ(file.parts[0].rig.roll, rollOfDegrees(3)) << "of a part that is not in this pack";
  EXPECT_EQ(file.parts[1].rig, editor.rig(0));

  for (const char* before : {R"({"kelp": 1, "bend": "sweep"})", "{\"kelp\": 1, \"parts\": {", "[]"}) {
    scratch.write("hero.rig.json", before);
    EXPECT_TRUE(refusalOf(path, editor, 0).starts_with(path + ": ")) << before;
    EXPECT_EQ(test::readWhole(path), before);
  }
  EXPECT_NE(refusalOf("/dev/full", editor, 0), "");
  EXPECT_NE(refusalOf(scratch.folder(), editor, 0), "");
  raw.parts[1].name = "arm";
  const OpenPack twice(raw);
  EXPECT_NE(refusalOf(scratch / "new.json", RigEditor(*twice.pack), 0).find("two parts have the name 'arm'"),
            std::string::npos);
}

}  // namespace
}  // namespace kelp::view
