// SPDX-License-Identifier: MIT
// Decimated surfaces. A file for each part, since parts move by themselves.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "extract/extract.h"
#include "kelp/common/console.h"
#include "kelp/common/output_file.h"
#include "proxy/decimate.h"
#include "proxy/encode_mesh.h"
#include "text/memory_check.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExtensions[] = {".obj", ".ply", ".stl", ".off"};
// A face is two triangles with all that is kept of them while they are decimated (measured: 560 bytes).
constexpr std::uint64_t kBytesOfFace = 600;
// A face that several triangles cover can lose one of them, so decimate() may end a bit too far away.
constexpr int kAttempts = 5;

// Below it nearly every triangle stays, and finding the others takes hours.
constexpr double kLeastError = 0.1;

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

// As the file has them: in metres, as floats.
std::vector<glm::vec3> pointsOfFile(const ProxyMesh& proxy, const glm::dmat4x3& to_object) {
  std::vector<glm::vec3> points;
  for (const glm::dvec3& point : proxy.points) points.emplace_back(to_object * glm::dvec4(point, 1));
  return points;
}

// The proxy with the points of the file.
ProxyMesh asFile(const ProxyMesh& proxy, const std::vector<glm::vec3>& points,
                 const glm::dmat4x3& to_object) {
  ProxyMesh written{{}, proxy.triangles};
  const glm::dmat3 back = glm::inverse(glm::dmat3(to_object));
  for (const glm::vec3& point : points) written.points.push_back(back * (glm::dvec3(point) - to_object[3]));
  return written;
}

// STL has no indices: two vertices in one place would be one.
bool allApart(const std::vector<glm::vec3>& points) {
  std::set<std::tuple<float, float, float>> places;
  return std::all_of(points.begin(), points.end(),
                     [&](const glm::vec3& p) { return places.emplace(p.x, p.y, p.z).second; });
}

struct Proxy {
  std::vector<glm::vec3> points;  // as in the file
  std::vector<std::array<std::uint32_t, 3>> triangles;
  double out = 0, in = 0;  // voxels from the voxels' surface, and that from it

  double apart() const { return std::max(out, in); }
};

Proxy measured(const ProxyMesh& mesh, const SurfaceDistance& distance, const glm::dmat4x3& to_object,
               double error) {
  Proxy proxy{pointsOfFile(mesh, to_object), mesh.triangles};
  const ProxyMesh written = asFile(mesh, proxy.points, to_object);
  // Far from the origin floats are too coarse; there is nothing to measure.
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    if (!(glm::distance(mesh.points[i], written.points[i]) <= error / 4)) {
      proxy.out = proxy.in = std::numeric_limits<double>::infinity();
      return proxy;
    }
  proxy.out = distance.fromMesh(written, error);
  proxy.in = distance.toMesh(written, error);
  if (glm::determinant(glm::dmat3(to_object)) < 0)  // mirrored
    for (auto& [a, b, c] : proxy.triangles) std::swap(b, c);
  return proxy;
}

// What is thinner than the error can turn inside out while it is decimated.
bool facesOutward(const ProxyMesh& mesh) {
  double volume = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle t = mesh.triangle(i);
    volume += glm::dot(t.a, glm::cross(t.b, t.c));
  }
  return volume > 0;
}

// Nothing if the numbers of a file are too coarse: the surface as it is, without decimation, is near enough
// in all other cases.
std::optional<Proxy> proxyWithin(double error, const VoxelSurface& surface,
                                 const std::vector<VoxelFace>& faces, const SurfaceDistance& distance,
                                 const glm::dmat4x3& to_object) {
  double most = error - SurfaceDistance::tolerance(error);
  for (int attempt = error < kLeastError ? kAttempts : 0; attempt <= kAttempts; ++attempt) {
    const ProxyMesh mesh = attempt == kAttempts ? ProxyMesh{surface.place, surface.triangles}
                                                : decimate(surface, faces, distance, most);
    const Proxy proxy = measured(mesh, distance, to_object, error);
    if (proxy.apart() <= error && allApart(proxy.points) && facesOutward(mesh)) return proxy;
    most *= 0.998 * std::min(1.0, error / proxy.apart());
    if (!std::isfinite(proxy.apart())) break;
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
  const std::vector<VoxelFace> faces = facesOf(level);
  if (faces.empty()) return {};
  requireMemory(kBytesOfFace * faces.size(), fmt::format("{}: the proxy of {}", request.file.path(), name),
                "extract a coarser --level, or use a larger machine");
  const SurfaceDistance distance(level, faces);
  const VoxelSurface surface = surfaceOf(level, faces, request.error / 2);
  const std::optional<Proxy> proxy = proxyWithin(request.error, surface, faces, distance, level.toObject());
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
           name, countText(proxy->triangles.size()), countText(2 * faces.size()), proxy->out, proxy->in));
  return encodeMesh(proxy->points, proxy->triangles, extension);
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
      path.replace_extension("." + partFileName(request.part(part).name, part, nullptr, taken) +
                             output.extension().string());
    if (request.file.path() != "-") checkNotOverwritten(path, console::pathOf(request.file.path()));
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
