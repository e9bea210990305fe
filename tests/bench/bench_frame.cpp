// SPDX-License-Identifier: MIT
// The time of a frame of 2,000 animated instances: the CPU's part beside GLM's mat4 products of the same run,
// on a GL that does nothing, and the whole frame on the GL that is there. README.md here.
//   bench_frame [--json FILE] [--rounds N] [--size WxH] [--cpu | --gl] [--foxes]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <functional>
#include <string>

#include <glm/gtc/matrix_transform.hpp>

#include "bench_frame_foxes.h"
#include "bench_frame_gl.h"
#include "bench_frame_scene.h"
#include "support/fake_gl.h"

namespace kelp::bench {
namespace {

constexpr std::size_t kInstances = 2000;

// Every loop below writes its results here, so that the compiler removes none.
volatile float sink = 0;

struct Row {
  const char* name;
  std::function<void()> once;
  std::vector<double> ns{};  // an instance, of each round
};

// Nanoseconds that this program has computed: others may run beside it.
double processorTime() {
  std::timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
}

void measure(std::vector<Row>& rows, int rounds, std::size_t instances = kInstances) {
  for (int round = -3; round < rounds; ++round) {  // the first three warm up
    for (Row& row : rows) {
      const double start = processorTime();
      row.once();
      const double ns = (processorTime() - start) / static_cast<double>(instances);
      if (round >= 0) row.ns.push_back(ns);
    }
  }
}

// A field of plants, 50 in a row, each turned and scaled; the camera at one side sees all of it, or from its
// middle about half.
void placeAll(Crowd& crowd) {
  for (std::size_t i = 0; i < crowd.instances.size(); ++i) {
    glm::mat4 m = glm::translate(
        glm::mat4(1), glm::vec3(static_cast<float>(i % 50) - 25.0f, 0, static_cast<float>(i / 50) - 20.0f));
    m = glm::rotate(m, 0.1f * static_cast<float>(i), glm::vec3(0, 1, 0));
    crowd.instances[i].to_world = glm::scale(m, glm::vec3(0.9f + 0.01f * static_cast<float>(i % 20)));
  }
}
gl::View fieldView(const glm::vec3& eye, const glm::vec3& target) {
  gl::View view;
  view.camera.viewport = {1920, 1080};
  view.camera.eye_to_clip = glm::perspective(1.0f, 16.0f / 9, 0.1f, 500.0f);
  view.camera.world_to_eye = glm::lookAt(eye, target, glm::vec3(0, 1, 0));
  return view;
}

// A crowd of the library's assets on a GL that does nothing.
struct Field {
  explicit Field(const Library& library, std::size_t count = kInstances, int clip = 0)
      : crowd(library, count, clip) {
    placeAll(crowd);
    test::FakeGl::current() = &fake;
    gl::RendererOptions config;
    config.getProcAddress = test::FakeGl::getProcAddress;
    config.state = gl::State::kRestore;
    renderer = gl::Renderer::create(config).value();
    for (std::size_t i = 0; i < library.size(); ++i) renderer->add(library[i]).value();
    renderer->upload(~std::uint64_t{0}).value();
  }
  test::FakeGl fake;
  Crowd crowd;
  std::unique_ptr<gl::Renderer> renderer;
};

// The same crowd sheared and swept, of three spans.
void reportSwept(Report& out, int rounds) {
  const Library library[] = {Library(1, Bend::kShear, true), Library(1, Bend::kSweep, true)};
  Field sheared(library[0]), swept(library[1]);
  const gl::View near = fieldView({0, 25, 62}, {0, 0, 0}), far = fieldView({0, 100, 250}, {0, 0, 0});
  gl::Stats seen;
  std::vector<Row> rows;
  const auto add = [&](Field& field, const gl::View& view, const char* name) {
    rows.push_back({"", [&] {
                      test::FakeGl::current() = &field.fake;
                      field.crowd.update();
                    }});
    rows.push_back({name, [&] { seen = *field.renderer->draw(view, field.crowd.instances); }});
  };
  add(sheared, near, "draw(), sheared");
  add(swept, near, "draw(), swept");
  add(sheared, far, "draw(), sheared, four times as far");
  add(swept, far, "draw(), swept, four times as far");
  measure(rows, rounds);
  std::printf(
      "\n%zu instances of 3 spans, %u drawn, %u left out\n\n| | ns an instance | over sheared "
      "|\n|---|---|---|\n",
      kInstances, seen.instances, seen.left_out);
  for (std::size_t i = 1; i < rows.size(); i += 2) {
    const double ns = median(rows[i].ns), over = ns / median(rows[i - i % 4 + 1].ns);
    std::printf("| %s | %.1f | %.2f |\n", rows[i].name, ns, over);
    out.add(std::string("cpu, ") + rows[i].name, over);
  }
}

// Swept ones of three spans, and the same in cages whose nodes the host writes.
void reportCaged(Report& out, int rounds) {
  const Library libraries[] = {Library(1, Bend::kSweep, true), Library(1, Bend::kSweep, true, 4)};
  Field swept(libraries[0]), caged(libraries[1]);
  const gl::View view = fieldView({0, 25, 62}, {0, 0, 0});
  gl::Stats seen[2];
  std::vector<Row> rows;
  rows.push_back({"swept: reset + addClip", [&] { swept.crowd.update(); }});
  rows.push_back({"swept: draw()", [&] {
                    test::FakeGl::current() = &swept.fake;
                    seen[0] = *swept.renderer->draw(view, swept.crowd.instances);
                  }});
  rows.push_back({"caged: nodes copied", [&] { caged.crowd.writeNodes(); }});
  rows.push_back({"caged: draw()", [&] {
                    test::FakeGl::current() = &caged.fake;
                    seen[1] = *caged.renderer->draw(view, caged.crowd.instances);
                  }});
  measure(rows, rounds);
  double nodes = 0;
  for (const std::vector<glm::vec3>& of : caged.crowd.nodes) nodes += static_cast<double>(of.size());
  const double both = median(rows[0].ns) + median(rows[1].ns);
  std::printf(
      "\n%zu instances: swept of 3 spans, %u drawn; caged, of %.0f nodes in the mean, %u drawn\n\n"
      "| | ns an instance | over swept |\n|---|---|---|\n",
      kInstances, seen[0].instances, nodes / static_cast<double>(caged.crowd.nodes.size()),
      seen[1].instances);
  const auto print = [&](const char* name, double ns) {
    std::printf("| %s | %.0f | %.2f |\n", name, ns, ns / both);
    out.add(std::string("cpu, ") + name, ns / both);
  };
  for (const Row& row : rows) print(row.name, median(row.ns));
  print("caged: both", median(rows[2].ns) + median(rows[3].ns));
}

// Foxes that run and the same ones that stand still.
void reportFoxes(Report& out, const Foxes& foxes, const glm::ivec2& size, int rounds) {
  Field still(foxes.still, Foxes::kCount), playing(foxes.playing, Foxes::kCount, foxes.run);
  const gl::View view = viewOf(size, 1);
  gl::Stats seen[2];
  std::vector<Row> rows;
  const auto addDraw = [&](Field& field, const char* name, gl::Stats& stats) {
    foxes.place(field.crowd);
    rows.push_back({name, [&] {
                      test::FakeGl::current() = &field.fake;
                      stats = *field.renderer->draw(view, field.crowd.instances);
                    }});
  };
  addDraw(still, "draw(), still", seen[0]);
  rows.push_back({"update, running", [&] { playing.crowd.update(); }});
  addDraw(playing, "draw(), running", seen[1]);
  measure(rows, rounds, Foxes::kCount);
  std::printf(
      "\n%zu foxes, %d x %d: still %u parts drawn, running %u, %u left out\n\n| | ns a fox | over draw(), "
      "still "
      "|\n|---|---|---|\n",
      Foxes::kCount, size.x, size.y, seen[0].instances, seen[1].instances, seen[1].left_out);
  for (const Row& row : rows) {
    const double ns = median(row.ns), over = ns / median(rows[0].ns);
    std::printf("| %s | %.0f | %.1f |\n", row.name, ns, over);
    out.add(std::string("cpu, foxes, ") + row.name, over);
  }
}

void reportCpu(Report& out, int parts, int rounds) {
  const Library library(parts);
  Field field(library);
  Crowd& crowd = field.crowd;
  gl::Renderer* const renderer = field.renderer.get();
  const gl::View all = fieldView({0, 25, 62}, {0, 0, 0}), half = fieldView({0, 1, 0}, {20, 0.5f, 0});

  // Rotations, as the world matrices of a crowd are. Few, so that they stay in the nearest cache: the product
  // at its cheapest.
  constexpr std::size_t kMatrices = 100;
  std::vector<glm::mat4> a(kMatrices), b(kMatrices), products(kMatrices);
  for (std::size_t i = 0; i < kMatrices; ++i) {
    a[i] = glm::rotate(glm::mat4(1), 0.01f * static_cast<float>(i), glm::vec3(0.6f, 0, 0.8f));
    b[i] = glm::rotate(glm::mat4(1), 0.02f * static_cast<float>(i), glm::vec3(0, 1, 0));
  }
  gl::Stats seen_all, seen_half;
  std::vector<Row> rows;
  rows.push_back({"mat4 product, independent", [&] {
                    for (std::size_t n = 0; n < kInstances / kMatrices; ++n) {
                      for (std::size_t i = 0; i < kMatrices; ++i) products[i] = a[i] * b[i];
                      sink = sink + products[n][1][1];
                    }
                  }});
  rows.push_back({"mat4 product, chained", [&] {
                    glm::mat4 m = a[3];
                    for (std::size_t i = 0; i < kInstances; ++i) m = m * b[i % kMatrices];
                    sink = sink + m[1][1];
                  }});
  rows.push_back({"update: reset + addClip", [&] { crowd.update(); }});
  rows.push_back({"draw(), all visible", [&] { seen_all = *renderer->draw(all, crowd.instances); }});
  // Once more, of poses that changed since.
  rows.push_back({"", [&] { crowd.update(); }});
  rows.push_back({"draw(), part culled", [&] { seen_half = *renderer->draw(half, crowd.instances); }});
  rows.push_back({"draw() again, nothing moved",
                  [&] { (void)*renderer->draw(half, crowd.instances, gl::Pass::kDepth); }});
  measure(rows, rounds);

  const double product = median(rows[0].ns);
  std::printf(
      "\n%zu instances of %zu assets, %d part(s) each: %.1f knots and %.1f waves an instance; all visible: "
      "%u drawn, %u culled; part culled: %u drawn, %u culled\n\n"
      "| | ns an instance | mat4 products |\n|---|---|---|\n",
      kInstances, library.size(), parts,
      static_cast<double>(library.knots()) / static_cast<double>(library.size()),
      static_cast<double>(library.waves()) / static_cast<double>(library.size()), seen_all.instances,
      seen_all.culled, seen_half.instances, seen_half.culled);
  const std::string prefix = "cpu, " + std::to_string(parts) + " part(s), ";
  const auto print = [&](const char* name, double ns) {
    std::printf("| %s | %.1f | %.2f |\n", name, ns, ns / product);
    out.add(prefix + name, ns / product);
  };
  for (const Row& row : rows) {
    if (*row.name) print(row.name, median(row.ns));
  }
  print("update + draw(), all visible", median(rows[2].ns) + median(rows[3].ns));
  print("update + draw(), part culled", median(rows[2].ns) + median(rows[5].ns));
}

int usage() {
  std::fprintf(stderr,
               "usage: bench_frame [--json FILE] [--rounds N] [--size WxH] [--cpu | --gl] [--foxes]\n");
  return 1;
}

int run(int count, char** words) {
  const char* json = nullptr;
  int rounds = 101;
  bool cpu = true, gl = true, foxes_only = false;
  glm::ivec2 size(320, 240);
  for (int i = 1; i < count; ++i) {
    const bool more = i + 1 < count;
    if (std::strcmp(words[i], "--json") == 0 && more) {
      json = words[++i];
    } else if (std::strcmp(words[i], "--rounds") == 0 && more) {
      rounds = std::atoi(words[++i]);
    } else if (std::strcmp(words[i], "--size") == 0 && more) {
      if (std::sscanf(words[++i], "%dx%d", &size.x, &size.y) != 2 || size.x < 1 || size.y < 1) return usage();
    } else if (std::strcmp(words[i], "--cpu") == 0) {
      gl = false;
    } else if (std::strcmp(words[i], "--gl") == 0) {
      cpu = false;
    } else if (std::strcmp(words[i], "--foxes") == 0) {
      foxes_only = true;
    } else {
      return usage();
    }
  }
  if (rounds < 1 || (!cpu && !gl)) return usage();
  Report report;
  const std::unique_ptr<Foxes> foxes = Foxes::bake();
  if (cpu && !foxes_only) {
    reportCpu(report, 1, rounds);
    reportCpu(report, 3, rounds);
    reportSwept(report, rounds);
    reportCaged(report, rounds);
  }
  if (cpu && foxes) reportFoxes(report, *foxes, size, rounds);
  if (gl) reportGl(report, foxes.get(), foxes_only, size, std::min(rounds, 3));  // some frames take seconds
  return json && !report.write(json) ? 2 : 0;
}

}  // namespace
}  // namespace kelp::bench

int main(int argc, char** argv) { return kelp::bench::run(argc, argv); }
