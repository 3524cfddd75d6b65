"""Lighthouse on pages of the site, as on a telephone with slow reception: they are light, and show their text soon."""

from __future__ import annotations

import gzip
import json
import os
import subprocess
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

pytestmark = [pytest.mark.site, pytest.mark.one_python]

PAGES = ("index", "gallery/crossing", "reference/codes", "skills/irsim-benchmark/results/results")
LEAST = {"accessibility": 0.95, "best-practices": 0.95, "seo": 0.85}
"""Category -> least score. A site that is not published yet has no address of its own, which `seo` asks for."""
MOST = 500_000
"""Bytes of a page with all that it loads: what its score of performance, 93 to 98 on a quiet machine, comes from."""
FLAGS = "--headless --no-sandbox --disable-gpu"


class _Packed(SimpleHTTPRequestHandler):
    """Text is compressed, as every host of pages does it."""

    protocol_version = "HTTP/1.1"

    def do_GET(self) -> None:
        path = Path(self.translate_path(self.path))
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


@pytest.fixture(scope="module")
def address(html: Path) -> Iterator[str]:
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Packed, directory=str(html)))
    thread = Thread(target=server.serve_forever)
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    thread.join()
    server.server_close()


@pytest.mark.parametrize("page", PAGES)
def test_a_page_is_shown_soon(page: str, address: str, tmp_path: Path) -> None:
    script = Path(os.environ["IRSIM_NPM"]) / "lighthouse" / "cli" / "index.js"
    report = tmp_path / "report.json"
    command = ["node", str(script), f"{address}/{page}.html", "--quiet", f"--chrome-flags={FLAGS}", "--output=json"]
    command += [f"--output-path={report}", f"--only-categories=performance,{','.join(LEAST)}"]
    subprocess.run(command, env={**os.environ, "CHROME_PATH": os.environ["IRSIM_CHROMIUM"]}, check=True, timeout=180)
    told = json.loads(report.read_text(encoding="utf-8"))
    scores = {name: told["categories"][name]["score"] for name in LEAST}
    assert {name: score for name, score in scores.items() if score < LEAST[name]} == {}
    requests = told["audits"]["network-requests"]["details"]["items"]
    assert sum(one["transferSize"] for one in requests) <= MOST
    shown = told["audits"]["largest-contentful-paint"]["numericValue"]
    assert shown <= 3 * 2500, shown  # ms; a quiet machine is three times as fast
