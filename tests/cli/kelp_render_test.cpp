// SPDX-License-Identifier: MIT
// kelp-render as a user runs it: pictures that show what they should, and mistakes that are explained.
#include <algorithm>
#include <fstream>

#include "render_fixture.h"
#include "support/distance_pack.h"
#include "support/fog_pack.h"

namespace kelp {
namespace {

using namespace test;

TEST_F(KelpRender, ShowsTheModelUprightAndInItsColors) {
  const Picture p = picture();
  ASSERT_EQ(p.width, 120);
  ASSERT_EQ(p.height, 120);
  // The box is half as wide as high and fills most of the height.
  EXPECT_FALSE(p.covered(5, 60));
  EXPECT_FALSE(p.covered(60, 2));
  EXPECT_TRUE(p.covered(60, 12));
  EXPECT_TRUE(p.covered(60, 108));
  EXPECT_NEAR(p.middle(0, 120), 59.5, 1.0);
  const auto strongest = [&](int x, int y) {
    const glm::ivec4 c = p.at(x, y);
    return c.r > 2 * c.g && c.r > 2 * c.b   ? 'r'
           : c.g > 2 * c.r && c.g > 2 * c.b ? 'g'
           : c.b > 2 * c.r && c.b > 2 * c.g ? 'b'
                                            : '?';
  };
  EXPECT_EQ(strongest(45, 30), 'r');
  EXPECT_EQ(strongest(45, 90), 'g');
  EXPECT_EQ(strongest(78, 30), 'b');
  EXPECT_EQ(strongest(78, 90), 'b');
}

TEST_F(KelpRender, YawShowsTheRightSideAndPitchTheTop) {
  const Picture side = picture({"--yaw", "90"});
  EXPECT_GT(side.at(60, 60).b, 2 * side.at(60, 60).r);  // all of the +x face is blue
  EXPECT_GT(side.at(50, 30).b, 2 * side.at(50, 30).r);
  const Picture top = picture({"--pitch", "90", "--view", "normals"});
  EXPECT_NEAR(top.at(60, 60).g, 255, 2);
}

TEST_F(KelpRender, BendsByTangentsAndOffsets) {
  const double straight = picture().middle(10, 40);
  EXPECT_NEAR(straight, picture().middle(80, 110), 1.0);
  const Picture moved = picture({"--offset", "1=0.5,0,0"});
  EXPECT_GT(moved.middle(10, 40), moved.middle(80, 110) + 15);
  // A tangent of (1.5, 1, 0) at the lower end bulges to the right and comes back.
  const Picture bulged = picture({"--tangent", "0=1.5,1,0"});
  EXPECT_GT(bulged.middle(60, 100), bulged.middle(8, 20) + 5);
  EXPECT_GT(bulged.middle(60, 100), bulged.middle(100, 112) + 2);
}

TEST_F(KelpRender, ViewsShowWhatTheySay) {
  const glm::ivec4 normal = picture({"--view", "normals"}).at(60, 60);
  EXPECT_NEAR(normal.r, 128, 2);
  EXPECT_NEAR(normal.g, 128, 2);
  EXPECT_NEAR(normal.b, 255, 2);
  const Picture depth = picture({"--view", "depth", "--pitch", "45"});
  EXPECT_GT(depth.at(60, 30).r, depth.at(60, 100).r);  // the top's near edge against the foot of the front
  const glm::ivec4 steps = picture({"--view", "steps"}).at(60, 60);
  EXPECT_GT(steps.b, steps.r);  // few steps
  EXPECT_NE(picture({"--view", "level", "--level", "0"}).at(60, 60),
            picture({"--view", "level", "--level", "2"}).at(60, 60));
}

fields::Occupancy boxVolume() { return {{24, 48, 16}, std::vector<std::uint8_t>(24 * 48 * 16, 1)}; }

long sumOf(const Picture& p) {
  long all = 0;
  for (int y = 0; y < p.height; ++y) {
    for (int x = 0; x < p.width; ++x) all += p.at(x, y).r + p.at(x, y).g + p.at(x, y).b;
  }
  return all;
}

// Through the middle of the box: orange inside, blue outside, the surface black, a contour for each 32nd of
// the height.
TEST_F(KelpRender, DistancesAreShownOnASlice) {
  RawPack pack = boxPack();
  pack.parts[0].distances = distancesOf(boxVolume(), static_cast<int>(pack.parts[0].levels.size()));
  const std::string without = folder_ / "without.kelp";
  std::filesystem::rename(pack_, without);
  write(pack_, bytesOf(pack));
  const std::vector<std::string> options = {"--view", "distance", "--size", "512x512", "--samples", "1"};
  std::vector<std::string> caged = options;
  caged.insert(caged.end(), {"--bend", "cage"});
  const Picture slice = picture(options), in_cage = picture(caged);
  int apart = 0;
  for (int i = 0; i < 512 * 512; ++i) {
    const glm::ivec4 off = glm::abs(slice.at(i % 512, i / 512) - in_cage.at(i % 512, i / 512));
    apart += std::max({off.r, off.g, off.b}) > 40;
  }
  EXPECT_LT(apart, 512 * 512 / 20) << "contours, and the middle of the box, may differ";
  const glm::ivec4 inside = slice.at(256, 256), outside = slice.at(8, 256);
  EXPECT_GT(inside.r, inside.b + 50);
  EXPECT_GT(outside.b, outside.r + 50);
  int edge = 256, contours = 0;
  while (edge > 8 && slice.at(edge, 256).r > 60) --edge;
  const glm::ivec4 surface = slice.at(edge, 256);
  EXPECT_LT(surface.r + surface.g + surface.b, 180);
  bool on_line = true;
  for (int x = edge - 6; x > edge - 6 - 4 * 16; --x) {
    const bool dark = slice.at(x, 256).g < 0.75 * slice.at(x - 5, 256).g ||
                      slice.at(x, 256).g < 0.75 * slice.at(x + 5, 256).g;
    contours += dark && !on_line;
    on_line = dark;
  }
  EXPECT_NEAR(contours, 4, 1);
  const ProcessResult refused = render({without, "-o", out_, "--view", "distance"});
  EXPECT_EQ(refused.exit, 5);
  EXPECT_NE(refused.err.find("--no-distance"), std::string::npos) << refused.err;
  write(without, bytesOf(fogPack(fogOf(glm::ivec3(8), puffs), 1)));
  const ProcessResult of_fog = render({without, "-o", out_, "--view", "distance"});
  EXPECT_EQ(of_fog.exit, 5);
  EXPECT_EQ(of_fog.err.find("--no-distance"), std::string::npos) << of_fog.err;
  EXPECT_NE(of_fog.err.find("is fog"), std::string::npos) << of_fog.err;
  EXPECT_EQ(render({pack_, "-o", out_, "--view", "distance", "--method", "paper"}).exit, 1);
}

TEST_F(KelpRender, ShadingIsWhatWasAsked) {
  // The border between red and blue, at x = 16 of 24: from pixel to pixel, or over some voxels.
  const auto reds = [&](const std::vector<std::string>& shading) {
    std::vector<std::string> arguments = {"--samples", "1", "--level", "0"};
    arguments.insert(arguments.end(), shading.begin(), shading.end());
    const Picture p = picture(arguments);
    int between = 0;
    for (int x = 45; x < 85; ++x) between += p.at(x, 30).r > 60 && p.at(x, 30).b > 60;
    return between;
  };
  EXPECT_EQ(reds({}), 0);
  EXPECT_EQ(reds({"--shading", "gradient"}), 0);
  EXPECT_EQ(reds({"--shading", "faces"}), 0);
  EXPECT_GE(reds({"--shading", "smooth"}), 2);
  // From above: the stored normals of the front row look to the front, its faces up.
  const auto frontRow = [&](const std::string& shading) {
    const Picture p = picture({"--view", "normals", "--pitch", "90", "--samples", "1", "--shading", shading});
    int y = 119;
    while (y > 0 && !p.covered(60, y)) --y;
    return p.at(60, y - 1);
  };
  EXPECT_EQ(frontRow("gradient").b, 255);
  EXPECT_EQ(frontRow("faces").g, 255);
}

TEST_F(KelpRender, ShadowsAndOcclusionAreSwitches) {
  const std::vector<std::string> bent = {"--tangent", "0=2,1,0", "--tangent", "1=-2,1,0"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), bent.begin(), bent.end());
    return sumOf(picture(more));
  };
  const long plain = with({"--shadows", "off"});
  EXPECT_LT(with({}), plain);
  EXPECT_EQ(with({"--shadows", "on"}), with({}));
  EXPECT_LT(with({"--occlusion", "8"}), with({}));
}

// A box with a groove across its front shades itself about as much by distances as by rays.
TEST_F(KelpRender, ShadowsAndOcclusionMayComeFromDistances) {
  const std::string without = folder_ / "without.kelp";
  std::filesystem::copy_file(pack_, without);
  fields::Occupancy grooved = boxVolume();
  glm::ivec3 v;
  for (v.z = 6; v.z < 16; ++v.z)
    for (v.y = 16; v.y < 32; ++v.y)
      for (v.x = 0; v.x < 24; ++v.x) grooved.solid[grooved.index(v)] = 0;
  write(pack_, bytesOf(distancePackOf(grooved)));
  for (const char* const bend : {"shear", "cage"}) {
    SCOPED_TRACE(bend);
    const auto with = [&](std::vector<std::string> options) {
      options.insert(options.end(), {"--bend", bend});
      return sumOf(picture(options));
    };
    const long plain = with({"--shadows", "off"});
    const long hard = plain - with({}), soft = plain - with({"--soft-shadows", "1"});
    EXPECT_GT(hard, 0);
    EXPECT_GT(soft, hard / 2);
    EXPECT_LT(soft, hard * 2);
    EXPECT_NE(with({"--soft-shadows", "8"}), with({"--soft-shadows", "1"}));
    EXPECT_EQ(with({"--soft-shadows", "0"}), with({}));
    const long rays = plain - with({"--shadows", "off", "--occlusion", "16"});
    const long distances = plain - with({"--shadows", "off", "--occlusion", "distances"});
    EXPECT_GT(distances, rays / 2);
    EXPECT_LT(distances, rays * 2);
    EXPECT_LT(with({"--soft-shadows", "1", "--occlusion", "distances"}), plain - soft);
  }

  for (const std::vector<std::string>& option : {std::vector<std::string>{"--soft-shadows", "1"},
                                                 std::vector<std::string>{"--occlusion", "distances"}}) {
    std::vector<std::string> arguments = {without, "-o", out_};
    arguments.insert(arguments.end(), option.begin(), option.end());
    const ProcessResult refused = render(arguments);
    EXPECT_EQ(refused.exit, 5);
    EXPECT_NE(refused.err.find("--no-distance"), std::string::npos) << refused.err;
    arguments.insert(arguments.end(), {"--method", "paper"});
    EXPECT_EQ(render(arguments).exit, 1);
  }
}

// The box is 0.5 m wide and 1 m high.
TEST_F(KelpRender, SeveralPacksStandWhereTheyWereToldTo) {
  const std::vector<std::string> wide = {"--size", "240x120"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), wide.begin(), wide.end());
    return picture(more);
  };
  // One half a meter to the left, one half a meter to the right of the middle, a gap of half a meter between
  // them.
  const Picture two = with({"--at", "-0.5,0,0", "--and", pack_, "--at=0.5,0,0"});
  EXPECT_FALSE(two.covered(120, 60));
  const auto edges = [](const Picture& p, int y) {
    std::vector<int> at;
    for (int x = 1; x < p.width; ++x) {
      if (p.covered(x, y) != p.covered(x - 1, y)) at.push_back(x);
    }
    return at;
  };
  const std::vector<int> both = edges(two, 60);
  ASSERT_EQ(both.size(), 4u);
  EXPECT_NEAR(both[1] - both[0], both[3] - both[2], 2);
  EXPECT_NEAR(both[2] - both[1], both[1] - both[0], 0.3 * (both[1] - both[0]));  // the near faces look larger
  // Each has its own pose, clip and time; what is nearer hides what is behind.
  const Picture posed =
      with({"--at", "-0.8,0,0", "--and", pack_, "--at=0.8,0,0", "--clip", "lean", "--time", "0.5"});
  ASSERT_EQ(edges(posed, 100).size(), 4u);
  EXPECT_EQ(edges(posed, 30).size(), 4u);
  EXPECT_NEAR(edges(posed, 30)[0], edges(posed, 100)[0], 3);
  EXPECT_GT(edges(posed, 30)[2], edges(posed, 100)[2] + 5);
  const glm::ivec4 front =
      picture({"--turn", "90", "--at", "0,0,1", "--and", pack_, "--at", "0,0,-1", "--scale", "0.5"})
          .at(60, 60);
  const glm::ivec4 alone = picture({"--yaw", "-90"}).at(60, 60);
  // turned to the left, its left side, which is not blue, is in front
  EXPECT_EQ(front.g > 2 * front.b, alone.g > 2 * alone.b);
  // Half as large in every direction.
  const Picture scaled = with({"--at", "-0.5,0,0", "--and", pack_, "--at=0.5,0,0", "--scale", "0.5"});
  int left = 0, right = 0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 240; ++x) (x < 120 ? left : right) += scaled.covered(x, y);
  }
  EXPECT_NEAR(static_cast<double>(left) / right, 4, 0.6);
}

TEST_F(KelpRender, BackgroundsAreWhatWasAsked) {
  EXPECT_EQ(picture().at(0, 0), glm::ivec4(0));
  const Picture gradient = picture({"--background", "200,0,0:0,0,200"});
  EXPECT_GT(gradient.at(0, 0).r, 190);
  EXPECT_GT(gradient.at(0, 119).b, 190);
  EXPECT_EQ(picture({"--background", "10,200,30"}).at(0, 0), glm::ivec4(10, 200, 30, 255));
}

TEST_F(KelpRender, ClipsAndTurntablesGiveFrames) {
  picture({"--clip", "lean", "--frames", "4"});
  EXPECT_FALSE(std::filesystem::exists(out_));
  double middle[4];
  for (int i = 0; i < 4; ++i)
    middle[i] = Picture(folder_ / ("out_000" + std::to_string(i + 1) + ".png")).middle(8, 30);
  EXPECT_GT(middle[1], middle[0] + 10);  // a quarter of the wave: right
  EXPECT_NEAR(middle[2], middle[0], 2);
  EXPECT_LT(middle[3], middle[0] - 10);
  EXPECT_GT(picture({"--clip", "lean", "--time", "0.5"}).middle(8, 30), middle[0] + 10);

  picture({"--frames", "2"});
  const Picture front(folder_ / "out_0001.png"), back(folder_ / "out_0002.png");
  EXPECT_GT(front.at(78, 30).b, 2 * front.at(78, 30).r);
  EXPECT_GT(back.at(42, 30).b, 2 * back.at(42, 30).r);  // from behind, right is left
}

TEST_F(KelpRender, SaysTheSameTwice) {
  picture();
  const std::string first = readWhole(out_);
  picture();
  EXPECT_EQ(readWhole(out_), first);
}

TEST_F(KelpRender, DrawsTheSameWithOpenGlEs) {
  const Picture desktop = picture({"--view", "shaded"});
  // Mesa then refuses a context of OpenGL 3.3.
  const ProcessResult result =
      runProcess({"env", "MESA_GL_VERSION_OVERRIDE=3.2", KELP_RENDER, pack_, "-o", out_, "--size", "120x120",
                  "--yaw", "0", "--pitch", "0", "--background", "none"});
  ASSERT_EQ(result.exit, 0) << result.err;
  const Picture embedded(out_);
  ASSERT_EQ(embedded.rgba.size(), desktop.rgba.size());
  int different = 0;
  for (std::size_t i = 0; i < desktop.rgba.size(); ++i)
    different += std::abs(embedded.rgba[i] - desktop.rgba[i]) > 2;
  EXPECT_LE(different, 20);
}

TEST_F(KelpRender, ExplainsMistakesInOneLineAndLeavesTheOutputAlone) {
  const std::vector<std::byte> bytes = bytesOf(boxPack());
  const std::string cut = folder_ / "cut.kelp", flipped = folder_ / "flipped.kelp",
                    text = folder_ / "text.kelp", newer = folder_ / "newer.kelp";
  write(cut, std::span(bytes).first(bytes.size() / 2));
  std::vector<std::byte> damaged = bytes;
  damaged[bytes.size() - 100] ^= std::byte{1};
  write(flipped, damaged);
  damaged = bytes;
  damaged[12] = std::byte{9};  // the major version
  write(newer, damaged);
  std::ofstream(text) << "not a pack";
  const std::string named_png = folder_ / "pack.png";
  write(named_png, bytes);
  std::filesystem::create_directory(folder_ / "folder.png");
  struct Case {
    std::vector<std::string> arguments;
    int exit;
    const char* says;
  };
  const std::vector<Case> cases = {
      {{}, 1, "PACK"},
      {{pack_}, 1, "--output"},
      {{pack_, "-o", out_, "--nonsense"}, 1, "--nonsense"},
      {{pack_, "-o", folder_ / "out.jpg"}, 1, ".png"},
      {{pack_, "-o", out_, "--size", "0x10"}, 1, "--size 0x10"},
      {{pack_, "-o", out_, "--size", "100000x10"}, 1, "8192"},
      {{pack_, "-o", out_, "--samples", "3"}, 1, "samples"},
      {{pack_, "-o", out_, "--shadows", "maybe"}, 1, "shadows"},
      {{pack_, "-o", out_, "--occlusion", "2x"}, 1, "from 0 to 16, or distances"},
      {{pack_, "-o", out_, "--soft-shadows", "21"}, 1, "soft-shadows"},
      {{pack_, "-o", out_, "--soft-shadows", "1", "--shadows", "off"}, 1, "leave one"},
      {{pack_, "-o", out_, "--view", "inside"},
       1,
       "--view inside: expected shaded, normals, depth, distance, parts, steps, level, bounds, splines or "
       "cages"},
      {{pack_, "-o", out_, "--shading", "flat"}, 1, "--shading flat: expected gradient, faces or smooth"},
      {{pack_, "-o", out_, "--time", "nan"}, 1, "finite"},
      {{pack_, "-o", out_, "--background", "1,2,300"}, 1, "--background 1,2,300"},
      {{pack_, "-o", out_, "--tangent", "0=1,2"}, 1, "--tangent 0=1,2"},
      {{pack_, "-o", out_, "--time", "5"}, 1, "--clip"},
      {{pack_, "-o", out_, "--level", "4"}, 1, "levels 0 to 3; name one"},
      {{pack_, "-o", out_, "--tangent", "7=1,2,3"}, 1, "knots 0 to 1; name one"},
      {{pack_, "-o", out_, "--tangent", "tail:0=1,2,3"}, 1, "no part \"tail\". Parts: part"},
      {{pack_, "-o", out_, "--clip", "swim"}, 1, "Clips: lean"},
      {{pack_, "-o", out_, "--at", "1,2"}, 1, "--at 1,2: expected x,y,z"},
      {{pack_, "-o", out_, "--turn", "inf"}, 1, "--turn takes a finite number"},
      {{pack_, "-o", out_, "--scale", "0"}, 1, "--scale takes a number from"},
      {{pack_, "-o", out_, "--and"}, 1, "PACK is required"},
      {{pack_, "-o", out_, "--and", pack_, "--size", "9x9"}, 1, "--size"},
      {{pack_, "-o", out_, "--and", folder_ / "none.kelp"}, 2, "none.kelp: cannot be opened"},
      {{named_png, "-o", named_png}, 1, "would overwrite"},
      {{pack_, "-o", folder_ / "folder.png"}, 2, "is a folder"},
      {{folder_ / "none.kelp", "-o", out_}, 2, "No such file"},
      {{folder_ / ".", "-o", out_}, 2, "cannot be opened"},
      {{pack_, "-o", folder_ / "no/such/folder/out.png"}, 2, "folder"},
      {{cut, "-o", out_}, 3, "cut.kelp"},
      {{flipped, "-o", out_}, 3, "checksum"},
      {{text, "-o", out_}, 3, "not a .kelp pack"},
      {{newer, "-o", out_}, 5, "newer"},
      {{pack_, "-o", out_, "--tangent", "part:0=0,-2,0"}, 3, "between knots 0 and 1"},
      {{pack_, "-o", out_, "--offset", "1=0,-2,0"}, 3, "turns back"},
  };
  std::ofstream(out_) << "precious";
  for (const Case& c : cases) {
    const ProcessResult result = render(c.arguments);
    std::string line;
    for (const std::string& argument : c.arguments) line += argument + " ";
    EXPECT_EQ(result.exit, c.exit) << line << "\n" << result.err;
    EXPECT_NE(result.err.find(c.says), std::string::npos) << line << "\n" << result.err;
    EXPECT_EQ(result.err.rfind("kelp-render: ", 0), 0u) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_EQ(result.out, "") << line;
    EXPECT_EQ(readWhole(out_), "precious") << line;
  }
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(out_).parent_path()))
    files += entry.is_regular_file();
  EXPECT_EQ(files, 7) << "a temporary file was left behind";
  EXPECT_EQ(readWhole(named_png), std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

TEST_F(KelpRender, WithoutAnEglDeviceSaysWhatToInstall) {
  // glvnd finds no vendor, so EGL has no display.
  const ProcessResult result =
      runProcess({"env", "__EGL_VENDOR_LIBRARY_FILENAMES=/dev/null", KELP_RENDER, pack_, "-o", out_});
  EXPECT_EQ(result.exit, 4) << result.err;
  EXPECT_NE(result.err.find("install libegl1 libgl1-mesa-dri"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace kelp
