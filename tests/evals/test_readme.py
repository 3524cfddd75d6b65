"""The commands of evals/README.md run as they are written."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.evals.conftest import EVALS

BLOCKS = re.findall(r"(<!-- .*? -->\n)?```bash\n(.*?)```", (EVALS / "README.md").read_text(encoding="utf-8"), re.DOTALL)
RUN = [block for mark, block in BLOCKS if not mark]


@pytest.mark.rotates(3)
@pytest.mark.slow
def test_commands_run(tmp_path: Path) -> None:
    assert len(RUN) >= 3
    environment = {**os.environ, "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])}
    for block in RUN:
        done = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", block], cwd=tmp_path, env=environment, capture_output=True, text=True,
            check=False, timeout=300,
        )  # fmt: skip
        assert done.returncode == 0, (block, done.stdout, done.stderr)
    assert (tmp_path / "report" / "report.html").is_file()
    assert (tmp_path / "tasks").is_dir()
