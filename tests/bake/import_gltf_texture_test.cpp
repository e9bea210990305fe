// SPDX-License-Identifier: MIT
// Textures of glTF files: which picture, where on it, and the material workflows that name it.
#include <cmath>

#include <webp/encode.h>

#include "import_scratch.h"

namespace kelp::bake::test {
namespace {

std::string webp(const Texels& texels, int width) {
  std::uint8_t* out = nullptr;
  const std::size_t size = WebPEncodeLosslessRGBA(texels[0].data(), width,
                                                  static_cast<int>(texels.size()) / width, 4 * width, &out);
  const std::string bytes(reinterpret_cast<const char*>(out), size);
  WebPFree(out);
  return bytes;
}

std::string dataUri(const std::string& bytes) { return "data:image/x;base64," + base64(bytes); }

const Texels kRedGreen = {{255, 0, 0, 255}, {0, 255, 0, 255}};
const Texels kBlue = {{0, 0, 255, 255}};

// A box with one material; `members` of the root: textures, images, samplers.
class Textured : public ::testing::Test {
 protected:
  SourceModel import(const std::string& material, const std::string& members) {
    return importFile(write(material, members), {});
  }
  std::filesystem::path write(const std::string& material, const std::string& members) {
    GltfMaker maker;
    maker.addBox();
    std::vector<float> uvs;
    for (int i = 0; i < 8; ++i) uvs.insert(uvs.end(), {i & 1 ? 1.0f : 0.0f, i & 2 ? 1.0f : 0.0f});
    maker.floats(uvs, 2);
    for (float& uv : uvs) uv = 0.25f;
    maker.floats(uvs, 2);
    return scratch_.write(
        "model.gltf",
        maker.text(
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":2,"TEXCOORD_1":3},"indices":1,"material":0}]}],"nodes":[{"mesh":0}],"materials":[{)" +
            material + "}]" + (members.empty() ? "" : "," + members)));
  }
  static std::string plain(const std::string& more = "") {
    return R"("pbrMetallicRoughness":{"metallicFactor":0,"baseColorTexture":{"index":0)" + more + "}}";
  }
  static std::string images(const std::vector<std::string>& uris) {
    std::string text;
    for (const std::string& uri : uris) text += (text.empty() ? R"({"uri":")" : R"(,{"uri":")") + uri + "\"}";
    return "\"images\":[" + text + "]";
  }

  Scratch scratch_;
};

TEST_F(Textured, WebpPicturesAreRead) {
  const std::string extension =
      R"("textures":[{"extensions":{"EXT_texture_webp":{"source":0}}}],"extensionsUsed":["EXT_texture_webp"],"extensionsRequired":["EXT_texture_webp"],)";
  const SourceModel model = import(plain(), extension + images({dataUri(webp(kRedGreen, 2))}));
  ASSERT_EQ(model.images.size(), 1u);
  EXPECT_EQ(model.images[0].width, 2);
  EXPECT_EQ(model.images[0].rgba, (std::vector<std::uint8_t>{255, 0, 0, 255, 0, 255, 0, 255}));
  EXPECT_TRUE(model.notices.empty()) << model.notices[0];
  // Beside the file, and named as if it were a plain one.
  scratch_.write("picture.webp", webp(kBlue, 1));
  EXPECT_EQ(import(plain(), R"("textures":[{"source":0}],)" + images({"picture.webp"})).images.at(0).rgba,
            (std::vector<std::uint8_t>{0, 0, 255, 255}));
}

TEST_F(Textured, ADamagedWebpPictureGivesWayToThePlainOne) {
  const std::string textures = R"("textures":[{"source":1,"extensions":{"EXT_texture_webp":{"source":0}}}],)";
  const std::string good = webp(kRedGreen, 2);
  EXPECT_EQ(import(plain(), textures + images({dataUri(good), dataUri(tga(kBlue, 1))})).images.at(0).width,
            2);
  const SourceModel model =
      import(plain(), textures + images({dataUri(good.substr(0, good.size() - 4)), dataUri(tga(kBlue, 1))}));
  EXPECT_EQ(model.images.at(0).rgba, (std::vector<std::uint8_t>{0, 0, 255, 255}));
  EXPECT_TRUE(anyContains(model.notices, "images[0]: is a WebP picture that cannot be decoded"));
}

TEST_F(Textured, BasisTexturesFallBackOrAreRefused) {
  const std::string required =
      R"("extensionsUsed":["KHR_texture_basisu"],"extensionsRequired":["KHR_texture_basisu"],)";
  const std::string both = images({"absent.ktx2", dataUri(tga(kBlue, 1))});
  EXPECT_EQ(
      import(
          plain(),
          required + R"("textures":[{"source":1,"extensions":{"KHR_texture_basisu":{"source":0}}}],)" + both)
          .images.size(),
      1u);
  const std::string alone = R"("textures":[{"extensions":{"KHR_texture_basisu":{"source":0}}}],)";
  EXPECT_TRUE(contains(refusal(write(plain(), required + alone + both), Exit::kUnsupported),
                       "textures[0]: has only a KTX2 picture (KHR_texture_basisu)"));
  // Pictures that no voxel shows may need anything.
  EXPECT_EQ(import(R"("normalTexture":{"index":0})", required + alone + both).materials[0].texture, -1);
}

TEST_F(Textured, CoordinateSetsAndTransformsAreThoseOfTheTexture) {
  const std::string rest = R"("textures":[{"source":0}],)" + images({dataUri(tga(kRedGreen, 2))});
  const SourceModel second = import(plain(R"(,"texCoord":1)"), rest);
  for (const glm::vec2& corner : second.parts[0].soup.uvs.at(0)) EXPECT_EQ(corner, glm::vec2(0.25f));
  // The example of KHR_texture_transform: the lower left quadrant of the picture, turned clockwise by a
  // quarter.
  const SourceModel turned = import(
      plain(
          R"(,"extensions":{"KHR_texture_transform":{"offset":[0,1],"rotation":1.57079632679,"scale":[0.5,0.5]}})"),
      rest);
  const SourceModel as_is = import(plain(), rest);
  ASSERT_EQ(turned.parts[0].soup.uvs.size(), 12u);
  for (std::size_t t = 0; t < 12; ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      const glm::vec2 from = as_is.parts[0].soup.uvs[t][c], to = turned.parts[0].soup.uvs[t][c];
      EXPECT_NEAR(to.x, 0.5f * from.y, 1e-6);
      EXPECT_NEAR(to.y, 1 - 0.5f * from.x, 1e-6);
    }
  }
  // Its texCoord overrides the texture's.
  const SourceModel moved =
      import(plain(R"(,"extensions":{"KHR_texture_transform":{"texCoord":1,"offset":[0.5,0]}})"), rest);
  for (const glm::vec2& corner : moved.parts[0].soup.uvs.at(0)) EXPECT_EQ(corner, glm::vec2(0.75f, 0.25f));
}

TEST_F(Textured, SamplersSayHowToWrapAndFilter) {
  const std::string rest =
      R"("textures":[{"source":0,"sampler":0}],"samplers":[{"wrapS":33071,"wrapT":33648,"magFilter":9728}],)" +
      images({dataUri(tga(kRedGreen, 2))});
  const SurfaceMaterial material = import(plain(), rest).materials[0];
  EXPECT_EQ(material.wrap_u, Wrap::kClamp);
  EXPECT_EQ(material.wrap_v, Wrap::kMirror);
  EXPECT_TRUE(material.nearest);
  const SurfaceMaterial standard =
      import(plain(), R"("textures":[{"source":0}],)" + images({dataUri(tga(kRedGreen, 2))})).materials[0];
  EXPECT_EQ(standard.wrap_u, Wrap::kRepeat);
  EXPECT_EQ(standard.wrap_v, Wrap::kRepeat);
  EXPECT_FALSE(standard.nearest);
}

TEST_F(Textured, SpecularGlossinessKeepsTheColorOfPaintAndOfMetal) {
  const auto import = [&](const std::string& value, const std::string& rest = "") {
    return Textured::import(R"("extensions":{"KHR_materials_pbrSpecularGlossiness":{)" + value + "}}", rest);
  };
  const SurfaceMaterial paint =
      import(R"("diffuseFactor":[0.8,0.2,0.1,1],"specularFactor":[0.04,0.04,0.04],"glossinessFactor":0.75)")
          .materials[0];
  EXPECT_EQ(paint.base_color, glm::vec4(0.8f, 0.2f, 0.1f, 1));
  EXPECT_EQ(paint.metallic, 0.0f);
  EXPECT_NEAR(paint.roughness, 0.25f, 1e-6);
  // Gold: nothing is diffuse, all of its color is specular.
  const SurfaceMaterial gold =
      import(R"("diffuseFactor":[0,0,0,1],"specularFactor":[1,0.766,0.336],"glossinessFactor":0.5)")
          .materials[0];
  EXPECT_EQ(gold.base_color, glm::vec4(1, 0.766f, 0.336f, 1));
  EXPECT_GT(gold.metallic, 0.9f);
  // An exporter that wrote no specular half means the diffuse color.
  EXPECT_EQ(import(R"("diffuseFactor":[0.8,0.2,0.1,1])").materials[0].base_color,
            glm::vec4(0.8f, 0.2f, 0.1f, 1));
  // A metal in its texture, whose alpha is the gloss and no transparency.
  const SourceModel textured =
      import(R"("diffuseFactor":[0,0,0,1],"specularGlossinessTexture":{"index":0,"texCoord":1})",
             R"("textures":[{"source":0}],)" + images({dataUri(tga({{255, 200, 100, 51}}, 1))}));
  ASSERT_EQ(textured.materials[0].texture, 0);
  EXPECT_EQ(textured.images[0].rgba[3], 255);
  EXPECT_NEAR(textured.materials[0].roughness, 0.8f, 1e-5);
  EXPECT_EQ(textured.parts[0].soup.uvs.at(0)[0], glm::vec2(0.25f));
}

// A square of one meter in the plane of x and y, one material, as voxels. TEXCOORD_0 is the picture upright,
// TEXCOORD_1 exchanges u and v.
class Square : public ::testing::Test {
 protected:
  void bake(const std::string& material, const std::vector<std::string>& pictures, int resolution = 32,
            const std::string& filter = "9728") {
    GltfMaker maker;
    maker.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, 3);
    maker.floats({0, 1, 1, 1, 0, 0, 1, 0}, 2);
    maker.floats({1, 0, 1, 1, 0, 0, 0, 1}, 2);
    maker.indices({0, 1, 2, 2, 1, 3});
    std::string textures, images;
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      textures += (i ? "," : "") + std::string(R"({"sampler":0,"source":)") + std::to_string(i) + "}";
      images += (i ? "," : "") + std::string(R"({"uri":")") + pictures[i] + "\"}";
    }
    model_ = importFile(
        scratch_.write(
            "square.gltf",
            maker.text(
                R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1,"TEXCOORD_1":2},"indices":3,"material":0}]}],"nodes":[{"mesh":0}],"materials":[{)" +
                material + R"(}],"samplers":[{"magFilter":)" + filter + R"(}],"textures":[)" + textures +
                R"(],"images":[)" + images + "]")),
        {});
    const Frame frame = makeFrame(model_.parts[0].soup, Axis::kPlusY, 1.0 / resolution, "square");
    grid_ = voxelize(model_, model_.parts[0], frame, Fill::kAuto, 2, {}).grid;
    ASSERT_GE(grid_.surface.size(), static_cast<std::size_t>(resolution * resolution));
  }

  // expect(material, whether it is to the right, whether it is above) of each voxel.
  template <class Expect>
  void forEachVoxel(const Expect& expect) const {
    for (const SurfaceSample& sample : grid_.surface) {
      const auto x = sample.index % static_cast<std::uint64_t>(grid_.size.x),
                 y = sample.index / static_cast<std::uint64_t>(grid_.size.x) %
                     static_cast<std::uint64_t>(grid_.size.y);
      const glm::vec3 at =
          grid_.to_node * glm::vec4(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, 0, 1);
      expect(sample.material, at.x > 0.5f, at.y > 0.5f);
      if (HasFatalFailure()) return;
    }
  }

  Scratch scratch_;
  SourceModel model_;
  VoxelGrid grid_;
};

// glows on the left; its alpha says nothing
const Texels kLamp = {{255, 128, 0, 0}, {0, 0, 0, 0}};
const Texels kSteelAndChalk = {{99, 51, 255, 255}, {7, 204, 0, 255}};  // one above the other
constexpr float kHalfAsLight = 0.21586050f;                            // 128 of 255 as light

TEST_F(Square, GlowMetalAndRoughnessAreThoseOfTheirPictures) {
  bake(
      R"("pbrMetallicRoughness":{"baseColorFactor":[0.5,0.5,0.5,1],"roughnessFactor":0.5,"metallicRoughnessTexture":{"index":1}},
      "emissiveFactor":[1,1,0.5],"emissiveTexture":{"index":0},"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":4}})",
      {dataUri(tga(kLamp, 2)), dataUri(tga(kSteelAndChalk, 1))});
  EXPECT_FALSE(anyContains(model_.notices, "glow"));
  EXPECT_TRUE(model_.parts[0].soup.more_uvs[0].empty());  // all pictures lie alike
  forEachVoxel([](const Material& m, bool right, bool above) {
    ASSERT_NEAR(m.base_color.g, 0.5f, 1e-6);
    ASSERT_NEAR(m.emissive.r, right ? 0 : 4, 1e-5);
    ASSERT_NEAR(m.emissive.g, right ? 0 : 4 * kHalfAsLight, 1e-5);
    ASSERT_EQ(m.emissive.b, 0);
    ASSERT_NEAR(m.metallic, above ? 1 : 0, 1e-6);
    ASSERT_NEAR(m.roughness, above ? 0.1f : 0.4f, 1e-6);
  });
}

TEST_F(Square, EachPictureLiesWhereItsOwnCoordinatesSay) {
  bake(
      R"("pbrMetallicRoughness":{"baseColorTexture":{"index":2},"metallicRoughnessTexture":{"index":1,"texCoord":1}},
      "emissiveFactor":[1,1,1],"emissiveTexture":{"index":0,"extensions":{"KHR_texture_transform":{"offset":[0.5,0]}}})",
      {dataUri(tga(kLamp, 2)), dataUri(tga(kSteelAndChalk, 1)), dataUri(tga(kRedGreen, 2))});
  forEachVoxel([](const Material& m, bool right, bool) {
    ASSERT_EQ(glm::vec3(m.base_color), right ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0));
    ASSERT_NEAR(m.emissive.g, right ? kHalfAsLight : 0, 1e-6);  // moved by half the picture
    ASSERT_NEAR(m.metallic, right ? 0 : 1, 1e-6);               // its rows are columns
    ASSERT_NEAR(m.roughness, right ? 0.8f : 0.2f, 1e-6);
  });
}

TEST_F(Square, ALampWithoutItsPictureIsDark) {
  bake(R"("emissiveFactor":[1,1,1],"emissiveTexture":{"index":0})", {"absent.png"});
  EXPECT_TRUE(anyContains(model_.notices,
                          "materials[0]: its emissive texture cannot be read: the surface does not glow"));
  forEachVoxel([](const Material& m, bool, bool) { ASSERT_EQ(m.emissive, glm::vec3(0)); });
}

TEST_F(Textured, PicturesThatLeaveTheFolderAreRefused) {
  const Scratch& scratch = scratch_;
  scratch.write("sub/secret.tga", tga(kBlue, 1));
  const std::string said =
      refusal(write(plain(), R"("textures":[{"source":0}],)" + images({"../x/secret.tga"})), Exit::kInvalid);
  EXPECT_TRUE(contains(said, ".gltf: images[0]: reference '../x/secret.tga': leaves the input's folder"))
      << said;
  EXPECT_TRUE(
      contains(refusal(write(plain(), R"("textures":[{"source":0}],)" + images({"sub/../../x/secret.tga"})),
                       Exit::kInvalid),
               "leaves the input's folder"));
}

// Only where a path ends decides, and a link is no way out.
TEST_F(Textured, PathsAndLinksThatStayInTheFolderAreFollowed) {
  const std::string textures = R"("textures":[{"source":0}],)";
  const std::filesystem::path picture = scratch_.write("in/picture.tga", tga(kBlue, 1));
  const std::filesystem::path folder = picture.parent_path().parent_path();
  std::filesystem::create_directories(folder / "sub dir");
  std::filesystem::create_symlink(picture, folder / "inside.tga");
  for (const char* uri :
       {"sub%20dir/../in/picture.tga", "./in//picture.tga", "absent/../in/picture.tga", "inside.tga"}) {
    const SourceModel model = import(plain(), textures + images({uri}));
    EXPECT_EQ(model.images.size(), 1u) << uri;
    EXPECT_TRUE(model.notices.empty()) << model.notices[0];
  }
  // The same folder, with the asset one below: now the picture is outside.
  const std::filesystem::path below = folder / "below";
  std::filesystem::create_directories(below);
  std::filesystem::rename(write(plain(), textures + images({"link.tga"})), below / "model.gltf");
  std::filesystem::create_symlink(picture, below / "link.tga");
  EXPECT_TRUE(contains(refusal(below / "model.gltf", Exit::kInvalid), "leaves the input's folder by a link"));
  std::filesystem::rename(write(plain(), textures + images({"way/picture.tga"})), below / "model.gltf");
  std::filesystem::create_directory_symlink("../in", below / "way");
  EXPECT_TRUE(contains(refusal(below / "model.gltf", Exit::kInvalid), "leaves the input's folder by a link"));
}

// A damaged picture makes a notice, and the model loses its texture alone. Every kind of damage:
// import_picture_test.cpp.
TEST_F(Textured, DamagedPicturesAreDoneWithout) {
  const std::pair<std::string, const char*> cases[] = {
      {"\xff\xd8\xff",
       "images[0]: is a JPEG picture that cannot be decoded (Premature end of JPEG file): the color factor "
       "alone is used"},
      {"\x89PNG\r\n\x1a\n",
       "images[0]: is a PNG picture whose header is damaged or cut off: the color factor alone is used"},
      {"BM", "images[0]: is not a PNG, JPEG, WebP, BMP or TGA image: the color factor alone is used"}};
  for (const auto& [bytes, said] : cases) {
    const SourceModel model = import(plain(), R"("textures":[{"source":0}],)" + images({dataUri(bytes)}));
    ASSERT_EQ(model.notices.size(), 1u) << said;
    EXPECT_TRUE(contains(model.notices[0], said)) << model.notices[0];
    EXPECT_TRUE(model.images.empty());
  }
}

TEST_F(Textured, PicturesOnTheNetCanNotBeHad) {
  const SourceModel model = import(plain(), R"("textures":[{"source":0}],)" + images({"http://a/b.png"}));
  EXPECT_TRUE(model.images.empty());
  ASSERT_EQ(model.notices.size(), 1u);
  EXPECT_TRUE(contains(model.notices[0], "images[0]: reference 'http://a/b.png'") &&
              contains(model.notices[0], "the color factor alone is used"));
}

}  // namespace
}  // namespace kelp::bake::test
