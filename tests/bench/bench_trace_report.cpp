// SPDX-License-Identifier: MIT
#include "bench_trace_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>

namespace kelp::bench {
namespace {

// The records of one scene, pose and method, averaged over the views; missed and the like summed.
Record overViews(const std::vector<Record>& records, const Record& like, Method method) {
  Record sum = like;
  sum.method = method;
  sum.rays = sum.hits = sum.checked = sum.owed = sum.grazing = sum.missed = sum.false_hits = sum.depth_off =
      sum.cpp_differs = 0;
  sum.steps_mean = sum.steps_max = sum.outside_mean = sum.fetches_mean = sum.frame_ms = 0;
  double views = 0;
  for (const Record& r : records) {
    if (r.scene != like.scene || r.pose != like.pose || r.method != method) continue;
    views += 1;
    sum.rays += r.rays;
    sum.hits += r.hits;
    sum.checked += r.checked;
    sum.owed += r.owed;
    sum.grazing += r.grazing;
    sum.missed += r.missed;
    sum.false_hits += r.false_hits;
    sum.depth_off += r.depth_off;
    sum.cpp_differs += r.cpp_differs;
    sum.steps_mean += r.steps_mean;
    sum.outside_mean += r.outside_mean;
    sum.fetches_mean += r.fetches_mean;
    sum.frame_ms += r.frame_ms;
    sum.steps_max = std::max(sum.steps_max, r.steps_max);
  }
  for (double* mean : {&sum.steps_mean, &sum.outside_mean, &sum.fetches_mean, &sum.frame_ms})
    *mean /= std::max(views, 1.0);
  return sum;
}

// The first record of each scene and pose.
std::vector<Record> groups(const std::vector<Record>& records) {
  std::vector<Record> out;
  for (const Record& r : records) {
    if (std::none_of(out.begin(), out.end(),
                     [&](const Record& o) { return o.scene == r.scene && o.pose == r.pose; }))
      out.push_back(r);
  }
  return out;
}

}  // namespace

void printTable(const std::vector<Record>& records) {
  std::array<double, kMethods.size()> log_all{}, log_moderate{};
  double all = 0, moderate = 0;
  Record kelp_total;
  for (const Record& group : groups(records)) {
    std::printf("\n%s %s, pose %s\n  %-17s %9s %9s %8s %6s %8s %8s %8s %6s %9s %7s\n", group.scene.c_str(),
                group.size.c_str(), group.pose.c_str(), "method", "rays", "hits", "steps", "max", "outside",
                "fetches", "missed", "false", "frame ms", "ratio");
    const Record kelp = overViews(records, group, Method::kKelp);
    for (const Method method : kMethods) {
      const Record r = overViews(records, group, method);
      const double ratio = kelp.frame_ms > 0 ? r.frame_ms / kelp.frame_ms : 0;
      std::printf("  %-17s %9llu %9llu %8.2f %6.0f %8.2f %8.2f %7.2f%% %6llu %9.2f %7.2f\n", toString(method),
                  static_cast<unsigned long long>(r.rays), static_cast<unsigned long long>(r.hits),
                  r.steps_mean, r.steps_max, r.outside_mean, r.fetches_mean,
                  r.owed ? 100.0 * static_cast<double>(r.missed) / static_cast<double>(r.owed) : 0.0,
                  static_cast<unsigned long long>(r.false_hits), r.frame_ms, ratio);
      if (ratio > 0) log_all[static_cast<std::size_t>(method)] += std::log(ratio);
      if (ratio > 0 && group.moderate) log_moderate[static_cast<std::size_t>(method)] += std::log(ratio);
    }
    all += 1;
    moderate += group.moderate;
    kelp_total.checked += kelp.checked;
    kelp_total.owed += kelp.owed;
    kelp_total.grazing += kelp.grazing;
    kelp_total.missed += kelp.missed;
    kelp_total.false_hits += kelp.false_hits;
    kelp_total.depth_off += kelp.depth_off;
    kelp_total.cpp_differs += kelp.cpp_differs;
    kelp_total.rays += kelp.rays;
  }
  std::printf(
      "\nFrame time as a multiple of kelp's, geometric mean over scenes and poses (moderate poses alone)\n");
  for (const Method method : kMethods) {
    const auto m = static_cast<std::size_t>(method);
    std::printf("  %-17s %6.2f (%.2f)\n", toString(method), std::exp(log_all[m] / std::max(all, 1.0)),
                std::exp(log_moderate[m] / std::max(moderate, 1.0)));
  }
  const auto n = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  std::printf(
      "\nkelp: of %llu rays %llu were compared with the ground truth: %llu owed, %llu missed, %llu false, "
      "%llu grazing, %llu more than half a voxel off in depth\n",
      n(kelp_total.rays), n(kelp_total.checked), n(kelp_total.owed), n(kelp_total.missed),
      n(kelp_total.false_hits), n(kelp_total.grazing), n(kelp_total.depth_off));
  std::printf(
      "      the C++ build of trace.glsl agrees with the GPU on %.4f %% of all rays (hit, steps and "
      "fetches)\n",
      100.0 - 100.0 * static_cast<double>(kelp_total.cpp_differs) /
                  std::max(static_cast<double>(kelp_total.rays), 1.0));
}

void writeJson(const std::vector<Record>& records, const std::string& machine,
               const std::filesystem::path& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "w"), std::fclose);
  if (!file) throw std::runtime_error(path.string() + ": cannot be written");
  const auto n = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  std::fprintf(file.get(), "[\n");
  for (const Record& r : records) {
    std::fprintf(file.get(),
                 "{\"scene\": \"%s\", \"size\": \"%s\", \"pose\": \"%s\", \"view\": \"%s\", \"method\": "
                 "\"%s\", \"rays\": %llu, \"hits\": %llu, \"steps_mean\": %.3f, "
                 "\"steps_max\": %.0f, \"outside_mean\": %.3f, \"fetches_mean\": %.3f, \"checked\": %llu, "
                 "\"owed\": %llu, \"grazing\": %llu, \"missed\": %llu, "
                 "\"false_hits\": %llu, \"depth_off\": %llu, \"frame_ms\": %.3f, \"machine\": \"%s\"}%s\n",
                 r.scene.c_str(), r.size.c_str(), r.pose.c_str(), r.view.c_str(), toString(r.method),
                 n(r.rays), n(r.hits), r.steps_mean, r.steps_max, r.outside_mean, r.fetches_mean,
                 n(r.checked), n(r.owed), n(r.grazing), n(r.missed), n(r.false_hits), n(r.depth_off),
                 r.frame_ms, machine.c_str(), &r == &records.back() ? "" : ",");
  }
  std::fprintf(file.get(), "]\n");
  if (std::ferror(file.get())) throw std::runtime_error(path.string() + ": cannot be written");
}

}  // namespace kelp::bench
