// SPDX-License-Identifier: MIT
// Draws by the paper's method as published: shaders/reference/paper.glsl over dense 3D textures.
#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <glm/gtc/matrix_inverse.hpp>

#include "dense_volume.h"
#include "drawer.h"
#include "gl_program.h"
#include "glsl.h"
#include "kelp/common/error.h"
#include "kelp/formats/spline.h"
#include "kelp/shaders/shaders.h"

namespace kelp::render {
namespace {

// Texture units.
enum Unit : GLint { kVoxels, kAttributes, kPalette, kSegments };

void bindTexture(Unit unit, GLenum target, GLuint name) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(target, name);
}

// A texture that is read with texelFetch alone. Bound to its unit.
GLuint makeTexture(Unit unit, GLenum target) {
  GLuint name = 0;
  glGenTextures(1, &name);
  bindTexture(unit, target, name);
  glTexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexParameteri(target, GL_TEXTURE_MAX_LEVEL, 0);
  return name;
}

// A part's textures. 0: nothing in it is solid.
struct PaperPart {
  GLuint voxels = 0, attributes = 0;
};

struct PaperAsset {
  GLuint palette = 0;
  std::vector<PaperPart> parts;
};

// Where and how a part stands in one frame.
struct PosedPart {
  const runtime::Instance* instance;
  int index;
  const Part* part;
  std::span<const Knot> knots;
  Box bounds;  // part space
  glm::dmat4 to_world, to_clip;

  PosedPart(const gl::View& view, const runtime::Instance& posed, int p)
      : instance(&posed),
        index(p),
        part(&posed.asset->pack().parts()[static_cast<std::size_t>(p)]),
        knots(posed.pose->knots(p)),
        bounds(deformedBounds(knots, part->size)),
        to_world(partToWorld(posed, p).value()),
        to_clip(glm::dmat4(view.camera.eye_to_clip) * glm::dmat4(view.camera.world_to_eye) * to_world) {}

  // The rectangle that the bounds cover: low x, low y, high x, high y in clip space.
  glm::vec4 rectangle() const {
    glm::vec2 low(1), high(-1);
    for (int corner = 0; corner < 8; ++corner) {
      const glm::bvec3 upper(corner & 1, corner & 2, corner & 4);
      const glm::dvec4 clip = to_clip * glm::dvec4(glm::mix(bounds.min, bounds.max, upper), 1);
      if (clip.w <= 0) return {-1, -1, 1, 1};
      low = glm::min(low, glm::vec2(clip) / static_cast<float>(clip.w));
      high = glm::max(high, glm::vec2(clip) / static_cast<float>(clip.w));
    }
    return {glm::max(low, glm::vec2(-1)), glm::min(high, glm::vec2(1))};
  }
};

// The spline's segments, four texels each, as paper_part.glsl reads them.
std::vector<glm::vec4> segmentTexels(const PosedPart& posed) {
  const float size = static_cast<float>(posed.part->size.y);
  const float base = size * posed.knots.front().position.y;
  const float stretch = 1 / (posed.knots.back().position.y - posed.knots.front().position.y);
  std::vector<glm::vec4> texels;
  for (std::size_t k = 0; k + 1 < posed.knots.size(); ++k) {
    const Segment segment = makeSegment(posed.knots[k], posed.knots[k + 1], size);
    const float foot = (segment.p0.y - base) * stretch;
    const float top = k + 2 == posed.knots.size() ? size : (segment.p1.y - base) * stretch;
    texels.insert(texels.end(), {glm::vec4(segment.p0, foot), glm::vec4(segment.m0, top - foot),
                                 glm::vec4(segment.p1, 0), glm::vec4(segment.m1, 0)});
  }
  return texels;
}

class PaperDrawer final : public Drawer {
 public:
  PaperDrawer(const Options& options, const ViewStyle& style, const Scene& scene, bool es);
  ~PaperDrawer() override;

  void draw(const gl::View& view, std::span<const runtime::Instance> instances) override;
  StepCount count(const gl::View& view, std::span<const runtime::Instance> instances,
                  CountTarget& target) override;

 private:
  void check(const Scene& scene) const;
  PaperAsset load(const std::string& path, const runtime::Asset& asset) const;
  void uploadVolume(const std::string& where, Unit unit, const glm::ivec3& size, const void* voxels) const;
  void setPart(const GlProgram& program, const PosedPart& posed) const;

  bool distances_;
  std::unique_ptr<GlProgram> drawer_, counter_;
  std::map<const runtime::Asset*, PaperAsset> assets_;
  GLuint segments_ = 0;
};

PaperDrawer::PaperDrawer(const Options& options, const ViewStyle& style, const Scene& scene, bool es)
    : distances_(options.method == Method::kPaperDf) {
  check(scene);
  std::vector<const char*> text{"#define KELP_FN\n"};
  if (distances_) text.push_back("#define PAPER_DISTANCES\n");
  if (!style.surface.empty()) text.push_back("#define KELP_HOST_SURFACE\n");
  if (options.shadows || options.occlusion > 0) text.push_back("#define KELP_SECONDARY_RAYS\n");
  text.insert(text.end(), {shaders::kSpline, glsl::kPaperPart, glsl::kPaper, glsl::kPaperRay});
  std::vector<const char*> count_text = text;
  text.insert(text.end(), {shaders::kUniforms, shaders::kSurface, style.surface.c_str(), glsl::kPaperDraw});
  count_text.push_back(glsl::kPaperCount);
  drawer_ = std::make_unique<GlProgram>(text, es);
  counter_ = std::make_unique<GlProgram>(count_text, es);
  for (const auto& [key, pack] : scene.packs()) assets_[pack.get()] = load(key.path, *pack);
  segments_ = makeTexture(kSegments, GL_TEXTURE_2D);
}

PaperDrawer::~PaperDrawer() {
  for (const auto& [asset, textures] : assets_) {
    glDeleteTextures(1, &textures.palette);
    for (const PaperPart& part : textures.parts) {
      glDeleteTextures(1, &part.voxels);
      glDeleteTextures(1, &part.attributes);
    }
  }
  glDeleteTextures(1, &segments_);
}

// Refuses what cannot be drawn as published, before anything is decoded.
void PaperDrawer::check(const Scene& scene) const {
  constexpr char kRemedy[] = "use --method kelp";
  GLint most = 0;
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &most);
  const std::uint64_t texture_bytes = sizeof(std::uint32_t) + (distances_ ? 2 : 1);
  const std::uint64_t decode_bytes = distances_ ? 11 : 5;  // while one part is decoded
  std::uint64_t voxels = 0, largest = 0;
  for (const auto& [key, pack] : scene.packs()) {
    for (const Part& part : pack->pack().parts()) {
      if (part.kind == PartKind::kEmpty) continue;
      const std::string where = fmt::format("{}: part {}", key.path, part.name);
      if (part.kind == PartKind::kFog)
        throw ToolError(
            Exit::kUnsupported,
            fmt::format("{} is fog, and the paper's method draws solid voxels only; {}", where, kRemedy));
      if (part.bend == Bend::kSweep)
        throw ToolError(
            Exit::kUnsupported,
            fmt::format("{} is swept, and the paper's method shears; {}, or --bend shear", where, kRemedy));
      if (std::max({part.size.x, part.size.y, part.size.z}) > most)
        throw ToolError(
            Exit::kUnsupported,
            fmt::format("{} has {} x {} x {} voxels, and a dense 3D texture has at most {} along each side "
                        "here; {}, or bake with a lower --resolution",
                        where, part.size.x, part.size.y, part.size.z, most, kRemedy));
      const std::uint64_t count = static_cast<std::uint64_t>(part.size.x) *
                                  static_cast<std::uint64_t>(part.size.y) *
                                  static_cast<std::uint64_t>(part.size.z);
      voxels += count;
      largest = std::max(largest, count);
    }
  }
  const std::uint64_t bytes = voxels * texture_bytes + largest * decode_bytes;
  if (bytes > mostMemory())
    throw ToolError(Exit::kUnsupported,
                    fmt::format("as dense textures all parts together take {} MiB, and this machine has "
                                "memory for {} MiB; {}, or bake with a lower --resolution",
                                bytes >> 20, mostMemory() >> 20, kRemedy));
}

void PaperDrawer::uploadVolume(const std::string& where, Unit unit, const glm::ivec3& size,
                               const void* voxels) const {
  GLint internal = GL_R32UI;
  GLenum format = GL_RED_INTEGER, type = GL_UNSIGNED_INT;
  if (unit == kVoxels) {
    internal = distances_ ? GL_R16F : GL_R8UI;
    format = distances_ ? GL_RED : GL_RED_INTEGER;
    type = distances_ ? GL_HALF_FLOAT : GL_UNSIGNED_BYTE;
  }
  (void)ranOutOfGlMemory();
  glTexImage3D(GL_TEXTURE_3D, 0, internal, size.x, size.y, size.z, 0, format, type, voxels);
  if (ranOutOfGlMemory())
    throw ToolError(Exit::kUnsupported,
                    fmt::format("{}: OpenGL has no memory for a dense texture of {} x {} x {} "
                                "voxels; use --method kelp, or bake with a lower --resolution",
                                where, size.x, size.y, size.z));
}

PaperAsset PaperDrawer::load(const std::string& path, const runtime::Asset& asset) const {
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  PaperAsset textures;
  const std::span<const Part> parts = asset.pack().parts();
  for (int p = 0; p < static_cast<int>(parts.size()); ++p) {
    PaperPart& part = textures.parts.emplace_back();
    if (parts[static_cast<std::size_t>(p)].kind == PartKind::kEmpty) continue;
    DenseVolume volume = decodeDense(asset, p);
    if (std::find(volume.solid.begin(), volume.solid.end(), 1) == volume.solid.end()) continue;
    const std::string where = fmt::format("{}: part {}", path, parts[static_cast<std::size_t>(p)].name);
    part.attributes = makeTexture(kAttributes, GL_TEXTURE_3D);
    uploadVolume(where, kAttributes, volume.size, volume.attributes.data());
    volume.attributes = {};
    part.voxels = makeTexture(kVoxels, GL_TEXTURE_3D);
    if (distances_) {
      uploadVolume(where, kVoxels, volume.size, distanceField(volume, 0).data());
    } else {
      for (std::uint8_t& voxel : volume.solid) voxel = !voxel;
      uploadVolume(where, kVoxels, volume.size, volume.solid.data());
    }
  }
  std::vector<glm::vec4> palette;
  for (const Material& m : asset.pack().palette())
    palette.insert(palette.end(),
                   {m.base_color, glm::vec4(m.emissive, m.metallic), glm::vec4(m.roughness, 0, 0, 0)});
  textures.palette = makeTexture(kPalette, GL_TEXTURE_2D);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, 3, static_cast<GLsizei>(palette.size() / 3), 0, GL_RGBA,
               GL_FLOAT, palette.data());
  return textures;
}

// Binds the part's textures and sets its uniforms, in the program in use.
void PaperDrawer::setPart(const GlProgram& program, const PosedPart& posed) const {
  const PaperAsset& asset = assets_.at(posed.instance->asset);
  const PaperPart& part = asset.parts[static_cast<std::size_t>(posed.index)];
  bindTexture(kVoxels, GL_TEXTURE_3D, part.voxels);
  bindTexture(kAttributes, GL_TEXTURE_3D, part.attributes);
  bindTexture(kPalette, GL_TEXTURE_2D, asset.palette);
  bindTexture(kSegments, GL_TEXTURE_2D, segments_);
  const std::vector<glm::vec4> texels = segmentTexels(posed);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, 4, static_cast<GLsizei>(texels.size() / 4), 0, GL_RGBA, GL_FLOAT,
               texels.data());
  program.set("paper_voxels", kVoxels);
  program.set("paper_attributes", kAttributes);
  program.set("paper_palette", kPalette);
  program.set("paper_segments", kSegments);
  program.set("paper_segment_count", static_cast<int>(texels.size() / 4));
  const glm::ivec3 size = posed.part->size;
  program.set("paper_size", size);
  program.set("paper_step", 0.001f * static_cast<float>(std::max({size.x, size.y, size.z})));
  program.set("paper_clip_to_part", glm::mat4(glm::inverse(posed.to_clip)));
  program.set("paper_part_to_clip", glm::mat4(posed.to_clip));
  program.set("paper_part_to_world", glm::mat4(posed.to_world));
  program.set("paper_normal_to_world", glm::mat3(glm::inverseTranspose(glm::dmat3(posed.to_world))));
  program.set("paper_tint", posed.instance->tint);
  program.set("kelp_bounds_min", posed.bounds.min);
  program.set("kelp_bounds_max", posed.bounds.max);
}

// Calls visit(posed part) for every part of the instances that has solid voxels.
template <class Visit>
void forParts(const std::map<const runtime::Asset*, PaperAsset>& assets, const gl::View& view,
              std::span<const runtime::Instance> instances, Visit&& visit) {
  for (const runtime::Instance& instance : instances) {
    const std::vector<PaperPart>& parts = assets.at(instance.asset).parts;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (parts[p].voxels != 0) visit(PosedPart(view, instance, static_cast<int>(p)));
    }
  }
}

void PaperDrawer::draw(const gl::View& view, std::span<const runtime::Instance> instances) {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  drawer_->use();
  drawer_->set("paper_viewport", glm::vec2(view.camera.viewport));
  drawer_->set("kelp_sun_direction", glm::normalize(view.light.sun_direction));
  drawer_->set("kelp_sun_color", view.light.sun_color);
  drawer_->set("kelp_sky_color", view.light.sky_color);
  drawer_->set("kelp_ground_color", view.light.ground_color);
  drawer_->set("kelp_self_shadow", int{view.quality.self_shadow});
  drawer_->set("kelp_occlusion_rays", view.quality.occlusion_rays);
  drawer_->set("kelp_occlusion_reach", view.quality.occlusion_reach);
  drawer_->set("kelp_shading", static_cast<int>(view.quality.shading));
  forParts(assets_, view, instances, [this](const PosedPart& posed) {
    setPart(*drawer_, posed);
    drawer_->drawRectangle(posed.rectangle());
  });
}

StepCount PaperDrawer::count(const gl::View& view, std::span<const runtime::Instance> instances,
                             CountTarget& target) {
  StepCount sum;
  target.bind();
  counter_->use();
  counter_->set("paper_viewport", glm::vec2(target.size()));
  forParts(assets_, view, instances, [&](const PosedPart& posed) {
    target.clear();
    setPart(*counter_, posed);
    counter_->drawRectangle(posed.rectangle());
    sum += target.read(posed.rectangle());
  });
  return sum;
}

}  // namespace

std::unique_ptr<Drawer> makePaperDrawer(const Options& options, const ViewStyle& style, const Scene& scene,
                                        bool es) {
  return std::make_unique<PaperDrawer>(options, style, scene, es);
}

}  // namespace kelp::render
