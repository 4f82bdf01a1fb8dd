"""A virtual screen for a test (Xvfb) and a simulated user, who looks at a program's window, resizes it and types.

Xlib is called through ctypes; its structures below are those of X11/Xlib.h, on machines with 64 bits.
"""
import ctypes
import os
import shutil
import subprocess
import time
from ctypes import CFUNCTYPE, POINTER, Structure, byref, c_char_p, c_int, c_long, c_ubyte, c_uint, c_ulong, c_void_p

KEY_PRESS, KEY_RELEASE, BUTTON_PRESS, BUTTON_RELEASE, MOTION = 2, 3, 4, 5, 6
LEFT, RIGHT = 1, 3
Z_PIXMAP = 2
SECONDS = 60  # s, limit for any wait


class Attributes(Structure):
    _fields_ = [(name, c_int) for name in ("x", "y", "width", "height", "border", "depth")] + [
        ("visual", c_void_p), ("root", c_ulong), ("kind", c_int), ("bit_gravity", c_int), ("win_gravity", c_int),
        ("backing_store", c_int), ("planes", c_ulong), ("pixel", c_ulong), ("save_under", c_int),
        ("colormap", c_ulong), ("installed", c_int), ("map_state", c_int), ("rest", c_long * 8)]


class Picture(Structure):
    _fields_ = [("width", c_int), ("height", c_int), ("offset", c_int), ("format", c_int), ("data", c_void_p),
                ("byte_order", c_int), ("unit", c_int), ("bit_order", c_int), ("pad", c_int), ("depth", c_int),
                ("bytes_per_line", c_int), ("bits_per_pixel", c_int)]


class Event(Structure):
    """XKeyEvent and XButtonEvent; XMotionEvent has no detail there, but the same members before it."""
    _fields_ = [("type", c_int), ("serial", c_ulong), ("sent", c_int), ("display", c_void_p), ("window", c_ulong),
                ("root", c_ulong), ("below", c_ulong), ("time", c_ulong), ("x", c_int), ("y", c_int),
                ("x_root", c_int), ("y_root", c_int), ("state", c_uint), ("detail", c_uint), ("same", c_int),
                ("rest", c_long * 12)]


class Error(Structure):
    _fields_ = [("type", c_int), ("display", c_void_p), ("resource", c_ulong), ("serial", c_ulong),
                ("code", c_ubyte), ("request", c_ubyte), ("minor", c_ubyte)]


BAD_WINDOW, SEND_EVENT = 3, 25
HANDLER = CFUNCTYPE(c_int, c_void_p, POINTER(Error))


@HANDLER
def forgive_a_closed_window(_display, error):
    """A window may close at the press of a key, before the release of that key has been sent to it."""
    if (error.contents.code, error.contents.request) == (BAD_WINDOW, SEND_EVENT):
        return 0
    print(f"X error {error.contents.code} of request {error.contents.request}", flush=True)
    os._exit(1)


def wait_for(what, seen):
    """Calls `seen` until it returns something true, and returns that."""
    end = time.monotonic() + SECONDS
    while time.monotonic() < end:
        result = seen()
        if result:
            return result
        time.sleep(0.02)
    raise AssertionError(f"{what}: not within {SECONDS} s")


class Screen:
    """with Screen() as screen: ...; `screen.missing` names what is not installed; None if nothing."""

    def __init__(self):
        self.missing = "" if shutil.which("Xvfb") else "no Xvfb (Debian package xvfb)"
        try:
            self.x = ctypes.CDLL("libX11.so.6")
        except OSError:
            self.missing = "no libX11.so.6 (Debian package libx11-6)"

    def __enter__(self):
        if self.missing:
            return self
        read, write = os.pipe()
        self.server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x1024x24", "-nolisten",
                                        "tcp"], pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as ready:
            self.name = ":" + ready.readline().strip()
        x = self.x
        x.XOpenDisplay.restype = x.XGetImage.restype = c_void_p
        x.XOpenDisplay.argtypes = [c_char_p]
        x.XDefaultRootWindow.restype = c_ulong
        x.XDefaultRootWindow.argtypes = x.XCloseDisplay.argtypes = [c_void_p]
        x.XSync.argtypes = [c_void_p, c_int]
        x.XQueryTree.argtypes = [c_void_p, c_ulong, c_void_p, c_void_p, c_void_p, c_void_p]
        x.XGetWindowAttributes.argtypes = [c_void_p, c_ulong, c_void_p]
        x.XGetImage.argtypes = [c_void_p, c_ulong, c_int, c_int, c_uint, c_uint, c_ulong, c_int]
        x.XFree.argtypes = [c_void_p]
        x.XResizeWindow.argtypes = [c_void_p, c_ulong, c_uint, c_uint]
        x.XKeysymToKeycode.argtypes = [c_void_p, c_ulong]
        x.XSendEvent.argtypes = [c_void_p, c_ulong, c_int, c_long, c_void_p]
        x.XCreateSimpleWindow.restype = c_ulong
        x.XCreateSimpleWindow.argtypes = [c_void_p, c_ulong, c_int, c_int, c_uint, c_uint, c_uint, c_ulong, c_ulong]
        x.XMapRaised.argtypes = x.XDestroyWindow.argtypes = [c_void_p, c_ulong]
        x.XSetErrorHandler.argtypes = [HANDLER]
        x.XSetErrorHandler(forgive_a_closed_window)
        self.display = x.XOpenDisplay(self.name.encode())
        assert self.display, f"cannot open the display {self.name}"
        self.root = x.XDefaultRootWindow(self.display)
        return self

    def __exit__(self, *failure):
        if not self.missing:
            self.x.XCloseDisplay(self.display)
            self.server.terminate()
            self.server.wait()

    def start(self, *command, **options):
        """Starts a program on this screen."""
        return subprocess.Popen([str(word) for word in command], env={**os.environ, "DISPLAY": self.name},
                                stdin=subprocess.DEVNULL, **options)

    def windows(self):
        root, parent, children, count = c_ulong(), c_ulong(), POINTER(c_ulong)(), c_uint()
        self.x.XQueryTree(self.display, self.root, byref(root), byref(parent), byref(children), byref(count))
        found = [children[i] for i in range(count.value)]
        if count.value:
            self.x.XFree(children)
        return [window for window in found if self.attributes(window).map_state == 2]

    def window(self):
        """The visible window; waits until there is one."""
        return wait_for("a window", self.windows)[0]

    def attributes(self, window):
        attributes = Attributes()
        self.x.XGetWindowAttributes(self.display, window, byref(attributes))
        return attributes

    def resize(self, window, width, height):
        self.x.XResizeWindow(self.display, window, width, height)
        self.x.XSync(self.display, 0)

    def cover_for_a_moment(self, window):
        """Covers the window with a black one and removes that again, so that the window has to be redrawn."""
        size = self.attributes(window)
        cover = self.x.XCreateSimpleWindow(self.display, self.root, size.x, size.y, size.width, size.height, 0, 0, 0)
        self.x.XMapRaised(self.display, cover)
        self.x.XSync(self.display, 0)
        wait_for("a cover", lambda: self.attributes(cover).map_state == 2)
        self.x.XDestroyWindow(self.display, cover)
        self.x.XSync(self.display, 0)

    def pixels(self, window):
        """The window's pixels, 4 bytes each."""
        size = self.attributes(window)
        image = self.x.XGetImage(self.display, window, 0, 0, size.width, size.height, 0xFFFFFF, Z_PIXMAP)
        picture = Picture.from_address(image)
        assert picture.bits_per_pixel == 32, picture.bits_per_pixel
        data = ctypes.string_at(picture.data, picture.bytes_per_line * picture.height)
        self.x.XFree(picture.data)
        self.x.XFree(image)
        return data

    def lit_share(self, window):
        """Share of the window's pixels that are not black."""
        data = self.pixels(window)
        lit = sum(1 for at in range(0, len(data), 4 * 97) if any(data[at:at + 3]))  # every 97th
        return lit / (len(data) / (4 * 97))

    def type(self, window, key):
        """A letter, or an X keysym by its number."""
        event = Event(display=self.display, window=window, root=self.root, same=1)
        event.detail = self.x.XKeysymToKeycode(self.display, ord(key) if isinstance(key, str) else key)
        for event.type in (KEY_PRESS, KEY_RELEASE):
            self.x.XSendEvent(self.display, window, 1, 0, byref(event))
        self.x.XSync(self.display, 0)

    def mouse(self, window, *happened):
        """Sends events (kind, x, y) or (kind, x, y, button) to the program together."""
        for kind, x, y, *button in happened:
            event = Event(type=kind, display=self.display, window=window, root=self.root, same=1, x=x, y=y)
            event.detail = button[0] if button else 0
            self.x.XSendEvent(self.display, window, 1, 0, byref(event))
        self.x.XSync(self.display, 0)


ESCAPE = 0xFF1B
