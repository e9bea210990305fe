// SPDX-License-Identifier: MIT
// Baking beside its peers, interleaved in one run: the distance transform beside ITK, SciPy and seung-lab's
// edt; a whole bake beside OpenVDB's meshToLevelSet alone; packs beside .vdb and .nvdb of the same narrow
// band; reading them beside zstd alone. README.md here.
//   bench_bake [--json FILE] [--rounds N] [--threads N] [--resolution N] [edt] [scale] [bake] [scan]
//              [read]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <set>
#include <thread>

#include "../fields/volumes.h"
#include "bench_bake_peers.h"
#include "coding_libraries.h"
#include "kelp/formats/level.h"
#include "support/scratch.h"

namespace kelp::bench {
namespace {

struct Options {
  const char* json = nullptr;
  int rounds = 3, threads = 2, resolution = 512;
  std::set<std::string> sections;
  bool wants(const char* section) const { return sections.empty() || sections.count(section) > 0; }
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

double secondsOf(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// One line of the table and one object of the file. Seconds or bytes are 0 where they were not measured; the
// ratio is of bytes where they were.
struct Row {
  std::string name, method;
  std::uint64_t voxels = 0;
  int threads = 1;
  double seconds = 0;
  std::uint64_t bytes = 0;
  double ratio = 1;
};

class Table {
 public:
  void add(Row row) {
    std::printf("| %s | %s | %.1f M | %d | ", row.name.c_str(), row.method.c_str(),
                1e-6 * static_cast<double>(row.voxels), row.threads);
    if (row.seconds > 0)
      std::printf("%.4f s, %.2f ns/voxel | ", row.seconds,
                  1e9 * row.seconds / static_cast<double>(row.voxels));
    else
      std::printf("| ");
    if (row.bytes > 0)
      std::printf("%.2f MiB | ", static_cast<double>(row.bytes) / (1 << 20));
    else
      std::printf("| ");
    std::printf("%.2f |\n", row.ratio);
    std::fflush(stdout);
    rows_.push_back(std::move(row));
  }
  bool write(const char* path) const {
    std::FILE* const file = std::fopen(path, "w");
    if (!file) return false;
    std::fprintf(file, "[\n");
    for (const Row& row : rows_) {
      std::fprintf(file,
                   "  {\"case\": \"%s\", \"method\": \"%s\", \"voxels\": %llu, \"threads\": %d, "
                   "\"seconds_median\": %.6g, \"bytes\": %llu, \"ratio_to_kelp\": %.4g}%s\n",
                   row.name.c_str(), row.method.c_str(), static_cast<unsigned long long>(row.voxels),
                   row.threads, row.seconds, static_cast<unsigned long long>(row.bytes), row.ratio,
                   &row == &rows_.back() ? "" : ",");
    }
    std::fprintf(file, "]\n");
    return std::fclose(file) == 0;
  }

 private:
  std::vector<Row> rows_;
};

struct Model {
  std::string name;
  std::filesystem::path path;
};
std::vector<Model> models() {
  const char* const given = std::getenv("KELP_ASSETS");
  const std::filesystem::path assets = given ? given : KELP_DEFAULT_ASSETS;
  std::vector<Model> found;
  for (const auto& [name, file] : {std::pair("bunny", "mesh/common3d/stanford-bunny.obj"),
                                   {"dragon", "mesh/stanford/dragon_vrip_res3.ply"}}) {
    if (std::filesystem::exists(assets / file))
      found.push_back({name, assets / file});
    else
      std::printf("%s: absent (KELP_ASSETS); left out\n", (assets / file).string().c_str());
  }
  return found;
}

bake::Settings settingsFor(int resolution, int threads) {
  bake::Settings settings;
  settings.resolution = resolution;
  settings.resolution_given = true;
  settings.threads = threads;
  return settings;
}

fields::Occupancy occupancyOf(const Model& model, int resolution, int threads) {
  bake::Report report;
  const RawPack pack = bake::bake(model.path, settingsFor(resolution, threads), report);
  return fields::occupancyOf(pack.parts[0].levels[0], pack.parts[0].size);
}

// --- distance transforms

void copyInParts(const std::vector<std::uint32_t>& from, std::vector<std::uint32_t>& to, int threads) {
  std::vector<std::thread> workers;
  const std::size_t share =
      (from.size() + static_cast<std::size_t>(threads) - 1) / static_cast<std::size_t>(threads);
  for (std::size_t begin = 0; begin < from.size(); begin += share) {
    workers.emplace_back([&, begin] {
      std::memcpy(to.data() + begin, from.data() + begin,
                  std::min(share, from.size() - begin) * sizeof from[0]);
    });
  }
  for (std::thread& worker : workers) worker.join();
}

// True if a peer's squares are kelp's at every empty voxel.
bool agrees(const EdtRun& run, const fields::Occupancy& volume, const std::vector<std::uint32_t>& squared) {
  if (run.squared.size() != squared.size()) return false;
  for (std::size_t i = 0; i < squared.size(); ++i) {
    // A float holds integers to 2^24 exactly, and rounds beyond.
    if (!volume.solid[i] && run.squared[i] != static_cast<float>(squared[i])) return false;
  }
  return true;
}

struct Peer {
  std::string name;
  int threads;
  std::function<EdtRun()> run;
  std::vector<double> seconds{};
  bool agrees = true;
};

void compareTransforms(const Options& options, Table& table, const test::Scratch& scratch,
                       const std::string& name, const fields::Occupancy& volume, bool with_peers) {
  std::vector<std::uint32_t> squared(volume.solid.size()), copy(volume.solid.size());
  std::vector<Peer> peers;
  if (with_peers) {
    if (haveItk()) {
      for (const int threads : {1, options.threads})
        peers.push_back(
            {"ITK SignedMaurer", threads, [&volume, threads] { return runItk(volume, threads); }});
    }
    if (haveSeungLab()) {
      for (const int threads : {1, options.threads})
        peers.push_back(
            {"seung-lab edt", threads, [&volume, threads] { return runSeungLab(volume, threads); }});
    }
    if (haveScipy()) peers.push_back({"SciPy", 1, [&] { return runScipy(volume, scratch.folder()); }});
  }
  std::vector<double> ours, copies;
  for (int round = 0; round < options.rounds; ++round) {
    ours.push_back(
        secondsOf([&] { fields::squaredDistance(volume.solid, volume.size, squared, options.threads); }));
    copies.push_back(secondsOf([&] { copyInParts(squared, copy, options.threads); }));
    for (Peer& peer : peers) {
      const EdtRun run = peer.run();
      peer.seconds.push_back(run.seconds);
      if (round == 0) peer.agrees = agrees(run, volume, squared);
    }
  }
  const double kelp = median(ours);
  const std::uint64_t voxels = volume.solid.size();
  const std::string title = "edt, " + name;
  table.add({title, "kelp", voxels, options.threads, kelp});
  table.add(
      {title, "copy of 4 bytes a voxel", voxels, options.threads, median(copies), 0, median(copies) / kelp});
  for (const Peer& peer : peers) {
    table.add({title, peer.name + (peer.agrees ? "" : " (DIFFERS)"), voxels, peer.threads,
               median(peer.seconds), 0, median(peer.seconds) / kelp});
  }
}

// --- whole bakes

void compareBakes(const Options& options, Table& table, const test::Scratch& scratch, const Model& model,
                  int resolution) {
  const bake::Settings settings = settingsFor(resolution, options.threads);
  const bake::SourceModel source = bake::importFile(model.path, settings);
  std::vector<double> bakes, level_sets;
  bake::Report report;
  LevelSetRun written;
  const std::filesystem::path pack_path = scratch / "pack.kelp";
  for (int round = 0; round < options.rounds; ++round) {
    report = {};
    bakes.push_back(secondsOf([&] {
      bake::writePackFile(bake::bake(model.path, settings, report), pack_path, options.threads, report);
    }));
    const bake::SourcePart& part = source.parts[0];
    const bake::Frame frame = bake::makeFrame(part.soup, part.rig.axis.value_or(Axis::kPlusY),
                                              report.parts[0].voxel_size, model.name);
    const LevelSetRun run =
        runMeshToLevelSet(part.soup, frame, options.threads, round == 0 ? &scratch.folder() : nullptr);
    level_sets.push_back(run.seconds);
    if (round == 0) written = run;
  }
  const glm::ivec3 size = report.parts[0].size;
  const std::uint64_t voxels = static_cast<std::uint64_t>(size.x) * static_cast<std::uint64_t>(size.y) *
                               static_cast<std::uint64_t>(size.z);
  const std::string title = model.name + " at " + std::to_string(resolution);
  const double kelp = median(bakes);
  const std::uint64_t bytes = std::filesystem::file_size(pack_path);
  table.add({"bake, " + title, "kelp", voxels, options.threads, kelp});
  table.add({"bake, " + title, "meshToLevelSet alone", voxels, options.threads, median(level_sets), 0,
             median(level_sets) / kelp});
  table.add({"size, " + title, "kelp", voxels, 1, 0, bytes});
  for (const auto& [name, size_of_file] : written.files)
    table.add({"size, " + title, name, voxels, 1, 0, size_of_file,
               static_cast<double>(size_of_file) / static_cast<double>(bytes)});
}

// The dragon in as many triangles as the scan that it was made of has.
void compareScans(const Options& options, Table& table, const test::Scratch& scratch, const Model& dragon) {
  constexpr std::size_t kTriangles = 871414;
  const Model scan{"scan of 871 k triangles", scratch / "scan.ply"};
  const bake::SourceModel source = bake::importFile(dragon.path, settingsFor(256, options.threads));
  writeDivided(source.parts[0].soup, kTriangles, scan.path);
  for (const int resolution : {256, 1024}) compareBakes(options, table, scratch, scan, resolution);
}

// --- reading

std::vector<std::byte> bytesOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<std::byte> bytes(std::filesystem::file_size(path));
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return bytes;
}

// One zstd frame of what a page decodes to, its ranks aside: how pages were stored before they had a code of
// their own.
struct PlainFrame {
  std::vector<std::byte> bytes;
  std::size_t raw = 0;
};
PlainFrame plainFrame(const PageData& page, FrameEncoder& encoder) {
  std::vector<std::byte> raw;
  raw.reserve(page.info.raw);
  for (std::uint32_t brick = 0; brick < page.info.count; ++brick)
    for (const std::uint8_t code : page.codes(brick))
      raw.push_back(std::byte{isSurfaceCode(code) ? kSurfaceCode : code});
  const std::span<const std::byte> attributes = std::as_bytes(page.attributes());
  raw.insert(raw.end(), attributes.begin(), attributes.end());
  std::vector<std::byte> room(FrameEncoder::bound(raw.size()));
  const std::size_t size = encoder.encode(raw, room);
  return {{room.begin(), room.begin() + static_cast<std::ptrdiff_t>(size)}, raw.size()};
}

// Every page of every level: read, checked and decoded, beside zstd's decompression of the same voxels.
void compareReading(const Options& options, Table& table, const test::Scratch& scratch, const Model& model) {
  const std::filesystem::path path = scratch / "read.kelp";
  bake::Report report;
  bake::writePackFile(bake::bake(model.path, settingsFor(options.resolution, options.threads), report), path,
                      options.threads, report);
  const std::vector<std::byte> bytes = bytesOf(path);
  MemorySource source(bytes);
  const auto pack = Pack::open(source.source());
  if (!pack) return;
  std::vector<LevelReader> levels;
  std::vector<PlainFrame> frames;
  FrameEncoder encoder;
  PageData data;
  bool good = true;
  for (int level = 0; level < pack->parts()[0].levels; ++level) {
    auto reader = LevelReader::open(*pack, 0, level);
    if (!reader) return;
    for (std::size_t page = 0; page < reader->grid().pages.size(); ++page) {
      good = good && reader->readPage(page, data);
      frames.push_back(plainFrame(data, encoder));
    }
    levels.push_back(*std::move(reader));
  }
  std::vector<std::byte> raw(1 << 16), workspace(decodeWorkspaceBytes());
  std::vector<double> ours, zstd;
  std::uint64_t decoded = 0;
  for (int round = 0; round < std::max(options.rounds, 5); ++round) {
    decoded = 0;
    ours.push_back(secondsOf([&] {
      for (const LevelReader& level : levels) {
        for (std::size_t page = 0; page < level.grid().pages.size(); ++page) {
          good = good && level.readPage(page, data);
          decoded += data.info.raw;
        }
      }
    }));
    zstd.push_back(secondsOf([&] {
      for (const PlainFrame& frame : frames)
        good = good && decodeFrame(frame.bytes, std::span(raw).first(frame.raw), workspace);
    }));
  }
  if (!good) std::printf("%s: a page could not be read\n", model.name.c_str());
  const std::string title = "read, " + model.name + " at " + std::to_string(options.resolution);
  const double kelp = median(ours);
  table.add({title, "kelp", decoded, 1, kelp, decoded});
  table.add({title, "zstd, plain pages", decoded, 1, median(zstd), decoded, median(zstd) / kelp});
}

int usage() {
  std::fprintf(stderr,
               "usage: bench_bake [--json FILE] [--rounds N] [--threads N] [--resolution N] [edt] [scale] "
               "[bake] [scan] [read]\n");
  return 1;
}

int run(int count, char** words) {
  Options options;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    const bool more = i + 1 < count;
    if (word == "--json" && more) {
      options.json = words[++i];
    } else if (word == "--rounds" && more) {
      options.rounds = std::atoi(words[++i]);
    } else if (word == "--threads" && more) {
      options.threads = std::atoi(words[++i]);
    } else if (word == "--resolution" && more) {
      options.resolution = std::atoi(words[++i]);
    } else if (word == "edt" || word == "scale" || word == "bake" || word == "scan" || word == "read") {
      options.sections.insert(word);
    } else {
      return usage();
    }
  }
  if (options.rounds < 1 || options.threads < 1 || options.resolution < 16) return usage();
  const test::Scratch scratch;
  Table table;
  for (const auto& [name, have] :
       {std::pair("ITK", haveItk()), {"seung-lab edt", haveSeungLab()}, {"SciPy", haveScipy()}}) {
    if (!have) std::printf("%s: not here; left out\n", name);
  }
  std::printf(
      "| case | method | voxels or bytes | threads | median | bytes | ratio to kelp "
      "|\n|---|---|---|---|---|---|---|\n");
  const std::vector<Model> all = models();
  const std::string at = " at " + std::to_string(options.resolution);
  if (options.wants("edt")) {
    for (const Model& model : all)
      compareTransforms(options, table, scratch, model.name + at,
                        occupancyOf(model, options.resolution, options.threads), true);
    for (const auto& [name, density] : {std::pair("noise, 10 %", 0.1), {"noise, 0.01 %", 0.0001}}) {
      compareTransforms(options, table, scratch, name + at,
                        test::randomVolume(glm::ivec3(options.resolution), density, 1), true);
    }
  }
  if (options.wants("scale") && !all.empty()) {
    for (const int resolution : {128, 256, 512, 1024}) {
      compareTransforms(options, table, scratch, all[0].name + " at " + std::to_string(resolution),
                        occupancyOf(all[0], resolution, options.threads), false);
    }
  }
  if (options.wants("bake")) {
    for (const Model& model : all) compareBakes(options, table, scratch, model, options.resolution);
  }
  if (options.wants("scan") && all.size() == 2) compareScans(options, table, scratch, all[1]);
  if (options.wants("read")) {
    for (const Model& model : all) compareReading(options, table, scratch, model);
  }
  return options.json && !table.write(options.json) ? 2 : 0;
}

}  // namespace
}  // namespace kelp::bench

int main(int argc, char** argv) { return kelp::bench::run(argc, argv); }
