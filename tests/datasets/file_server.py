"""A server of files on this machine, that can be told to misbehave."""

import threading
import time
from collections.abc import Mapping
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import unquote

__all__ = ["FileServer", "serve"]


class FileServer:
    """What is served, how, and who asked for what.

    `contents` are bytes or files by their path. For the next request of a path, `statuses` has answers other than 200
    and `cuts` after how many bytes to hang up, each used once, from the left.
    """

    def __init__(self, contents: Mapping[str, bytes | Path]):
        self.contents = {path.lstrip("/"): content for path, content in contents.items()}
        self.statuses: dict[str, list[int]] = {}
        self.cuts: dict[str, list[int]] = {}
        self.knows_ranges = True
        self.wait = 0.0
        self.requests: list[tuple[str, str | None]] = []
        self.url = ""

    def ranges(self, path: str) -> list[str | None]:
        """Return the ranges asked for of one path; None is all of it."""
        return [asked for requested, asked in self.requests if requested.endswith(path)]


@contextmanager
def serve(contents: Mapping[str, bytes | Path]):
    files = FileServer(contents)

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self):
            _answer(self, files)

        def log_message(self, *arguments):
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.daemon_threads = True
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    files.url = f"http://127.0.0.1:{server.server_port}"
    try:
        yield files
    finally:
        server.shutdown()
        server.server_close()
        thread.join()


def _answer(handler, files):
    path, asked = unquote(handler.path).lstrip("/"), handler.headers.get("Range")
    files.requests.append((path, asked))
    time.sleep(files.wait)
    statuses = files.statuses.get(path, [])
    if statuses or path not in files.contents:
        handler.send_error(statuses.pop(0) if statuses else 404)
        return
    content = files.contents[path]
    content = content.read_bytes() if isinstance(content, Path) else content
    start = int(asked.removeprefix("bytes=").removesuffix("-")) if asked and files.knows_ranges else 0
    if start and start >= len(content):
        handler.send_error(416)
        return
    handler.send_response(206 if start else 200)
    if start:
        handler.send_header("Content-Range", f"bytes {start}-{len(content) - 1}/{len(content)}")
    handler.send_header("Content-Length", str(len(content) - start))
    handler.end_headers()
    cuts = files.cuts.get(path, [])
    end = cuts.pop(0) if cuts else len(content)
    handler.wfile.write(content[start:end])
