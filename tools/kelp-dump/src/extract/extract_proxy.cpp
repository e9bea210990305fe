// SPDX-License-Identifier: MIT
// Decimated surfaces. A file for each part, since parts move by themselves.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "extract/extract.h"
#include "kelp/common/console.h"
#include "kelp/common/output_file.h"
#include "proxy/mesh_distance.h"
#include "proxy/proxy_mesh.h"
#include "proxy/voxel_faces.h"
#include "text/checks.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExtensions[] = {".obj", ".ply", ".stl", ".off"};
// A face of a voxel makes two triangles, with all that OpenMesh keeps of them (measured: 900 bytes).
constexpr std::uint64_t kBytesOfFace = 1000;
constexpr double kTolerance = 0.01;  // voxels by which a measured distance may be too large
constexpr int kAttempts = 6;
constexpr double kMostSmoothing = 0.4;  // voxels
constexpr double kCorner = 0.58;        // voxels that surfaceOf() cuts off a corner

std::string extensionOf(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (std::find(std::begin(kExtensions), std::end(kExtensions), extension) == std::end(kExtensions))
    throw ToolError(Exit::kUsage,
                    fmt::format("--proxy {}: its ending says no format; end it with .obj, .ply, .stl or .off",
                                nameText(path.string())));
  return extension;
}

// Two vertices in one place would be one in STL, which has no indices. A part thinner than the error can turn
// inside out.
bool isSound(const ProxyMesh& mesh) {
  std::set<std::tuple<float, float, float>> places;
  for (const auto vertex : mesh.vertices())
    if (const auto& p = mesh.point(vertex); !places.emplace(p[0], p[1], p[2]).second) return false;
  double volume = 0;
  for (const Triangle& t : trianglesOf(mesh)) volume += glm::dot(t.a, glm::cross(t.b, t.c));
  return volume > 0;
}

struct Proxy {
  ProxyMesh mesh;          // as in the file
  double out = 0, in = 0;  // voxels from the voxels' surface, and that from it
};

// Empty if the numbers of a file are too coarse for the part's place.
std::optional<Proxy> proxyWithin(double error, const LevelVoxels& level) {
  std::vector<Triangle> faces;
  eachFace(level, [&](const glm::ivec3& voxel, const VoxelFace& face) {
    glm::dvec3 corner[4];
    for (std::size_t i = 0; i < 4; ++i) corner[i] = voxel + face.corners[i];
    faces.push_back({corner[0], corner[1], corner[2]});
    faces.push_back({corner[0], corner[2], corner[3]});
  });
  const TriangleTree tree(std::move(faces));
  const ProxyMesh surface = surfaceOf(level);
  const glm::dmat4x3 to_object = level.toObject(), to_voxels(glm::inverse(glm::dmat4(to_object)));
  const double smoothing = std::min(kMostSmoothing, error / 6);
  double most = error - kCorner - smoothing;
  for (int attempt = 1; attempt <= kAttempts; ++attempt) {
    Proxy proxy{surface};
    if (attempt < kAttempts) {
      smooth(proxy.mesh, smoothing);
      decimate(proxy.mesh, most);
    }
    const std::vector<Triangle> exact = trianglesOf(proxy.mesh);
    proxy.mesh = mapped(proxy.mesh, to_object);
    std::vector<Triangle> triangles = trianglesOf(proxy.mesh);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      Triangle& t = triangles[i];
      for (glm::dvec3* const p : {&t.a, &t.b, &t.c}) *p = to_voxels * glm::dvec4(*p, 1);
      if (!(glm::distance(t.a, exact[i].a) <= error / 4)) return std::nullopt;
    }
    proxy.out = largestDistance(triangles, tree, kTolerance);
    proxy.in = largestDistance(tree.triangles(), TriangleTree(triangles), kTolerance);
    const double apart = std::max(proxy.out, proxy.in);
    if (apart <= error && isSound(proxy.mesh)) return proxy;
    most *= 0.7;
  }
  return std::nullopt;
}

struct PartFile {
  fs::path path;
  std::string bytes;
};

// Nothing if the part has no voxels.
std::string proxyOf(const ExtractRequest& request, std::uint32_t part, const std::string& extension) {
  const LevelVoxels level = request.read(part);
  const std::string name = fmt::format("part {} '{}'", part, nameText(request.part(part).name, 40));
  std::uint64_t faces = 0;
  eachFace(level, [&](const glm::ivec3&, const VoxelFace&) { ++faces; });
  if (faces == 0) return {};
  requireMemory(kBytesOfFace * faces, fmt::format("{}: the proxy of {}", request.file.path(), name),
                "extract a coarser --level, or use a larger machine");
  const std::optional<Proxy> proxy = proxyWithin(request.error, level);
  if (!proxy)
    throw ToolError(Exit::kUnsupported,
                    fmt::format("{}: the coordinates of {} are too far from the origin, or its voxels too "
                                "small, for the numbers of a mesh file; bake it nearer to the origin, or "
                                "allow a larger --error",
                                request.file.path(), name));
  note(request,
       fmt::format(
           "{}: {} triangles for {}; at most {:.3f} voxels from the voxels' surface, no point of which "
           "is more than {:.3f} from them",
           name, countText(proxy->mesh.n_faces()), countText(2 * faces), proxy->out, proxy->in));
  return encodeMesh(proxy->mesh, extension);
}

}  // namespace

void extractProxy(const ExtractRequest& request) {
  const fs::path output = console::pathOf(request.output);
  const std::string extension = extensionOf(output);
  const std::vector<std::uint32_t> parts = solidParts(request, "a mesh");
  std::vector<PartFile> files;
  std::set<std::string> taken;
  for (const std::uint32_t part : parts) {
    fs::path path = output;
    if (parts.size() > 1)
      path.replace_extension("." + partFileName(request.part(part).name, part, taken) +
                             output.extension().string());
    checkNotOverwritten(path, console::pathOf(request.file.path()));
    checkOutput(path);
    files.push_back({path, {}});
  }
  bool any = false;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    files[i].bytes = proxyOf(request, parts[i], extension);
    any = any || !files[i].bytes.empty();
    if (files[i].bytes.empty() && parts.size() > 1)
      note(request, fmt::format("part {} '{}' left out: it has no voxels", parts[i],
                                nameText(request.part(parts[i]).name, 40)));
  }
  if (!any)
    throw ToolError(Exit::kUnsupported, request.file.path() + ": has no voxels, so there is no surface");
  for (const PartFile& file : files) {
    if (file.bytes.empty()) continue;
    OutputFile out(file.path);
    out.write(file.bytes);
    out.commit();
  }
}

constinit const Writer kProxyWriter{.write = extractProxy};

}  // namespace kelp::dump
