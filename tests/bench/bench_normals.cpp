// SPDX-License-Identifier: MIT
// How far stored normals are from the truth after each pose of the paper's Figure 6, by the number of bits
// they are stored in; and the paper's equation 5, which is given normals that are not rounded at all. Shear:
// voxels sideways for one upwards, which is what makes small errors large. Tables in Markdown, degrees.
// README.md here.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>

#include "kelp/bake/bake.h"
#include "kelp/formats/brick.h"
#include "reference/deformed_field.h"
#include "reference/paper_cpp.h"
#include "support/assets.h"
#include "support/poses.h"

namespace kelp::bench {
namespace {

using glm::dvec3;

constexpr int kBits[] = {8, 10, 12, 16, 20, 24, 32};
const glm::ivec3 kSize{256, 249, 195};
constexpr int kPoints = 20000;

// The pack's normals (formats/SPEC.md, "Attributes") with `bits` bits instead of 24.
dvec3 decoded(int u, int v, int half) {
  double x = static_cast<double>(u) / half, z = static_cast<double>(v) / half;
  const double y = 1 - std::abs(x) - std::abs(z), fold = std::max(-y, 0.0);
  x += x >= 0 ? -fold : fold;
  z += z >= 0 ? -fold : fold;
  return glm::normalize(dvec3(x, y, z));
}
// The nearest normal that the bits can say.
dvec3 rounded(const dvec3& n, int bits) {
  const int half = (1 << (bits / 2 - 1)) - 1;
  const double sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  double x = n.x / sum, z = n.z / sum;
  if (n.y < 0) {
    const double folded = (1 - std::abs(z)) * (x >= 0 ? 1 : -1);
    z = (1 - std::abs(x)) * (z >= 0 ? 1 : -1);
    x = folded;
  }
  const int u0 = static_cast<int>(std::floor(x * half)), v0 = static_cast<int>(std::floor(z * half));
  dvec3 best(0);
  for (int v = std::max(v0 - 1, -half); v <= std::min(v0 + 2, half); ++v) {
    for (int u = std::max(u0 - 1, -half); u <= std::min(u0 + 2, half); ++u) {
      const dvec3 d = decoded(u, v, half);
      if (best == dvec3(0) || glm::distance(d, n) < glm::distance(best, n)) best = d;
    }
  }
  return best;
}

struct Sample {
  dvec3 at;      // in the undeformed volume, voxels
  dvec3 normal;  // before it is stored
};

std::string number(double degrees) {
  char text[32];
  std::snprintf(text, sizeof text, degrees < 1e-4 ? "%.0e" : (degrees < 100 ? "%.2g" : "%.0f"), degrees);
  return text;
}
std::string cell(const std::vector<double>& degrees) {
  const reference::Spread s = reference::spreadOf(degrees);
  return number(s.mean) + " / " + number(s.p99) + " / " + number(s.worst);
}

void printTable(const std::string& name, const std::vector<Sample>& samples, const glm::ivec3& size) {
  std::printf("\n%s, %zu normals, %d x %d x %d: mean / 99th percentile / maximum in degrees\n\n| pose |",
              name.c_str(), samples.size(), size.x, size.y, size.z);
  for (const int bits : kBits) std::printf(" %d bits |", bits);
  std::printf(" not rounded | equation 5, not rounded | shear: 99th percentile, maximum |\n|---|");
  for (std::size_t i = 0; i < std::size(kBits) + 3; ++i) std::printf("---|");
  std::printf("\n");
  for (const test::FigurePose& figure : test::kFigure6) {
    const std::vector<Knot> knots = test::figureKnots(figure);
    const reference::SplineMap map(knots, size);
    const Segment s = makeSegment(knots[0], knots[1], static_cast<float>(size.y));
    const trace::KelpSegment g{s.p0, s.m0, s.p1, s.m1};
    const auto stretch = static_cast<float>(map.stretch());
    std::vector<double> errors[std::size(kBits)], exact, paper, shear;
    for (const Sample& sample : samples) {
      const dvec3 p = map.toDeformed(sample.at);
      // The truth: the plane that touches the surface, deformed.
      const dvec3 truth = reference::differenceNormal(
          [&](const dvec3& q) { return glm::dot(q - sample.at, sample.normal); }, map, p);
      const dvec3 slope = map.placeOf(p.y).slope;
      shear.push_back(std::hypot(slope.x, slope.z) / slope.y);
      const float t = trace::kelpSplineParameter(g, static_cast<float>(p.y - double{g.p0.y}),
                                                 static_cast<float>(double{g.p1.y} - p.y));
      const auto errorOf = [&](const dvec3& n) {
        return reference::degreesBetween(dvec3(trace::kelpDeformNormal(g, t, stretch, glm::vec3(n))), truth);
      };
      for (std::size_t i = 0; i < std::size(kBits); ++i)
        errors[i].push_back(errorOf(rounded(sample.normal, kBits[i])));
      exact.push_back(errorOf(sample.normal));
      paper.push_back(reference::degreesBetween(
          dvec3(paper::paperNormal(paper::paperSpline(g), t, glm::vec3(sample.normal))), truth));
    }
    std::printf("| %s |", figure.name);
    for (const auto& e : errors) std::printf(" %s |", cell(e).c_str());
    const reference::Spread sheared = reference::spreadOf(shear);
    std::printf(" %s | %s | %.0f, %.0f |\n", cell(exact).c_str(), cell(paper).c_str(), sheared.p99,
                sheared.worst);
    std::fflush(stdout);
  }
}

// What the pack stores at 24 bits is as near as what the tables say (of two that are equally near, either
// will do).
void checkTheProduct(const std::vector<Sample>& samples) {
  for (const Sample& sample : samples) {
    const glm::vec3 n(sample.normal);
    const double product = reference::degreesBetween(dvec3(decodeNormal(encodeNormal(n))), dvec3(n)),
                 ours = reference::degreesBetween(rounded(dvec3(n), 24), dvec3(n));
    if (std::abs(product - ours) > 1e-4) {
      throw std::runtime_error(
          "bench_normals does not round as kelp::encodeNormal does: one of them has changed");
    }
  }
}

std::vector<Sample> shapeSamples(const reference::Shape& shape) {
  std::mt19937 random(1);
  std::vector<Sample> samples;
  for (int i = 0; i < kPoints; ++i) {
    const dvec3 q = shape.surfacePoint(random);
    samples.push_back({q, shape.normal(q)});
  }
  return samples;
}

// Every surface voxel's centre, with the normal that the baker is about to store.
std::vector<Sample> bakedSamples(const std::filesystem::path& path, int resolution, glm::ivec3& size) {
  const bake::SourceModel model = bake::importFile(path, {});
  const bake::SourcePart& part = model.parts.front();
  dvec3 low(1e30), high(-1e30);
  for (const glm::vec3& p : part.soup.positions) {
    low = glm::min(low, dvec3(p));
    high = glm::max(high, dvec3(p));
  }
  const dvec3 extent = high - low;
  const bake::Frame frame = bake::makeFrame(
      part.soup, Axis::kPlusY, std::max({extent.x, extent.y, extent.z}) / resolution, path.string());
  const bake::VoxelGrid grid = bake::voxelize(model, part, frame, bake::Fill::kAuto, 0, {}).grid;
  size = grid.size;
  std::vector<Sample> samples;
  for (const bake::SurfaceSample& s : grid.surface) {
    const auto x = static_cast<std::uint64_t>(size.x), y = static_cast<std::uint64_t>(size.y);
    samples.push_back({dvec3(static_cast<double>(s.index % x), static_cast<double>(s.index / x % y),
                             static_cast<double>(s.index / (x * y))) +
                           0.5,
                       glm::normalize(dvec3(s.normal))});
  }
  return samples;
}

void run() {
  for (const reference::Shape& shape : reference::shapesIn(kSize)) {
    const std::vector<Sample> samples = shapeSamples(shape);
    checkTheProduct(samples);
    printTable(shape.name, samples, kSize);
  }
  const std::filesystem::path bunny = test::assetsFolder() / "mesh/common3d/stanford-bunny.obj";
  if (!std::filesystem::exists(bunny)) {
    std::fprintf(
        stderr,
        "bench_normals: the bunny is left out, %s is absent: set KELP_ASSETS to a folder that holds it\n",
        bunny.c_str());
    return;
  }
  glm::ivec3 size(0);
  const std::vector<Sample> samples = bakedSamples(bunny, 256, size);
  checkTheProduct(samples);
  printTable("bunny as baked", samples, size);
}

}  // namespace
}  // namespace kelp::bench

int main() {
  try {
    kelp::bench::run();
  } catch (const std::exception& e) {
    std::fprintf(stderr, "bench_normals: %s\n", e.what());
    return EXIT_FAILURE;
  }
}
