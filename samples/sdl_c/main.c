// SPDX-License-Identifier: MIT
// kelp in a game of C99 and SDL2: plants sway, a thread loads them, a click makes one red.
//   cc -std=c99 -Wall -Wextra -pedantic main.c -o sdl_c $(pkg-config --cflags --libs kelp sdl2 gl)
#include <SDL.h>
#include <SDL_opengl.h>
#include <kelp/kelp.h>
#include <stdio.h>
#include <stdlib.h>

enum { kWidth = 960, kHeight = 720, kPlants = 40 };
static const float kSlope = 0.42f, kNear = 0.5f, kFar = 50.0f;  // slope: of the picture's upper edge
static const float kEye[3] = {0, 1.0f, 4.0f};                   // looks down -z

static kelp_asset asset;
static kelp_renderer renderer;
static kelp_instance plants[kPlants];
static kelp_bool has_clip;
static SDL_atomic_t ends;

// Prints the error and returns the exit code.
static int fail(const char* what, const char* why, int exit_code) {
  fprintf(stderr, "sdl_c: %s: %s\n", what, why);
  return exit_code;
}

static int exitCodeOf(kelp_result result) {
  switch (result) {
    case KELP_ERROR_IO:
      return 2;
    case KELP_ERROR_GRAPHICS:
      return 4;
    default:
      return 3;
  }
}

// An error ends the game.
static void check(const char* what, kelp_result result) {
  kelp_error error = {.struct_size = sizeof error};
  if (result == KELP_OK) return;
  kelp_last_error(&error);
  exit(fail(what, error.text, exitCodeOf(result)));
}

static void* functionOf(void* user, const char* name) {
  (void)user;
  return SDL_GL_GetProcAddress(name);
}

// A thread that reads the voxels that the renderer asks for.
static int load(void* path) {
  while (!SDL_AtomicGet(&ends)) {
    kelp_bool more = 0;
    check(path, kelp_asset_pump(asset, &more));
    if (!more) SDL_Delay(2);
  }
  return 0;
}

static void openPack(const char* path) {
  kelp_asset_info info = {.struct_size = sizeof info};
  kelp_renderer_options options = {.struct_size = sizeof options};
  kelp_renderer_options_defaults(&options);
  options.get_proc_address = functionOf;
  check(path, kelp_asset_open_file(path, NULL, &asset));
  check(path, kelp_asset_get_info(asset, &info));
  has_clip = info.clips > 0;
  check("renderer", kelp_renderer_create(&options, &renderer));
  check(path, kelp_renderer_add(renderer, asset));
}

// Plants in five rows of eight, each 1.2 high.
static void grow(const char* path) {
  kelp_instance plant = {.struct_size = sizeof plant};
  kelp_box box;
  kelp_instance_defaults(&plant);
  plant.asset = asset;
  check(path, kelp_instance_get_bounds(&plant, &box));
  for (int axis = 0; axis < 3; ++axis) plant.to_world[5 * axis] = 1.2f / (box.max[1] - box.min[1]);
  for (int i = 0; i < kPlants; ++i) {
    plants[i] = plant;
    plants[i].to_world[12] = (float)(i % 8) - 3.5f;
    plants[i].to_world[14] = -1.2f * (float)(i / 8);
    check(path, kelp_pose_create(asset, NULL, &plants[i].pose));
  }
}

static void sway(double seconds) {
  for (int i = 0; i < kPlants; ++i) {
    check("pose", kelp_pose_reset(plants[i].pose));
    if (!has_clip) continue;
    check("clip", kelp_pose_add_clip(plants[i].pose, asset, 0, seconds + 0.37 * i, 1, KELP_PLAY_LOOP));
  }
}

// Makes the plant under the pixel red.
static void click(float x, float y) {
  const float direction[3] = {kSlope * (2 * x - kWidth) / kHeight, kSlope * (1 - 2 * y / kHeight), -1};
  kelp_raycast_answer hit = {.struct_size = sizeof hit};
  check("click", kelp_raycast(plants, kPlants, kEye, direction, kFar, 0, &hit));
  if (!hit.found) return;
  plants[hit.instance].tint[0] = 6;
  plants[hit.instance].tint[1] = 0.2f;
}

// 0: the game ends.
static int handleEvents(void) {
  SDL_Event event;
  while (SDL_PollEvent(&event)) {
    if (event.type == SDL_QUIT) return 0;
    if (event.type == SDL_MOUSEBUTTONDOWN) click((float)event.button.x, (float)event.button.y);
  }
  return 1;
}

static kelp_view makeView(void) {
  kelp_view view = {.struct_size = sizeof view};
  kelp_view_defaults(&view);
  view.viewport[0] = kWidth;
  view.viewport[1] = kHeight;
  for (int i = 0; i < 3; ++i) view.world_to_eye[12 + i] = -kEye[i];
  view.eye_to_clip[0] = kHeight / kSlope / kWidth;
  view.eye_to_clip[5] = 1 / kSlope;
  view.eye_to_clip[10] = (kNear + kFar) / (kNear - kFar);
  view.eye_to_clip[11] = -1;
  view.eye_to_clip[14] = 2 * kNear * kFar / (kNear - kFar);
  view.eye_to_clip[15] = 0;
  view.output = KELP_OUTPUT_DISPLAY;  // few windows of SDL encode
  return view;
}

static int save(const char* path) {
  static unsigned char rows[kHeight][3 * kWidth];
  FILE* const file = fopen(path, "wb");
  if (!file) return fail(path, "the picture cannot be written", 2);
  glReadPixels(0, 0, kWidth, kHeight, GL_RGB, GL_UNSIGNED_BYTE, rows);
  fprintf(file, "P6\n%d %d\n255\n", kWidth, kHeight);
  for (int y = kHeight - 1; y >= 0; --y) fwrite(rows[y], 1, sizeof rows[y], file);
  if (fclose(file) != 0) return fail(path, "the picture cannot be written", 2);
  return 0;
}

static int play(SDL_Window* window, int frames, const char* picture) {
  const kelp_view view = makeView();
  kelp_stats stats = {.struct_size = sizeof stats};
  int frame = 0;
  while (handleEvents()) {
    sway(0.001 * SDL_GetTicks());
    glClearColor(0.58f, 0.74f, 0.78f, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    check("upload", kelp_renderer_upload(renderer, 4 << 20, &stats));
    check("draw", kelp_renderer_draw(renderer, &view, plants, kPlants, KELP_PASS_COLOR, NULL));
    if (stats.pending == 0) ++frame;  // all voxels are there
    if (frames > 0 && frame == frames) return picture ? save(picture) : 0;
    SDL_GL_SwapWindow(window);
  }
  return 0;
}

static void destroyAll(void) {
  kelp_renderer_destroy(renderer);
  for (int i = 0; i < kPlants; ++i) kelp_pose_destroy(plants[i].pose);
  kelp_asset_destroy(asset);
}

int main(int count, char** words) {
  const int frames = count > 3 && SDL_strcmp(words[2], "--frames") == 0 ? atoi(words[3]) : 0;
  if (count != 2 && (frames <= 0 || count > 5))
    return fail("usage", "sdl_c PACK.kelp [--frames N [PICTURE.ppm]]", 1);
  if (SDL_Init(SDL_INIT_VIDEO) != 0) return fail("window", SDL_GetError(), 4);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_CORE);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 3);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, 3);
  SDL_Window* const window = SDL_CreateWindow("kelp: sdl_c", 0, 0, kWidth, kHeight, SDL_WINDOW_OPENGL);
  const SDL_GLContext context = window ? SDL_GL_CreateContext(window) : NULL;
  if (!context) return fail("window", SDL_GetError(), 4);

  openPack(words[1]);
  grow(words[1]);
  SDL_Thread* const loader = SDL_CreateThread(load, "loader", words[1]);
  const int exit_code = play(window, frames, count == 5 ? words[4] : NULL);
  SDL_AtomicSet(&ends, 1);
  SDL_WaitThread(loader, NULL);

  destroyAll();
  SDL_GL_DeleteContext(context);
  SDL_DestroyWindow(window);
  SDL_Quit();
  return exit_code;
}
