// SPDX-License-Identifier: MIT
// Where the sockets of a skin are on its parts.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kelp/skin/skin.h"
#include "tree.h"

namespace kelp::bake {

// The part of each socket: the one that moves with its joint, or another that stays much nearer to where the
// joint takes it: some files animate sockets beside the joints, not below them. `clips`: [clip][part].
struct SocketSeats {
  std::vector<std::uint32_t> parts;
  std::vector<SocketFit> fits;
};
SocketSeats seatSockets(const SourceSkin& skin, const SkinSpace& space, const PartTree& tree,
                        const std::vector<std::vector<RigDescription::Clip>>& clips);

// Gives the parts their sockets, when they have their grids. The grid of a rigid part grows along y, up to
// three times its height, where a socket lies beyond it. A socket that lies farther is taken to the
// end; of one that is beyond a rig's numbers there is a notice.
void addSkinSockets(const SourceSkin& skin, const SkinSpace& space, const PartTree& tree,
                    const std::vector<std::uint32_t>& part_of_socket, std::vector<SkinPart>& parts,
                    std::vector<std::string>& notices);

}  // namespace kelp::bake
