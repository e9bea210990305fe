// SPDX-License-Identifier: MIT
#include "skin_sockets.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "kelp/common/dense_index.h"
#include "keys.h"
#include "moments.h"
#include "rigid.h"

namespace kelp::bake {
namespace {

// `below` and `above` layers of empty voxels more.
void growAlongY(VoxelGrid& grid, int below, int above) {
  const glm::ivec3 old = grid.size;
  grid.size.y += below + above;
  std::vector<std::uint8_t> solid(denseCount(grid.size), 0);
  for (int z = 0; z < old.z; ++z)
    for (int y = 0; y < old.y; ++y) {
      const auto row = grid.solid.begin() + static_cast<std::ptrdiff_t>(denseIndex(old, 0, y, z));
      std::copy(row, row + old.x,
                solid.begin() + static_cast<std::ptrdiff_t>(denseIndex(grid.size, 0, y + below, z)));
    }
  for (SurfaceSample& sample : grid.surface)
    sample.index = denseIndex(grid.size, voxelAt(old, sample.index) + glm::ivec3(0, below, 0));
  grid.solid = std::move(solid);
  grid.to_node[3] = grid.to_node * glm::vec4(0, static_cast<float>(-below), 0, 1);
}

// A socket's place and axes in the voxels of the part's grid, straight.
struct Seat {
  glm::dvec3 at{0};
  glm::dmat3 axes{1};
};

Seat seatIn(const SkinPart& part, const std::optional<SkinSweep>& sweep, const SkinSpace& space,
            const glm::dmat4& place) {
  const glm::dmat4x3 to_node(part.grid.to_node);
  const glm::dmat3 back = glm::inverse(linearOf(to_node));
  Seat seat{back * (glm::dvec3(place[3]) - to_node[3]), back * glm::dmat3(place)};
  if (!sweep) return seat;
  seat.at = glm::dvec3(sweep->straightened(sweep->toPart(glm::dvec3(space.from_soup * place[3]))));
  const glm::dmat3 section = linearOf(glm::dmat4x3(sectionAt(sweep->arcs, static_cast<float>(seat.at.y))));
  seat.axes = glm::transpose(section) * seat.axes;
  return seat;
}

// The rotation of axes that may be stretched; y keeps its direction.
glm::quat turnOf(const glm::dmat3& axes) {
  const glm::dvec3 y = glm::normalize(axes[1]), x = glm::normalize(axes[0] - glm::dot(axes[0], y) * y);
  return glm::quat(quaternionOf({x, y, glm::cross(x, y)}));
}

}  // namespace

void addSkinSockets(const SourceSkin& skin, const SkinSpace& space, const PartTree& tree,
                    const std::vector<std::uint32_t>& part_of_socket, std::vector<SkinPart>& parts,
                    std::vector<std::string>& notices) {
  std::vector<int> heights, grown_below(parts.size(), 0), grown_above(parts.size(), 0);
  for (const SkinPart& part : parts) heights.push_back(part.grid.size.y);
  for (const bool places : {false, true})  // first the boxes grow
    for (std::size_t i = 0; i < skin.sockets.size(); ++i) {
      const SourceSkin::Socket& socket = skin.sockets[i];
      const std::uint32_t p = part_of_socket[i];
      SkinPart& part = parts[p];
      const Seat seat = seatIn(part, tree.sweeps[p], space, socket.place);
      const glm::dvec3 size(part.grid.size);
      if (!places) {
        if (tree.sweeps[p]) continue;
        const auto layers = [&](double beyond, int& grown) {
          const int room = heights[p] - grown;
          const int more = !(beyond > 0) ? 0 : beyond < room ? static_cast<int>(std::ceil(beyond)) : room;
          grown += more;
          return more;
        };
        const int below = layers(-seat.at.y, grown_below[p]),
                  above = layers(seat.at.y - size.y, grown_above[p]);
        if (below + above > 0) growAlongY(part.grid, below, above);
        continue;
      }
      constexpr double kFarthest = 1e6;  // in heights of the part
      if (!(glm::length(seat.at - 0.5 * size) < kFarthest * size.y)) {
        notices.push_back("socket '" + socket.name + "' is too far from part '" + part.name +
                          "' to be on it: it is left out");
        continue;
      }
      RigDescription::Socket& its = part.rig.sockets.emplace_back();
      its.name = socket.name;
      its.at = static_cast<float>(std::clamp(seat.at.y / size.y, 0.0, 1.0));
      its.offset = glm::vec3((seat.at.x - 0.5 * size.x) / size.y, 0, (seat.at.z - 0.5 * size.z) / size.y);
      its.rotation = turnOf(seat.axes);
    }
}

SocketSeats seatSockets(const SourceSkin& skin, const SkinSpace& space, const PartTree& tree,
                        const std::vector<std::vector<RigDescription::Clip>>& clips) {
  constexpr int kMoments = 12;
  const std::size_t parts = tree.parents.size(), count = skin.sockets.size();
  // How far each part takes each socket from its joint at most, and in which clip.
  std::vector<double> most(count * parts, 0);
  std::vector<std::uint32_t> worst(count * parts, 0);
  // Of each socket in the bind pose, and of each part that is swept, straight.
  std::vector<glm::dvec3> places;
  std::vector<glm::vec3> straight(count * parts);
  for (const SourceSkin::Socket& socket : skin.sockets)
    places.emplace_back(space.from_soup * socket.place[3]);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t p = 0; p < parts; ++p)
      if (tree.sweeps[p])
        straight[i * parts + p] = tree.sweeps[p]->straightened(tree.sweeps[p]->toPart(places[i]));
  for (std::uint32_t c = 0; c < clips.size() && count > 0; ++c) {
    const std::vector<double> times = evenTimes(skin.clips[c], kMoments);
    const SkinMoments moments = momentsAt(skin, c, times, space, 1);
    for (std::size_t t = 0; t < times.size(); ++t) {
      const std::vector<SkinPose> poses = posesOfKeys(clips[c], tree, space, times[t]);
      for (std::size_t p = 0; p < parts; ++p) {
        std::optional<PosedSweep> swept;
        if (tree.sweeps[p]) swept.emplace(*tree.sweeps[p], poses[p]);
        for (std::size_t i = 0; i < count; ++i) {
          const glm::dvec4 at(places[i], 1);
          const glm::dvec3 posed = swept ? swept->at(straight[i * parts + p]) : poses[p].motion * at;
          const double off = glm::distance(posed, moments.motion(t, skin.sockets[i].joint) * at);
          if (off <= most[i * parts + p]) continue;
          most[i * parts + p] = off;
          worst[i * parts + p] = c;
        }
      }
    }
  }
  constexpr double kNear = 1, kMuchNearer = 1.5;  // units
  SocketSeats seats;
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = most.begin() + static_cast<std::ptrdiff_t>(i * parts);
    const auto best =
        static_cast<std::uint32_t>(std::min_element(row, row + static_cast<std::ptrdiff_t>(parts)) - row);
    std::uint32_t part = tree.part_of_joint[skin.sockets[i].joint];
    if (row[part] > std::max(kNear, kMuchNearer * row[best])) part = best;
    seats.parts.push_back(part);
    seats.fits.push_back({skin.sockets[i].name, tree.names[part],
                          clips.empty() ? "" : skin.clips[worst[i * parts + part]].name,
                          row[part] * space.voxels});
  }
  return seats;
}

}  // namespace kelp::bake
