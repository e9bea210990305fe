// SPDX-License-Identifier: MIT
// A pack in memory. Opening it reads some kilobytes. Then kelp_asset_pump loads its voxels page by page,
// coarse to fine. Include kelp/kelp.h.
#ifndef KELP_C_ASSET_H
#define KELP_C_ASSET_H

#include "kelp/c/base.h"

typedef struct kelp_asset {
  uint64_t id;
} kelp_asset;

typedef struct kelp_asset_options {
  uint32_t struct_size;
  // The finest level of distances to load, for the queries of kelp/c/distance.h. 0: all; KELP_NONE: none.
  int32_t distance_level;
  // The most bytes of grids and pages to keep in memory. What was not used for longest makes room.
  uint64_t memory_budget;
  // Limits of a pack; KELP_ERROR_LIMIT beyond.
  uint64_t max_decoded_bytes;   // of any one chunk
  uint64_t max_metadata_bytes;  // of all metadata together
  uint32_t max_side;            // voxels of the finest level along an axis
  uint32_t max_parts;
  const kelp_allocator* allocator;  // copied. Null: malloc and free
} kelp_asset_options;

typedef int32_t kelp_read;
enum {
  KELP_READ_DONE = 0,     // all of the bytes are there
  KELP_READ_NOT_YET = 1,  // some have not arrived; note what was asked for, fetch and keep it
  KELP_READ_FAILED = 2    // these bytes cannot be had; so is any other number
};

// The host's reader: an entry of an archive, a network. `read` fills all of `bytes` from `offset`. It may
// block. Every thread that opens or pumps the asset calls it, several at the same time. `acquire` (may be
// null) is called once in kelp_asset_open, `release` (may be null) once when the asset is destroyed or could
// not be opened. `user` must live in between or, if these are null, as long as the asset.
typedef struct kelp_source {
  uint32_t struct_size;
  kelp_read (*read)(void* user, uint64_t offset, void* bytes, size_t count);
  void (*acquire)(void* user);
  void (*release)(void* user);
  void* user;
  uint64_t size;  // of the whole pack, however much has arrived
} kelp_source;

KELP_API kelp_result kelp_asset_options_defaults(kelp_asset_options* options);

// Opens a pack. options: null for the defaults. Safe for hostile packs. KELP_ERROR_NOT_YET: the source has
// not got the first bytes; open it again later. All other errors of reading.
KELP_API kelp_result kelp_asset_open(const kelp_source* source, const kelp_asset_options* options,
                                     kelp_asset* asset);
// path: in the system's encoding, UTF-8 on Windows. The file stays open as long as the asset lives.
KELP_API kelp_result kelp_asset_open_file(const char* path, const kelp_asset_options* options,
                                          kelp_asset* asset);
// The bytes must live as long as the asset.
KELP_API kelp_result kelp_asset_open_memory(const void* bytes, uint64_t size,
                                            const kelp_asset_options* options, kelp_asset* asset);
// Remove the asset from its renderers first; otherwise they refuse its instances. Poses and springs that were
// made from it stay.
KELP_API kelp_result kelp_asset_destroy(kelp_asset asset);

// Reads and decodes the most urgent grid or page. Blocks while the source reads. *more: something was loaded,
// so call again. Otherwise nothing is wanted now, or the source has not got it; call again in the next frame
// or after some milliseconds. An error is returned once. What failed stays absent until kelp_asset_retry, and
// the next call goes on with the rest.
KELP_API kelp_result kelp_asset_pump(kelp_asset asset, kelp_bool* more);
// Loads everything, and waits for what other threads load. Everything that can be loaded is, even if it
// fails.
KELP_API kelp_result kelp_asset_load_all(kelp_asset asset);
// Tries again what failed.
KELP_API kelp_result kelp_asset_retry(kelp_asset asset);

// A material of the palette.
typedef struct kelp_material {
  float base_color[4];  // linear; alpha is coverage, 1 = opaque
  float emissive[3];
  float metallic;
  float roughness;
} kelp_material;

// The content of a pack. Pointers are valid as long as the asset.
typedef struct kelp_asset_info {
  uint32_t struct_size;
  uint32_t format_minor;
  uint64_t file_size;
  uint64_t memory;      // bytes of grids, pages and distances that are in memory now
  kelp_text info_json;  // what the baker says of the pack; not parsed
  const kelp_material* palette;
  uint32_t palette_count;  // 1 to 256
  uint32_t parts;
  uint32_t clips;
  uint32_t sockets;
  kelp_bool has_distances;    // the pack has some
  kelp_bool loads_distances;  // and the asset loads them
  uint32_t joints;
} kelp_asset_info;
KELP_API kelp_result kelp_asset_get_info(kelp_asset asset, kelp_asset_info* info);

// A knot of a spline, in heights of the part.
typedef struct kelp_knot {
  float at;           // place along the axis, 0 to 1; animation does not change it
  float position[3];  // (0, at, 0) in a straight rig
  float tangent[3];   // dS/d(at); (0, 1, 0) in a straight rig
} kelp_knot;

typedef int32_t kelp_part_kind;
enum { KELP_PART_SOLID = 0, KELP_PART_FOG = 1, KELP_PART_EMPTY = 2 };
typedef int32_t kelp_bend;
enum { KELP_BEND_SHEAR = 0, KELP_BEND_SWEEP = 1 };

// A volume of voxels with one rig, or a rig alone. Pointers are valid as long as the asset.
typedef struct kelp_part {
  uint32_t struct_size;
  int32_t parent;  // index of an earlier part, whose motion this part follows, or KELP_NONE
  kelp_text name;
  kelp_part_kind kind;
  kelp_bend bend;
  int32_t levels;               // 0 of an empty part
  int32_t distance_levels;      // 0: no distances
  int32_t size[3];              // voxels of the finest level; +y along the spline
  float to_object[16];          // those voxels -> meters, at rest
  float pivot[16];              // pivot space, in which motions act -> meters
  float parent_at;              // where it hangs on its parent's spline, 0 to 1; -1: not on the spline
  float roll;                   // of a swept part: radians, its turn at the first knot
  uint32_t knot_count;          // 2 to 64
  const kelp_knot* knots;       // the rest rig
  uint64_t automatic_tangents;  // bit i: the tangent of knot i follows when a knot beside it moves
  // Of fog, else 0. Lengths are in voxels of the finest level.
  float fog_color[3];           // the share of the stopped light that is scattered
  float fog_anisotropy;         // mean cosine of the scattering angle
  float fog_glow;               // emission at heat 1 is this times the last color of the ramp
  uint32_t fog_ramp_count;      // 0: no heat
  const float* fog_ramp;        // 3 floats a color, from cold to hot
  const float* fog_extinction;  // one a level: optical depth of a length of 1 at density 1
} kelp_part;
KELP_API kelp_result kelp_asset_get_part(kelp_asset asset, int32_t part, kelp_part* out);
// The first part of that name. KELP_ERROR_MISUSE: there is none; the error's text lists the names.
KELP_API kelp_result kelp_asset_find_part(kelp_asset asset, const char* name, int32_t* part);
// The cells of a part's finest cage, for what moves its nodes (kelp_pose_write_nodes): eight numbers of nodes
// each, corner i at x + (i & 1), y + (i >> 1 & 1), z + (i >> 2). At most `capacity` cells are copied to
// `nodes` (may be null if that is 0). *count: how many the part has; 0 without a cage. KELP_ERROR_MISUSE: no
// such part.
KELP_API kelp_result kelp_asset_get_cage_cells(kelp_asset asset, int32_t part, uint32_t* nodes,
                                               uint32_t capacity, uint32_t* count);
// The morph targets that move the nodes of a part (kelp_pose_set_morph): each an empty part with its name. At
// most `capacity` indices of parts are copied to `morphs` (may be null if that is 0). *count: how many there
// are. KELP_ERROR_MISUSE: no such part.
KELP_API kelp_result kelp_asset_get_morphs(kelp_asset asset, int32_t part, int32_t* morphs, uint32_t capacity,
                                           uint32_t* count);

// An animation. kelp_pose_add_clip plays it.
typedef struct kelp_clip {
  uint32_t struct_size;
  float duration;  // seconds
  kelp_text name;  // valid as long as the asset
  uint32_t waves;
  uint32_t tracks;
} kelp_clip;
KELP_API kelp_result kelp_asset_get_clip(kelp_asset asset, int32_t clip, kelp_clip* out);
// The first clip of that name. KELP_ERROR_MISUSE: there is none; the error's text lists the names.
KELP_API kelp_result kelp_asset_find_clip(kelp_asset asset, const char* name, int32_t* clip);

// The thing that a wave or track moves.
typedef int32_t kelp_target;
enum {
  KELP_TARGET_KNOT_OFFSET = 0,
  KELP_TARGET_KNOT_TANGENT = 1,
  KELP_TARGET_PART_TRANSLATION = 2,
  KELP_TARGET_PART_ROTATION = 3,
  KELP_TARGET_PART_SCALE = 4
};
// amplitude * sin(2 pi (seconds / period + phase)), added to a knot.
typedef struct kelp_wave {
  uint32_t struct_size;
  int32_t part;
  int32_t knot;
  kelp_target target;
  float amplitude[3];
  float period;  // seconds
  float phase;   // turns
} kelp_wave;
KELP_API kelp_result kelp_asset_get_wave(kelp_asset asset, int32_t clip, int32_t wave, kelp_wave* out);

typedef int32_t kelp_interpolation;
enum { KELP_INTERPOLATION_STEP = 0, KELP_INTERPOLATION_LINEAR = 1, KELP_INTERPOLATION_CUBIC = 2 };
typedef struct kelp_key {
  float time;  // seconds
  float value[4];
  float in[4];  // slopes per second before and after the key, for cubic tracks
  float out[4];
} kelp_key;
typedef struct kelp_track {
  uint32_t struct_size;
  int32_t part;
  int32_t knot;  // 0 if the target is a part
  kelp_target target;
  kelp_interpolation interpolation;
  uint32_t key_count;
  const kelp_key* keys;  // ascending times; valid as long as the asset
} kelp_track;
KELP_API kelp_result kelp_asset_get_track(kelp_asset asset, int32_t clip, int32_t track, kelp_track* out);

// A named place on a part, for what a game attaches: kelp_instance_socket_to_world.
typedef struct kelp_socket {
  uint32_t struct_size;
  int32_t part;
  kelp_text name;     // valid as long as the asset
  float at;           // place along the axis, 0 to 1
  float offset[2];    // across the axis, from the middle line: part x and z, heights of the part
  float rotation[4];  // of its axes against those of the part
} kelp_socket;
KELP_API kelp_result kelp_asset_get_socket(kelp_asset asset, int32_t socket, kelp_socket* out);
// The first socket of that name; of one part, or of any if `part` is KELP_NONE. KELP_ERROR_MISUSE: there is
// none; the error's text lists the names.
KELP_API kelp_result kelp_asset_find_socket(kelp_asset asset, const char* name, int32_t part,
                                            int32_t* socket);

// A joint of the skin that the parts were made of, for hosts that move its skeleton themselves. Parents come
// first. With a matrix M from joint space to meters, what follows the joint alone goes from x at rest to
// M * inverse_bind * x; what follows several, to the weighted sum of these. Pointers are valid as long as the
// asset.
typedef struct kelp_joint {
  uint32_t struct_size;
  int32_t parent;          // an earlier joint, or KELP_NONE
  kelp_text name;          // the source's; need not be unique
  float inverse_bind[16];  // meters, at rest -> joint space, whose axes and units are the source's
  uint32_t part_count;
  const int32_t* parts;  // ascending: those made to move as the joint does, alone or with others
} kelp_joint;
KELP_API kelp_result kelp_asset_get_joint(kelp_asset asset, int32_t joint, kelp_joint* out);
// The first joint of that name. KELP_ERROR_MISUSE: there is none; the error's text lists the names.
KELP_API kelp_result kelp_asset_find_joint(kelp_asset asset, const char* name, int32_t* joint);

// The finest level of the part that is wholly in memory and not finer than `wanted`; if there is none, the
// coarsest of the finer ones; KELP_NONE: none yet. KELP_ERROR_MISUSE: no such part.
KELP_API kelp_result kelp_asset_resident_level(kelp_asset asset, int32_t part, int32_t wanted,
                                               int32_t* level);

// The grid of a level of voxels. kelp/formats/page.h says what a cell holds. Valid as long as the asset.
typedef struct kelp_level {
  uint32_t struct_size;
  int32_t size[3];        // voxels of this level
  int32_t grid[3];        // bricks of 8 x 8 x 8 voxels
  uint32_t pages;         // of stored bricks
  const uint32_t* cells;  // one a brick, x fastest, then y, then z
} kelp_level;
// KELP_ERROR_NOT_YET: the grid, or one of a coarser level, is not loaded.
KELP_API kelp_result kelp_asset_get_level(kelp_asset asset, int32_t part, int32_t level, kelp_level* out);

// A level of distances. kelp/formats/distance.h says what the codes mean. Valid as long as the asset.
typedef struct kelp_distance_level {
  uint32_t struct_size;
  int32_t size[3];
  int32_t grid[3];
  uint32_t band_outside;  // the largest squared distances that it stores: of empty voxels, of solid ones
  uint32_t band_inside;
  uint32_t pages;               // of stored bricks
  const uint32_t* cells;        // one a brick: the code of all its voxels, or 0x80000000 | page << 7 | brick
  const uint32_t* first_slots;  // one a page: the slot of its brick 0
  const uint8_t* codes;         // 512 a slot
  uint64_t code_count;
} kelp_distance_level;
// KELP_ERROR_NOT_YET: not in memory, and never so unless kelp_asset_options.distance_level asks for it.
KELP_API kelp_result kelp_asset_get_distance_level(kelp_asset asset, int32_t part, int32_t level,
                                                   kelp_distance_level* out);

#endif
