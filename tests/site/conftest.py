from __future__ import annotations

import gzip
import os
import sys
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]


class _Packed(SimpleHTTPRequestHandler):
    """Text is compressed, as every host of pages does it."""

    protocol_version = "HTTP/1.1"

    def do_GET(self) -> None:
        path = Path(self.translate_path(self.path))
        path = path / "index.html" if path.is_dir() else path
        if not path.is_file():
            self.send_error(404)
            return
        data, kind = path.read_bytes(), self.guess_type(str(path))
        self.send_response(200)
        self.send_header("Content-Type", kind)
        if not kind.startswith(("image/png", "image/gif", "video", "font")):
            data = gzip.compress(data, 6)
            self.send_header("Content-Encoding", "gzip")
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        self.wfile.write(data)

    def log_message(self, *arguments: Any) -> None:
        pass


@pytest.fixture(scope="session")
def site() -> Path:
    """The folder of a built site, ``source`` and ``html``: the session `docs` builds it and names it in IRSIM_SITE."""
    return Path(os.environ["IRSIM_SITE"])


@pytest.fixture(scope="session")
def html(site: Path) -> Path:
    return site / "html"


@pytest.fixture(scope="session", autouse=True)
def writer() -> None:
    """Modules of the script that writes the site can be imported."""
    folder = str(ROOT / ".ci" / "site")
    if folder not in sys.path:
        sys.path.insert(0, folder)


@pytest.fixture(scope="session")
def address(html: Path) -> Iterator[str]:
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Packed, directory=str(html)))
    thread = Thread(target=server.serve_forever)
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    thread.join()
    server.server_close()
