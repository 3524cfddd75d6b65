"""A copy of the checkout with a Python of its own, in which one fault after another is made."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import site
import subprocess
import sysconfig
import venv
from collections.abc import Iterator, Sequence
from pathlib import Path

from irsim import _core
from tests.packaging.faults.table import ROOT, Fault, holder

__all__ = ["Copy"]

LEFT_OUT = (
    ".git",
    ".venv",
    ".nox",
    ".irsim",
    ".*_cache",
    ".hypothesis",
    "build",
    "dist",
    "evals-results",
    "*.egg-info",
)
LONGEST = 600.0
"""Seconds after which the tests of one fault are ended."""


class Copy:
    """The checkout in another folder, and an environment whose Python imports the packages from there.

    The environment has the libraries of the one that runs this, but not its editable install: so processes that a test
    starts, isolated ones too, meet the fault as well.
    """

    def __init__(self, folder: Path) -> None:
        self.root = folder / "checkout"
        shutil.copytree(ROOT, self.root, ignore=shutil.ignore_patterns(*LEFT_OUT))
        shutil.copy2(_core.__file__, self.root / "irsim")
        venv.create(folder / "python", symlinks=os.name != "nt")
        base = {"base": str(folder / "python"), "platbase": str(folder / "python")}
        paths = [self.root, self.root / "mcp_server", self.root / "evals", *site.getsitepackages()]
        libraries = Path(sysconfig.get_path("purelib", vars=base)) / "checkout.pth"
        libraries.write_text("".join(f"{path}\n" for path in paths), encoding="utf-8")
        self.python = Path(sysconfig.get_path("scripts", vars=base)) / "python"
        self._stamp = 1_000_000_000

    @contextlib.contextmanager
    def fault(self, fault: Fault) -> Iterator[None]:
        """The fault is there inside ``with``, and gone afterwards.

        Each writing has a time of its own: files are compiled again if that or their size changes, and two writings
        within one second may have the same size.
        """
        path = holder(fault, self.root)
        before = path.read_text(encoding="utf-8")
        self._write(path, before.replace(fault.find, fault.write))
        try:
            yield
        finally:
            self._write(path, before)

    def _write(self, path: Path, text: str) -> None:
        path.write_text(text, encoding="utf-8")
        self._stamp += 1
        os.utime(path, (self._stamp, self._stamp))

    def pytest(self, tests: Sequence[str]) -> tuple[int | None, str]:
        """Run tests until one fails: pytest's exit code, None if they took too long; and what it printed.

        Args:
            tests: Tests to run, slow ones too; all quick tests if it is empty.
        """
        command = [str(self.python), "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider"]
        command += ["-m", "", *tests] if tests else []
        with subprocess.Popen(
            command, cwd=self.root, text=True, stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True,
        ) as running:  # fmt: skip
            try:
                told = running.communicate(timeout=LONGEST)[0]
            except subprocess.TimeoutExpired:
                os.killpg(running.pid, signal.SIGKILL)
                return None, running.communicate()[0]
        return running.returncode, told
