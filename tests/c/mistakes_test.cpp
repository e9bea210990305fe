// SPDX-License-Identifier: MIT
// Long: the rows of a table.
// Makes each mistake of runtime/MISTAKES.md, row by row, and compares what is answered with the table.
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <regex>
#include <set>
#include <thread>

#include "../gl/canvas.h"
#include "both.h"
#include "support/fog_pack.h"

namespace kelp::test {
namespace {

using runtime::Asset;
using runtime::Instance;
using runtime::Pose;

// The words that name an answer in the table: error codes, fields of gl::Stats, "log".
constexpr const char* kCodes[] = {
    "",           "kMisuse",   "kIo",      "kNotAPack", "kUnsupportedVersion", "kUnsupportedFeature",
    "kTruncated", "kChecksum", "kCorrupt", "kLimit",    "kOutOfMemory",        "kNotMonotone",
    "kFolds",     "kGraphics", "kNotYet"};
constexpr const char* kOthers[] = {"culled",  "too_small",  "waiting",
                                   "pending", "other_kind", "left_out",
                                   "clamped", "log",        "KELP_ERROR_WRONG_THREAD"};
using Words = std::set<std::string>;

// All that was answered to a mistake.
struct Answers {
  Words words;
  std::string text;
  bool names_instance = false;  // the second one of the list
  std::string shown_by;         // the test that makes this mistake, which one program cannot

  void add(const Error& error) {
    words.insert(kCodes[static_cast<std::size_t>(error.code)]);
    text += error.detail;
    if (error.unit == Error::Unit::kInstance) names_instance = error.offset == 1;
  }
  template <class T>
  void add(const Result<T>& result) {
    if (!result) add(result.error());
  }
  void add(const Result<gl::Stats>& result) {
    if (!result) return add(result.error());
    const std::pair<std::uint32_t, const char*> numbers[] = {
        {result->culled, "culled"},         {result->too_small, "too_small"}, {result->waiting, "waiting"},
        {result->pending, "pending"},       {result->left_out, "left_out"},   {result->clamped, "clamped"},
        {result->other_kind, "other_kind"},
    };
    for (const auto& [number, name] : numbers)
      if (number > 0) words.insert(name);
    EXPECT_TRUE(result->left_out == 0 || result->first_left_out.offset == 1u);
  }
};
template <class... T>
Answers answersOf(const T&... results) {
  Answers out;
  (out.add(results), ...);
  return out;
}
Answers shownBy(const char* test) {
  Answers out;
  out.shown_by = test;
  EXPECT_TRUE(std::filesystem::exists(std::string(KELP_SOURCE_DIR "/") + test)) << test;
  return out;
}

struct Row {
  const char* mistake;
  std::function<Answers()> answers;
};

// What a host has: an asset on the GPU, two instances of it in view, of which it spoils the second.
struct Host {
  static inline std::string said;
  static gl::RendererOptions options() {
    said.clear();
    gl::RendererOptions out;
    out.getProcAddress = EglContext::getProcAddress;
    out.gpu_budget = 1 << 20;
    out.log = [](void*, const char* text) { said += text; };
    return out;
  }
  static RawPack fox() { return packOf(ballClump({24, 32, 20}, 12, 3)); }
  static std::string foxFile() {
    static const Scratch scratch;
    static const auto bytes = bytesOf(fox());
    static const std::string path = scratch.write("fox.kelp", std::span<const std::byte>(bytes)).string();
    return path;
  }

  explicit Host(bool pumps = true, bool uploads = true)
      : Host(Asset::open(foxFile().c_str()), pumps, uploads) {}
  Host(Result<std::unique_ptr<Asset>> opened, bool pumps, bool uploads) : asset(std::move(opened).value()) {
    if (pumps) asset->loadAll().value();
    renderer->add(*asset).value();
    if (uploads) renderer->upload(1 << 20).value();
    pose = Pose::create(*asset).value();
    instances[0] = instances[1] = {.asset = asset.get()};
    instances[1].pose = &pose;
    view = lookAt({64, 48}, {0, 1, 4}, {0, 0.5f, 0});
  }
  Answers draw() {
    Answers out = answersOf(renderer->draw(view, instances, pass));
    out.text += said;
    if (!said.empty()) out.words.insert("log");
    return out;
  }

  std::unique_ptr<Asset> asset;
  std::unique_ptr<gl::Renderer> renderer = std::move(gl::Renderer::create(options())).value();
  Pose pose;
  Instance instances[2];
  gl::View view;
  gl::Pass pass = gl::Pass::kColor;
};
// Draws after a change of the host.
std::function<Answers()> drawn(const std::function<void(Host&)>& spoil) {
  return [spoil] {
    Host host;
    spoil(host);
    return host.draw();
  };
}
Answers create(const std::function<void(gl::RendererOptions&)>& spoil) {
  gl::RendererOptions options = Host::options();
  spoil(options);
  Answers out = answersOf(gl::Renderer::create(options));
  out.text += Host::said;
  if (!Host::said.empty()) out.words.insert("log");
  return out;
}

// A pack whose bytes the test changes, or that arrive late.
struct Bytes {
  std::vector<std::byte> bytes = bytesOf(Host::fox());
  Read answer = Read::kDone;

  Source source() {
    return {[](void* user, std::uint64_t offset, std::span<std::byte> out) {
              const Bytes& self = *static_cast<Bytes*>(user);
              std::copy_n(self.bytes.begin() + static_cast<std::ptrdiff_t>(offset), out.size(), out.begin());
              return self.answer;
            },
            this, bytes.size(), nullptr, nullptr};
  }
  Answers open(const runtime::AssetOptions& options = {}) {
    return answersOf(Asset::open(source(), options));
  }
};
// The first error of pump(), which is answered once.
Answers pump(Asset& asset) {
  Answers out;
  int errors = 0;
  for (Result<bool> more = true; !more || *more;) {
    more = asset.pump();
    errors += !more;
    out.add(more);
  }
  EXPECT_EQ(errors, 1);
  return out;
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::vector<Row> building() {
  const auto layouts = [] { return shownBy("tests/runtime/glm_layouts_test.py"); };
  return {{"GLM with `GLM_FORCE_QUAT_DATA_WXYZ`", layouts},
          {"GLM with `GLM_FORCE_QUAT_CTOR_XYZW` or `_DATA_XYZW`", layouts},
          {"GLM with `GLM_FORCE_DEFAULT_ALIGNED_GENTYPES` where it aligns", layouts},
          {"a result of kelp is ignored", layouts}};
}

std::vector<Row> opening() {
  return {
      {"a file that is not there, or may not be read",
       [] {
         const Scratch scratch;
         return answersOf(Asset::open((scratch / "absent.kelp").c_str()));
       }},
      {"a folder or a pipe as a file",
       [] {
         const Scratch scratch;
         const std::string pipe = scratch / "pipe";
         EXPECT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
         return answersOf(Asset::open(scratch.folder().c_str()), Asset::open(pipe.c_str()));
       }},
      {"the path is null", [] { return answersOf(Asset::open(static_cast<const char*>(nullptr))); }},
      {"a file that is no pack", [] { return Bytes{std::vector<std::byte>(1000, std::byte{'x'})}.open(); }},
      {"a pack of another major version",
       [] {
         Bytes pack;
         pack.bytes[12] = std::byte{2};
         return pack.open();
       }},
      {"a pack that was copied in part",
       [] {
         Bytes pack;
         pack.bytes.resize(pack.bytes.size() / 2);
         return pack.open();
       }},
      {"a pack with a wrong byte",
       [] {
         Bytes pack;
         const auto asset = std::move(Asset::open(pack.source())).value();
         const int levels = asset->pack().parts()[0].levels;
         // The finest level comes last.
         while (asset->residentLevel(0) != 1) asset->pump().value();
         for (std::byte& byte : pack.bytes) byte ^= std::byte{1};
         Answers out = pump(*asset);
         EXPECT_EQ(asset->residentLevel(0), 1) << levels;
         return out;
       }},
      {"a pack beyond `PackLimits`",
       [] {
         runtime::AssetOptions options;
         options.limits.max_side = 8;
         return Bytes{}.open(options);
       }},
      {"`memory_budget` too small",
       [] {
         Bytes pack;
         runtime::AssetOptions options;
         options.memory_budget = 100;
         const auto asset = std::move(Asset::open(pack.source(), options)).value();
         return answersOf(asset->loadAll());
       }},
      {"a source that fails",
       [] {
         Bytes pack;
         const auto asset = std::move(Asset::open(pack.source())).value();
         pack.answer = Read::kFailed;
         Answers out = pump(*asset);
         pack.answer = Read::kDone;
         EXPECT_FALSE(asset->pump().value());
         asset->retry();
         EXPECT_TRUE(asset->pump().value());
         return out;
       }},
      {"a source that has nothing yet",
       [] {
         Bytes pack;
         pack.answer = Read::kNotYet;
         Answers out = pack.open();
         pack.answer = Read::kDone;
         Host host(Asset::open(pack.source()), false, false);
         pack.answer = Read::kNotYet;
         out.add(host.asset->loadAll());
         out.add(host.renderer->upload(1 << 20));
         out.add(host.renderer->draw(host.view, host.instances));
         return out;
       }},
      {"`distance_level` below 0",
       [] {
         runtime::AssetOptions options;
         options.distance_level = -1;
         return Bytes{}.open(options);
       }},
      {"queries of distances without `distance_level`",
       [] {
         const auto asset = std::move(Asset::open(packFile("distance").c_str())).value();
         const Host without;
         return answersOf(runtime::distance(Instance{.asset = asset.get()}, {0, 0, 0}),
                          runtime::distance(without.instances[0], {0, 0, 0}));
       }},
  };
}

// An asset with clips, sockets and two parts, and poses of it.
struct Named {
  std::unique_ptr<Asset> asset = std::move(Asset::open(packFile("solid").c_str())).value();
  Pose pose = Pose::create(*asset).value(), other = Pose::create(*asset).value();
  Instance instance{.asset = asset.get(), .pose = &pose};
};

std::vector<Row> names() {
  // The answer, if its text lists the names.
  const auto listed = [](const Result<int>& found, const char* name) {
    EXPECT_NE(std::string(found.error().detail).find(name), std::string::npos) << found.error().detail;
    return answersOf(found);
  };
  return {
      {"a clip that is not in the pack",
       [=] { return listed(runtime::findClip(*Named().asset, "nothing"), "sway"); }},
      {"a part or joint that is not in the pack",
       [=] {
         const Answers out = listed(runtime::findPart(*Named().asset, "nothing"), "stem");
         EXPECT_EQ(answersOf(runtime::findJoint(*Named().asset, "nothing")).words, out.words);
         return out;
       }},
      {"a socket that is not in the pack",
       [=] { return listed(runtime::findSocket(*Named().asset, "nothing"), "tip"); }},
      {"an index of a part, knot, clip or socket that does not exist",
       [] {
         Named of;
         EXPECT_EQ(of.pose.motion(99), nullptr);
         return answersOf(runtime::partToWorld(of.instance, 99), of.pose.move(0, 99, {}),
                          runtime::addClip(*of.asset, 99, 0, 1, of.pose),
                          runtime::socketToWorld(of.instance, 99));
       }},
  };
}

std::vector<Row> poses() {
  return {
      {"a pose of another asset", drawn([](Host& host) {
         static const Named other;
         host.instances[1].pose = &other.pose;
       })},
      {"a pose that turns back or folds",
       [] {
         Host host;
         host.pose.move(0, 1, {0, -2, 0}).value();
         Answers out = host.draw();
         host.instances[1].unsound = runtime::Unsound::kClamp;
         out.add(host.renderer->draw(host.view, host.instances));
         return out;
       }},
      {"knots that are not finite", drawn([](Host& host) {
         host.pose.move(0, 1, {kNan, 0, 0}).value();
       })},
      {"nodes of a cage that are not finite",
       [] {
         const auto asset = std::move(Asset::open(packFile("cage").c_str())).value();
         Pose pose = Pose::create(*asset).value();
         pose.nodes(2)[0].x = kNan;
         return answersOf(pose.check());
       }},
      {"a motion that is not finite", drawn([](Host& host) { host.pose.motion(0)->translation.x = kNan; })},
      {"a clip at a time that is not finite",
       [] {
         Named of;
         return answersOf(runtime::addClip(*of.asset, 0, kNan, 1, of.pose));
       }},
      {"a weight of `blend` outside [0, 1], or a mask of wrong length",
       [] {
         Named of;
         return answersOf(of.pose.blend(of.other, 2), of.pose.blend(of.other, 1, std::vector<float>(7)));
       }},
      {"`setKnots` with another number of knots",
       [] {
         Named of;
         return answersOf(of.pose.setKnots(0, of.other.knots(0).first(2)));
       }},
      {"a motion that scales a part to nothing",
       drawn([](Host& host) { host.pose.motion(0)->scale = glm::vec3(0); })},
  };
}

const char* stringOfGl21(unsigned) { return "2.1 kelp"; }

std::vector<Row> renderers(const EglContext& context, GlApi api) {
  return {
      {"`getProcAddress` is null", [] { return create([](auto& of) { of.getProcAddress = nullptr; }); }},
      {"no context is current in `create()`",
       [] {
         Answers out;
         std::thread([&out] { out = create([](auto&) {}); }).join();
         return out;
       }},
      {"a context below OpenGL 3.3 and OpenGL ES 3.0",
       [] {
         return create([](auto& of) {
           of.getProcAddress = [](void* user, const char* name) {
             return std::string(name) == "glGetString" ? reinterpret_cast<void*>(&stringOfGl21)
                                                       : EglContext::getProcAddress(user, name);
           };
         });
       }},
      {"a `getProcAddress` that lacks functions",
       [] {
         return create([](auto& of) {
           of.getProcAddress = [](void* user, const char* name) {
             return std::string(name) == "glUseProgram" ? nullptr : EglContext::getProcAddress(user, name);
           };
         });
       }},
      {"`surface_glsl` does not compile",
       [] {
         Answers out = create([](auto& of) {
           of.surface_glsl = "vec4 kelpSurface(KelpSurface s) {\n  return s.nonsense;\n}\n";
         });
         EXPECT_NE(out.text.find(":2("), std::string::npos) << out.text;
         return out;
       }},
      {"another context is current than in `create()`",
       [&context, api] {
         Host host;
         const EglContext other(api);
         Answers out = host.draw();
         EXPECT_FALSE(host.renderer->checkDestroy());
         host.renderer.reset();
         EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
         EXPECT_TRUE(context.makeCurrent());
         return out;
       }},
      {"another thread, without the context",
       [] {
         Host host;
         Answers out;
         kelp_renderer_options options = sized<kelp_renderer_options>();
         EXPECT_KELP(KELP_OK, kelp_renderer_options_defaults(&options));
         options.get_proc_address = EglContext::getProcAddress;
         options.gpu_budget = 1 << 20;
         kelp_renderer in_c = {};
         EXPECT_KELP(KELP_OK, kelp_renderer_create(&options, &in_c));
         std::thread([&] {
           out = host.draw();
           if (kelp_renderer_upload(in_c, 0, nullptr) == KELP_ERROR_WRONG_THREAD)
             out.words.insert("KELP_ERROR_WRONG_THREAD");
         }).join();
         EXPECT_KELP(KELP_OK, kelp_renderer_destroy(in_c));
         return out;
       }},
      {"a renderer that was abandoned", drawn([](Host& host) { host.renderer->abandon(); })},
      {"`gpu_budget` too small",
       [] {
         Answers out = create([](auto& of) { of.gpu_budget = 1000; });
         RawPack pack = Host::fox();
         for (int i = 0; i < 600; ++i) {
           pack.parts.push_back(pack.parts[0]);
           pack.parts.back().name = std::to_string(i);
         }
         const LoadedAsset large(pack);
         gl::RendererOptions options = Host::options();
         options.gpu_budget = 256 << 10;
         const auto renderer = std::move(gl::Renderer::create(options)).value();
         renderer->add(*large.asset).value();
         for (int i = 0; i < 100 && out.words.size() < 2; ++i)
           if (const auto sent = renderer->upload(1 << 20); !sent) out.add(sent.error());
         return out;
       }},
      {"an asset is added twice",
       [] {
         const Host host;
         return answersOf(host.renderer->add(*host.asset));
       }},
      {"`pump()` is never called", [] { return Host(false, true).draw(); }},
      {"`upload()` is never called", [] { return Host(true, false).draw(); }},
      {"`upload()` of 1 to 4095 bytes",
       [] {
         const Host host;
         return answersOf(host.renderer->upload(1), host.renderer->upload(4095));
       }},
  };
}

std::vector<Row> drawing() {
  return {
      {"an asset that was not added, or is null",
       [] {
         Host host;
         const Named other;
         host.instances[1] = {.asset = other.asset.get()};
         Answers out = host.draw();
         host.instances[1] = {};
         out.add(host.renderer->draw(host.view, host.instances));
         return out;
       }},
      {"an asset that was destroyed before `remove()`", drawn([](Host& host) {
         auto other = std::move(Asset::open(Host::foxFile().c_str())).value();
         host.renderer->add(*other).value();
         host.instances[1] = {.asset = other.get()};
       })},
      {"a `to_world` that is not finite, affine and invertible",
       drawn([](Host& host) { host.instances[1].to_world[2] = glm::vec4(0); })},
      {"a palette of another length", drawn([](Host& host) {
         static const std::vector<Material> materials(7);
         host.instances[1].palette = materials;
       })},
      {"the framebuffer is not complete",
       [] {
         Host host;
         GLint before = 0;
         glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &before);
         GLuint framebuffer = 0;
         glGenFramebuffers(1, &framebuffer);
         glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
         Answers out = host.draw();
         glDeleteFramebuffers(1, &framebuffer);
         glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(before));
         return out;
       }},
      {"`Camera::viewport` is not set", drawn([](Host& host) { host.view.camera.viewport = {}; })},
      {"the camera's matrices are not finite and invertible",
       drawn([](Host& host) { host.view.camera.world_to_eye[3].x = kNan; })},
      {"the camera looks elsewhere", drawn([](Host& host) {
         host.view.camera = lookAt({64, 48}, {0, 1, 4}, {0, 1, 9}).camera;
       })},
      {"the model is too small or too far, as with millimeters for meters", drawn([](Host& host) {
         for (Instance& instance : host.instances) instance.to_world[3].z = -1000;
         host.view.camera.eye_to_clip = lookAt({64, 48}, {0, 0, 1}, {}, 0.01f, 1e5f).camera.eye_to_clip;
       })},
      {"a pack of fog, and no `Pass::kFog`",
       [] {
         const LoadedAsset fog(fogPack(fogOf({16, 16, 16}, [](const glm::dvec3&) { return 1.0; }), 0.2f));
         Host host;
         host.renderer->add(*fog.asset).value();
         while (host.renderer->upload(1 << 20)->pending > 0) {
         }
         host.instances[1] = {.asset = fog.asset.get()};
         return host.draw();
       }},
      {"the sun has no direction", drawn([](Host& host) { host.view.light.sun_direction = {}; })},
      {"`soft_shadows` or `self_shadow` without its feature",
       [] {
         Host host;
         host.view.quality.soft_shadows = 5;
         Answers out = host.draw();
         host.view.quality = {};
         host.view.quality.self_shadow = true;
         out.add(host.renderer->draw(host.view, host.instances));
         return out;
       }},
      {"a `Quality` with a number outside its range",
       drawn([](Host& host) { host.view.quality.depth_batches = 17; })},
  };
}

struct TableRow {
  std::string mistake, answer;
};
std::vector<TableRow> table() {
  std::vector<TableRow> out;
  std::ifstream file(KELP_SOURCE_DIR "/runtime/MISTAKES.md");
  const std::regex form(R"(\| (\d+) \| (.*) \| (.*) \|)");
  std::smatch row;
  for (std::string line; std::getline(file, line);) {
    if (!std::regex_match(line, row, form)) continue;
    EXPECT_EQ(std::stoul(row[1]), out.size() + 1);
    out.push_back({row[2], row[3]});
  }
  return out;
}

// The words of an answer, and a text within quotes that it must have.
Words wordsOf(const std::string& answer) {
  Words out;
  const auto take = [&](const std::string& word) {
    if (std::regex_search(answer, std::regex(R"((^|[^\w]))" + word + R"(($|[^\w]))"))) out.insert(word);
  };
  for (const char* const code : std::span(kCodes).subspan(1)) take(code);
  for (const char* const other : kOthers) take(other);
  return out;
}

TEST(Mistakes, AreAnsweredAsTheTableSays) {
  const EglContext context(GlApi::kDesktop33);
  if (!context) GTEST_SKIP() << "no EGL device gives a context: install libegl1 libgl1-mesa-dri";
  const Canvas canvas({64, 48});
  std::vector<Row> rows;
  for (const auto& section :
       {building(), opening(), names(), poses(), renderers(context, GlApi::kDesktop33), drawing()})
    rows.insert(rows.end(), section.begin(), section.end());
  const std::vector<TableRow> expected = table();
  ASSERT_EQ(rows.size(), expected.size());
  std::string answer;  // with that of the row before, if it is the same
  for (std::size_t i = 0; i < rows.size(); ++i) {
    SCOPED_TRACE(testing::Message() << "row " << i + 1 << ": " << expected[i].mistake);
    EXPECT_EQ(rows[i].mistake, expected[i].mistake);
    answer = expected[i].answer.starts_with("the same") ? answer + expected[i].answer : expected[i].answer;
    const Answers got = rows[i].answers();
    EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
    if (!got.shown_by.empty()) continue;
    Words words = wordsOf(answer);
    EXPECT_EQ(got.words, words) << got.text;
    EXPECT_FALSE(words.empty()) << "an answer that nobody can see";
    EXPECT_EQ(got.names_instance, answer.find("index of the instance") != std::string::npos);
    std::smatch quoted;
    if (std::regex_search(answer, quoted, std::regex(R"re("(?:PATH|\.\.\. )?([^"]*)")re"))) {
      EXPECT_NE(got.text.find(quoted[1]), std::string::npos) << got.text;
    }
  }
}

}  // namespace
}  // namespace kelp::test
