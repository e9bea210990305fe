// SPDX-License-Identifier: MIT
// The paper's method as published beside kelp's, in one run on the same OpenGL: steps, fetches, missed and
// false hits, frame times and ratios. README.md says how to run it and how to read it.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>
#include <thread>

#include "bench_trace_caged.h"
#include "bench_trace_check.h"
#include "bench_trace_gpu.h"
#include "bench_trace_long.h"
#include "bench_trace_report.h"
#include "support/assets.h"

namespace {

using namespace kelp;
using namespace kelp::bench;

constexpr double kSlow = 1000;  // milliseconds; what takes longer is timed once

struct Options {
  glm::ivec2 size{640, 480};
  int frames = 3;
  int truth = 16;
  int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  std::uint64_t long_rays = 0;
  std::vector<std::string> scenes = sceneNames(), views = viewNames(), poses;
  std::string json;
};

constexpr char kUsage[] =
    "usage: bench_trace [--scenes A,B] [--poses A;B] [--views A,B] [--size WxH] [--frames N] [--truth N] "
    "[--threads N] [--json FILE]\n"
    "       bench_trace --long RAYS [--scenes A,B] [--threads N]\n"
    "  --scenes   of: orange spot bunny256 bunny512 underwater; column bunny fish tentacle, and these swept: "
    "'column swept' and so on; and 'bunny caged', fish, Fox, comb, slab, on the CPU\n"
    "  --poses    by name as the table prints them, separated by semicolons\n"
    "  --views    of: front side above below level inside along horizontal\n"
    "  --frames   timed frames of each method and view, interleaved; the median counts; 0: no times (default "
    "3). What takes more than a second is timed once\n"
    "  --truth    compare every N-th ray with the ground truth; 1: all, 0: none (default 16)\n"
    "  --long     random rays on the CPU through the scenes and through volumes of up to 4096 voxels; "
    "--scenes none for those alone\n";

std::vector<std::string> split(const std::string& text, char by) {
  std::vector<std::string> out;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find(by, from), text.size());
    out.push_back(text.substr(from, to - from));
    from = to + 1;
  }
  return out;
}

template <class Integer>
bool parse(const std::string& text, Integer low, Integer& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && value >= low;
}

bool allOf(const std::vector<std::string>& wanted, const std::vector<std::string>& known) {
  return std::all_of(wanted.begin(), wanted.end(), [&](const std::string& name) {
    return std::find(known.begin(), known.end(), name) != known.end();
  });
}

std::optional<Options> parseOptions(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; i += 2) {
    const std::string name = argv[i], value = i + 1 < argc ? argv[i + 1] : "";
    bool good = !value.empty();
    if (name == "--scenes") {
      options.scenes = value == "none" ? std::vector<std::string>() : split(value, ',');
      good = good && allOf(options.scenes, sceneNames());
    } else if (name == "--views") {
      options.views = split(value, ',');
      good = good && allOf(options.views, viewNames());
    } else if (name == "--poses") {
      options.poses = split(value, ';');
    } else if (name == "--size") {
      const std::vector<std::string> sides = split(value, 'x');
      good = good && sides.size() == 2 && parse(sides[0], 1, options.size.x) &&
             parse(sides[1], 1, options.size.y);
    } else if (name == "--frames") {
      good = good && parse(value, 0, options.frames);
    } else if (name == "--truth") {
      good = good && parse(value, 0, options.truth);
    } else if (name == "--threads") {
      good = good && parse(value, 1, options.threads);
    } else if (name == "--long") {
      good = good && parse(value, std::uint64_t{1}, options.long_rays);
    } else if (name == "--json") {
      options.json = value;
    } else {
      good = false;
    }
    if (!good) {
      std::fprintf(stderr, "bench_trace: %s %s: not understood\n%s", name.c_str(), value.c_str(), kUsage);
      return std::nullopt;
    }
  }
  return options;
}

// The scenes whose files are here; the others are left out with a word.
std::vector<Scene> loadScene(const std::string& name, int threads) {
  std::fprintf(stderr, "%s: making its volumes\n", name.c_str());
  try {
    std::vector<Scene> scenes;
    scenes.push_back(makeScene(name, KELP_MODELS_DIR, test::assetsFolder(), threads));
    return scenes;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s is left out: %s\n", name.c_str(), error.what());
    return {};
  }
}

std::string machineName(const Gpu& gpu) {
  std::string cpu = "unknown CPU", line;
  std::ifstream info("/proc/cpuinfo");
  while (std::getline(info, line)) {
    if (line.rfind("model name", 0) == 0) {
      cpu = line.substr(line.find(':') + 2);
      break;
    }
  }
  return gpu.renderer() + "; " + cpu + ", " + std::to_string(std::thread::hardware_concurrency()) +
         " threads";
}

void tally(const std::vector<Count>& counts, const std::vector<RayCheck>& checks, Record& record) {
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const Count& count = counts[i];
    const RayCheck& check = checks[i];
    const std::optional<double> s = count.s >= 0 ? std::optional<double>(double{count.s}) : std::nullopt;
    if (check.truth) {
      const reference::Truth& truth = *check.truth;
      const reference::Verdict verdict = reference::judge(truth, s);
      ++record.checked;
      record.owed += truth.owed.has_value();
      record.grazing += truth.grazing();
      record.missed += verdict == reference::Verdict::kMissed;
      record.farther += verdict == reference::Verdict::kMissed && s;
      record.false_hits += verdict == reference::Verdict::kFalse;
      record.depth_off += s && truth.owed && (*s < *truth.possible - 0.5 || *s > *truth.owed + 0.5);
    }
    if (!check.meets_box) continue;
    ++record.rays;
    record.hits += s.has_value();
    record.steps_mean += double{count.steps};
    record.steps_max = std::max(record.steps_max, double{count.steps});
    record.outside_mean += double{count.outside};
    record.fetches_mean += double{count.fetches};
    const Count& cpp = check.cpp;
    record.cpp_differs += (cpp.s >= 0) != (count.s >= 0) || std::abs(cpp.s - count.s) > 0.01f ||
                          cpp.steps != count.steps || cpp.fetches != count.fetches;
  }
}

// What `like` says of the scene, pose and view, with what each method counts and how long it takes.
// count(method): one list for each of `checks`; frame(method): milliseconds.
template <class CountOf, class Frame>
void measure(const Record& like, const std::vector<std::vector<RayCheck>>& checks, const Options& options,
             CountOf&& count, Frame&& frame, std::vector<Record>& records) {
  std::vector<Method> methods;
  std::ranges::copy_if(kMethods, std::back_inserter(methods), [&](Method method) {
    return draws(method, like.bend, like.caged) && (method != Method::kUncaged || like.pose == "rest");
  });
  std::vector<Record> found;
  for (const Method method : methods) {
    Record record = like;
    record.method = method;
    for (std::size_t i = 0; i < checks.size(); ++i) tally(count(method, i), checks[i], record);
    for (double* sum : {&record.steps_mean, &record.outside_mean, &record.fetches_mean})
      *sum /= static_cast<double>(std::max<std::uint64_t>(record.rays, 1));
    if (method != Method::kKelp || like.caged) record.cpp_differs = 0;
    found.push_back(record);
  }

  std::vector<std::vector<double>> times(methods.size());
  for (int i = 0; i < options.frames; ++i) {  // counting has warmed everything up
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const bool slow = !times[m].empty() && times[m].front() > kSlow;
      if (!slow) times[m].push_back(frame(methods[m]));
    }
  }
  for (std::size_t m = 0; m < methods.size(); ++m) {
    std::sort(times[m].begin(), times[m].end());
    if (!times[m].empty()) found[m].frame_ms = times[m][times[m].size() / 2];
    records.push_back(found[m]);
  }
}

Record recordOf(const Scene& scene, const std::string& pose, const std::string& view) {
  Record record;
  record.scene = scene.name;
  record.bend = scene.bend;
  record.caged = scene.caged;
  record.size = scene.size;
  record.pose = pose;
  record.view = view;
  return record;
}

bool wanted(const Options& options, const std::string& pose) {
  return options.poses.empty() || allOf({pose}, options.poses);
}

void measureScene(Gpu& gpu, const Scene& scene, const Options& options, std::vector<Record>& records) {
  gpu.setScene(scene);
  for (const Pose& pose : makePoses(scene)) {
    if (!wanted(options, pose.name)) continue;
    std::fprintf(stderr, "%s, pose %s\n", scene.name.c_str(), pose.name.c_str());
    const std::vector<PosedItem> items = poseItems(scene, pose);
    for (const std::string& name : options.views) {
      const View view = makeView(name, items, options.size);
      gpu.setView(items, view);
      std::vector<std::vector<RayCheck>> checks;
      for (std::size_t i = 0; i < items.size(); ++i)
        checks.push_back(checkRays(items[i], view.rays[i], options.truth, options.threads));
      Record like = recordOf(scene, pose.name, name);
      like.moderate = pose.moderate;
      measure(
          like, checks, options, [&](Method method, std::size_t i) { return gpu.count(method, i); },
          [&](Method method) { return gpu.frame(method); }, records);
    }
  }
}

// On the CPU. An eye within has no faces to walk from.
void measureCaged(const Scene& scene, const Options& options, std::vector<Record>& records) {
  const Item& item = scene.items.front();
  const reference::CagedVolume volume = reference::cagedVolume(scene.name, item.volume, kCageCell);
  for (const reference::CagePose& pose : cagedPoses(volume.size)) {
    if (!wanted(options, pose.name)) continue;
    std::fprintf(stderr, "%s, pose %s\n", scene.name.c_str(), pose.name.c_str());
    CagedItem caged(volume, pose);
    // Rays begin before the boundary faces.
    const Box bounds{caged.bounds().min - 1.0f, caged.bounds().max + 1.0f};
    for (const std::string& name : options.views) {
      if (name == "inside") continue;
      const View view = makeView(name, {{&item, {}, {}, nullptr, bounds, pose.map}}, options.size);
      caged.setView(view.rays[0], options.threads);
      Record like = recordOf(scene, pose.name, name);
      like.inverted = caged.inverted();
      measure(
          like, {caged.check(options.truth, options.threads)}, options,
          [&](Method method, std::size_t) { return caged.count(method, options.threads); },
          [&](Method method) { return caged.frame(method); }, records);
    }
  }
}

int run(const Options& options) {
  if (options.long_rays > 0) {
    std::vector<Scene> scenes;
    for (const std::string& name : options.scenes) {
      for (Scene& scene : loadScene(name, options.threads)) scenes.push_back(std::move(scene));
    }
    return runLong(scenes, options.long_rays, options.threads) ? 0 : 7;
  }
  Gpu gpu(options.size);
  const std::string machine = machineName(gpu);
  std::printf("%s, %dx%d, median of %d frames\n", machine.c_str(), options.size.x, options.size.y,
              options.frames);
  std::vector<Record> records;
  for (const std::string& name : options.scenes) {
    for (const Scene& scene : loadScene(name, options.threads)) {
      scene.caged ? measureCaged(scene, options, records) : measureScene(gpu, scene, options, records);
      if (!options.json.empty()) writeJson(records, machine, options.json);
    }
  }
  printTable(records);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::optional<Options> options = parseOptions(argc, argv);
  if (!options) return 1;
  try {
    return run(*options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_trace: %s\n", error.what());
    return 4;
  }
}
