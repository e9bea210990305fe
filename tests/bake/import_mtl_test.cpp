// SPDX-License-Identifier: MIT
// Materials of OBJ files: pictures that lie elsewhere, what map_d cuts out, alphas.
#include <map>

#include "import_scratch.h"
#include "two_boxes.h"

namespace kelp::bake::test {
namespace {

const Texels kRedBlue = {{255, 32, 32, 255}, {32, 64, 255, 255}};

// Two boxes, each in a half of a picture, by material m of a.mtl.
std::string texturedBoxes() {
  std::string text = "mtllib a.mtl\nusemtl m\n";
  for (int i = 0; i < TwoBoxes::kCorners; ++i) text += "v " + TwoBoxes::text(i) + "\n";
  text += "vt 0.25 0.5\nvt 0.75 0.5\n";
  for (const auto& face : TwoBoxes::kFaces) {
    text += "f";
    for (const int corner : face)
      text += fmt::format(" {}/{}", corner + 1, TwoBoxes::isSecond(corner) ? 2 : 1);
    text += "\n";
  }
  return text;
}

class MtlElsewhere : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& reference) {
    scratch_.write("in/a.mtl", "newmtl m\nKd 0.8 0.8 0.8\nmap_Kd " + reference + "\n");
    return scratch_.write("in/a.obj", texturedBoxes());
  }
  // True if the picture was read, else there is a notice.
  bool finds(const std::string& reference) {
    const SourceModel model = importFile(write(reference), {});
    EXPECT_EQ(model.notices.empty(), model.images.size() == 1) << reference;
    return model.images.size() == 1;
  }

  Scratch scratch_;
};

TEST_F(MtlElsewhere, PicturesAreTriedByTheirNameBesideTheInput) {
  scratch_.write("in/dungeon texture.tga", tga(kRedBlue, 2));
  scratch_.write("in/sub/other.tga", tga(kRedBlue, 2));
  for (const char* path :
       {R"(C:\\Users\\someone\\Desktop\\export 1.0\\dungeon texture.tga)", R"(D:\art\dungeon texture.tga)",
        "/home/someone/art/dungeon texture.tga", "../textures/dungeon texture.tga",
        R"(..\..\dungeon texture.tga)", R"(\\server\share\dungeon texture.tga)", "dungeon texture.tga",
        "C:/dungeon texture.tga", "sub/../../in/../dungeon texture.tga",
        R"(-clamp on /x\dungeon texture.tga)"})
    EXPECT_TRUE(finds(path)) << path;
  EXPECT_TRUE(finds(R"(sub\other.tga)"));
  Report report;
  const RawPack pack = bakeBoxes(write(R"(C:\\Users\\someone\\export 1.0\\dungeon texture.tga)"), report);
  EXPECT_EQ(report.images, 1u);
  EXPECT_EQ(colorsOf(pack), (std::set<std::string>{"#1731cc", "#cc1717"}));
}

TEST_F(MtlElsewhere, NothingOutsideTheFolderIsRead) {
  scratch_.write("secret.tga", tga(kRedBlue, 2));
  scratch_.write("in/sub/other.tga", tga(kRedBlue, 2));
  std::filesystem::create_symlink(scratch_ / "secret.tga", scratch_ / "in/link.tga");
  const std::string absolute = (scratch_ / "secret.tga").string();
  for (const std::string& path :
       {absolute, std::string("../secret.tga"), std::string(R"(..\secret.tga)"), "/x/../" + absolute,
        std::string("../x/link.tga"), std::string("/x/.."), std::string("../x/."), std::string("/x/"),
        std::string("/x/other.tga"), std::string(R"(C:\x\..)")})
    EXPECT_FALSE(finds(path)) << path;
}

TEST_F(MtlElsewhere, LibrariesAndPicturesOfGltfAreTriedAlike) {
  scratch_.write("in/p.tga", tga(kRedBlue, 2));
  scratch_.write("in/a.mtl", "newmtl m\nKd 1 0 0\n");
  std::string text = texturedBoxes();
  text.replace(0, text.find('\n'), R"(mtllib C:\My Models\a.mtl)");
  Report report;
  EXPECT_EQ(colorsOf(bakeBoxes(scratch_.write("in/a.obj", text), report)), std::set<std::string>{"#ff0000"});
  const auto gltf = [&](const std::string& uri) {
    GltfMaker maker;
    maker.addBox();
    return scratch_.write(
        "in/a.gltf",
        maker.text(
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],)"
            R"("nodes":[{"mesh":0}],"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],)"
            R"("textures":[{"source":0}],"images":[{"uri":")" +
            uri + R"("}])"));
  };
  for (const char* uri : {R"(C:\\art\\p.tga)", "/home/me/p.tga", "../textures/p.tga",
                          "file:///C:/art%20x/p.tga", R"(textures\\p.tga)", "..%2Fp.tga", "..%5Cp.tga"})
    EXPECT_EQ(importFile(gltf(uri), {}).images.size(), 1u) << uri;
  scratch_.write("q.tga", tga(kRedBlue, 2));
  for (const char* uri : {"../q.tga", "/q.tga", R"(C:\\q.tga)", "..%2fq.tga"})
    EXPECT_TRUE(contains(refusal(gltf(uri), Exit::kInvalid), "only files beside the input are read")) << uri;
  // Geometry is taken from no other place.
  scratch_.write("in/b.bin", std::string(36, '\0'));
  refusal(
      scratch_.write(
          "in/b.gltf",
          R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"/x/b.bin"}],"bufferViews":[{"buffer":0,)"
          R"("byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],)"
          R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}]})"),
      Exit::kInvalid);
}

class MtlLook : public testing::Test {
 protected:
  // A square for each material, with the whole of its picture.
  SourceModel import(const std::string& library, const std::vector<std::string>& materials) {
    scratch_.write("a.mtl", library);
    std::string text = "mtllib a.mtl\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    for (std::size_t i = 0; i < materials.size(); ++i)
      text += fmt::format("v 0 0 {0}\nv 1 0 {0}\nv 1 1 {0}\nv 0 1 {0}\nusemtl {1}\nf -4/1 -3/2 -2/3 -1/4\n",
                          i, materials[i]);
    return importFile(scratch_.write("a.obj", text), {});
  }
  static std::map<std::string, int> trianglesOf(const SourceModel& model) {
    std::map<std::string, int> out;
    for (const auto& triangle : model.parts[0].soup.triangles) ++out[model.materials[triangle.material].name];
    return out;
  }
  static const SurfaceMaterial& named(const SourceModel& model, const std::string& name) {
    for (const SurfaceMaterial& material : model.materials)
      if (material.name == name) return material;
    throw std::runtime_error("no material " + name);
  }
  static const Image& pictureOf(const SourceModel& model, const std::string& name) {
    return model.images.at(static_cast<std::size_t>(named(model, name).texture));
  }

  Scratch scratch_;
};

TEST_F(MtlLook, MapDCutsOut) {
  scratch_.write("leaf.tga", tga({{10, 20, 30, 0}, {40, 50, 60, 127}, {70, 80, 90, 128}, {1, 2, 3, 255}}, 4));
  scratch_.write("gray.tga", tga({{255, 255, 255, 255}, {127, 127, 127, 255}}, 2));
  scratch_.write("color.tga", tga({{9, 8, 7, 255}}, 1));
  const SourceModel model = import(
      // the color's own alpha; a gray picture before a color; a gray one alone, and with d
      "newmtl leaf\nKd 0 0 0\nmap_Kd leaf.tga\nmap_d leaf.tga\nnewmtl card\nmap_d -clamp on gray.tga\nmap_Kd "
      "color.tga\nnewmtl mask\nKd 1 0 0\nd 0.5\nmap_d gray.tga\nnewmtl plain\nmap_Kd leaf.tga\n",
      {"leaf", "card", "mask", "plain"});
  EXPECT_TRUE(model.notices.empty()) << model.notices.front();
  EXPECT_EQ(named(model, "leaf").base_color, glm::vec4(1));
  EXPECT_EQ(named(model, "leaf").alpha_cutoff, 0.5f);
  EXPECT_EQ(pictureOf(model, "leaf").rgba,
            (std::vector<std::uint8_t>{10, 20, 30, 0, 40, 50, 60, 0, 70, 80, 90, 255, 1, 2, 3, 255}));
  EXPECT_TRUE(pictureOf(model, "leaf").srgb);
  EXPECT_EQ(named(model, "card").alpha_cutoff, 0.5f);
  EXPECT_EQ(named(model, "card").wrap_u, Wrap::kRepeat);  // the color's
  EXPECT_EQ(pictureOf(model, "card").rgba, (std::vector<std::uint8_t>{9, 8, 7, 255, 9, 8, 7, 0}));
  EXPECT_EQ(named(model, "mask").alpha_cutoff, 0.25f);  // of the factor's half
  EXPECT_EQ(pictureOf(model, "mask").rgba, (std::vector<std::uint8_t>{255, 255, 255, 255, 255, 255, 255, 0}));
  EXPECT_EQ(named(model, "plain").alpha_cutoff, 0);
  EXPECT_EQ(pictureOf(model, "plain").rgba[3], 0);
  EXPECT_EQ(model.images.size(), 4u);
}

TEST_F(MtlLook, MapDThatCutsNothingOrAll) {
  scratch_.write("white.tga", tga({{255, 255, 255, 255}}, 1));
  scratch_.write("black.tga", tga({{0, 0, 0, 255}}, 1));
  scratch_.write("photo.tga", tga({{0, 200, 0, 255}, {250, 0, 0, 255}}, 2));
  const SourceModel model = import(
      "newmtl full\nd 0\nmap_d white.tga\nnewmtl gone\nmap_Kd photo.tga\nmap_d black.tga\nnewmtl "
      "same\nmap_Kd "
      "photo.tga\nmap_d photo.tga\nnewmtl lost\nmap_d lost.tga\nmap_Kd photo.tga\n",
      {"full", "gone", "same", "lost"});
  EXPECT_EQ(trianglesOf(model), (std::map<std::string, int>{{"full", 2}, {"same", 2}, {"lost", 2}}));
  for (const char* name : {"full", "same", "lost"}) {
    EXPECT_EQ(named(model, name).alpha_cutoff, 0) << name;
    EXPECT_EQ(named(model, name).base_color.a, 1) << name;
  }
  EXPECT_EQ(pictureOf(model, "same").rgba, (std::vector<std::uint8_t>{0, 200, 0, 255, 250, 0, 0, 255}));
  EXPECT_EQ(model.notices.size(), 2u);
  EXPECT_TRUE(anyContains(model.notices, "lost.tga"));
  EXPECT_TRUE(anyContains(model.notices, "material 'gone': is invisible"));
}

// A card with a hole, through to the voxels.
TEST_F(MtlLook, MapDIsSeenInTheVoxels) {
  Texels half(8, {255, 255, 255, 255});
  for (std::size_t i = 0; i < 4; ++i) half[i] = {0, 0, 0, 255};
  scratch_.write("half.tga", tga(half, 8));
  import("newmtl card\nmap_d -clamp on half.tga\n", {"card"});
  Report report;
  Settings settings;
  settings.resolution = 32;
  settings.resolution_given = true;
  const RawPack pack = bake::bake(scratch_ / "a.obj", settings, report);
  EXPECT_NEAR(static_cast<double>(report.parts[0].surface_voxels), 512, 40);
}

TEST_F(MtlLook, InvisibleOnesAreLeftOut) {
  scratch_.write("p.tga", tga(kRedBlue, 2));
  const SourceModel model = import(
      "newmtl body\nd 1\nnewmtl air\nd 0\nnewmtl gas\nTr 1.0\nnewmtl both\nd 1\nTr 1\nnewmtl other\nTr 1\nd "
      "1\nnewmtl shown\nd 0\nmap_Kd p.tga\n",
      {"body", "air", "gas", "both", "other", "shown", "air"});
  EXPECT_EQ(trianglesOf(model),
            (std::map<std::string, int>{{"body", 2}, {"both", 2}, {"other", 2}, {"shown", 2}}));
  EXPECT_EQ(model.notices.size(), 2u);
  EXPECT_TRUE(anyContains(model.notices,
                          "material 'air': is invisible (its alpha is 0): 2 of its faces are left out"));
  // Never all there is.
  const SourceModel all = import("newmtl air\nTr 1\n", {"air"});
  EXPECT_EQ(trianglesOf(all), (std::map<std::string, int>{{"air", 2}}));
  EXPECT_TRUE(anyContains(all.notices, "material 'air': is transparent; it is baked opaque"));
}

TEST_F(MtlLook, TransparentOnesAreOpaque) {
  const SourceModel model = import(
      "newmtl glass\nd 0.4\nnewmtl water\nTr 0.25\nnewmtl unused\nd 0.5\nnewmtl "
      "stone\nTr 0\n",
      {"glass", "water", "stone"});
  EXPECT_EQ(model.notices,
            (std::vector<std::string>{"material 'glass': is transparent; it is baked opaque",
                                      "material 'water': is transparent; it is baked opaque"}));
  EXPECT_EQ(named(model, "glass").base_color.a, 0.4f);
}

}  // namespace
}  // namespace kelp::bake::test
