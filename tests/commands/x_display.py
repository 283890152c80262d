"""A virtual X server (Xvfb), a hand on its mouse and keyboard (XTEST), a source of dropped files (XDND), and its screen.

By ctypes on libX11 and libXtst: nothing but the libraries themselves has to be installed.
"""

import ctypes
import os
import pathlib
import shutil
import signal
import struct
import subprocess
import tempfile
import time
import unittest

from png import Picture

WIDTH, HEIGHT = 1920, 1080  # of the screen

Window = Atom = ctypes.c_ulong


class ClientMessage(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p), ("window", Window), ("message_type", Atom), ("format", ctypes.c_int),
                ("data", ctypes.c_long * 5)]


class SelectionRequest(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p), ("owner", Window), ("requestor", Window), ("selection", Atom),
                ("target", Atom), ("property", Atom), ("time", ctypes.c_ulong)]


class SelectionNotify(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p), ("requestor", Window), ("selection", Atom), ("target", Atom),
                ("property", Atom), ("time", ctypes.c_ulong)]


class Event(ctypes.Union):
    _fields_ = [("type", ctypes.c_int), ("client", ClientMessage), ("request", SelectionRequest),
                ("notify", SelectionNotify), ("pad", ctypes.c_long * 24)]


# Windows come and go while they are asked for; without a handler of its own Xlib ends the process then.
ON_ERROR = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)(lambda *_: 0)

SELECTION_REQUEST, SELECTION_NOTIFY, CLIENT_MESSAGE = 30, 31, 33


def libraries():
    """libX11 and libXtst, or None where one of them is missing."""
    try:
        x, test = ctypes.CDLL("libX11.so.6"), ctypes.CDLL("libXtst.so.6")
    except OSError:
        return None
    x.XOpenDisplay.restype = ctypes.c_void_p
    x.XOpenDisplay.argtypes = [ctypes.c_char_p]
    for name in ("XDefaultRootWindow", "XCreateSimpleWindow", "XInternAtom", "XStringToKeysym"):
        getattr(x, name).restype = ctypes.c_ulong
    return x, test


class Display:
    """`with Display() as display`. Raises SkipTest where there is no Xvfb."""

    def __init__(self):
        self.libraries = libraries()
        if not shutil.which("Xvfb") or not self.libraries:
            raise unittest.SkipTest("no Xvfb or no libXtst here; scripts/setup installs xvfb and libxtst6")

    def __enter__(self):
        self.folder = tempfile.TemporaryDirectory()
        read, write = os.pipe()
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", f"{WIDTH}x{HEIGHT}x24", "-fbdir", self.folder.name,
             "-nolisten", "tcp", "-noreset"], pass_fds=[write], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as numbers:
            self.name = ":" + numbers.readline().strip()
        self.x, self.test = self.libraries
        self.x.XSetErrorHandler(ON_ERROR)
        self.display = ctypes.c_void_p(self.x.XOpenDisplay(self.name.encode()))
        assert self.display, f"Xvfb {self.name} does not answer"
        self.root = self.x.XDefaultRootWindow(self.display)
        return self

    def __exit__(self, *_):
        if self.display:
            self.x.XCloseDisplay(self.display)
        self.end_server()
        self.folder.cleanup()

    def end_server(self):
        self.server.terminate()
        self.server.wait(timeout=20)

    def lose(self):
        """Ends the server under its clients, this one forgotten first."""
        self.x.XCloseDisplay(self.display)
        self.display = None
        self.server.send_signal(signal.SIGKILL)
        self.server.wait(timeout=20)

    def flush(self):
        self.x.XSync(self.display, 0)

    # ---- windows ----

    def windows(self):
        root, parent, count = Window(), Window(), ctypes.c_uint()
        children = ctypes.POINTER(Window)()
        self.x.XQueryTree(self.display, Window(self.root), ctypes.byref(root), ctypes.byref(parent),
                          ctypes.byref(children), ctypes.byref(count))
        return [children[i] for i in range(count.value)]

    def title(self, window):
        name = ctypes.c_char_p()
        self.x.XFetchName(self.display, Window(window), ctypes.byref(name))
        return (name.value or b"").decode()

    def find(self, word):
        return next((w for w in self.windows() if word in self.title(w)), None)

    def focus(self, window):
        """Gives the keyboard to a window; whether it took it: one that is not on the screen cannot."""
        owner, how = Window(), ctypes.c_int()
        self.x.XSetInputFocus(self.display, Window(window), 1, ctypes.c_ulong(0))
        self.x.XGetInputFocus(self.display, ctypes.byref(owner), ctypes.byref(how))
        return owner.value == window

    def resize(self, window, width, height):
        self.x.XResizeWindow(self.display, Window(window), width, height)
        self.flush()

    def atom(self, name):
        return self.x.XInternAtom(self.display, name.encode(), 0)

    def send(self, window, kind, *data):
        event = Event()
        event.client.type = CLIENT_MESSAGE
        event.client.window = window
        event.client.message_type = self.atom(kind)
        event.client.format = 32
        for i, value in enumerate(data):
            event.client.data[i] = value
        self.x.XSendEvent(self.display, Window(window), 0, ctypes.c_long(0), ctypes.byref(event))
        self.flush()

    def close(self, window):
        """What a window manager sends when its button is clicked."""
        self.send(window, "WM_PROTOCOLS", self.atom("WM_DELETE_WINDOW"), 0)

    # ---- mouse and keyboard ----

    def move(self, x, y):
        self.test.XTestFakeMotionEvent(self.display, -1, int(x), int(y), ctypes.c_ulong(0))
        self.flush()
        time.sleep(0.03)

    def button(self, number, down):
        self.test.XTestFakeButtonEvent(self.display, number, int(down), ctypes.c_ulong(0))
        self.flush()
        time.sleep(0.03)

    def click(self, x, y, number=1, times=1):
        self.move(x, y)
        for _ in range(times):
            self.button(number, True)
            self.button(number, False)

    def drag(self, start, end, number=1, steps=6, rest=0.0):
        """With a rest before anything else happens: a panel looks at the pointer once a frame."""
        self.move(*start)
        time.sleep(rest)
        self.button(number, True)
        for i in range(1, steps + 1):
            self.move(*(a + (b - a) * i / steps for a, b in zip(start, end)))
        time.sleep(rest)
        self.button(number, False)
        time.sleep(rest)

    def away(self):
        """The pointer is part of the screen: out of the way."""
        self.move(WIDTH - 2, HEIGHT - 2)

    def key(self, name, hold=0.0):
        code = self.x.XKeysymToKeycode(self.display, ctypes.c_ulong(self.x.XStringToKeysym(name.encode())))
        for down in (1, 0):
            self.test.XTestFakeKeyEvent(self.display, code, down, ctypes.c_ulong(0))
            self.flush()
            time.sleep(hold if down else 0.03)

    # ---- drag and drop, as the XDND protocol (version 5) has it ----

    def drop(self, window, files):
        uris = "".join(f"file://{pathlib.Path(file).resolve()}\r\n" for file in files).encode()
        source = self.x.XCreateSimpleWindow(self.display, Window(self.root), 0, 0, 1, 1, 0, ctypes.c_ulong(0),
                                            ctypes.c_ulong(0))
        uri_list, selection = self.atom("text/uri-list"), self.atom("XdndSelection")
        self.x.XSetSelectionOwner(self.display, Atom(selection), Window(source), ctypes.c_ulong(0))
        self.send(window, "XdndEnter", source, 5 << 24, uri_list, 0, 0)
        self.send(window, "XdndPosition", source, 0, 300 << 16 | 300, 0, self.atom("XdndActionCopy"))
        self.send(window, "XdndDrop", source, 0, 0)
        self.answer_requests(uri_list, uris)

    def answer_requests(self, target, content, timeout=10):
        """Gives the dropped files to the window when it asks for them, and waits for its thanks."""
        finished, event = self.atom("XdndFinished"), Event()
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            if not self.x.XPending(self.display):
                time.sleep(0.01)
                continue
            self.x.XNextEvent(self.display, ctypes.byref(event))
            if event.type == CLIENT_MESSAGE and event.client.message_type == finished:
                return
            if event.type != SELECTION_REQUEST:
                continue
            request, answer = event.request, Event()
            self.x.XChangeProperty(self.display, Window(request.requestor), Atom(request.property), Atom(target), 8, 0,
                                   content, len(content))
            answer.notify.type = SELECTION_NOTIFY
            answer.notify.requestor, answer.notify.selection = request.requestor, request.selection
            answer.notify.target, answer.notify.property = request.target, request.property
            self.x.XSendEvent(self.display, Window(request.requestor), 0, ctypes.c_long(0), ctypes.byref(answer))
            self.flush()
        raise AssertionError("nobody took the dropped files")

    # ---- the screen ----

    def grab(self, width, height):
        """The upper left corner of the screen, where windows without a manager stand: rows of RGB bytes."""
        screen = (pathlib.Path(self.folder.name) / "Xvfb_screen0").read_bytes()
        header = struct.unpack(">25I", screen[:100])
        first, line = header[0] + 12 * header[19], header[12]
        picture = bytearray(3 * width * height)
        for y in range(height):
            row = screen[first + y * line:][:4 * width]
            for channel in range(3):
                picture[3 * width * y + channel:3 * width * (y + 1):3] = row[2 - channel::4]
        return Picture(picture)
