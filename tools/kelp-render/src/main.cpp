// SPDX-License-Identifier: MIT
// kelp-render: from the command line to the pictures. The one place where errors become exit codes.
#include <cstdio>
#include <exception>
#include <new>

#include <fmt/format.h>

#include "camera.h"
#include "canvas.h"
#include "drawer.h"
#include "headless_context.h"
#include "kelp/common/console.h"
#include "kelp/common/error.h"
#include "kelp/common/output_file.h"
#include "kelp/common/png.h"
#include "method_report.h"
#include "options.h"
#include "scene.h"
#include "views.h"

namespace kelp::render {
namespace {

// OUT.png, or OUT_0001.png and so on.
std::string frameName(const Options& options, int frame) {
  if (options.frames == 1) return options.output;
  return fmt::format("{}_{:04}.png", options.output.substr(0, options.output.size() - 4), frame + 1);
}

// Before the work: whether the picture can be written, and replaces none of the packs.
void checkFrame(const std::string& name, const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) checkNotOverwritten(name, input);
  checkOutput(name);
}

void run(const Options& options) {
  std::vector<std::string> inputs;
  for (const Item& item : options.items) inputs.push_back(item.pack);
  for (int frame = 0; frame < options.frames; ++frame) checkFrame(frameName(options, frame), inputs);
  Scene scene(options);
  const bool turntable = scene.duration() == 0;
  const auto pose = [&](int frame) { scene.pose(scene.duration() * frame / options.frames); };

  // The camera frames what all frames show. With a clip also the models at rest, so that pictures of single
  // moments are framed alike.
  Framing framing(options.yaw, options.pitch, turntable ? options.frames : 1,
                  static_cast<double>(options.size.x) / options.size.y);
  const auto addOutlines = [&] {
    for (const runtime::Instance& instance : scene.instances()) addOutline(instance, framing);
  };
  if (!turntable) addOutlines();
  for (int frame = 0; frame < (turntable ? 1 : options.frames); ++frame) {
    pose(frame);
    addOutlines();
  }
  const Camera camera(framing);
  const ViewStyle style = styleOf(options.view, camera);

  const HeadlessContext context;
  Canvas canvas(options.samples * options.size, style.colors, context.es());
  const auto makeDrawer = options.method == Method::kKelp ? makeKelpDrawer : makePaperDrawer;
  const std::unique_ptr<Drawer> drawer = makeDrawer(options, style, scene, context.es());
  MethodReport report(options, canvas);

  gl::View view;
  view.camera.viewport = options.samples * options.size;
  view.debug = style.debug;
  view.quality.shading = options.shading;
  view.quality.self_shadow = options.shadows && options.soft_shadows == 0;
  view.quality.occlusion_rays = options.occlusion;
  if (options.shadesByDistances()) {
    view.quality.soft_shadows = static_cast<float>(options.soft_shadows);
    view.quality.occlusion = options.occlusion_by_distances;
  }
  if (options.level) {
    view.quality.finest_level = *options.level;
    view.quality.pixels_per_voxel = 0;
  }
  for (int frame = 0; frame < options.frames; ++frame) {
    pose(frame);
    camera.apply(turntable ? frame : 0, view);
    canvas.clear();
    if (options.report)
      report.draw(*drawer, view, scene.instances());
    else
      drawer->draw(view, scene.instances());
    const Picture picture = resolve(canvas.read(), options.size, options.samples, style.colors,
                                    options.background.value_or(style.background));
    writePng(OutputFile(frameName(options, frame)), picture.size, 4, picture.rgba);
  }
  if (options.report) report.print();
}

int complain(Exit code, const std::string& message) {
  std::fprintf(stderr, "kelp-render: %s\n", console::oneLine(message).c_str());
  return static_cast<int>(code);
}

}  // namespace

}  // namespace kelp::render

int main(int argc, char** argv) {
  using namespace kelp::render;
  using kelp::Exit;
  kelp::console::prepareStreams();
  kelp::endOnInterrupt("kelp-render");
  try {
    if (const auto options = parseOptions(argc, argv)) run(*options);
    return static_cast<int>(Exit::kOk);
  } catch (const kelp::ToolError& error) {
    return complain(error.exit, error.what());
  } catch (const std::bad_alloc&) {
    return complain(Exit::kRuntime,
                    "out of memory; lower --size or --samples, or bake with a lower resolution");
  } catch (const std::exception& error) {
    return complain(Exit::kRuntime, std::string("unexpected: ") + error.what() +
                                        "; please report this as a fault of kelp-render");
  }
}
