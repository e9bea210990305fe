// SPDX-License-Identifier: MIT
// read_pack.py, written from SPEC.md alone, reads what the writer writes, and what it says is compared line
// by line.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <random>
#include <string>

#include "cage_lies.h"
#include "joint_lies.h"
#include "kelp/formats/verify.h"
#include "morph_lies.h"
#include "pack_compare.h"
#include "pack_surgeon.h"
#include "socket_lies.h"
#include "support/all_tests.h"
#include "support/random_pack.h"
#include "support/scratch.h"
#include "tiny_cage_pack.h"
#include "tiny_distance_pack.h"
#include "tiny_fog_pack.h"
#include "tiny_pack.h"

namespace kelp {
namespace {

constexpr int kNoZstd = 77;

// Output and exit code of a program.
struct Answer {
  int code = -1;
  std::string text;
};

Answer readPack(const std::string& arguments) {
  const std::string command =
      std::string(KELP_PYTHON) + " -B " KELP_SOURCE_DIR "/tests/formats/read_pack.py " + arguments;
  Answer out;
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (!pipe) return out;
  std::array<char, 4096> block;
  for (std::size_t got; (got = std::fread(block.data(), 1, block.size(), pipe)) > 0;)
    out.text.append(block.data(), got);
  const int status = ::pclose(pipe);
  out.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return out;
}

// A pack in a file that goes with the test.
struct PackFile {
  explicit PackFile(const std::vector<std::byte>& bytes) : path(scratch.write("pack.kelp", bytes)) {}
  test::Scratch scratch;
  std::filesystem::path path;
};

std::string format(const char* form, auto... values) {
  std::array<char, 512> text;
  std::snprintf(text.data(), text.size(), form, values...);
  return text.data();
}

// The floats of a plain struct as their bits.
template <class T>
std::string bits(const T& value) {
  std::array<std::uint32_t, sizeof(T) / 4> words;
  std::memcpy(words.data(), &value, sizeof(T));
  std::string text;
  for (const std::uint32_t word : words) text += format(text.empty() ? "%08x" : " %08x", word);
  return text;
}

std::string hex(const std::string& name) {
  std::string text;
  for (const char c : name) text += format("%02x", static_cast<unsigned>(static_cast<unsigned char>(c)));
  return text;
}

// CRC-32 of ISO 3309, as zlib's.
template <class T>
std::uint32_t crc32(const std::vector<T>& values) {
  std::uint32_t crc = ~0u;
  for (const std::byte byte : test::bytesOf(values)) {
    crc ^= static_cast<std::uint32_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1 ? 0xedb88320u : 0);
  }
  return ~crc;
}

// As a file holds them: readers count ranks.
std::vector<std::uint8_t> withoutRanks(std::vector<std::uint8_t> codes) {
  for (std::uint8_t& code : codes) code = isSurfaceCode(code) ? kSurfaceCode : code;
  return codes;
}

// offsets: for each node of a cage, in steps.
std::string dump(const RawMorph& morph, const std::vector<glm::dvec3>& offsets) {
  std::string out = format("morph %u", morph.part);
  for (std::size_t node = 0; node < offsets.size(); ++node) {
    const glm::ivec3 steps(glm::round(offsets[node]));
    if (steps != glm::ivec3(0)) out += format(" %zu ", node) + bits(morph.step * glm::vec3(steps));
  }
  return out + "\n";
}

std::string dump(const Cage& cage) {
  std::vector<std::uint32_t> places, nodes, beyond, faces, masks, rest, influences;
  for (std::uint32_t i = 0; i < cage.cells(); ++i) {
    const glm::ivec3 place = cage.place(i);
    for (int axis = 0; axis < 3; ++axis) places.push_back(static_cast<std::uint32_t>(place[axis]));
    for (int corner = 0; corner < 8; ++corner) nodes.push_back(cage.node(i, corner));
    for (int face = 0; face < 6; ++face) beyond.push_back(cage.beyond(i, face));
  }
  for (std::uint32_t i = 0; i < cage.faces(); ++i) faces.push_back(cage.face(i));
  const std::span<const std::uint32_t> after =
      cage.words.subspan(kCageHeader + kCageCellWords * cage.cells() + cage.faces());
  masks.assign(after.begin(), after.end());
  for (std::uint32_t i = 0; i < cage.nodes(); ++i)
    for (int axis = 0; axis < 3; ++axis) rest.push_back(static_cast<std::uint32_t>(cage.rest(i)[axis]));
  for (const Influences& node : cage.influences)
    for (int k = 0; k < 4; ++k) influences.insert(influences.end(), {node.parts[k], node.weights[k]});
  return format("cage side %d levels %d %d cells %u nodes %u faces %u", cage.side, cage.level,
                cage.last_level, cage.cells(), cage.nodes(), cage.faces()) +
         format(" crc %08x %08x %08x %08x %08x %08x", crc32(places), crc32(nodes), crc32(beyond),
                crc32(faces), crc32(masks), crc32(rest)) +
         format(" %08x %08x\n", crc32(test::followWords(cage)), crc32(influences));
}

std::string dumpCages(const RawPart& part) {
  std::string out;
  std::vector<Influences> influences = part.influences;
  std::vector<std::vector<glm::dvec3>> offsets(part.morphs.size());
  std::vector<CageMemory> memory(part.cages.size());
  std::vector<Cage> cages;
  for (std::size_t i = 0; i < part.cages.size(); ++i) {
    const Result<Cage> cage =
        makeCage(part.cages[i].source(), part.size, static_cast<int>(part.levels.size()), part.cell,
                 static_cast<int>(i), i > 0 ? &cages.back() : nullptr, ~std::uint64_t{0}, memory[i]);
    EXPECT_TRUE(cage);
    if (!cage) return out;
    if (i > 0) influences = test::coarserInfluences(*cage, cages.back(), influences);
    for (std::size_t m = 0; m < offsets.size(); ++m) {
      if (i > 0) offsets[m] = test::coarserOffsets(*cage, cages.back(), offsets[m]);
      if (i == 0) offsets[m].assign(cage->nodes(), glm::dvec3(0));
      for (std::size_t n = 0; i == 0 && n < part.morphs[m].nodes.size(); ++n)
        offsets[m][part.morphs[m].nodes[n]] = part.morphs[m].offsets[n];
    }
    cages.push_back(*cage);
    cages.back().influences = influences;
    out += dump(cages.back());
    for (std::size_t m = 0; m < offsets.size(); ++m) out += dump(part.morphs[m], offsets[m]);
  }
  if (part.sections >= 0) out += format("sections %d\n", part.sections);
  return out;
}

std::string dump(const RawPack& pack) {
  const bool any_caged =
      std::any_of(pack.parts.begin(), pack.parts.end(), [](const RawPart& p) { return !p.cages.empty(); });
  const bool any_empty =
      std::any_of(pack.parts.begin(), pack.parts.end(), [](const RawPart& p) { return p.levels.empty(); });
  std::string out = format("minor %d\ninfo ", any_caged              ? 3
                                              : !pack.joints.empty() ? 2
                                                                     : int{any_empty}) +
                    pack.info_json + "\n";
  for (const Material& m : pack.palette) out += "material " + bits(m) + "\n";
  for (const RawPart& part : pack.parts) {
    out += "part " + hex(part.name) +
           format(" parent %d kind %d size %d %d %d levels %zu\n", part.parent,
                  part.fog              ? 1
                  : part.levels.empty() ? 2
                                        : 0,
                  part.size.x, part.size.y, part.size.z, part.levels.size());
    out += "object " + bits(part.to_object) + "\npivot " + bits(part.pivot) + "\n";
    for (const Knot& knot : part.knots) out += "knot " + bits(knot) + "\n";
    out += format("automatic %llx parent at ", static_cast<unsigned long long>(part.automatic_tangents)) +
           bits(part.parent_at) + format("\nbend %d roll ", static_cast<int>(part.bend)) + bits(part.roll) +
           "\n";
    out += dumpCages(part);
    if (part.fog) {
      out += "fog " + bits(part.fog->color) + " " + bits(part.fog->anisotropy) + " " + bits(part.fog->glow) +
             "\n";
      for (const glm::vec3& color : part.fog->ramp) out += "color " + bits(color) + "\n";
      for (const RawLevel& level : part.levels) {
        out += format("fog level bricks %zu extinction %s crc %08x %08x %08x\n", level.density.size() / 729,
                      bits(level.extinction).c_str(), crc32(level.cells), crc32(level.density),
                      crc32(level.heat));
      }
      continue;
    }
    for (const RawLevel& level : part.levels) {
      out += format("level bricks %zu surface %zu crc %08x %08x %08x\n", level.codes.size() / 512,
                    level.attributes.size(), crc32(level.cells), crc32(withoutRanks(level.codes)),
                    crc32(level.attributes));
    }
    for (const RawDistances& level : part.distances)
      out += format("distances band %d %d bricks %zu crc %08x %08x\n", level.band.outside, level.band.inside,
                    level.codes.size() / 512, crc32(level.cells), crc32(level.codes));
  }
  for (const RawClip& clip : pack.clips) {
    out += "clip " + hex(clip.name) + " duration " + bits(clip.duration) + "\n";
    for (const Wave& w : clip.waves) {
      out += format("wave %u %u %u ", w.part, w.knot, static_cast<unsigned>(w.target)) + bits(w.amplitude) +
             " " + bits(w.period) + " " + bits(w.phase) + "\n";
    }
    for (const RawTrack& t : clip.tracks) {
      out += format("track %u %u %u %u\n", t.part, t.knot, static_cast<unsigned>(t.target),
                    static_cast<unsigned>(t.interpolation));
      for (const Key& key : t.keys) out += "key " + bits(key) + "\n";
    }
  }
  for (const RawSocket& s : pack.sockets) {
    const glm::vec4 rotation(s.rotation.x, s.rotation.y, s.rotation.z, s.rotation.w);
    out += "socket " + hex(s.name) + format(" %u ", s.part) + bits(s.at) + " " + bits(s.offset) + " " +
           bits(rotation) + "\n";
  }
  for (const RawJoint& joint : pack.joints) {
    out += "joint " + hex(joint.name) + format(" %d ", joint.parent) + bits(joint.inverse_bind) + " parts";
    for (const std::uint32_t part : joint.parts) out += format(" %u", part);
    out += "\n";
  }
  return out;
}

TEST(SecondReader, ReadsWhatTheWriterWrote) {
  std::vector<RawPack> packs = {test::makeTinyPack(),         test::makeTinyFogPack(),
                                test::makeTinyDistancePack(), test::makeTinyEmptyPack(),
                                test::makeTinyJointPack(),    test::makeTinyCagePack(),
                                test::makeTinyMorphPack()};
  packs.push_back(test::makeTinyFogPack());
  packs.back().parts[2].bend = Bend::kSweep;
  for (std::uint32_t seed = 50; seed < 52; ++seed) packs.push_back(test::makeRandomPack(seed, {3, 50, 3, 3}));
  for (const RawPack& pack : packs) {
    const PackFile file(test::writeToMemory(pack));
    const Answer read = readPack("\"" + file.path.string() + "\"");
    if (read.code == kNoZstd) GTEST_SKIP() << "Python finds no zstd library";
    ASSERT_EQ(read.code, 0);
    ASSERT_EQ(read.text, dump(pack));
  }
}

TEST(SecondReader, SeesEveryChangedByte) {
  for (const RawPack& pack : {test::makeTinyPack(), test::makeTinyFogPack(), test::makeTinyDistancePack(),
                              test::makeTinyEmptyPack(), test::makeTinyJointPack(), test::makeTinyCagePack(),
                              test::makeTinyMorphPack()}) {
    const PackFile file(test::writeToMemory(pack));
    const Answer damaged = readPack("--damage \"" + file.path.string() + "\"");
    if (damaged.code == kNoZstd) GTEST_SKIP() << "Python finds no zstd library";
    EXPECT_EQ(damaged.code, 0);
  }
}

// Bytes of tables changed, and their checksums made right again: what one reader refuses the other does.
TEST(SecondReader, RefusesTheSameLies) {
  std::mt19937 random(9);
  const auto below = [&](std::size_t count) { return static_cast<std::size_t>(random() % count); };
  const int lies = test::allTests() ? 60 : 6;  // of each pack
  int refused = 0, accepted = 0;
  for (const RawPack& pack : {test::makeTinyPack(), test::makeTinyFogPack(), test::makeTinyDistancePack(),
                              test::makeTinyEmptyPack(), test::makeTinyJointPack(), test::makeTinyCagePack(),
                              test::makeTinyMorphPack()}) {
    const test::PackSurgeon sound(test::writeToMemory(pack));
    for (int i = 0; i < lies; ++i) {
      test::PackSurgeon lying = sound;
      test::PackSurgeon::Chunk& chunk = lying.chunks[below(lying.chunks.size())];
      const bool pages = chunk.fourcc == test::PackSurgeon::fourcc("BRCK") ||
                         chunk.fourcc == test::PackSurgeon::fourcc("FOGB") ||
                         chunk.fourcc == test::PackSurgeon::fourcc("DIST");
      const std::size_t at = pages ? 0 : below(chunk.content.size());
      if (pages)
        (i % 2 == 0 ? chunk.level : chunk.part) ^= 1u << below(3);
      else if (i % 2 == 0)
        chunk.content[at] = std::array{std::byte{0}, std::byte{1}, std::byte{0x7f}, std::byte{0x80},
                                       std::byte{0xff}}[below(5)];
      else if (at + 4 <= chunk.content.size())
        test::set(chunk.content, at / 4 * 4,
                  std::array{0.0f, -0.0f, 1.0f, -1.0f, 1e38f, 1e-45f, NAN, INFINITY}[below(8)]);
      const test::Bytes bytes = lying.build();
      MemorySource memory(bytes);
      const std::uint64_t errors = verify(
          memory.source(), {}, [](void*, const Issue&) {}, nullptr);
      const PackFile file(bytes);
      const Answer read = readPack("\"" + file.path.string() + "\" 2>&1");
      if (read.code == kNoZstd) GTEST_SKIP() << "Python finds no zstd library";
      EXPECT_EQ(read.code, errors > 0 ? 3 : 0) << "chunk " << chunk.fourcc << " byte " << at << ", change "
                                               << i << ": " << read.text.substr(0, 300);
      ++(errors > 0 ? refused : accepted);
    }
  }
  EXPECT_GT(refused, lies / 2);
  EXPECT_GT(accepted, lies / 6);
}

void expectRefused(std::span<const test::Lie> lies, const test::Bytes& sound) {
  for (std::size_t i = 0; i < lies.size(); i += test::allTests() ? 1 : 4) {
    test::PackSurgeon surgeon(sound);
    lies[i].tell(surgeon);
    const PackFile file(surgeon.build());
    const Answer read = readPack("\"" + file.path.string() + "\" 2>&1");
    if (read.code == kNoZstd) GTEST_SKIP() << "Python finds no zstd library";
    EXPECT_EQ(read.code, 3) << lies[i].name << ": " << read.text.substr(0, 300);
  }
}

TEST(SecondReader, RefusesLiesAboutSockets) { expectRefused(test::kSocketLies, test::tinyBytes()); }
TEST(SecondReader, RefusesLiesAboutJoints) {
  expectRefused(test::kJointLies, test::writeToMemory(test::makeTinyJointPack()));
}
TEST(SecondReader, RefusesLiesAboutCages) {
  expectRefused(test::kCageLies, test::writeToMemory(test::makeTinyCagePack()));
}
TEST(SecondReader, RefusesLiesAboutMorphs) {
  expectRefused(test::kMorphLies, test::writeToMemory(test::makeTinyMorphPack()));
}

}  // namespace
}  // namespace kelp
