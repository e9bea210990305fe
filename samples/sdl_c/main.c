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
static SDL_atomic_t ends;

static int say(const char* what, const char* why, int exit_code) {
  return fprintf(stderr, "sdl_c: %s: %s\n", what, why), exit_code;
}

static void check(const char* what, kelp_result result) {  // an error ends the game
  kelp_error error = {.struct_size = sizeof error};
  if (result == KELP_OK) return;
  kelp_last_error(&error);
  exit(say(what, error.text, result == KELP_ERROR_IO ? 2 : result == KELP_ERROR_GRAPHICS ? 4 : 3));
}

static void* functionOf(void* user, const char* name) { return (void)user, SDL_GL_GetProcAddress(name); }

static int load(void* path) {  // a thread
  for (kelp_bool more = 0; !SDL_AtomicGet(&ends); more || (SDL_Delay(2), 0))
    check(path, kelp_asset_pump(asset, &more));
  return 0;
}

static void grow(const char* path) {
  kelp_renderer_options config = {.struct_size = sizeof config};
  kelp_instance plant = {.struct_size = sizeof plant};
  kelp_box box;
  kelp_renderer_options_defaults(&config);
  config.get_proc_address = functionOf;
  kelp_instance_defaults(&plant);
  check(path, kelp_asset_open_file(path, NULL, &asset));
  check("renderer", kelp_renderer_create(&config, &renderer));
  check(path, kelp_renderer_add(renderer, asset));
  plant.asset = asset;
  check(path, kelp_instance_get_bounds(&plant, &box));
  for (int axis = 0; axis < 3; ++axis) plant.to_world[5 * axis] = 1.2f / (box.max[1] - box.min[1]);
  for (int i = 0; i < kPlants; plants[i++] = plant) {
    check(path, kelp_pose_create(asset, NULL, &plant.pose));
    plant.to_world[12] = (float)(i % 8) - 3.5f, plant.to_world[14] = -1.2f * (float)(i / 8);
  }
}

static void click(float x, float y) {
  const float direction[3] = {kSlope * (2 * x - kWidth) / kHeight, kSlope * (1 - 2 * y / kHeight), -1};
  kelp_raycast_answer hit = {.struct_size = sizeof hit};
  check("click", kelp_raycast(plants, kPlants, kEye, direction, kFar, 0, &hit));
  if (hit.found) plants[hit.instance].tint[0] = 6, plants[hit.instance].tint[1] = 0.2f;
}

static int save(const char* path) {
  static unsigned char rows[kHeight][3 * kWidth];
  FILE* const file = fopen(path, "wb");
  if (!file) return say(path, "the picture cannot be written", 2);
  glReadPixels(0, 0, kWidth, kHeight, GL_RGB, GL_UNSIGNED_BYTE, rows);
  fprintf(file, "P6\n%d %d\n255\n", kWidth, kHeight);
  for (int y = kHeight; y-- > 0;) fwrite(rows[y], 1, sizeof rows[y], file);
  return fclose(file) == 0 ? 0 : say(path, "the picture cannot be written", 2);
}

static int play(SDL_Window* window, int frames, const char* picture) {
  kelp_view view = {.struct_size = sizeof view};
  kelp_stats stats = {.struct_size = sizeof stats};
  kelp_view_defaults(&view);
  view.viewport[0] = kWidth, view.viewport[1] = kHeight;
  for (int i = 0; i < 3; ++i) view.world_to_eye[12 + i] = -kEye[i];
  view.eye_to_clip[0] = kHeight / kSlope / kWidth, view.eye_to_clip[5] = 1 / kSlope;
  view.eye_to_clip[10] = (kNear + kFar) / (kNear - kFar), view.eye_to_clip[11] = -1;
  view.eye_to_clip[14] = 2 * kNear * kFar / (kNear - kFar), view.eye_to_clip[15] = 0;
  view.output = KELP_OUTPUT_DISPLAY;  // few windows of SDL encode
  for (int frame = 0;; SDL_GL_SwapWindow(window)) {
    for (SDL_Event event; SDL_PollEvent(&event);) {
      if (event.type == SDL_QUIT) return 0;
      if (event.type == SDL_MOUSEBUTTONDOWN) click((float)event.button.x, (float)event.button.y);
    }
    for (int i = 0; i < kPlants; ++i) {
      kelp_pose_reset(plants[i].pose);  // then the first clip, if there is one
      kelp_pose_add_clip(plants[i].pose, asset, 0, 0.001 * SDL_GetTicks() + 0.37 * i, 1, KELP_PLAY_LOOP);
    }
    glClearColor(0.58f, 0.74f, 0.78f, 1), glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    check("upload", kelp_renderer_upload(renderer, 4 << 20, &stats));
    check("draw", kelp_renderer_draw(renderer, &view, plants, kPlants, KELP_PASS_COLOR, NULL));
    if (stats.pending == 0 && ++frame == frames) return picture ? save(picture) : 0;  // all voxels are there
  }
}

int main(int count, char** words) {
  const int frames = count > 3 && SDL_strcmp(words[2], "--frames") == 0 ? atoi(words[3]) : 0;
  if (count != 2 && (frames <= 0 || count > 5))
    return say("usage", "sdl_c PACK.kelp [--frames N [PICTURE.ppm]]", 1);
  if (SDL_Init(SDL_INIT_VIDEO) != 0) return say("window", SDL_GetError(), 4);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_CORE);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 3), SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, 3);
  SDL_Window* const window = SDL_CreateWindow("kelp: sdl_c", 0, 0, kWidth, kHeight, SDL_WINDOW_OPENGL);
  const SDL_GLContext context = window ? SDL_GL_CreateContext(window) : NULL;
  if (!context) return say("window", SDL_GetError(), 4);
  grow(words[1]);
  SDL_Thread* const loader = SDL_CreateThread(load, "loader", words[1]);
  const int exit_code = play(window, frames, count == 5 ? words[4] : NULL);
  SDL_AtomicSet(&ends, 1), SDL_WaitThread(loader, NULL);
  kelp_renderer_destroy(renderer);
  for (int i = 0; i < kPlants; ++i) kelp_pose_destroy(plants[i].pose);
  kelp_asset_destroy(asset);
  SDL_GL_DeleteContext(context), SDL_DestroyWindow(window), SDL_Quit();
  return exit_code;
}
