// SPDX-License-Identifier: MIT
// Files made to do harm: whatever they hold, importing ends in a model or in one line, and soon.
#include <algorithm>
#include <random>

#include "import_scratch.h"
#include "support/assets.h"

namespace kelp::bake::test {
namespace {

// True when a model with something in it came out. Anything but a ToolError of one line fails the test.
bool survive(const std::filesystem::path& path) {
  try {
    return !importFile(path, {}).parts.empty();
  } catch (const ToolError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << path;
    EXPECT_LT(std::string(error.what()).size(), 6000u) << path;
    EXPECT_TRUE(contains(error.what(), "; ")) << "names no remedy: " << error.what();
    for (const char* raw : {"json.exception", "basic_ios", "std::"})
      EXPECT_FALSE(contains(error.what(), raw)) << error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << path << " threw something else: " << error.what();
  }
  return false;
}

TEST(ImportHostile, KnownBadFiles) {
  KELP_ASSET(folder, "hostile");
  int files = 0;
  std::vector<std::string> accepted;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".gltf" && extension != ".glb" && extension != ".obj" && extension != ".ply" &&
        extension != ".off" && extension != ".stl")
      continue;
    ++files;
    if (survive(entry.path())) accepted.push_back(entry.path().filename().string());
  }
  EXPECT_GT(files, 80);
  // The reports of these files: tests/cli/kelp_bake_hostile_test.py.
  // Accepted are sound geometry beside values of a wrong type that it does not need, and an OBJ with one bad
  // line.
  for (const std::string& name : accepted)
    EXPECT_TRUE(name.rfind("bad", 0) == 0 || name == "malformed2.obj") << name;
}

// Quadratic or worse work would not end within the time of a test.
TEST(ImportHostile, PolygonsThatCrossThemselvesAreCutWhateverTheirSize) {
  const Scratch scratch;
  constexpr int kAll = 30000;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(0, 1);
  for (const int corners : {16, 63, 3000}) {
    std::string points, faces;
    for (int i = 0; i < kAll; ++i) {
      points += std::to_string(place(random)) + " " + std::to_string(place(random)) + " 0\n";
      faces += (i % corners == 0 ? "\n" + std::to_string(std::min(corners, kAll - i)) : "") + " " +
               std::to_string(i);
    }
    const std::string text = "OFF " + std::to_string(kAll) + " " +
                             std::to_string((kAll + corners - 1) / corners) + " 0\n" + points + faces + "\n";
    EXPECT_FALSE(importFile(scratch.write("a.off", text), {}).parts.at(0).soup.triangles.empty());
  }
  // Nine tenths of the corners lie on the rim of every ear.
  std::string text = "OFF 4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n40000";
  for (int i = 0; i < 40000; ++i) text += " " + std::to_string(i % 4);
  EXPECT_FALSE(importFile(scratch.write("a.off", text + "\n"), {}).parts.at(0).soup.triangles.empty());
}

TEST(ImportHostile, MessagesSayWhereAndWhatToDo) {
  const Scratch scratch;
  const std::string truncated =
      refusal(scratch.write("cut.gltf", "{\"asset\":{\"version\":\"2.0\"},\n\"nodes\":["), Exit::kInvalid);
  EXPECT_TRUE(contains(truncated, "JSON: ends in the middle; it is truncated")) << truncated;
  const std::string wrong = refusal(
      scratch.write("wrong.gltf", "{\"asset\":{\"version\":\"2.0\"},\n \"nodes\":[}]}"), Exit::kInvalid);
  EXPECT_TRUE(contains(wrong, "JSON, line 2, column 11: is not valid JSON; ")) << wrong;
  const std::string first = refusal(scratch.write("first.gltf", "{x}"), Exit::kInvalid);
  EXPECT_TRUE(contains(first, "JSON, line 1, column 2: ")) << first;
  const std::string number = refusal(scratch.write("number.obj", "v 0 0 0\nv 1 0 3.1+e2\n"), Exit::kInvalid);
  EXPECT_TRUE(contains(number, "line 2: '3.1+e2' is not a number; repair the file there")) << number;
  const std::string wide = refusal(scratch.write("wide.obj", {"\xfe\xff\0v", 4}), Exit::kUnsupported);
  EXPECT_TRUE(contains(wide, "is UTF-16 text")) << wide;
  const std::string vertex = refusal(scratch.write("vertex.obj", "v 0 0 0\nf 1 2 3\n"), Exit::kInvalid);
  EXPECT_TRUE(contains(vertex, "line 2: the face names vertex 2, but there are 1; ")) << vertex;
  for (const char* name : {"folder", "folder.obj", "folder.glb", "folder.vdb"}) {
    std::filesystem::create_directories(scratch.folder() / name);
    const std::string folder = refusal(scratch.folder() / name, Exit::kIo);
    EXPECT_TRUE(contains(folder, "is a folder; name the file")) << folder;
  }
}

// Real files, cut and with bytes turned over: a fixed seed, some hundred variants a format.
TEST(ImportHostile, CutAndFlippedFiles) {
  const Scratch scratch;
  std::mt19937 random(20240607);
  for (const char* name :
       {"gltf/draco_testdata/Box.glb", "gltf/draco_testdata/Box_Draco.glb", "gltf/aquarium/fish.glb",
        "gltf/assimp/BoxTextured.glb", "gltf/draco_testdata/SimpleSparseAccessor/SimpleSparseAccessor.gltf",
        "mesh/assimp/OBJ/box.obj", "mesh/assimp/PLY/cube_binary.ply", "mesh/assimp/PLY/cube_uv.ply",
        "mesh/draco_testdata/test_pos_color.ply", "gltf/meshopt/pirate.glb"}) {
    KELP_ASSET(path, name);
    std::ifstream in(path, std::ios::binary);
    const std::string good{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    for (int variant = 0; variant < 100; ++variant) {
      std::string bad = good;
      if (variant % 2 == 0) bad.resize(random() % bad.size());
      for (int flips = static_cast<int>(random() % 4) + variant % 2; flips > 0 && !bad.empty(); --flips)
        bad[random() % bad.size()] = static_cast<char>(random());
      survive(scratch.write("variant" + path.extension().string(), bad));
    }
  }
}

// The beginning of a PNG, which is all that it is sized by; its picture is lost, so that nobody pays for one.
std::string pngHeader(int side) {
  const std::string bytes{'\0', '\0', static_cast<char>(side >> 8), static_cast<char>(side & 255)};
  return std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16) + bytes + bytes +
         std::string("\x08\x06\0\0\0\0\0\0\0", 9);
}

// A box for each picture.
std::string modelOf(const std::vector<std::string>& uris) {
  std::string images, textures, materials, primitives;
  for (std::size_t i = 0; i < uris.size(); ++i) {
    const std::string comma = i ? "," : "", n = std::to_string(i);
    images += comma + R"({"uri":")" + uris[i] + R"("})";
    textures += comma + R"({"source":)" + n + "}";
    materials += comma + R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":)" + n + "}}}";
    primitives += comma + R"({"attributes":{"POSITION":0},"indices":1,"material":)" + n + "}";
  }
  GltfMaker maker;
  maker.addBox();
  return maker.text(R"("nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0,"meshes":[{"primitives":[)" +
                    primitives + R"(]}],"materials":[)" + materials + R"(],"textures":[)" + textures +
                    R"(],"images":[)" + images + "]");
}

// A header is enough to say no: what follows it is never looked at. Two of them fit into no gibibyte.
TEST(ImportHostile, PicturesAreCountedBeforeTheyAreDecoded) {
  const Scratch scratch;
  std::vector<std::string> uris;
  for (const char* n : {"0", "1"}) uris.push_back("data:image/png;base64," + base64(pngHeader(8192) + n));
  const auto path = scratch.write("bomb.gltf", modelOf(uris));
  const std::string said = refusal(path, Exit::kRuntime);
  EXPECT_TRUE(contains(said, "images[1]") && contains(said, "8192 x 8192") && contains(said, "--max-memory"))
      << said;
  Settings settings;
  settings.max_memory = std::uint64_t{4} << 30;
  EXPECT_TRUE(anyContains(importFile(path, settings).notices, "cannot be decoded"));
}

// Eight pictures of 4096 pixels take 1.3 GiB: that is a usual model if its files are as large as such
// pictures are, and a bomb if they all name one file.
TEST(ImportHostile, PicturesMayTakeWhatTheirFilesAreWorth) {
  const Scratch scratch;
  const std::string picture = pngHeader(4096) + std::string(400000, '\x55');
  std::vector<std::string> own, shared;
  for (int i = 0; i < 8; ++i) {
    own.push_back("own" + std::to_string(i) + ".png");
    shared.push_back("own0.png");
    scratch.write(own.back(), picture);
  }
  const SourceModel model = importFile(scratch.write("own.gltf", modelOf(own)), {});
  EXPECT_EQ(std::count_if(model.notices.begin(), model.notices.end(),
                          [](const std::string& line) { return contains(line, "cannot be decoded"); }),
            8);
  EXPECT_TRUE(contains(refusal(scratch.write("shared.gltf", modelOf(shared)), Exit::kRuntime), "images[7]"));
  Settings settings;
  settings.max_memory = std::uint64_t{1} << 30;
  EXPECT_TRUE(contains(refusal(scratch.folder() / "own.gltf", Exit::kRuntime, settings), "images[6]"))
      << "what was asked for counts alone";
}

TEST(ImportHostile, PicturesOfMaterialLibrariesCountAlike) {
  const Scratch scratch;
  for (const char* n : {"0", "1"}) scratch.write(std::string(n) + ".png", pngHeader(8192));
  // Two libraries have one bound.
  scratch.write("a.mtl", "newmtl a\nmap_Kd 0.png\n");
  scratch.write("b.mtl", "newmtl b\nmap_Ke 1.png\n");
  const auto path =
      scratch.write("bomb.obj", "mtllib a.mtl\nmtllib b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
  const std::string said = refusal(path, Exit::kRuntime);
  EXPECT_TRUE(contains(said, "b.mtl: texture 1.png") && contains(said, "8192 x 8192") &&
              contains(said, "--max-memory"))
      << said;
  Settings settings;
  settings.max_memory = std::uint64_t{4} << 30;
  EXPECT_TRUE(anyContains(importFile(path, settings).notices, "cannot be decoded"));
}

// `count` of them, parted by commas.
std::string list(int count, const std::function<std::string(int)>& item) {
  std::string out;
  for (int i = 0; i < count; ++i) out += (i ? "," : "") + item(i);
  return out;
}
std::string list(int count, const std::string& item) {
  return list(count, [&](int) { return item; });
}

// In quadratic time these files would exceed the time limit of a test.
void expectEnds(const char* extension, const std::string& text) {
  const Scratch scratch;
  FilesUsed used;
  EXPECT_FALSE(importFile(scratch.write(std::string("model") + extension, text), {}, &used).parts.empty());
}

// Several buffers may read one file, each with its own length.
TEST(ImportHostile, BuffersOfOneFileKeepTheirLengths) {
  const Scratch scratch;
  scratch.write("t.bin", bytesOf(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 2, 0, 0, 0, 2, 0}));
  const auto model = [&](const std::string& offset) {
    return scratch.write(
        "m.gltf",
        R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"t.bin"},{"byteLength":72,"uri":"./t.bin"}],"bufferViews":[{"buffer":0,"byteOffset":)" +
            offset +
            R"(,"byteLength":36},{"buffer":1,"byteOffset":36,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},{"bufferView":1,"componentType":5126,"count":3,"type":"VEC3"}],
                                       "meshes":[{"primitives":[{"attributes":{"POSITION":0}},{"attributes":{"POSITION":1}}]}],"nodes":[{"mesh":0}]})");
  };
  const SourceModel read = importFile(model("0"), {});
  EXPECT_EQ(read.parts.at(0).soup.triangles.size(), 2u);
  EXPECT_EQ(boundsOf(read.parts.at(0)).high, glm::vec3(2, 2, 0));
  EXPECT_TRUE(contains(refusal(model("4"), Exit::kInvalid), "reaches beyond buffers[0] (36 bytes)"));
}

// Pictures and libraries are read where they are named; names of one file come to an end.
TEST(ImportHostile, PicturesThatAreOneFileAreReadWithinBounds) {
  const Scratch scratch;
  scratch.write("p.png", std::string(std::size_t{32} << 20, '\0'));
  const std::string said =
      refusal(scratch.write("m.gltf", modelOf(std::vector<std::string>(120, "p.png"))), Exit::kInvalid);
  EXPECT_TRUE(contains(said, "p.png") && contains(said, "is named too often")) << said;
}

TEST(ImportHostile, ALibraryIsReadOnceHoweverManyLinesNameIt) {
  const Scratch scratch;
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n", lines;
  for (int i = 0; i < 200; ++i) {
    text += "newmtl m" + std::to_string(i) + "\n";
    lines += i % 2 ? "mtllib ./self.obj\n" : "mtllib self.obj\n";
  }
  const SourceModel model = importFile(scratch.write("self.obj", text + lines + "usemtl m7\nf 1 2 3\n"), {});
  EXPECT_EQ(model.materials.size(), 201u);
  EXPECT_EQ(model.materials.at(model.parts.at(0).soup.triangles.at(0).material).name, "m7");
}

// Each word of an mtllib may be a file: all that is missing is what the pack depends on.
TEST(ImportHostile, ALineThatNamesFilesWithoutEnd) {
  const Scratch scratch;
  std::string words;
  const auto tried = [&](int from, int to) {
    for (int i = from; i < to; ++i) words += " " + std::to_string(i);
    FilesUsed used;
    try {
      importFile(scratch.write("m.obj", "mtllib" + words + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), {},
                 &used);
    } catch (const ToolError& error) {
      EXPECT_EQ(error.exit, Exit::kRuntime);
      EXPECT_TRUE(contains(error.what(), "m.obj: names more than 4000 other files; ")) << error.what();
      return -1;
    }
    return static_cast<int>(used.missing.size());
  };
  EXPECT_GE(tried(0, 3900), 3900);
  EXPECT_EQ(tried(3900, 60000), -1);
}

// Turns that follow no polynomial are sampled, a part's rest as often as its motion. Still ones are not.
TEST(ImportHostile, KnotsThatTurnForLong) {
  const Scratch scratch;
  const auto text = [](float last) {
    GltfMaker maker;
    maker.addBox();
    const int times = maker.floats({0, 700}, 1), turns = maker.floats({0, 0, 0, 1, 0, 0, last, 1}, 4);
    std::string nodes, children;
    for (int k = 0; k < 64; ++k) {
      nodes += R"(,{"name":"knot.)" + std::to_string(k) + R"(","translation":[0,)" +
               std::to_string(2.0 * k / 63) + ",0]}";
      children += (k ? "," : "") + std::to_string(k + 1);
    }
    const std::string channels = list(64, [](int k) {
      return R"({"sampler":0,"target":{"node":)" + std::to_string(k + 1) + R"(,"path":"rotation"}})";
    });
    return maker.text(GltfMaker::boxMesh() + R"(,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"children":[)" +
                      children + "]}" + nodes + R"(],"animations":[)" +
                      list(16,
                           [&](int i) {
                             return R"({"name":"a)" + std::to_string(i) + R"(","samplers":[{"input":)" +
                                    std::to_string(times) + R"(,"output":)" + std::to_string(turns) +
                                    R"(}],"channels":[)" + channels + "]}";
                           }) +
                      "]");
  };
  EXPECT_TRUE(contains(refusal(scratch.write("m.gltf", text(1e-3f)), Exit::kInvalid), "knot."));
  EXPECT_EQ(importFile(scratch.write("m.gltf", text(0)), {}).parts.at(0).rig.clips.size(), 0u);
}

TEST(ImportHostile, OfTwoLibrariesTheOneNamedLastCounts) {
  const Scratch scratch;
  scratch.write("a.mtl", "newmtl x\nPr 0.25\nnewmtl x\nPr 0.5\n");
  scratch.write("b.mtl", "newmtl x\nPr 0.75\n");
  const SourceModel model = importFile(
      scratch.write("m.obj",
                    "v 0 0 0\nv 1 0 0\nv 0 1 0\nmtllib a.mtl\nusemtl x\nf 1 2 3\nmtllib b.mtl\nusemtl x\nf 1 "
                    "2 3\nmtllib a.mtl\nusemtl x\nf 1 2 3\nmtllib lost.mtl\nmtllib lost.mtl\nf 1 2 3\n"),
      {});
  std::vector<float> roughness;
  for (const auto& triangle : model.parts.at(0).soup.triangles)
    roughness.push_back(model.materials.at(triangle.material).roughness);
  EXPECT_EQ(roughness, (std::vector<float>{0.5f, 0.75f, 0.5f, 0.5f}));
  EXPECT_EQ(model.materials.size(), 4u);
  EXPECT_EQ(std::count_if(model.notices.begin(), model.notices.end(),
                          [](const std::string& line) { return contains(line, "lost.mtl"); }),
            1);
}

// A box with animations of one key.
class Animated {
 public:
  Animated() {
    maker_.addBox();
    times_ = maker_.floats({0}, 1);
    values_ = maker_.floats({1, 2, 3}, 3);
  }
  std::string text(const std::string& animations) const {
    return maker_.text(
        GltfMaker::boxMesh() +
        R"(,"nodes":[{"name":"n","mesh":0,"extras":{"kelp":{"kelp":1,"knots":[{"at":0},{"at":1}]}}}],"scenes":[{"nodes":[0]}],"animations":[)" +
        animations + "]");
  }
  std::string animation(const std::string& name, const std::string& channels) const {
    return R"({"name":")" + name + R"(","samplers":[{"input":)" + std::to_string(times_) + R"(,"output":)" +
           std::to_string(values_) + R"(}],"channels":[)" + channels + "]}";
  }
  static std::string channel(const std::string& node) {
    return R"({"sampler":0,"target":{)" + node + R"("path":"translation"}})";
  }

 private:
  GltfMaker maker_;
  int times_ = 0, values_ = 0;
};

TEST(ImportHostile, ManyChannelsWithoutANode) {
  const Animated made;
  expectEnds(".gltf", made.text(made.animation("a", list(48000, Animated::channel("")))));
}

TEST(ImportHostile, ManyAnimationsOfOneName) {
  const Animated made;
  expectEnds(".gltf", made.text(list(6000, made.animation("a", Animated::channel(R"("node":0,)")))));
  // Named after the node, they are clips of one name.
  expectEnds(".gltf", made.text(list(2800, [&](int i) {
    return made.animation(
        "nAction." + std::string{static_cast<char>('a' + i / 676), static_cast<char>('a' + i / 26 % 26),
                                 static_cast<char>('a' + i % 26)},
        Animated::channel(R"("node":0,)"));
  })));
}

// Names are free for what does not move yet, whichever of them come first.
TEST(ImportHostile, AnimationsOfOneNameFillTheFirstThatIsFree) {
  const Scratch scratch;
  const Animated made;
  const std::string first = Animated::channel(R"("node":0,)"),
                    second = R"({"sampler":0,"target":{"node":0,"path":"scale"}})",
                    both = first + "," + second;
  const SourceModel model = importFile(
      scratch.write("m.gltf", made.text(made.animation("a", both) + "," + made.animation("a.3", first) + "," +
                                        made.animation("a", first) + "," + made.animation("a", first) + "," +
                                        made.animation("a", second))),
      {});
  std::vector<std::string> clips;
  for (const RigDescription::Clip& clip : model.parts.at(0).rig.clips)
    clips.push_back(clip.name + ":" + std::to_string(clip.tracks.size()));
  EXPECT_EQ(clips, (std::vector<std::string>{"a:2", "a.3:1", "a.2:2", "a.4:1"}));
}

TEST(ImportHostile, ManyLibrariesThatAreNotThere) {
  const std::string faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::string names = "mtllib";
  for (int i = 0; i < 3600; ++i) names += " a" + std::to_string(i);
  expectEnds(".obj", names + "\n" + faces);
  const Scratch scratch;
  FilesUsed used;
  importFile(scratch.write("m.obj", "mtllib a b\nmtllib b a\nmtllib a\n" + faces), {}, &used);
  EXPECT_EQ(std::count(used.missing.begin(), used.missing.end(), scratch / "a"), 1);
  EXPECT_EQ(std::count(used.missing.begin(), used.missing.end(), scratch / "b"), 1);
}

TEST(ImportHostile, ManyOptionsOfAPicture) {
  const Scratch scratch;
  std::string line = "newmtl a\nmap_Kd";
  for (int i = 0; i < 80000; ++i) line += " -t 1 2";
  scratch.write("a.mtl", line + " -clamp on lost.png\n");
  const SourceModel model =
      importFile(scratch.write("m.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n"), {});
  EXPECT_TRUE(anyContains(model.notices, "lost.png"));
  EXPECT_EQ(model.materials.at(1).wrap_u, Wrap::kClamp);
}

TEST(ImportHostile, ManyTexturesWithoutAPicture) {
  constexpr int kCount = 16000;
  GltfMaker maker;
  maker.addBox();
  expectEnds(".gltf", maker.text(GltfMaker::boxMesh() + R"(,"nodes":[{"mesh":0}],"textures":[)" +
                                 list(kCount, "{}") + R"(],"materials":[)" +
                                 list(kCount,
                                      [](int i) {
                                        return R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":)" +
                                               std::to_string(i) + "}}}";
                                      }) +
                                 "]"));
}

// Nodes that share a mesh make one notice together, and what they read of it has a bound.
TEST(ImportHostile, ManyNodesOfOneMesh) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const auto text = [&](int nodes, int lines) {
    return maker.text(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1},)" +
                      list(lines, R"({"mode":1,"attributes":{"POSITION":0}})") + R"(]}],"nodes":[)" +
                      list(nodes, R"({"mesh":0})") + "]");
  };
  const SourceModel model = importText(scratch, text(300, 100));
  EXPECT_EQ(model.parts.at(0).soup.triangles.size(), 3600u);
  EXPECT_EQ(model.notices.size(), 100u);
  const std::string said = refusal(scratch.write("m.gltf", text(1500, 1500)), Exit::kInvalid);
  EXPECT_TRUE(contains(said, "meshes[0].primitives[") &&
              contains(said, "shared ones counted anew; bake it in pieces"))
      << said;
}

// Four million keys without a byte behind them.
TEST(ImportHostile, KeysThatChannelsShareAreCounted) {
  const Scratch scratch;
  const std::string accessors =
      R"({"componentType":5126,"count":4194304,"type":"SCALAR"},{"componentType":5126,"count":4194304,"type":"VEC3"})";
  const auto text = [&](int channels) {
    return R"({"asset":{"version":"2.0"},"accessors":[)" + accessors +
           R"(],"nodes":[{}],"animations":[{"samplers":[{"input":0,"output":1}],"channels":[)" +
           list(channels, Animated::channel(R"("node":0,)")) + "]}]}";
  };
  EXPECT_TRUE(importText(scratch, text(2)).parts.empty());
  const std::string said = refusal(scratch.write("m.gltf", text(3)), Exit::kRuntime);
  EXPECT_TRUE(contains(said, "animations[0].channels[2]: ") && contains(said, "--max-memory")) << said;
}

TEST(ImportHostile, ManyElementsOfNothing) {
  constexpr int kCount = 240, kInstances = 25000 * kCount;
  std::string head = "ply\nformat ascii 1.0\n";
  for (int i = 0; i < kCount; ++i)
    head += "element e" + std::to_string(i) + " " + std::to_string(kInstances) + "\n";
  expectEnds(".ply",
             head +
                 "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face "
                 "1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1 0 0 0 1 0 3 0 1 2\n" +
                 std::string(std::size_t{kInstances}, ' '));
}

}  // namespace
}  // namespace kelp::bake::test
