// SPDX-License-Identifier: MIT
// Format: https://github.com/ephtracy/voxel-model, MagicaVoxel-file-format-vox.txt and -extension.txt.
#include "vox_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "kelp/import/core/frame.h"
#include "kelp/import/core/text_reader.h"

namespace kelp::bake {
namespace {

constexpr std::size_t kHeader = 12;          // id, bytes of content, bytes of children
constexpr std::int64_t kFarthest = 1 << 24;  // beyond, 32-bit floats no longer tell voxels apart

// Reads a chunk's content from its beginning.
class Chunk {
 public:
  Chunk(const InputFiles& files, std::string_view id, std::size_t at, std::span<const std::uint8_t> content)
      : files_(files), id_(id), at_(at), left_(content) {}

  [[noreturn]] void damaged(const std::string& what) const {
    refuse(Exit::kInvalid, files_.input(), place(), what);
  }
  std::string place() const { return oneLine(id_, 4) + " chunk at byte " + std::to_string(at_); }

  std::size_t left() const { return left_.size(); }
  std::span<const std::uint8_t> take(std::size_t count) {
    if (count > left_.size()) damaged("ends too early; the file is damaged: save it again");
    const auto bytes = left_.first(count);
    left_ = left_.subspan(count);
    return bytes;
  }
  std::int32_t integer() {
    const auto b = take(4);
    return static_cast<std::int32_t>(b[0] | std::uint32_t{b[1]} << 8 | std::uint32_t{b[2]} << 16 |
                                     std::uint32_t{b[3]} << 24);
  }
  float real() {
    const std::int32_t bits = integer();
    float value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  // The number of items that follow, of at least `each` bytes.
  std::size_t count(const char* what, std::size_t each) {
    const std::int32_t count = integer();
    if (count < 0 || static_cast<std::size_t>(count) > left_.size() / each)
      damaged("claims " + std::to_string(static_cast<std::uint32_t>(count)) + " " + what +
              ", more than it holds; save the file again");
    return static_cast<std::size_t>(count);
  }
  std::string_view text() {
    const auto bytes = take(count("characters", 1));
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

 private:
  const InputFiles& files_;
  std::string_view id_;
  std::size_t at_;
  std::span<const std::uint8_t> left_;
};

// A DICT: a few entries, looked up by name.
class Dictionary {
 public:
  explicit Dictionary(Chunk& chunk) : chunk_(chunk) {
    const std::size_t count = chunk.count("attributes", 8);
    for (std::size_t i = 0; i < count; ++i) {
      const std::string_view key = chunk.text();
      entries_.emplace_back(key, chunk.text());
    }
  }
  std::optional<std::string_view> find(std::string_view key) const {
    for (const auto& [name, value] : entries_)
      if (name == key) return value;
    return std::nullopt;
  }
  bool flag(std::string_view key) const { return trim(find(key).value_or("0")) == "1"; }
  std::int64_t integer(std::string_view key, std::int64_t fallback, std::int64_t least,
                       std::int64_t most) const {
    const std::optional<std::string_view> word = find(key);
    if (!word) return fallback;
    const std::optional<std::int64_t> value = parseInteger(trim(*word));
    if (!value || *value < least || *value > most) bad(key, *word);
    return *value;
  }
  std::optional<float> real(std::string_view key) const {
    const std::optional<std::string_view> word = find(key);
    const std::optional<float> value = word ? parseFloat(trim(*word)) : std::nullopt;
    return value && std::isfinite(*value) ? value : std::nullopt;
  }
  [[noreturn]] void bad(std::string_view key, std::string_view value) const {
    chunk_.damaged("has a " + std::string(key) + " that makes no sense: '" + oneLine(value, 40) +
                   "'; save the file again");
  }

 private:
  Chunk& chunk_;
  std::vector<std::pair<std::string_view, std::string_view>> entries_;
};

// A rotation in one byte: the columns of the first and the second row that are not 0, and which rows are
// negative.
VoxelTurn readTurn(const Dictionary& attributes) {
  const std::int64_t bits = attributes.integer("_r", 4, 0, 127);
  const int first = static_cast<int>(bits & 3), second = static_cast<int>(bits >> 2 & 3),
            third = 3 - first - second;
  if (first > 2 || second > 2 || first == second) attributes.bad("_r", *attributes.find("_r"));
  VoxelTurn turn(0);  // columns of rows
  turn[first][0] = bits & 16 ? -1 : 1;
  turn[second][1] = bits & 32 ? -1 : 1;
  turn[third][2] = bits & 64 ? -1 : 1;
  return turn;
}

VoxelPoint readShift(const Dictionary& attributes) {
  VoxelPoint shift(0);
  const std::optional<std::string_view> text = attributes.find("_t");
  if (!text) return shift;
  std::string_view rest = *text;
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<std::int64_t> value = parseInteger(nextWord(rest));
    if (!value || *value < -kFarthest || *value > kFarthest) attributes.bad("_t", *text);
    shift[axis] = *value;
  }
  return shift;
}

void readTransform(Chunk& chunk, const Dictionary& attributes, VoxNode& node) {
  node.kind = VoxNode::Kind::kTransform;
  node.name = attributes.find("_name").value_or("");
  node.children.push_back(chunk.integer());
  chunk.integer();  // reserved
  node.layer = chunk.integer();
  const std::size_t frames = chunk.count("frames", 4);
  for (std::size_t i = 0; i < frames; ++i) {
    const Dictionary frame(chunk);
    node.moves.push_back({frame.integer("_f", 0, 0, INT32_MAX), readTurn(frame), readShift(frame)});
  }
  if (node.moves.empty()) chunk.damaged("has no frame; save the file again");
  std::stable_sort(node.moves.begin(), node.moves.end(),
                   [](const VoxMove& a, const VoxMove& b) { return a.frame < b.frame; });
}

void readShape(Chunk& chunk, VoxNode& node) {
  node.kind = VoxNode::Kind::kShape;
  const std::size_t models = chunk.count("models", 8);
  for (std::size_t i = 0; i < models; ++i) {
    const std::int32_t model = chunk.integer();
    node.models.emplace_back(Dictionary(chunk).integer("_f", 0, 0, INT32_MAX), model);
  }
  if (node.models.empty()) chunk.damaged("has no model; save the file again");
  std::stable_sort(node.models.begin(), node.models.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
}

void readNode(Chunk& chunk, std::string_view id, VoxFile& file) {
  const std::int32_t number = chunk.integer();
  const auto [at, fresh] = file.nodes.try_emplace(number);
  if (!fresh) chunk.damaged("is a second node " + std::to_string(number) + "; save the file again");
  VoxNode& node = at->second;
  const Dictionary attributes(chunk);
  node.hidden = attributes.flag("_hidden");
  node.loop = attributes.flag("_loop");
  if (id == "nTRN") {
    readTransform(chunk, attributes, node);
  } else if (id == "nSHP") {
    readShape(chunk, node);
  } else {
    const std::size_t children = chunk.count("children", 4);
    for (std::size_t i = 0; i < children; ++i) node.children.push_back(chunk.integer());
  }
}

void readLayer(Chunk& chunk, VoxFile& file) {
  VoxLayer& layer = file.layers[chunk.integer()];
  const Dictionary attributes(chunk);
  layer.name = attributes.find("_name").value_or("");
  layer.hidden = attributes.flag("_hidden");
}

VoxMaterial::Type typeOf(std::string_view name) {
  using Type = VoxMaterial::Type;
  constexpr std::pair<std::string_view, Type> kTypes[] = {{"_metal", Type::kMetal}, {"_glass", Type::kGlass},
                                                          {"_emit", Type::kEmit},   {"_blend", Type::kBlend},
                                                          {"_media", Type::kMedia}, {"_cloud", Type::kMedia}};
  for (const auto& [word, type] : kTypes)
    if (name == word) return type;
  return Type::kDiffuse;
}

// Material 256 belongs to index 0.
void readMaterial(Chunk& chunk, VoxFile& file) {
  VoxMaterial& material = file.materials[static_cast<std::uint32_t>(chunk.integer()) & 255u];
  const Dictionary properties(chunk);
  material = {};
  material.type = typeOf(properties.find("_type").value_or("_diffuse"));
  material.weight = properties.real("_weight");
  material.metal = properties.real("_metal");
  material.rough = properties.real("_rough");
  material.emit = properties.real("_emit");
  material.flux = properties.real("_flux");
  material.transparency = properties.real("_trans");
  if (!material.transparency) material.transparency = properties.real("_alpha");
  material.plastic = properties.real("_plastic").value_or(0.0f) > 0;
}

// Materials as versions up to 0.98 wrote them: a type, its weight, and the properties whose bits are set.
void readOldMaterial(Chunk& chunk, VoxFile& file) {
  VoxMaterial& material = file.materials[static_cast<std::uint32_t>(chunk.integer()) & 255u];
  material = {};
  const std::int32_t type = chunk.integer();
  constexpr VoxMaterial::Type kTypes[] = {VoxMaterial::Type::kDiffuse, VoxMaterial::Type::kMetal,
                                          VoxMaterial::Type::kGlass, VoxMaterial::Type::kEmit};
  if (type < 0 || type > 3)
    chunk.damaged("is of a type " + std::to_string(type) +
                  " that the format does not have; save the file again");
  material.type = kTypes[type];
  const auto finite = [](float value) {
    return std::isfinite(value) ? std::optional<float>(value) : std::nullopt;
  };
  material.weight = finite(chunk.real());
  const std::int32_t bits = chunk.integer();
  for (int bit = 0; bit < 7 && chunk.left() >= 4; ++bit) {
    if (!(bits >> bit & 1)) continue;
    const std::optional<float> value = finite(chunk.real());
    if (bit == 0) material.plastic = value.value_or(0.0f) > 0;
    if (bit == 1) material.rough = value;
    if (bit == 5) material.flux = value;
  }
}

void readVoxels(Chunk& chunk, VoxModel& model) {
  const std::size_t count = chunk.count("voxels", 4);
  model.voxels = chunk.take(4 * count);
  for (std::size_t i = 0; i < model.voxels.size(); i += 4)
    for (int axis = 0; axis < 3; ++axis)
      if (model.voxels[i + static_cast<std::size_t>(axis)] >= model.size[axis])
        chunk.damaged("has a voxel outside its model; save the file again");
}

glm::ivec3 readSize(Chunk& chunk) {
  glm::ivec3 size;
  for (int axis = 0; axis < 3; ++axis) size[axis] = chunk.integer();
  for (int axis = 0; axis < 3; ++axis)
    if (size[axis] < 0 || size[axis] > 256)
      chunk.damaged("has a side of " + std::to_string(size[axis]) +
                    " voxels, and models have at most 256; save the file again");
  return size;
}

class VoxReader {
 public:
  VoxReader(const InputFiles& files, VoxFile& file, std::uint64_t max_memory)
      : files_(files), file_(file), left_(max_memory) {}

  void read(std::span<const std::uint8_t> bytes, std::size_t begin, std::size_t end) {
    for (std::size_t at = begin; at < end;) {
      if (end - at < kHeader)
        refuse(Exit::kInvalid, files_.input(), "byte " + std::to_string(at),
               "ends within a chunk; it is truncated: save the file again");
      const std::string_view id(reinterpret_cast<const char*>(bytes.data()) + at, 4);
      Chunk header(files_, id, at, bytes.subspan(at + 4, 8));
      const auto content = static_cast<std::uint32_t>(header.integer()),
                 children = static_cast<std::uint32_t>(header.integer());
      if (content > end - at - kHeader || children > end - at - kHeader - content)
        header.damaged("is longer than what holds it; the file is truncated or damaged: save it again");
      Chunk chunk(files_, id, at, bytes.subspan(at + kHeader, content));
      readChunk(id, chunk);
      at += kHeader + content + children;
    }
    if (size_)
      refuse(Exit::kInvalid, files_.input(), "", "has a SIZE without voxels at its end; save the file again");
  }

 private:
  void readChunk(std::string_view id, Chunk& chunk) {
    if (id == "SIZE") {
      if (size_) chunk.damaged("follows another without voxels between them; save the file again");
      size_ = readSize(chunk);
    } else if (id == "XYZI") {
      if (!size_) chunk.damaged("has no SIZE before it; save the file again");
      readVoxels(chunk, file_.models.emplace_back(VoxModel{*size_, {}}));
      size_.reset();
    } else if (id == "TDCZ") {
      const glm::ivec3 size = readSize(chunk);
      if (size_ && *size_ != size) chunk.damaged("has another size than the SIZE before it; save it again");
      readPacked(chunk, size);
      size_.reset();
    } else if (id == "RGBA") {
      // Teardown leaves the unused one out.
      const std::size_t bytes = chunk.left() == 1020 ? 1020 : 1024;
      std::memcpy(file_.colors.emplace().data(), chunk.take(bytes).data(), bytes);
    } else if (id == "IMAP") {
      std::memcpy(file_.index_map.emplace().data(), chunk.take(256).data(), 256);
    } else if (id == "nTRN" || id == "nGRP" || id == "nSHP") {
      readNode(chunk, id, file_);
    } else if (id == "LAYR") {
      readLayer(chunk, file_);
    } else if (id == "MATL") {
      readMaterial(chunk, file_);
    } else if (id == "MATT") {
      readOldMaterial(chunk, file_);
    } else if (id == "META") {
      const Dictionary attributes(chunk);
      std::string_view range = attributes.find("_anim_range").value_or("");
      const std::optional<std::int64_t> first = parseInteger(nextWord(range)),
                                        last = parseInteger(nextWord(range));
      if (first && last && *first >= 0 && *first <= *last && *last <= INT32_MAX)
        file_.frames.emplace(*first, *last);
    }  // PACK says what the models' count says as well; cameras, lights and notes are no voxels
  }

  void readPacked(Chunk& chunk, const glm::ivec3& size) {
    std::vector<std::uint8_t> voxels = unpackVoxels(files_, chunk.place(), chunk.take(chunk.left()), size);
    if (voxels.size() > left_)
      refuse(Exit::kRuntime, files_.input(), chunk.place(),
             "unpacks to more voxels than fit into memory; raise --max-memory, or split the file");
    left_ -= voxels.size();
    file_.models.push_back({size, file_.unpacked.emplace_back(std::move(voxels))});
  }

  const InputFiles& files_;
  VoxFile& file_;
  std::uint64_t left_;              // bytes that packed models may still take
  std::optional<glm::ivec3> size_;  // of the model whose voxels come next
};

}  // namespace

VoxFile readVoxFile(const InputFiles& files, std::span<const std::uint8_t> bytes, std::uint64_t max_memory) {
  if (bytes.empty()) refuse(Exit::kInvalid, files.input(), "", "is empty; save the model again");
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!text.starts_with(std::string_view("VOX ").substr(0, bytes.size())))
    refuse(Exit::kInvalid, files.input(), "",
           "does not look like a MagicaVoxel file (its signature is missing); check the file's type");
  Chunk head(files, "VOX ", 0, bytes);
  if (head.left() < 8 + kHeader)
    refuse(Exit::kInvalid, files.input(), "byte " + std::to_string(bytes.size()),
           "ends within its header; it is truncated: save the file again");
  head.take(4);
  VoxFile file;
  file.version = head.integer();
  if (file.version != 150 && file.version != 200)
    refuse(Exit::kUnsupported, files.input(), "",
           "is of version " + std::to_string(file.version) +
               " of the format, and 150 and 200 are known; save it with MagicaVoxel 0.98 or 0.99");
  if (text.substr(8, 4) != "MAIN")
    refuse(Exit::kInvalid, files.input(), "byte 8",
           "has no MAIN chunk where it must be; save the file again");
  head.take(4);
  const auto content = static_cast<std::uint32_t>(head.integer()),
             children = static_cast<std::uint32_t>(head.integer());
  if (content > head.left() || children > head.left() - content)
    refuse(Exit::kInvalid, files.input(), "",
           "ends before its " + std::to_string(std::uint64_t{content} + children + 8 + kHeader) +
               " bytes; it is truncated: save the file again");
  const std::size_t begin = 8 + kHeader + content, end = begin + children;
  if (end < bytes.size())
    file.notices.push_back(std::to_string(bytes.size() - end) +
                           " bytes after the end of the MAIN chunk were not read");
  VoxReader(files, file, max_memory).read(bytes, begin, end);
  return file;
}

}  // namespace kelp::bake
