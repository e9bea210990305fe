# SPDX-License-Identifier: MIT
"""A web server for the tests: a folder, with byte ranges, a throttle, and faults that an address asks for.

    /packs/plant.kelp?rate=1        sends 1 Mbit/s, all requests of that rate together
    ...?noranges                    answers 200 with the whole file
    ...?abort=N                     breaks every connection off where it would send byte N or later
    ...?damage=N                    sends byte N changed
    ...?claim=N                     says that the file has N bytes
    ...?status=N                    answers with that status

By hand: python3 tests/web/server.py build/web_page/page 8000
"""

import http.server
import os
import re
import sys
import threading
import time
import urllib.parse

TYPES = {".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm",
         ".json": "application/json", ".ts": "text/plain"}
PIECE = 4096


class Throttle:
    """Bytes leave one after the other at a rate, whoever sends them."""

    def __init__(self, megabits):
        self.seconds_per_byte = 8 / (megabits * 1e6)
        self.free_at = 0.0
        self.lock = threading.Lock()

    def wait(self, count):
        with self.lock:
            start = max(self.free_at, time.monotonic())
            self.free_at = start + count * self.seconds_per_byte
            until = self.free_at
        time.sleep(max(until - time.monotonic(), 0))


class Server(http.server.ThreadingHTTPServer):
    daemon_threads = True
    request_queue_size = 64

    def __init__(self, folder, port=0, test_folder=None):
        """test_folder: what lies below /test/."""
        self.folder = os.path.realpath(folder)
        self.test_folder = os.path.realpath(test_folder or folder)
        self.throttles, self.lock = {}, threading.Lock()
        self.sent = {}  # bytes of each path
        super().__init__(("127.0.0.1", port), Handler)

    @property
    def address(self):
        return f"http://127.0.0.1:{self.server_address[1]}/"

    def throttle(self, rate):
        with self.lock:
            return self.throttles.setdefault(rate, Throttle(rate))

    def begin(self):
        threading.Thread(target=self.serve_forever, daemon=True).start()
        return self

    def handle_error(self, request, client_address):
        pass  # browsers close connections as they like


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def do_GET(self):
        url = urllib.parse.urlsplit(self.path)
        asked = dict(urllib.parse.parse_qsl(url.query, keep_blank_values=True))
        folder, name = self.server.folder, urllib.parse.unquote(url.path).lstrip("/")
        if name.startswith("test/"):
            folder, name = self.server.test_folder, name[len("test/"):]
        path = os.path.realpath(os.path.join(folder, name))
        if os.path.isdir(path):
            path = os.path.join(path, "index.html")
        status = int(asked.get("status", 200))
        if not path.startswith(folder + os.sep) or not os.path.isfile(path):
            status = 404
        if status != 200:
            return self.answer(status, b"", 0, None, path, asked)
        with open(path, "rb") as file:
            data = bytearray(file.read())
        if "damage" in asked and int(asked["damage"]) < len(data):
            data[int(asked["damage"])] ^= 0x55
        total = int(asked.get("claim", len(data)))
        span = re.fullmatch(r"bytes=(\d+)-(\d*)", self.headers.get("Range", ""))
        if not span or "noranges" in asked:
            return self.answer(200, data, 0, None, path, asked)
        first, last = int(span[1]), min(int(span[2] or total - 1), total - 1)
        if first >= total:
            return self.answer(416, b"", 0, f"bytes */{total}", path, asked)
        piece = bytes(data[first:last + 1]).ljust(last + 1 - first, b"\0")
        return self.answer(206, piece, first, f"bytes {first}-{last}/{total}", path, asked)

    def answer(self, status, data, first, content_range, path, asked):
        self.send_response(status)
        self.send_header("Content-Type", TYPES.get(os.path.splitext(path)[1], "application/octet-stream"))
        self.send_header("Content-Length", str(len(data)))
        self.send_header("Cache-Control", "no-store")
        if content_range:
            self.send_header("Content-Range", content_range)
        self.end_headers()
        throttle = self.server.throttle(float(asked["rate"])) if "rate" in asked else None
        stop = int(asked.get("abort", 1 << 62))
        for at in range(0, len(data), PIECE):
            piece = data[at:at + PIECE]
            if first + at + len(piece) > stop:
                self.close_connection = True
                self.wfile.flush()
                self.connection.shutdown(2)
                return
            if throttle:
                throttle.wait(len(piece))
            self.wfile.write(piece)
            self.wfile.flush()
            with self.server.lock:
                name = os.path.basename(path)
                self.server.sent[name] = self.server.sent.get(name, 0) + len(piece)


if __name__ == "__main__":
    server = Server(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 8000)
    print(server.address)
    server.serve_forever()
