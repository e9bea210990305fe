// SPDX-License-Identifier: MIT
// https://github.com/ephtracy/voxel-model, MagicaVoxel-file-format-vox.txt and -extension.txt. All sizes are
// counted first. Then voxels go from the pack to the file row by row.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "extract/extract.h"
#include "extract/vox_palette.h"
#include "kelp/common/console.h"
#include "kelp/common/output_file.h"
#include "pack/level_grid.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

constexpr int kSide = 256;             // of a model
constexpr double kFarthest = 1 << 24;  // voxels from the origin
constexpr std::uint64_t kMostBytes = std::numeric_limits<std::int32_t>::max();

// Where a part's voxels go in the file: along axis a of the file (x to the right, y to the back, z up),
// from[a] is the part's axis, sign[a] its direction, and shift[a] is added.
struct Placement {
  int from[3] = {0, 2, 1};
  int sign[3] = {1, -1, 1};
  std::int64_t shift[3] = {0, 0, 0};
  double turned = 0, moved = 0;  // what rounding did: of direction cosines, of voxels

  std::int64_t along(int axis, std::int64_t voxel) const {
    return sign[axis] > 0 ? shift[axis] + voxel : shift[axis] - 1 - voxel;
  }
  std::int64_t back(int axis, std::int64_t place) const {
    return sign[axis] > 0 ? place - shift[axis] : shift[axis] - 1 - place;
  }
};

// The placement in whole voxels and quarter turns that is nearest to the part's. `edge`: of the file's
// voxels, in meters.
Placement placementOf(const LevelVoxels& level, double edge) {
  Placement out;
  const glm::dmat4x3& to_object = level.toObject();
  // Object axes of the file's: x, -z, y.
  constexpr int kObjectAxis[3] = {0, 2, 1};
  constexpr int kObjectSign[3] = {1, -1, 1};
  constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  double best = -1;
  for (const auto& order : kOrders) {  // which part axis runs along each object axis
    double sum = 0;
    for (int object = 0; object < 3; ++object) sum += std::abs(to_object[order[object]][object]);
    if (!(sum > best)) continue;
    best = sum;
    for (int axis = 0; axis < 3; ++axis) {
      const int object = kObjectAxis[axis];
      out.from[axis] = order[object];
      out.sign[axis] = (to_object[order[object]][object] < 0 ? -1 : 1) * kObjectSign[axis];
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double exact = kObjectSign[axis] * to_object[3][kObjectAxis[axis]] / edge;
    out.turned =
        std::max(out.turned, std::abs(std::abs(to_object[out.from[axis]][kObjectAxis[axis]]) / edge - 1));
    out.moved = std::max(out.moved, std::abs(exact - std::round(exact)));
    out.shift[axis] =
        std::abs(exact) <= kFarthest ? std::llround(exact) : std::numeric_limits<std::int64_t>::max();
  }
  return out;
}

// A model: a box of one part's voxels in the file's space, at most kSide long.
struct Model {
  std::uint32_t part = 0;
  std::int64_t low[3] = {}, high[3] = {};  // the last beyond
  std::uint32_t voxels = 0;
};

class Chunk {
 public:
  explicit Chunk(const char* id) : id_(id) {}
  Chunk& integer(std::int64_t value) {
    const auto bits = static_cast<std::uint32_t>(value);
    for (int shift = 0; shift < 32; shift += 8) content_ += static_cast<char>(bits >> shift & 0xffu);
    return *this;
  }
  Chunk& text(std::string_view text) {
    integer(static_cast<std::int64_t>(text.size()));
    content_ += text;
    return *this;
  }
  Chunk& raw(std::string_view bytes) {
    content_ += bytes;
    return *this;
  }
  Chunk& dictionary(const VoxAttributes& attributes) {
    integer(static_cast<std::int64_t>(attributes.size()));
    for (const auto& [key, value] : attributes) text(key).text(value);
    return *this;
  }
  // The caller writes `more` bytes of content after it.
  std::string bytes(std::uint64_t more = 0, std::uint64_t children = 0) const {
    Chunk head("");
    head.integer(static_cast<std::int64_t>(content_.size() + more))
        .integer(static_cast<std::int64_t>(children));
    return id_ + head.content_ + content_;
  }

 private:
  std::string id_, content_;
};

class VoxWriter {
 public:
  explicit VoxWriter(const ExtractRequest& request)
      : request_(request), parts_(solidParts(request, "MagicaVoxel")) {}

  void write() {
    std::array<bool, 256> used{};
    for (const std::uint32_t part : parts_) countPart(part, used);
    palette_ = voxPalette(request_.file.pack().palette(), used);
    const std::string rest = scene() + colors();
    std::uint64_t bytes = rest.size();
    for (const Model& model : models_)
      bytes += sizeChunk(model).size() + 16 + std::uint64_t{4} * model.voxels;
    if (bytes > kMostBytes)
      throw ToolError(
          Exit::kUnsupported,
          fmt::format(
              "{}: needs {} for its voxels, a .vox file holds {}; extract a coarser --level, or one --part",
              request_.file.path(), bytesText(bytes), bytesText(kMostBytes)));
    OutputFile out = OutputFile::orStandardOutput(console::pathOf(request_.output));
    out.write(Chunk("VOX ").integer(200).bytes().erase(4, 8));
    out.write(Chunk("MAIN").bytes(0, bytes));
    for (std::size_t first = 0; first < models_.size();) first = writeModels(first, out);
    out.write(rest);
    out.commit();
    for (const std::string& text : palette_.notes) note(request_, text);
    noteRigs(request_, parts_, glm::dmat3(glm::dvec3(1, 0, 0), glm::dvec3(0, 0, -1), glm::dvec3(0, 1, 0)));
    sayWhereItStands();
  }

 private:
  // A part's models, and which colors its voxels have.
  void countPart(std::uint32_t part, std::array<bool, 256>& used) {
    const LevelVoxels level = request_.read(part);
    if (edge_ == 0) edge_ = level.edge();
    Placement placement = placementOf(level, edge_);
    for (const std::int64_t shift : placement.shift)
      if (shift == std::numeric_limits<std::int64_t>::max())
        throw ToolError(Exit::kUnsupported,
                        fmt::format("{}: {}: is more than {} voxels from the origin, which .vox files cannot "
                                    "hold; bake it nearer",
                                    request_.file.path(),
                                    levelText(request_.file.pack(), part, request_.level), kFarthest));
    turned_ = std::max(turned_, placement.turned);
    moved_ = std::max(moved_, placement.moved);
    std::int64_t low[3], high[3];
    int blocks[3];
    for (int axis = 0; axis < 3; ++axis) {
      const int side = level.size()[placement.from[axis]];
      low[axis] = std::min(placement.along(axis, 0), placement.along(axis, side - 1));
      high[axis] = low[axis] + side;
      blocks[axis] = (side + kSide - 1) / kSide;
    }
    const std::size_t first = models_.size();
    for (int z = 0; z < blocks[2]; ++z)
      for (int y = 0; y < blocks[1]; ++y)
        for (int x = 0; x < blocks[0]; ++x) {
          Model& model = models_.emplace_back();
          const int block[3] = {x, y, z};
          model.part = part;
          for (int axis = 0; axis < 3; ++axis) {
            model.low[axis] = low[axis] + static_cast<std::int64_t>(block[axis]) * kSide;
            model.high[axis] = std::min(model.low[axis] + kSide, high[axis]);
          }
        }
    level.eachSolid([&](const glm::ivec3& voxel) {
      std::size_t at = 0;
      for (int axis = 2; axis >= 0; --axis)
        at = at * static_cast<std::size_t>(blocks[axis]) +
             static_cast<std::size_t>((placement.along(axis, voxel[placement.from[axis]]) - low[axis]) /
                                      kSide);
      ++models_[first + at].voxels;
    });
    level.eachSurface(
        [&](const glm::ivec3&, std::uint32_t attribute) { used[attributePalette(attribute)] = true; });
    used[0] = used[0] || level.surfaceVoxels() == 0;
    models_.erase(std::remove_if(models_.begin() + static_cast<std::ptrdiff_t>(first), models_.end(),
                                 [](const Model& model) { return model.voxels == 0; }),
                  models_.end());
    placements_.push_back(placement);
  }

  std::string sizeChunk(const Model& model) const {
    Chunk chunk("SIZE");
    for (int axis = 0; axis < 3; ++axis) chunk.integer(model.high[axis] - model.low[axis]);
    return chunk.bytes();
  }

  // Writes all models of one part. Returns the index of the next part's first model.
  std::size_t writeModels(std::size_t first, OutputFile& out) const {
    const std::uint32_t part = models_[first].part;
    const LevelVoxels level = request_.read(part);
    const Placement& placement =
        placements_[static_cast<std::size_t>(std::find(parts_.begin(), parts_.end(), part) - parts_.begin())];
    std::size_t at = first;
    for (; at < models_.size() && models_[at].part == part; ++at)
      writeModel(models_[at], level, placement, out);
    return at;
  }

  void writeModel(const Model& model, const LevelVoxels& level, const Placement& placement,
                  OutputFile& out) const {
    out.write(sizeChunk(model));
    out.write(Chunk("XYZI").integer(model.voxels).bytes(std::uint64_t{4} * model.voxels));
    // The model's box in the part, whose rows go along x.
    glm::ivec3 low(0), high(0);
    int to[3] = {};  // the file's axis of each of the part's
    for (int axis = 0; axis < 3; ++axis) {
      const int part_axis = placement.from[axis];
      const auto a = placement.back(axis, model.low[axis]), b = placement.back(axis, model.high[axis] - 1);
      low[part_axis] = static_cast<int>(std::min(a, b));
      high[part_axis] = static_cast<int>(std::max(a, b)) + 1;
      to[part_axis] = axis;
    }
    std::vector<std::int16_t> row(static_cast<std::size_t>(high.x - low.x));
    const auto local = [&](int part_axis, int voxel) {
      return static_cast<char>(placement.along(to[part_axis], voxel) - model.low[to[part_axis]]);
    };
    char bytes[4];
    const auto writeRow = [&](int y, int z) {
      level.paletteRow(y, z, low.x, row);
      bytes[to[1]] = local(1, y);
      bytes[to[2]] = local(2, z);
      for (int x = low.x; x < high.x; ++x) {
        const std::int16_t entry = row[static_cast<std::size_t>(x - low.x)];
        if (entry == LevelVoxels::kEmpty) continue;
        bytes[to[0]] = local(0, x);
        bytes[3] = static_cast<char>(palette_.index_of[static_cast<std::size_t>(entry)]);
        out.write(std::string_view(bytes, 4));
      }
    };
    const auto endOfBrick = [](int voxel, int end) {
      return std::min(voxel / kBrickSide * kBrickSide + kBrickSide, end);
    };
    std::vector<int> rows;  // that may hold something, of a layer of bricks
    for (int layer = low.z; layer < high.z; layer = endOfBrick(layer, high.z)) {
      rows.clear();
      for (int y = low.y; y < high.y; y = endOfBrick(y, high.y)) {
        if (!level.anyBrick(low.x, high.x, y, layer)) continue;
        for (int in_brick = y; in_brick < endOfBrick(y, high.y); ++in_brick) rows.push_back(in_brick);
      }
      for (int z = layer; z < endOfBrick(layer, high.z); ++z)
        for (const int y : rows) writeRow(y, z);
    }
  }

  // Node 0 above a group of all parts; a part is one shape, or a group of shapes where it is too large for
  // one.
  std::string scene() const {
    std::string nodes;
    int next = 2;
    std::vector<int> tops;
    const auto transform = [&](int id, int child, int layer, const VoxAttributes& attributes,
                               const VoxAttributes& frame) {
      nodes += Chunk("nTRN")
                   .integer(id)
                   .dictionary(attributes)
                   .integer(child)
                   .integer(-1)
                   .integer(layer)
                   .integer(1)
                   .dictionary(frame)
                   .bytes();
    };
    const auto group = [&](int id, const std::vector<int>& children) {
      Chunk chunk("nGRP");
      chunk.integer(id).dictionary({}).integer(static_cast<std::int64_t>(children.size()));
      for (const int child : children) chunk.integer(child);
      nodes += chunk.bytes();
    };
    const auto shape = [&](std::size_t model, const VoxAttributes& attributes) {
      // A transform places a model's middle: the corner at half its size, rounded down.
      std::string place;
      for (int axis = 0; axis < 3; ++axis)
        place += fmt::format(
            "{}{}", axis ? " " : "",
            models_[model].low[axis] + (models_[model].high[axis] - models_[model].low[axis]) / 2);
      transform(next, next + 1, 0, attributes, {{"_t", place}});
      nodes += Chunk("nSHP")
                   .integer(next + 1)
                   .dictionary({})
                   .integer(1)
                   .integer(static_cast<std::int64_t>(model))
                   .dictionary({})
                   .bytes();
      next += 2;
      return next - 2;
    };
    for (std::size_t first = 0; first < models_.size();) {
      std::size_t end = first;
      while (end < models_.size() && models_[end].part == models_[first].part) ++end;
      const VoxAttributes name = {{"_name", std::string(request_.part(models_[first].part).name)}};
      if (end - first == 1) {
        tops.push_back(shape(first, name));
      } else {
        const int top = next;
        next += 2;
        std::vector<int> shapes;
        for (std::size_t model = first; model < end; ++model) shapes.push_back(shape(model, {}));
        transform(top, top + 1, 0, name, {});
        group(top + 1, shapes);
        tops.push_back(top);
      }
      first = end;
    }
    // Where objects overlap, MagicaVoxel shows the first one. In kelp the last part is on top.
    std::reverse(tops.begin(), tops.end());
    transform(0, 1, -1, {}, {});
    group(1, tops);
    return nodes;
  }

  std::string colors() const {
    std::string chunks;
    const auto bytes = [](const auto& array) {
      return std::string_view(reinterpret_cast<const char*>(array.data()), sizeof array);
    };
    chunks += Chunk("RGBA").raw(bytes(palette_.rgba)).bytes();
    if (palette_.order) chunks += Chunk("IMAP").raw(bytes(*palette_.order)).bytes();
    for (const auto& [index, attributes] : palette_.materials)
      chunks += Chunk("MATL").integer(index).dictionary(attributes).bytes();
    return chunks;
  }

  void sayWhereItStands() const {
    if (turned_ > 1e-4)
      note(request_,
           "parts were rotated to the nearest quarter turn and scaled to one voxel size: .vox files hold no "
           "others");
    if (moved_ > 1e-3)
      note(request_, fmt::format("parts were moved by up to {:.2f} voxels, to whole voxels", moved_));
    if (std::abs(edge_ - 1) > 1e-6)
      note(request_,
           fmt::format("voxels are {} wide, which .vox files cannot hold; bake with --voxel-size {}",
                       metersText(edge_), static_cast<float>(edge_)));
  }

  const ExtractRequest& request_;
  std::vector<std::uint32_t> parts_;
  std::vector<Placement> placements_;  // by parts_
  std::vector<Model> models_;
  VoxPalette palette_;
  double edge_ = 0, turned_ = 0, moved_ = 0;
};

}  // namespace

void extractVox(const ExtractRequest& request) { VoxWriter(request).write(); }

constinit const Writer kVoxWriter{.shown_as = "a MagicaVoxel model", .write = extractVox};

}  // namespace kelp::dump
