// SPDX-License-Identifier: MIT
#include "bench_trace_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <memory>
#include <stdexcept>

namespace kelp::bench {
namespace {

// The records of one scene, pose and method, averaged over the views; missed and the like summed.
Record overViews(const std::vector<Record>& records, const Record& like, Method method) {
  Record sum = like;
  sum.method = method;
  sum.rays = sum.hits = sum.checked = sum.owed = sum.grazing = sum.missed = sum.farther = sum.false_hits =
      sum.depth_off = sum.cpp_differs = 0;
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
    sum.farther += r.farther;
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

unsigned long long n(std::uint64_t value) { return value; }

void printGroup(const std::vector<Record>& records, const Record& group) {
  std::printf("\n%s %s, pose %s\n  %-17s %9s %9s %8s %6s %8s %8s %8s %6s %9s %7s\n", group.scene.c_str(),
              group.size.c_str(), group.pose.c_str(), "method", "rays", "hits", "steps", "max", "outside",
              "fetches", "missed", "false", "frame ms", "ratio");
  const Record kelp = overViews(records, group, Method::kKelp);
  for (const Method method : kMethods) {
    if (!draws(method, group.bend, group.caged)) continue;
    const Record r = overViews(records, group, method);
    if (method == Method::kUncaged && r.rays == 0) continue;
    std::printf("  %-17s %9llu %9llu %8.2f %6.0f %8.2f %8.2f %7.2f%% %6llu %9.2f %7.2f\n", toString(method),
                n(r.rays), n(r.hits), r.steps_mean, r.steps_max, r.outside_mean, r.fetches_mean,
                r.owed ? 100.0 * static_cast<double>(r.missed) / static_cast<double>(r.owed) : 0.0,
                n(r.false_hits), r.frame_ms, kelp.frame_ms > 0 ? r.frame_ms / kelp.frame_ms : 0);
  }
}

void printMeans(const std::vector<Record>& records) {
  std::printf(
      "\nFrame time as a multiple of kelp's, geometric mean over scenes and poses (moderate poses alone)\n");
  for (const Method method : kMethods) {
    double log_all = 0, log_moderate = 0, all = 0, moderate = 0;
    if (!draws(method, Bend::kShear, false)) continue;
    for (const Record& group : groups(records)) {
      const double kelp = overViews(records, group, Method::kKelp).frame_ms,
                   ratio = overViews(records, group, method).frame_ms / std::max(kelp, 1e-9);
      if (!(ratio > 0)) continue;
      log_all += std::log(ratio);
      all += 1;
      if (!group.moderate) continue;
      log_moderate += std::log(ratio);
      moderate += 1;
    }
    std::printf("  %-17s %6.2f (%.2f)\n", toString(method), std::exp(log_all / std::max(all, 1.0)),
                std::exp(log_moderate / std::max(moderate, 1.0)));
  }
}

// Beside the same part at rest without its cage.
void printCaged(const std::vector<Record>& records) {
  std::printf("\n%-13s %-18s %8s %12s %12s %13s %12s %12s %13s\n", "", "", "", "kelp: missed,",
              "walk: missed,", "walk: steps /", "walk: time /", "kelp: time /", "standard ms /");
  std::printf("%-13s %-18s %8s %13s %13s %13s %12s %12s %13s\n", "Caged parts", "pose", "inverted",
              "farther, false", "farther, false", "uncaged", "uncaged", "uncaged", "kelp");
  for (const Record& group : groups(records)) {
    if (!group.caged) continue;
    Record rest = group;
    rest.pose = "rest";
    const Record kelp = overViews(records, group, Method::kKelp),
                 walk = overViews(records, group, Method::kWalk),
                 uncaged = overViews(records, rest, Method::kUncaged);
    const auto perRay = [](const Record& r) { return r.rays ? r.frame_ms / static_cast<double>(r.rays) : 0; };
    const auto over = [](double a, double b) { return b > 0 ? a / b : 0; };
    std::printf("%-13s %-18s %8d %5llu %3llu %3llu %5llu %3llu %4llu %13.2f %12.2f %12.2f %13.2f\n",
                group.scene.c_str(), group.pose.c_str(), group.inverted, n(kelp.missed), n(kelp.farther),
                n(kelp.false_hits), n(walk.missed), n(walk.farther), n(walk.false_hits),
                over(walk.steps_mean, uncaged.steps_mean + uncaged.outside_mean),
                over(perRay(walk), perRay(uncaged)), over(perRay(kelp), perRay(uncaged)),
                over(overViews(records, group, Method::kStandard).frame_ms, kelp.frame_ms));
  }
}

// Beside the same part straight, and sheared in the same pose. 0: not drawn in this run.
void printSwept(const std::vector<Record>& records) {
  std::printf("\n%-18s %-12s %17s %25s %20s %20s\n", "Swept parts", "pose", "steps / straight",
              "ms a hit / sheared", "standard ms / kelp", "slices ms / kelp");
  const std::size_t ending = std::strlen(kSweptEnding);
  for (const Record& group : groups(records)) {
    if (group.bend != Bend::kSweep) continue;
    Record straight = group, sheared = group;
    straight.pose = "straight";
    sheared.scene.resize(group.scene.size() - ending);
    const auto kelpOf = [&](const Record& like) { return overViews(records, like, Method::kKelp); };
    const auto perHit = [](const Record& r) { return r.hits ? r.frame_ms / static_cast<double>(r.hits) : 0; };
    const auto over = [](double a, double b) { return b > 0 ? a / b : 0; };
    const Record kelp = kelpOf(group), unbent = kelpOf(straight);
    std::printf("%-18s %-12s %17.2f %25.2f %20.2f %20.2f\n", group.scene.c_str(), group.pose.c_str(),
                over(kelp.steps_mean + kelp.outside_mean, unbent.steps_mean + unbent.outside_mean),
                over(perHit(kelp), perHit(kelpOf(sheared))),
                over(overViews(records, group, Method::kStandard).frame_ms, kelp.frame_ms),
                over(overViews(records, group, Method::kStandardSlices).frame_ms, kelp.frame_ms));
  }
}

void printTruth(const std::vector<Record>& records) {
  Record total;
  for (const Record& r : records) {
    if (r.method != Method::kKelp) continue;
    total.rays += r.rays;
    total.checked += r.checked;
    total.owed += r.owed;
    total.grazing += r.grazing;
    total.missed += r.missed;
    total.false_hits += r.false_hits;
    total.depth_off += r.depth_off;
    total.cpp_differs += r.cpp_differs;
  }
  std::printf(
      "\nkelp: of %llu rays %llu were compared with the ground truth: %llu owed, %llu missed, %llu false, "
      "%llu grazing, %llu more than half a voxel off in depth\n",
      n(total.rays), n(total.checked), n(total.owed), n(total.missed), n(total.false_hits), n(total.grazing),
      n(total.depth_off));
  std::printf(
      "      the C++ build of the tracing core agrees with the GPU on %.4f %% of all rays (hit, steps and "
      "fetches)\n",
      100.0 -
          100.0 * static_cast<double>(total.cpp_differs) / std::max(static_cast<double>(total.rays), 1.0));
}

}  // namespace

void printTable(const std::vector<Record>& records) {
  for (const Record& group : groups(records)) printGroup(records, group);
  for (const Bend bend : {Bend::kShear, Bend::kSweep}) {
    std::vector<Record> of_bend;
    std::ranges::copy_if(records, std::back_inserter(of_bend),
                         [&](const Record& r) { return r.bend == bend && !r.caged; });
    if (of_bend.empty()) continue;
    bend == Bend::kSweep ? printSwept(records) : printMeans(of_bend);
    printTruth(of_bend);
  }
  if (std::ranges::any_of(records, [](const Record& r) { return r.caged; })) printCaged(records);
}

void writeJson(const std::vector<Record>& records, const std::string& machine,
               const std::filesystem::path& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "w"), std::fclose);
  if (!file) throw std::runtime_error(path.string() + ": cannot be written");
  std::fprintf(file.get(), "[\n");
  for (const Record& r : records) {
    std::fprintf(file.get(),
                 "{\"scene\": \"%s\", \"size\": \"%s\", \"pose\": \"%s\", \"view\": \"%s\", \"method\": "
                 "\"%s\", \"rays\": %llu, \"hits\": %llu, \"steps_mean\": %.3f, "
                 "\"steps_max\": %.0f, \"outside_mean\": %.3f, \"fetches_mean\": %.3f, \"checked\": %llu, "
                 "\"owed\": %llu, \"grazing\": %llu, \"missed\": %llu, "
                 "\"false_hits\": %llu, \"depth_off\": %llu, \"inverted\": %d, \"frame_ms\": %.3f, "
                 "\"machine\": \"%s\"}%s\n",
                 r.scene.c_str(), r.size.c_str(), r.pose.c_str(), r.view.c_str(), toString(r.method),
                 n(r.rays), n(r.hits), r.steps_mean, r.steps_max, r.outside_mean, r.fetches_mean,
                 n(r.checked), n(r.owed), n(r.grazing), n(r.missed), n(r.false_hits), n(r.depth_off),
                 r.inverted, r.frame_ms, machine.c_str(), &r == &records.back() ? "" : ",");
  }
  std::fprintf(file.get(), "]\n");
  if (std::ferror(file.get())) throw std::runtime_error(path.string() + ": cannot be written");
}

}  // namespace kelp::bench
