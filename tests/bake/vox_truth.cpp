// SPDX-License-Identifier: MIT
#include "vox_truth.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <utility>

#include <glm/glm.hpp>

namespace kelp::bake::test {
namespace {

using Dict = std::map<std::string, std::string>;

struct Bytes {
  std::string data;
  std::size_t at = 0;

  std::string take(std::size_t n) {
    at += n;
    return data.substr(at - n, n);
  }
  int number() {
    const std::string b = take(4);
    std::uint32_t bits = 0;
    for (int i = 3; i >= 0; --i)
      bits = bits * 256 + static_cast<unsigned char>(b[static_cast<std::size_t>(i)]);
    return static_cast<int>(bits);
  }
  std::string text() { return take(static_cast<std::size_t>(number())); }
  Dict dict() {
    Dict out;
    for (int n = number(); n > 0; --n) {
      const std::string key = text();
      out[key] = text();
    }
    return out;
  }
};

struct Shot {
  int frame = 0;
  glm::dmat4 place{1};
};

struct Scene {
  struct Model {
    std::array<int, 3> size{};
    std::vector<std::array<int, 4>> voxels;
  };
  std::vector<Model> models;
  std::map<int, std::vector<Shot>> places;
  std::map<int, std::vector<std::pair<int, int>>> shown;
  std::map<int, std::vector<int>> below;
  std::map<int, int> layer_of;
  std::set<int> hidden_nodes, hidden_layers;
};

// M v = R v + t, R from its rows.
glm::dmat4 placeOf(const Dict& d) {
  glm::dmat4 m(1);
  if (d.count("_r")) {
    const int r = std::atoi(d.at("_r").c_str());
    const int one[3] = {r & 3, r >> 2 & 3, 3 - (r & 3) - (r >> 2 & 3)};
    m = glm::dmat4(0);
    m[3][3] = 1;
    for (int row = 0; row < 3; ++row) m[one[row]][row] = (r >> (4 + row) & 1) ? -1 : 1;
  }
  if (d.count("_t")) {
    std::istringstream in(d.at("_t"));
    in >> m[3][0] >> m[3][1] >> m[3][2];
  }
  return m;
}

int frameOf(const Dict& d) { return d.count("_f") ? std::atoi(d.at("_f").c_str()) : 0; }

class Painter {
 public:
  Painter(const Scene& scene, int frame, bool first_wins, VoxTruth& out)
      : scene_(scene), frame_(frame), first_wins_(first_wins), out_(out) {}

  void visit(int node, const glm::dmat4& above, bool hidden) {
    glm::dmat4 here = above;
    if (scene_.hidden_nodes.count(node)) hidden = true;
    if (scene_.places.count(node)) {
      if (scene_.hidden_layers.count(scene_.layer_of.at(node))) hidden = true;
      here = above * placeAt(scene_.places.at(node));
    }
    if (scene_.shown.count(node) && !hidden) paint(modelAt(scene_.shown.at(node)), here);
    if (scene_.below.count(node))
      for (const int child : scene_.below.at(node)) visit(child, here, hidden);
  }

  void paint(int number, const glm::dmat4& place) {
    const Scene::Model& model = scene_.models[static_cast<std::size_t>(number)];
    std::map<std::array<int, 3>, int> own;
    for (const auto& v : model.voxels)
      if (v[3] != 0) own[{v[0], v[1], v[2]}] = v[3];
    for (const auto& [v, index] : own) {
      glm::dvec4 p(0, 0, 0, 1);
      for (int i = 0; i < 3; ++i)
        p[i] =
            v[static_cast<std::size_t>(i)] + 0.5 - std::floor(model.size[static_cast<std::size_t>(i)] / 2.0);
      p = place * p;
      const std::array<int, 3> at = {static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y)),
                                     static_cast<int>(std::floor(p.z))};
      if (first_wins_)
        out_.voxels.emplace(at, index);
      else
        out_.voxels[at] = index;
    }
  }

 private:
  glm::dmat4 placeAt(const std::vector<Shot>& shots) const {
    if (frame_ < shots.front().frame) return shots.front().place;
    std::size_t i = 0;
    while (i + 1 < shots.size() && shots[i + 1].frame <= frame_) ++i;
    glm::dmat4 m = shots[i].place;
    if (i + 1 < shots.size()) {
      const double share = double(frame_ - shots[i].frame) / double(shots[i + 1].frame - shots[i].frame);
      for (int k = 0; k < 3; ++k)
        m[3][k] =
            std::trunc(m[3][k] + share * (shots[i + 1].place[3][k] - m[3][k]) + (m[3][k] < 0 ? -1e-9 : 1e-9));
    }
    return m;
  }
  int modelAt(const std::vector<std::pair<int, int>>& shown) const {
    int model = shown.front().second;
    for (const auto& [frame, number] : shown)
      if (frame <= frame_) model = number;
    return model;
  }

  const Scene& scene_;
  int frame_;
  bool first_wins_;
  VoxTruth& out_;
};

}  // namespace

VoxTruth readVoxTruth(const std::filesystem::path& path, int frame) {
  std::ifstream file(path, std::ios::binary);
  Bytes in{{std::istreambuf_iterator<char>(file), {}}, 4};
  const int version = in.number();
  Scene scene;
  VoxTruth out;
  std::array<int, 3> size{};
  for (std::size_t i = 1; i <= 256; ++i) out.shown_at[i] = static_cast<int>(i) - 1;
  in.at = 20;
  while (in.at < in.data.size()) {
    const std::string id = in.take(4);
    const int content = in.number(), children = in.number();
    const std::size_t next = in.at + static_cast<std::size_t>(content) + static_cast<std::size_t>(children);
    if (id == "SIZE") {
      for (int& side : size) side = in.number();
    } else if (id == "XYZI") {
      Scene::Model& model = scene.models.emplace_back();
      model.size = size;
      for (int n = in.number(); n > 0; --n) {
        const std::string v = in.take(4);
        std::array<int, 4> voxel{};
        for (std::size_t i = 0; i < 4; ++i) voxel[i] = static_cast<unsigned char>(v[i]);
        model.voxels.push_back(voxel);
      }
    } else if (id == "RGBA") {
      out.has_palette = true;
      for (std::size_t i = 1; i <= 256; ++i) {
        const std::string c = in.take(4);
        for (std::size_t k = 0; k < 3; ++k) out.rgb[i][k] = static_cast<unsigned char>(c[k]);
      }
    } else if (id == "IMAP") {
      const std::string order = in.take(256);
      for (std::size_t k = 0; k < 256; ++k)
        out.shown_at[static_cast<unsigned char>(order[k])] = static_cast<int>(k);
    } else if (id == "LAYR") {
      const int layer = in.number();
      if (in.dict()["_hidden"] == "1") scene.hidden_layers.insert(layer);
    } else if (id == "nTRN" || id == "nGRP" || id == "nSHP") {
      const int node = in.number();
      if (in.dict()["_hidden"] == "1") scene.hidden_nodes.insert(node);
      if (id == "nTRN") {
        scene.below[node] = {in.number()};
        in.number();
        scene.layer_of[node] = in.number();
        for (int n = in.number(); n > 0; --n) {
          const Dict d = in.dict();
          scene.places[node].push_back({frameOf(d), placeOf(d)});
        }
      } else if (id == "nGRP") {
        for (int n = in.number(); n > 0; --n) scene.below[node].push_back(in.number());
      } else {
        for (int n = in.number(); n > 0; --n) {
          const int model = in.number();
          scene.shown[node].emplace_back(frameOf(in.dict()), model);
        }
      }
    }
    in.at = next;
  }
  Painter painter(scene, frame, version >= 200, out);
  if (scene.places.empty()) {
    const int model = std::max(frame, 0);
    glm::dmat4 standing(1);
    standing[3][2] = scene.models[static_cast<std::size_t>(model)].size[2] / 2;
    painter.paint(model, standing);
  } else {
    painter.visit(0, glm::dmat4(1), false);
  }
  return out;
}

std::string VoxMaker::integer(std::int64_t value) {
  std::string out;
  for (int i = 0; i < 4; ++i) out += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i) & 255u);
  return out;
}

std::string VoxMaker::dictionary(const Attributes& attributes) {
  std::string out = integer(static_cast<std::int64_t>(attributes.size()));
  for (const auto& [key, value] : attributes)
    for (const std::string& text : {key, value})
      out += integer(static_cast<std::int64_t>(text.size())) + text;
  return out;
}

void VoxMaker::chunk(const std::string& id, const std::string& content, const std::string& children) {
  chunks_ += id + integer(static_cast<std::int64_t>(content.size())) +
             integer(static_cast<std::int64_t>(children.size())) + content + children;
}

void VoxMaker::model(const std::array<int, 3>& size, const std::vector<std::array<int, 4>>& voxels) {
  chunk("SIZE", integer(size[0]) + integer(size[1]) + integer(size[2]));
  std::string content = integer(static_cast<std::int64_t>(voxels.size()));
  for (const auto& voxel : voxels)
    for (const int value : voxel) content += static_cast<char>(value);
  chunk("XYZI", content);
}

void VoxMaker::box(const std::array<int, 3>& size) {
  std::vector<std::array<int, 4>> voxels;
  for (int z = 0; z < size[2]; ++z)
    for (int y = 0; y < size[1]; ++y)
      for (int x = 0; x < size[0]; ++x)
        voxels.push_back({x, y, z, 1 + (x + size[0] * (y + size[1] * z)) % 255});
  model(size, voxels);
}

void VoxMaker::filled(const std::array<int, 3>& size, int index) {
  std::vector<std::array<int, 4>> voxels;
  for (int z = 0; z < size[2]; ++z)
    for (int y = 0; y < size[1]; ++y)
      for (int x = 0; x < size[0]; ++x) voxels.push_back({x, y, z, index});
  model(size, voxels);
}

void VoxMaker::transform(int id, int child, const std::vector<Attributes>& frames,
                         const Attributes& attributes, int layer) {
  std::string content = integer(id) + dictionary(attributes) + integer(child) + integer(-1) + integer(layer) +
                        integer(static_cast<std::int64_t>(frames.size()));
  for (const Attributes& frame : frames) content += dictionary(frame);
  chunk("nTRN", content);
}

void VoxMaker::group(int id, const std::vector<int>& children, const Attributes& attributes) {
  std::string content =
      integer(id) + dictionary(attributes) + integer(static_cast<std::int64_t>(children.size()));
  for (const int child : children) content += integer(child);
  chunk("nGRP", content);
}

void VoxMaker::shape(int id, const std::vector<std::pair<int, Attributes>>& models,
                     const Attributes& attributes) {
  std::string content =
      integer(id) + dictionary(attributes) + integer(static_cast<std::int64_t>(models.size()));
  for (const auto& [model, frame] : models) content += integer(model) + dictionary(frame);
  chunk("nSHP", content);
}

void VoxMaker::layer(int id, const Attributes& attributes) {
  chunk("LAYR", integer(id) + dictionary(attributes) + integer(-1));
}
void VoxMaker::material(int id, const Attributes& attributes) {
  chunk("MATL", integer(id) + dictionary(attributes));
}

void VoxMaker::scene(const std::vector<std::pair<int, Attributes>>& models_and_places) {
  std::vector<int> children;
  for (std::size_t i = 0; i < models_and_places.size(); ++i) children.push_back(2 + 2 * static_cast<int>(i));
  transform(0, 1, {{}});
  group(1, children);
  for (std::size_t i = 0; i < models_and_places.size(); ++i) {
    transform(children[i], children[i] + 1, {models_and_places[i].second});
    shape(children[i] + 1, {{models_and_places[i].first, {}}});
  }
}

std::string VoxMaker::bytes() const {
  return "VOX " + integer(version_) + "MAIN" + integer(0) +
         integer(static_cast<std::int64_t>(chunks_.size())) + chunks_;
}

}  // namespace kelp::bake::test
