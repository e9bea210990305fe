// SPDX-License-Identifier: MIT
// The basis of kelp/kelp.h: results, errors, texts, the host's allocator. Include kelp/kelp.h.
#ifndef KELP_C_BASE_H
#define KELP_C_BASE_H

#include <stddef.h>
#include <stdint.h>

// KELP_DLL_BUILD: while kelp.dll is compiled. KELP_DLL: in programs that link it (kelp::c defines it). They
// link without it, too, by way of a jump.
#if defined(_WIN32) && defined(KELP_DLL_BUILD)
#define KELP_VISIBLE __declspec(dllexport)
#elif defined(_WIN32) && defined(KELP_DLL)
#define KELP_VISIBLE __declspec(dllimport)
#elif defined(__GNUC__) && !defined(_WIN32)
#define KELP_VISIBLE __attribute__((visibility("default")))
#else
#define KELP_VISIBLE
#endif
#ifdef __cplusplus
#define KELP_API extern "C" KELP_VISIBLE
#else
#define KELP_API extern KELP_VISIBLE
#endif

typedef uint32_t kelp_bool;

// In place of an index that the library writes: there is none.
enum { KELP_NONE = -1 };

typedef int32_t kelp_result;
enum {
  KELP_OK = 0,
  KELP_ERROR_MISUSE = 1,               // a bad index or number, an object that does not fit
  KELP_ERROR_IO = 2,                   // the source failed to read
  KELP_ERROR_NOT_A_PACK = 3,           // the file does not start with the identifier of a .kelp pack
  KELP_ERROR_UNSUPPORTED_VERSION = 4,  // another major version of the format, newer or older
  KELP_ERROR_UNSUPPORTED_FEATURE = 5,  // a chunk, flag or kind of part that this version does not know
  KELP_ERROR_TRUNCATED = 6,            // the file is shorter than its header says
  KELP_ERROR_CHECKSUM = 7,             // bytes differ from their checksum
  KELP_ERROR_CORRUPT = 8,              // the content breaks a rule although the checksums match
  KELP_ERROR_LIMIT = 9,                // larger than the given limits or budgets allow
  KELP_ERROR_OUT_OF_MEMORY = 10,       // an allocation failed
  KELP_ERROR_NOT_MONOTONE = 11,        // the spline of a sheared part turns back along its axis
  KELP_ERROR_FOLDS = 12,               // a swept part bends too sharply for its thickness
  KELP_ERROR_GRAPHICS = 13,            // OpenGL failed: a missing function, a shader, a texture too large
  KELP_ERROR_NOT_YET = 14,             // not loaded yet: nothing is wrong, ask again later
  // Of this interface alone.
  KELP_ERROR_HANDLE = 100,        // names nothing: null, destroyed, or of another type
  KELP_ERROR_NULL = 101,          // a pointer is null that may not be
  KELP_ERROR_STRUCT_SIZE = 102,   // see kelp/kelp.h
  KELP_ERROR_WRONG_THREAD = 103,  // the renderer belongs to another thread
  KELP_ERROR_BUSY = 104           // another thread, or a caller of this callback, is using the object
};

// The unit of kelp_error.offset.
typedef uint32_t kelp_unit;
enum {
  KELP_UNIT_BYTE = 0,      // of the pack
  KELP_UNIT_PART = 1,      // index of a part
  KELP_UNIT_KNOT = 2,      // index of a knot in its part
  KELP_UNIT_INSTANCE = 3,  // index of an instance in the list that was given
  KELP_UNIT_NODE = 4,      // index of a node in the finest cage of its part
  KELP_UNIT_JOINT = 5,     // index of a joint
  KELP_UNIT_NONE = 6       // the error has no place; offset is 0
};

typedef struct kelp_error {
  uint32_t struct_size;
  kelp_result result;
  uint64_t offset;
  kelp_unit unit;
  char text[492];  // English, UTF-8, ends in a zero byte; a longer text is cut
} kelp_error;

// A text of the library: `size` bytes of UTF-8. No zero byte follows it.
typedef struct kelp_text {
  const char* data;
  size_t size;
} kelp_text;

// The host's memory. Every thread that uses the object calls both. `allocate` returns memory aligned to 16
// bytes, or null; `deallocate` gets the same number of bytes. `user` must live as long as the object.
typedef struct kelp_allocator {
  uint32_t struct_size;
  void* (*allocate)(void* user, size_t bytes);
  void (*deallocate)(void* user, void* memory, size_t bytes);
  void* user;
} kelp_allocator;

// Version of the library: 10000 major + 100 minor + patch.
KELP_API uint32_t kelp_version(void);
// The result in a few English words, such as "checksum mismatch". Static storage.
KELP_API const char* kelp_result_text(kelp_result result);
// Copies the last error of the calling thread; KELP_OK and an empty text if it has met none. Calls that
// succeed leave it. It is a copy, because the library's own text may go with the next error or with the asset
// whose names it lists.
KELP_API kelp_result kelp_last_error(kelp_error* error);

#endif
