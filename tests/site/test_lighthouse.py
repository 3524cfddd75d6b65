"""Lighthouse on pages of the site, as on a telephone with slow reception: they are light, and show their text soon."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import pytest

pytestmark = [pytest.mark.site, pytest.mark.one_python]

PAGES = ("index", "gallery/crossing", "reference/codes", "skills/irsim-benchmark/results/results")
LEAST = {"accessibility": 0.95, "best-practices": 0.95, "seo": 0.85}
"""Category -> least score. A site that is not published yet has no address of its own, which `seo` asks for."""
MOST = 500_000
"""Bytes of a page with all that it loads: what its score of performance, 93 to 98 on a quiet machine, comes from."""
FLAGS = "--headless --no-sandbox --disable-gpu"


@pytest.mark.parametrize("page", PAGES)
def test_a_page_is_shown_soon(page: str, address: str, tmp_path: Path) -> None:
    script = Path(os.environ["IRSIM_NPM"]) / "lighthouse" / "cli" / "index.js"
    report = tmp_path / "report.json"
    command = ["node", str(script), f"{address}/{page}.html", "--quiet", f"--chrome-flags={FLAGS}", "--output=json"]
    command += [f"--output-path={report}", f"--only-categories=performance,{','.join(LEAST)}"]
    subprocess.run(command, env={**os.environ, "CHROME_PATH": os.environ["IRSIM_CHROMIUM"]}, check=True, timeout=180)
    judged = json.loads(report.read_text(encoding="utf-8"))
    scores = {name: judged["categories"][name]["score"] for name in LEAST}
    assert {name: score for name, score in scores.items() if score < LEAST[name]} == {}
    requests = judged["audits"]["network-requests"]["details"]["items"]
    assert sum(one["transferSize"] for one in requests) <= MOST
    delay = judged["audits"]["largest-contentful-paint"]["numericValue"]
    assert delay <= 3 * 2500, delay  # ms; a quiet machine is three times as fast
