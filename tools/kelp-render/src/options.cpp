// SPDX-License-Identifier: MIT
#include "options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <map>
#include <sstream>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <glm/vector_relational.hpp>

#include "kelp/common/console.h"
#include "kelp/common/error.h"
#include "kelp/rig/rig.h"

namespace kelp::render {
namespace {

constexpr int kMaxSide = 8192;
constexpr int kMaxFrames = 9999;

[[noreturn]] void refuse(const char* option, const std::string& text, const char* wanted) {
  throw ToolError(Exit::kUsage,
                  fmt::format("{} {}: expected {}; see kelp-render --help", option, text, wanted));
}

// All of `text` as a number.
template <class Number>
bool parseNumber(std::string_view text, Number& out) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  return error == std::errc() && end == text.data() + text.size();
}

// "x,y,z"
bool parseVector(std::string_view text, glm::vec3& out) {
  for (int i = 0; i < 3; ++i) {
    const std::size_t comma = text.find(',');
    if ((comma == std::string_view::npos) != (i == 2)) return false;
    if (!parseNumber(text.substr(0, comma), out[i]) || !std::isfinite(out[i])) return false;
    text.remove_prefix(i == 2 ? text.size() : comma + 1);
  }
  return true;
}

ViewKind parseView(const std::string& text) {
  static const std::map<std::string, ViewKind> views{
      {"shaded", ViewKind::kShaded},     {"normals", ViewKind::kNormals}, {"depth", ViewKind::kDepth},
      {"distance", ViewKind::kDistance}, {"parts", ViewKind::kParts},     {"steps", ViewKind::kSteps},
      {"level", ViewKind::kLevel},       {"bounds", ViewKind::kBounds},   {"splines", ViewKind::kSplines},
      {"cages", ViewKind::kCages}};
  if (text == "fit")
    throw ToolError(Exit::kUsage, "--view fit is gone; see clips[].fit of kelp-bake --report");
  const auto found = views.find(text);
  if (found == views.end())
    refuse("--view", text, "shaded, normals, depth, distance, parts, steps, level, bounds, splines or cages");
  return found->second;
}

Method parseMethod(const std::string& text) {
  for (const Method method : {Method::kKelp, Method::kPaper, Method::kPaperDf}) {
    if (text == toString(method)) return method;
  }
  refuse("--method", text, "kelp, paper or paper-df");
}

gl::Shading parseShading(const std::string& text) {
  if (text == "gradient") return gl::Shading::kGradient;
  if (text == "faces") return gl::Shading::kFaces;
  if (text == "smooth") return gl::Shading::kSmooth;
  refuse("--shading", text, "gradient, faces or smooth");
}

glm::ivec2 parseSize(const std::string& text) {
  const std::size_t cross = text.find('x');
  glm::ivec2 size;
  if (cross == std::string::npos || !parseNumber(std::string_view(text).substr(0, cross), size.x) ||
      !parseNumber(std::string_view(text).substr(cross + 1), size.y) || size.x < 1 || size.y < 1 ||
      size.x > kMaxSide || size.y > kMaxSide) {
    refuse("--size", text, "WIDTHxHEIGHT, each from 1 to 8192");
  }
  return size;
}

KnotChange parseChange(const char* option, const std::string& text, bool tangent) {
  KnotChange change;
  change.tangent = tangent;
  change.text = fmt::format("{} {}", option, text);
  const std::size_t equals = text.rfind('=');
  std::string knot = text.substr(0, equals);
  const std::size_t colon = knot.rfind(':');
  if (colon != std::string::npos) {
    change.part = knot.substr(0, colon);
    knot.erase(0, colon + 1);
  }
  if (equals == std::string::npos || !parseNumber(knot, change.knot) || change.knot < 0 ||
      !parseVector(std::string_view(text).substr(equals + 1), change.value)) {
    refuse(option, text, "KNOT=x,y,z or PART:KNOT=x,y,z");
  }
  return change;
}

Background parseBackground(const std::string& text) {
  Background background;
  if (text == "none") {
    background.transparent = true;
    return background;
  }
  const auto parseColor = [](std::string_view color, glm::vec3& out) {
    return parseVector(color, out) && glm::all(glm::greaterThanEqual(out, glm::vec3(0))) &&
           glm::all(glm::lessThanEqual(out, glm::vec3(255)));
  };
  const std::size_t colon = text.find(':');
  const std::string_view top = std::string_view(text).substr(0, colon);
  const std::string_view bottom = colon == std::string::npos ? top : std::string_view(text).substr(colon + 1);
  if (!parseColor(top, background.top) || !parseColor(bottom, background.bottom)) {
    refuse("--background", text,
           "R,G,B or TOP:BOTTOM of two such colors, each number from 0 to 255, or none");
  }
  background.top /= 255.0f;
  background.bottom /= 255.0f;
  return background;
}

// The paper's method has one level and one normal for each voxel.
void checkPaperOptions(const Options& options, int level) {
  const char* const method = toString(options.method);
  if (level > 0)
    throw ToolError(Exit::kUsage, fmt::format("--level {}: --method {} draws level 0 only; leave --level out",
                                              level, method));
  if (options.view == ViewKind::kDistance)
    throw ToolError(
        Exit::kUsage,
        fmt::format("--view distance: is the same for every method; leave --method {} out", method));
  if (options.view == ViewKind::kParts || options.view >= ViewKind::kBounds)
    throw ToolError(
        Exit::kUsage,
        fmt::format(
            "--view parts, bounds, splines, cages: --method {} does not draw them; leave --method out",
            method));
  if (options.shading != gl::Shading::kGradient)
    throw ToolError(Exit::kUsage, fmt::format("--shading: --method {} has one normal for each voxel; leave "
                                              "--shading out",
                                              method));
  if (options.soft_shadows > 0 || options.occlusion_by_distances)
    throw ToolError(Exit::kUsage,
                    fmt::format("--method {} shades by rays; leave {} out", method,
                                options.soft_shadows > 0 ? "--soft-shadows" : "--occlusion distances"));
  for (const Item& item : options.items)
    if (item.bend == Bend::kSweep)
      throw ToolError(Exit::kUsage, fmt::format("--bend {}: --method {} shears all parts; use --method kelp, "
                                                "or --bend shear",
                                                toString(*item.bend, item.caged), method));
}

// The options of one pack, the same before and after --and.
struct ItemText {
  Item item;
  std::vector<std::string> tangents, offsets;
  std::string at, bend;
  CLI::Option* time = nullptr;
};

void addItemOptions(CLI::App& app, ItemText& text) {
  // So that options of a shell alias can be overridden.
  app.option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)->group("Options of a pack");
  app.add_option("PACK", text.item.pack, "the .kelp file")->required();
  app.add_option("--bend", text.bend,
                 "draw all parts as if their rigs said so: sections stay level, or perpendicular to the "
                 "spline, or a cage that moves like that; the pack stays as it is")
      ->option_text("shear|sweep|cage [as the pack says]");
  app.add_option("--clip", text.item.clip, "the animation to play")->option_text("NAME");
  text.time =
      app.add_option("--time", text.item.time, "where in the clip the picture, or the first frame, is")
          ->option_text("SECONDS [0]");
  app.add_option("--tangent", text.tangents, "replace the tangent dS/d(at) of a knot; may be repeated")
      ->option_text("[PART:]KNOT=x,y,z")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->allow_extra_args(false);
  app.add_option("--offset", text.offsets, "move a knot; may be repeated")
      ->option_text("[PART:]KNOT=x,y,z")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->allow_extra_args(false);
  app.add_option("--at", text.at, "place the model there, in meters")->option_text("x,y,z [0,0,0]");
  app.add_option("--turn", text.item.turn,
                 "turn the model about the vertical, counter-clockwise seen from above")
      ->option_text("DEGREES [0]");
  app.add_option("--scale", text.item.scale, "scale the model")->option_text("FACTOR [1]");
}

Item finishItem(const ItemText& text) {
  Item item = text.item;
  if (!std::isfinite(item.time))
    throw ToolError(Exit::kUsage, "--time takes a finite number; see kelp-render --help");
  if (*text.time && item.clip.empty())
    throw ToolError(Exit::kUsage, "--time needs a clip; name one with --clip (kelp-dump info lists them)");
  item.caged = text.bend == toString(Bend::kSweep, true);
  if (item.caged) item.bend = Bend::kSweep;
  if (!text.bend.empty() && !item.bend && !(item.bend = parseBend(text.bend)))
    refuse("--bend", text.bend, "shear, sweep or cage");
  if (!text.at.empty() && !parseVector(text.at, item.at)) refuse("--at", text.at, "x,y,z");
  if (!std::isfinite(item.turn))
    throw ToolError(Exit::kUsage, "--turn takes a finite number; see kelp-render --help");
  if (!(item.scale >= 1e-6 && item.scale <= 1e6))
    throw ToolError(Exit::kUsage, "--scale takes a number from 0.000001 to 1000000; see kelp-render --help");
  for (const std::string& change : text.tangents)
    item.changes.push_back(parseChange("--tangent", change, true));
  for (const std::string& change : text.offsets)
    item.changes.push_back(parseChange("--offset", change, false));
  return item;
}

// False: --help or --version was answered.
bool parse(CLI::App& app, std::vector<std::string> arguments) {
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 wants them
  try {
    app.parse(std::move(arguments));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0)
      throw ToolError(Exit::kUsage, fmt::format("{}; see kelp-render --help", error.what()));
    std::ostringstream text;
    app.exit(error, text);
    if (const std::string problem = console::writeOut(text.str()); !problem.empty())
      throw ToolError(
          Exit::kIo,
          fmt::format("standard output cannot be written: {}; free space or choose another file", problem));
    return false;
  }
  return true;
}

// The options of the whole picture that are checked after parsing.
struct PictureText {
  std::string view, method, shading, shadows, occlusion, size, background;
  int level = 0;
  CLI::Option* level_option = nullptr;
};

void addPictureOptions(CLI::App& app, Options& options, PictureText& text) {
  app.option_defaults()->group("Options of the picture");
  app.add_option("-o,--output", options.output, "the .png file; with --frames a number is added before .png")
      ->required()
      ->option_text("OUT.png");
  app.add_option("--view", text.view, "what to show")
      ->option_text("shaded|normals|depth|distance|parts|steps|level|bounds|splines|cages [shaded]");
  app.add_option(
         "--method", text.method,
         "how rays are traced: by kelp, or as the paper published it, with constant steps or distance-field "
         "steps; prints steps and time")
      ->option_text("kelp|paper|paper-df [kelp]");
  app.add_option("--shading", text.shading,
                 "the look of voxels larger than pixels: one normal each, blocks, or blended")
      ->option_text("gradient|faces|smooth [gradient]");
  app.add_option("--shadows", text.shadows, "whether parts cast shadows on themselves")
      ->check(CLI::IsMember({"on", "off"}))
      ->option_text("on|off [on]");
  app.add_option(
         "--soft-shadows", options.soft_shadows,
         "shadows with a penumbra, also between the parts of a model: how large the sun is; needs packs "
         "with distances")
      ->check(CLI::Range(0.0, 20.0))
      ->option_text("DEGREES [0]");
  app.add_option("--occlusion", text.occlusion,
                 "how to measure how much of the sky a sample sees: by so many rays (0 to 16), or by the "
                 "distances in the packs")
      ->option_text("N|distances [0]");
  app.add_option("--size", text.size, "pixels")->option_text("WxH [800x600]");
  app.add_option("--samples", options.samples, "samples along each side of a pixel")
      ->check(CLI::IsMember({1, 2, 4}))
      ->option_text("1|2|4 [2]");
  app.add_option("--frames", options.frames,
                 "number of pictures over the first clip's duration; without a clip, over a full turn")
      ->check(CLI::Range(1, kMaxFrames))
      ->option_text("N [1]");
  app.add_option("--yaw", options.yaw, "degrees to the right of the model's front")
      ->option_text("DEGREES [30]");
  app.add_option("--pitch", options.pitch, "degrees from which the camera looks down")
      ->check(CLI::Range(-90.0, 90.0))
      ->option_text("DEGREES [15]");
  text.level_option =
      app.add_option(
             "--level", text.level,
             "the level to draw, 0 = finest; by default chosen by the size of its voxels in the picture")
          ->check(CLI::Range(0, 15))
          ->option_text("N");
  app.add_option("--background", text.background,
                 "one color or two, or none for a transparent picture; by default a gradient")
      ->option_text("R,G,B|TOP:BOTTOM|none");
}

void finishPicture(const PictureText& text, Options& options) {
  if (!options.output.ends_with(".png")) refuse("-o", options.output, "a name that ends in .png");
  if (!std::isfinite(options.yaw))
    throw ToolError(Exit::kUsage, "--yaw takes a finite number; see kelp-render --help");
  if (!text.view.empty()) options.view = parseView(text.view);
  if (!text.shading.empty()) options.shading = parseShading(text.shading);
  options.occlusion_by_distances = text.occlusion == "distances";
  if (!text.occlusion.empty() && !options.occlusion_by_distances &&
      (!parseNumber(text.occlusion, options.occlusion) || options.occlusion < 0 || options.occlusion > 16))
    refuse("--occlusion", text.occlusion, "a number of rays from 0 to 16, or distances");
  if (!std::isfinite(options.soft_shadows))
    throw ToolError(Exit::kUsage, "--soft-shadows takes a finite number; see kelp-render --help");
  if (options.soft_shadows > 0 && text.shadows == "off")
    throw ToolError(Exit::kUsage, "--soft-shadows and --shadows off: leave one of them out");
  options.report = !text.method.empty();
  if (options.report) options.method = parseMethod(text.method);
  if (options.method != Method::kKelp) checkPaperOptions(options, *text.level_option ? text.level : 0);
  options.shadows = text.shadows != "off";
  if (!text.size.empty()) options.size = parseSize(text.size);
  if (!text.background.empty()) options.background = parseBackground(text.background);
  if (*text.level_option) options.level = text.level;
}

constexpr char kFooter[] =
    "Examples:\n"
    "  kelp-render reed.kelp -o reed.png                                     at rest\n"
    "  kelp-render orange.kelp -o bent.png --tangent 0=3,0,1 --tangent 1=3,0,2\n"
    "  kelp-render reed.kelp -o sway.png --clip sway --frames 24             sway_0001.png ... "
    "sway_0024.png\n"
    "  kelp-render reed.kelp -o turn.png --frames 36                         a turntable\n"
    "  kelp-render reed.kelp -o cost.png --view steps                        steps of each ray: blue 0, "
    "red 64 and more\n"
    "  kelp-render reed.kelp -o soft.png --soft-shadows 2 --occlusion distances\n"
    "  kelp-render reed.kelp -o both.png --bend shear --and reed.kelp --bend sweep --at 0.5,0,0\n"
    "  kelp-render orange.kelp -o paper.png --method paper-df                the paper's method as "
    "published, "
    "with its steps and time\n"
    "  kelp-render reed.kelp -o pond.png --and fish.kelp --clip swim --at 0.3,0.4,0.1 --turn 20\n"
    "\n"
    "The options of a pack belong to the pack before them; all other options come before the first --and.\n"
    "Vectors are in the part's axes, y along the spline; 1 is the length of the axis.\n"
    "--method prints one line: the mean number of steps of a ray that meets a part's box, and the time of a "
    "frame.\n"
    "Exit codes: 0 ok, 1 usage, 2 input/output, 3 invalid pack or pose, 4 failure at run time, 5 unsupported "
    "feature, 130 interrupted.";

}  // namespace

const char* toString(Method method) {
  switch (method) {
    case Method::kPaper:
      return "paper";
    case Method::kPaperDf:
      return "paper-df";
    case Method::kKelp:
      break;
  }
  return "kelp";
}

std::optional<Options> parseOptions(int argc, char** argv) {
  CLI::App app("Renders .kelp packs to PNG, without a window.", "kelp-render");
  app.set_version_flag("--version", "kelp-render " KELP_VERSION " (" KELP_BUILD ")");
  app.footer(kFooter);
  Options options;
  ItemText first;
  PictureText picture;
  addItemOptions(app, first);
  addPictureOptions(app, options, picture);
  std::string in_groups;  // stays empty; the option is here for --help
  app.add_option("--and", in_groups, "add a pack to the picture; its own options of a pack follow")
      ->option_text("PACK");

  std::vector<std::vector<std::string>> groups(1);
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--and") {
      groups.emplace_back();
    } else {
      groups.back().emplace_back(argv[i]);
    }
  }
  if (!parse(app, groups[0])) return std::nullopt;
  options.items.push_back(finishItem(first));
  for (std::size_t i = 1; i < groups.size(); ++i) {
    CLI::App more("Adds a pack to the picture; see kelp-render --help.", "kelp-render --and");
    ItemText text;
    addItemOptions(more, text);
    if (!parse(more, groups[i])) return std::nullopt;
    options.items.push_back(finishItem(text));
  }
  finishPicture(picture, options);
  return options;
}

}  // namespace kelp::render
