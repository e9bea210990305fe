# SPDX-License-Identifier: MIT
"""Mouse, keys and pictures of a program on an X server without a window manager. Needs libX11 and libXtst
(Debian: libxtst6)."""

import ctypes
import ctypes.util
import time


class Absent(Exception):
    """A library that is not there."""


def load(name):
    path = ctypes.util.find_library(name)
    if not path:
        raise Absent("no lib%s (Debian: lib%s6)" % (name, name.lower()))
    return ctypes.CDLL(path)


class ClientMessage(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p),
                ("window", ctypes.c_ulong), ("message_type", ctypes.c_ulong), ("format", ctypes.c_int),
                ("data", ctypes.c_long * 5),
                ("pad", ctypes.c_long * 24)]


class Image(ctypes.Structure):
    _fields_ = [("width", ctypes.c_int), ("height", ctypes.c_int), ("xoffset", ctypes.c_int),
                ("format", ctypes.c_int), ("data", ctypes.POINTER(ctypes.c_ubyte)),
                ("byte_order", ctypes.c_int), ("bitmap_unit", ctypes.c_int),
                ("bitmap_bit_order", ctypes.c_int), ("bitmap_pad", ctypes.c_int), ("depth", ctypes.c_int),
                ("bytes_per_line", ctypes.c_int), ("bits_per_pixel", ctypes.c_int)]


class Screen:
    """The largest window of the display, which is where the mouse and the keys go."""

    def __init__(self):
        self.x11, self.xtst = load("X11"), load("Xtst")
        for function in (self.x11.XOpenDisplay, self.x11.XDefaultRootWindow, self.x11.XInternAtom,
                         self.x11.XStringToKeysym):
            function.restype = ctypes.c_void_p if function is self.x11.XOpenDisplay else ctypes.c_ulong
        self.display = ctypes.c_void_p(self.x11.XOpenDisplay(None))
        if not self.display:
            raise Absent("no display")
        self.quiet = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p,
                                      ctypes.c_void_p)(lambda display, event: 0)
        self.x11.XSetErrorHandler(self.quiet)
        self.root = self.x11.XDefaultRootWindow(self.display)
        self.window = None

    def find(self, width, height):
        """The window of that size, once it is there; it gets the keys."""
        root, parent, children, count = ctypes.c_ulong(), ctypes.c_ulong(), ctypes.POINTER(
            ctypes.c_ulong)(), ctypes.c_uint()
        for _ in range(400):
            self.x11.XQueryTree(self.display, ctypes.c_ulong(self.root), ctypes.byref(root),
                                ctypes.byref(parent), ctypes.byref(children), ctypes.byref(count))
            for i in range(count.value):
                x, y = ctypes.c_int(), ctypes.c_int()
                w, h, border, depth = (ctypes.c_uint() for _ in range(4))
                self.x11.XGetGeometry(self.display, ctypes.c_ulong(children[i]), ctypes.byref(root),
                                      *map(ctypes.byref, (x, y, w, h, border, depth)))
                if (w.value, h.value) == (width, height):
                    self.window, self.corner = children[i], (x.value, y.value)
                    return self.focus()
            time.sleep(0.05)
        raise AssertionError("no window of %d x %d" % (width, height))

    def focus(self):
        """A window takes the keys once it is seen, which may be a moment after it is there; until then the
        server complains."""
        has, revert = ctypes.c_ulong(), ctypes.c_int()
        for _ in range(400):
            self.x11.XSetInputFocus(self.display, ctypes.c_ulong(self.window), 1, ctypes.c_ulong(0))
            self.x11.XSync(self.display, 0)
            self.x11.XGetInputFocus(self.display, ctypes.byref(has), ctypes.byref(revert))
            if has.value == self.window:
                return
            time.sleep(0.05)
        raise AssertionError("the window does not take the keys")

    def settle(self, seconds=0.25):
        """Some frames."""
        self.x11.XSync(self.display, 0)
        time.sleep(seconds)

    def move(self, x, y):
        self.xtst.XTestFakeMotionEvent(self.display, -1, self.corner[0] + x, self.corner[1] + y,
                                       ctypes.c_ulong(0))
        self.settle()

    def button(self, down):
        self.xtst.XTestFakeButtonEvent(self.display, 1, int(down), ctypes.c_ulong(0))
        self.settle()

    def click(self, x, y):
        self.move(x, y)
        self.button(True)
        self.button(False)

    def click_until_red(self, aim, size, is_red, share):
        """Until more than that share of the picture is; aim(pixels) is where, in the last picture."""
        pixels = self.picture(*size)
        for _ in range(120):
            self.click(*aim(pixels))
            pixels = self.picture(*size)
            if sum(1 for pixel in pixels if is_red(*pixel)) > share * size[0] * size[1]:
                return
        raise AssertionError("a click turns nothing red")

    def drag(self, x, y, to_x, to_y):
        self.move(x, y)
        self.button(True)
        for i in range(1, 5):
            self.move(x + (to_x - x) * i // 4, y + (to_y - y) * i // 4)
        self.button(False)

    def key(self, *names):
        """All of them at once: key("Control_L", "s")."""
        codes = [self.x11.XKeysymToKeycode(self.display,
                                           ctypes.c_ulong(self.x11.XStringToKeysym(name.encode())))
                                           for name in names]
        for code in codes:
            self.xtst.XTestFakeKeyEvent(self.display, code, 1, ctypes.c_ulong(0))
            self.settle(0.1)
        for code in reversed(codes):
            self.xtst.XTestFakeKeyEvent(self.display, code, 0, ctypes.c_ulong(0))
            self.settle(0.1)

    def picture(self, width, height):
        """The window's pixels now: a list of (r, g, b)."""
        self.x11.XGetImage.restype = ctypes.POINTER(Image)
        image = self.x11.XGetImage(self.display, ctypes.c_ulong(self.window), 0, 0, width, height,
                                   ctypes.c_ulong(0xffffff), 2)
        assert image and image[0].bits_per_pixel == 32 and image[0].byte_order == 0, "no picture of 24 bits"
        data = ctypes.string_at(image[0].data, image[0].bytes_per_line * height)
        assert image[0].bytes_per_line == 4 * width
        self.x11.XDestroyImage(image)
        return list(zip(data[2::4], data[1::4], data[0::4]))

    def close(self):
        """Closes the window, as the cross of its frame does."""
        message = ClientMessage(33, 0, 1, self.display, self.window,
                                self.x11.XInternAtom(self.display, b"WM_PROTOCOLS", 0), 32)
        message.data[0] = self.x11.XInternAtom(self.display, b"WM_DELETE_WINDOW", 0)
        self.x11.XSendEvent(self.display, ctypes.c_ulong(self.window), 0, ctypes.c_long(0),
                            ctypes.byref(message))
        self.settle()
