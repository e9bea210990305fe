// SPDX-License-Identifier: MIT
#include "contained/wire.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <tuple>
#include <type_traits>
#include <vector>

#include <sys/uio.h>

namespace kelp::bake_cli {
namespace {

using bake::Report;

// The fields of each struct in the order of the wire. Both ends are one program.
auto fieldsOf(glm::ivec3& v) { return std::tie(v.x, v.y, v.z); }
auto fieldsOf(bake::MeshCounts& c) {
  return std::tie(c.vertices, c.triangles, c.boundary_edges, c.boundaries, c.non_manifold_edges, c.dropped);
}
auto fieldsOf(bake::EdgeCounts& d) {
  return std::tie(d.open_edges, d.split_edges, d.split_vertices, d.cut_edges, d.holes);
}
auto fieldsOf(bake::FillCounts& c) {
  return std::tie(c.components, c.closed, c.capped, c.sheets, c.walls, c.doubled, c.turned, c.cap_triangles,
                  c.kept_voxels, c.diagnosis);
}
auto fieldsOf(bake::ComponentReport& c) {
  return std::tie(c.triangles, c.surface_share, c.solid, c.why, c.diagnosis);
}
auto fieldsOf(bake::FilesUsed::File& f) { return std::tie(f.path, f.xxh3); }
auto fieldsOf(bake::FilesUsed& f) { return std::tie(f.read, f.missing); }
auto fieldsOf(Report::Stage& s) { return std::tie(s.name, s.seconds, s.peak_bytes); }
auto fieldsOf(Report::Fit& f) { return std::tie(f.mean, f.p95, f.max, f.joint); }
auto fieldsOf(Report::Part& p) {
  return std::tie(p.name, p.rig_origin, p.fill, p.size, p.voxel_size, p.triangles, p.solid_voxels,
                  p.surface_voxels, p.bricks, p.fog, p.fog_voxels, p.closed, p.empty, p.mesh, p.repairs,
                  p.parent, p.parent_at, p.swept, p.caged, p.cell, p.roll, p.sockets, p.components, p.fit);
}
auto fieldsOf(Report::Clip& c) {
  return std::tie(c.name, c.part, c.duration, c.leaves_box, c.bends, c.moves, c.fit);
}
auto fieldsOf(Report& r) {
  return std::tie(r.format, r.stages, r.parts, r.clips, r.notices, r.files, r.materials, r.images,
                  r.palette_entries, r.palette_materials, r.palette_error, r.estimated_bytes);
}
auto fieldsOf(Stage& s) { return std::tie(s.name, s.done, s.estimated_bytes); }
auto fieldsOf(Containment& c) { return std::tie(c.landlock, c.seccomp); }

template <class T>
constexpr bool kIsVector = false;
template <class T>
constexpr bool kIsVector<std::vector<T>> = true;

class Packer {
 public:
  template <class T>
  Packer& put(const T& value) {
    if constexpr (std::is_arithmetic_v<T>) {
      bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    } else if constexpr (std::is_same_v<T, std::string>) {
      put(std::uint64_t{value.size()});
      bytes_ += value;
    } else if constexpr (std::is_same_v<T, std::filesystem::path>) {
      put(value.native());
    } else if constexpr (kIsVector<T>) {
      put(std::uint64_t{value.size()});
      for (const auto& element : value) put(element);
    } else {
      std::apply([this](const auto&... field) { (this->put(field), ...); }, fieldsOf(const_cast<T&>(value)));
    }
    return *this;
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

// Takes at most a few times the memory of the bytes: a vector grows as its elements come.
class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : left_(bytes) {}

  template <class T>
  Unpacker& take(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      std::uint8_t byte = 0;
      take(byte);
      if (byte > 1) throw std::out_of_range("neither true nor false");
      value = byte == 1;
    } else if constexpr (std::is_arithmetic_v<T>) {
      std::memcpy(&value, next(sizeof value).data(), sizeof value);
    } else if constexpr (std::is_same_v<T, std::string>) {
      value = next(takeSize());
    } else if constexpr (std::is_same_v<T, std::filesystem::path>) {
      value = std::filesystem::path(std::string(next(takeSize())));
    } else if constexpr (kIsVector<T>) {
      value.clear();
      for (std::uint64_t i = takeSize(); i > 0; --i) take(value.emplace_back());
    } else {
      std::apply([this](auto&... field) { (this->take(field), ...); }, fieldsOf(value));
    }
    return *this;
  }
  void end() const {
    if (!left_.empty()) throw std::length_error("trailing bytes");
  }

 private:
  std::uint64_t takeSize() {
    std::uint64_t size = 0;
    take(size);
    return size;
  }
  std::string_view next(std::uint64_t size) {
    if (size > left_.size()) throw std::length_error("more than it has");
    const std::string_view taken = left_.substr(0, size);
    left_.remove_prefix(size);
    return taken;
  }

  std::string_view left_;
};

constexpr std::uint32_t kMostOfError = 64 << 10;
constexpr std::uint32_t kMostOfOthers = 1 << 10;
// A report of the most parts that a pack may have, with all their components, takes half of this.
constexpr std::uint32_t kMostOfReport = 64 << 20;
constexpr std::size_t kHead = sizeof(Word) + sizeof(std::uint32_t);

std::uint32_t mostBytes(Word word) {
  switch (word) {
    case Word::kDone:
      return kMostOfReport;
    case Word::kFailed:
      return kMostOfError + kMostOfOthers;
    case Word::kProgress:
    case Word::kForbidden:
      return kMostOfOthers;
  }
  throw std::out_of_range("an unknown word");
}

}  // namespace

// One call, so that no other thread's message comes between head and content. Safe in a signal handler.
bool tell(int pipe, Word word, std::string_view content) {
  std::array<char, kHead> head;
  const auto size = static_cast<std::uint32_t>(content.size());
  std::memcpy(head.data(), &word, sizeof word);
  std::memcpy(head.data() + sizeof word, &size, sizeof size);
  std::array<iovec, 2> parts{
      {{head.data(), head.size()}, {const_cast<char*>(content.data()), content.size()}}};
  while (parts[0].iov_len + parts[1].iov_len > 0) {
    const ssize_t written = ::writev(pipe, parts.data(), static_cast<int>(parts.size()));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    auto left = static_cast<std::size_t>(written);
    for (iovec& part : parts) {
      const std::size_t sent = std::min(left, part.iov_len);
      part = {static_cast<char*>(part.iov_base) + sent, part.iov_len - sent};
      left -= sent;
    }
  }
  return true;
}

std::string packed(const Stage& stage) { return Packer().put(stage).take(); }

std::string packed(const bake::Report& report, const Containment& containment) {
  return Packer().put(report).put(containment).take();
}

std::string packed(const ToolError& error) {
  return Packer()
      .put(static_cast<int>(error.exit))
      .put(std::string(std::string_view(error.what()).substr(0, kMostOfError)))
      .take();
}

Stage unpackedStage(std::string_view content) {
  Stage stage;
  Unpacker(content).take(stage).end();
  // The name goes to the terminal.
  if (!std::all_of(stage.name.begin(), stage.name.end(), [](char c) { return c >= ' ' && c <= '~'; }))
    throw std::out_of_range("a step without a name");
  return stage;
}

void unpack(std::string_view content, bake::Report& report, Containment& containment) {
  Unpacker(content).take(report).take(containment).end();
}

ToolError unpackedError(std::string_view content) {
  int exit = 0;
  std::string what;
  Unpacker(content).take(exit).take(what).end();
  if (exit < static_cast<int>(Exit::kUsage) || exit > static_cast<int>(Exit::kInterrupted))
    throw std::out_of_range("an exit code of " + std::to_string(exit));
  return {static_cast<Exit>(exit), what};
}

void Messages::add(std::string_view bytes) {
  bytes_.erase(0, taken_);
  taken_ = 0;
  bytes_ += bytes;
}

std::optional<Messages::Message> Messages::next() {
  const std::string_view left = std::string_view(bytes_).substr(taken_);
  if (left.size() < kHead) return std::nullopt;
  Message message;
  std::uint32_t size = 0;
  std::memcpy(&message.word, left.data(), sizeof message.word);
  std::memcpy(&size, left.data() + sizeof message.word, sizeof size);
  if (size > mostBytes(message.word))
    throw std::length_error("a message of " + std::to_string(size) + " bytes");
  if (left.size() - kHead < size) return std::nullopt;
  message.content = left.substr(kHead, size);
  taken_ += kHead + size;
  return message;
}

}  // namespace kelp::bake_cli
