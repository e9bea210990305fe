// SPDX-License-Identifier: MIT
// kelp-render --method: the paper's method as published beside kelp's own.
#include <cstdio>

#include "render_fixture.h"
#include "support/fog_pack.h"

namespace kelp {
namespace {

using namespace test;

struct Said {
  char method[16] = "";
  double steps = 0, milliseconds = 0;
  int characters = 0;

  explicit Said(const std::string& line) {
    const int fields =
        std::sscanf(line.c_str(), "method %15[^:]: %lf steps per ray that meets the box, %lf ms a frame\n%n",
                    method, &steps, &milliseconds, &characters);
    EXPECT_EQ(fields, 3) << line;
    EXPECT_EQ(static_cast<std::size_t>(characters), line.size()) << line;
  }
};

struct Difference {
  double mean = 0;   // of the channel that differs most, over all pixels
  double share = 0;  // of the pixels that differ by more than 24
  double cover = 0;  // of the pixels that are covered in one picture only
};
Difference differ(const Picture& a, const Picture& b) {
  Difference d;
  EXPECT_EQ(a.rgba.size(), b.rgba.size());
  const double pixels = a.width * a.height;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const glm::ivec4 apart = glm::abs(a.at(x, y) - b.at(x, y));
      const int most = std::max({apart.r, apart.g, apart.b, apart.a});
      d.mean += most / pixels;
      d.share += (most > 24) / pixels;
      d.cover += (a.covered(x, y) != b.covered(x, y)) / pixels;
    }
  }
  return d;
}

class KelpRenderMethod : public KelpRender {
 protected:
  // The picture by a method, at level 0.
  Picture by(const std::string& method, std::vector<std::string> more = {}) {
    more.insert(more.end(), {"--level", "0", "--method", method});
    const Said said_(said(more));
    EXPECT_EQ(said_.method, method);
    EXPECT_GT(said_.steps, 0);
    EXPECT_GT(said_.milliseconds, 0);
    steps_ = said_.steps;
    return Picture(out_);
  }
  double steps_ = 0;  // of the last picture
};

TEST_F(KelpRenderMethod, PaperAtRestShowsWhatKelpShows) {
  const Picture kelp = by("kelp"), standard = by("paper"), df = by("paper-df");
  EXPECT_LT(differ(kelp, standard).mean, 0.5);
  EXPECT_LT(differ(kelp, standard).share, 0.005);
  EXPECT_LT(differ(kelp, df).mean, 1.5);
  EXPECT_LT(differ(kelp, df).share, 0.02);
  // The views are the same too, in the methods' own numbers.
  for (const char* const view : {"normals", "depth"}) {
    const Difference d = differ(by("kelp", {"--view", view}), by("paper", {"--view", view}));
    EXPECT_LT(d.mean, 1.0) << view;
    EXPECT_LT(d.share, 0.01) << view;
  }
}

TEST_F(KelpRenderMethod, PaperBendsAsKelpDoes) {
  // Three knots: the paper's volume twice, one above the other. Balls have surfaces in all directions.
  const glm::ivec3 size(36, 48, 36);
  std::vector<Knot> knots;
  for (const float at : {0.0f, 0.4f, 1.0f}) knots.push_back({at, {0, at, 0}, {0, 1, 0}});
  write(pack_, bytesOf(packOf(ballClump(size, 10, 4), knots)));
  const std::vector<std::string> bent = {"--offset",     "1=0.3,0.1,0.1", "--tangent",
                                         "2=-0.5,1,0.3", "--yaw",         "30"};
  const Picture kelp = by("kelp", bent);
  const double kelp_steps = steps_;
  const Picture standard = by("paper", bent);
  const double standard_steps = steps_;
  const Picture df = by("paper-df", bent);
  EXPECT_LT(differ(kelp, standard).cover, 0.005);
  EXPECT_LT(differ(kelp, standard).mean, 4);
  EXPECT_LT(differ(kelp, df).cover, 0.02);
  // A step of 0.001 against steps as far as the distance field lets them.
  EXPECT_GT(standard_steps, 20 * steps_);
  EXPECT_GT(standard_steps, 20 * kelp_steps);
  // The bend is in the picture.
  EXPECT_GT(differ(kelp, by("kelp", {"--yaw", "30"})).cover, 0.05);
}

TEST_F(KelpRenderMethod, PaperDrawsClipsAndSeveralPacks) {
  const std::vector<std::string> pond = {"--method", "paper-df", "--size", "160x80",       "--at",
                                         "-0.6,0,0", "--and",    pack_,    "--at=0.6,0,0", "--clip",
                                         "lean",     "--time",   "0.5",    "--scale",      "0.8"};
  const Said paper(said(pond));
  const Picture by_paper(out_);
  std::vector<std::string> own = pond;
  own[1] = "kelp";
  const Said kelp(said(own));
  const Difference d = differ(Picture(out_), by_paper);
  EXPECT_LT(d.cover, 0.02);
  EXPECT_LT(d.mean, 2.5);
  EXPECT_EQ(kelp.method, std::string("kelp"));

  const Said frames(said({"--method", "paper", "--clip", "lean", "--frames", "2", "--samples", "1"}));
  EXPECT_GE(frames.steps, 1);
  EXPECT_TRUE(Picture(folder_ / "out_0002.png").covered(60, 60));
}

TEST_F(KelpRenderMethod, PaperNeedsNoMoreThanOpenGlEs) {
  const Picture desktop = by("paper-df");
  const ProcessResult result =
      runProcess({"env", "MESA_GL_VERSION_OVERRIDE=3.2", KELP_RENDER, pack_, "-o", out_, "--size", "120x120",
                  "--yaw", "0", "--pitch", "0", "--background", "none", "--method", "paper-df"});
  ASSERT_EQ(result.exit, 0) << result.err;
  EXPECT_LT(differ(desktop, Picture(out_)).share, 0.005);
  EXPECT_GT(Said(result.out).steps, 0);
}

TEST_F(KelpRenderMethod, RefusesWhatCannotBeDrawnAsPublished) {
  const std::string fog = folder_ / "fog.kelp";
  write(fog, bytesOf(fogPack(fogOf({16, 16, 16}, [](const glm::dvec3&) { return 1.0; }), 0.1f)));
  struct Case {
    std::vector<std::string> arguments;
    int exit;
    const char* says;
  };
  const std::vector<Case> cases = {
      {{pack_, "--method", "newton"}, 1, "--method newton: expected kelp, paper or paper-df"},
      {{pack_, "--method", "paper", "--level", "1"}, 1, "--level 1: --method paper draws level 0 only"},
      {{pack_, "--method", "paper-df", "--shading", "faces"}, 1, "--method paper-df has one normal"},
      {{fog, "--method", "paper"}, 5, "fog.kelp: part part is fog"},
      {{pack_, "--method", "paper-df", "--and", fog}, 5, "use --method kelp"},
  };
  for (const Case& c : cases) {
    std::vector<std::string> arguments = c.arguments;
    arguments.insert(arguments.begin() + 1, {"-o", out_});
    const ProcessResult result = render(arguments);
    EXPECT_EQ(result.exit, c.exit) << c.says << "\n" << result.err;
    EXPECT_NE(result.err.find(c.says), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_FALSE(std::filesystem::exists(out_));
  }
  EXPECT_EQ(Said(said({"--method", "kelp", "--and", fog})).method, std::string("kelp"));
}

TEST_F(KelpRenderMethod, RefusesPartsThatAreTooLargeForATexture) {
  const int height = 8192;
  fields::Occupancy volume{{8, height, 8}, std::vector<std::uint8_t>(64 * height, 0)};
  for (int x = 0; x < 8; ++x) volume.solid[volume.index({x, height / 2, 4})] = 1;
  write(pack_, bytesOf(packOf(volume)));
  const ProcessResult result = render({pack_, "-o", out_, "--size", "32x32", "--method", "paper-df"});
  if (result.exit == 0) GTEST_SKIP() << "this OpenGL has 3D textures of 8192 voxels along a side";
  EXPECT_EQ(result.exit, 5) << result.err;
  EXPECT_NE(result.err.find("a dense 3D texture has at most"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(out_));
  EXPECT_EQ(render({pack_, "-o", out_, "--size", "32x32", "--method", "kelp"}).exit, 0);
}

}  // namespace
}  // namespace kelp
