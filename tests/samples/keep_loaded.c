// SPDX-License-Identifier: MIT
// For sdl_c_leaks: libraries stay in memory, so that a leak in a driver has the driver's name.
#include <dlfcn.h>

int dlclose(void* library) { return (void)library, 0; }
