// SPDX-License-Identifier: MIT
#include "kelp/formats/verify.h"

namespace kelp {

const char* toString(IssueId id) {
  switch (id) {
    case IssueId::kUnreadable:
      return "The file, its header or its index cannot be read. Check that the file is complete, or bake it "
             "again.";
    case IssueId::kChunkChecksum:
      return "The bytes of a chunk differ from their checksum: the file was damaged. Copy or bake it again.";
    case IssueId::kPaddingNotZero:
      return "A byte that must be zero is not: the file was changed, or its writer has a bug. Bake it again.";
    case IssueId::kUnknownChunk:
      return "This version does not know an optional chunk and skips it. A newer kelp may use it.";
    case IssueId::kMetadata:
      return "Parts, palette, rigs, clips, sockets, joints, cages or information break a rule. The writer "
             "has "
             "a bug: report it.";
    case IssueId::kNotMonotone:
      return "The rest rig of a part turns back along its axis. Shorten the tangents of its knots and bake "
             "again.";
    case IssueId::kFolds:
      return "The rest rig of a swept part bends too sharply for its thickness. Lengthen the tangents of its "
             "knots and bake again.";
    case IssueId::kGrid:
      return "The grid of a level cannot be read. Copy or bake the pack again.";
    case IssueId::kPage:
      return "A page of bricks cannot be read. Copy or bake the pack again.";
    case IssueId::kClearBrick:
      return "A stored brick of fog holds nothing. The writer has a bug: report it.";
    case IssueId::kFogOutside:
      return "A sample of fog lies outside its level. The writer has a bug: report it.";
    case IssueId::kDistanceGrid:
      return "A grid of distances cannot be read. The pack can be drawn; bake it again to ask for distances.";
    case IssueId::kDistances:
      return "A page of distances cannot be read, or its own voxels contradict it. The pack can be drawn; "
             "bake "
             "it again to ask for distances.";
  }
  return "Unknown issue.";
}

}  // namespace kelp
