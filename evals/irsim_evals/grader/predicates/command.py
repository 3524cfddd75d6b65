"""``command``: what a command prints in the folder, for tasks whose answer is a program."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from typing import TYPE_CHECKING

from irsim_evals.grader.predicates._base import AnswerPredicate, Observation, register

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material

_SECONDS = 60.0
"""Time [s] after which a command is ended."""
_MAX_QUOTED = 200
"""Number of characters of an output that an observation quotes."""


@register("command")
class Command(AnswerPredicate):
    """A command succeeds in the folder. It may run programs of the answer, so it is run only where
    ``irsim-evals grade --run-programs`` says so; elsewhere it has not been observed and does not hold."""

    stage = "behavior"

    run: str
    """The command: ``python …``, or one of this project, such as ``irsim validate …``."""
    prints: str | None = None
    """Regular expression that its standard output contains."""

    def observe(self, material: Material) -> Observation:
        """Run it."""
        expected = f"`{self.run}` succeeds" + (f" and prints /{self.prints}/" if self.prints is not None else "")
        if material.trusted_folder is None:
            return Observation(False, expected, "it was not run; grade with --run-programs if you trust the answer")
        words = shlex.split(self.run)
        command = [sys.executable, *words[1:]] if words[0] == "python" else [sys.executable, "-m", *words]
        try:
            done = subprocess.run(
                command, cwd=material.trusted_folder, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                errors="replace", check=False, timeout=_SECONDS,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return Observation(False, expected, f"it takes more than {_SECONDS:g} s")
        said = (done.stdout if done.returncode == 0 else done.stderr).strip()
        quoted = said if len(said) <= _MAX_QUOTED else f"… {said[-_MAX_QUOTED:]}"
        passed = done.returncode == 0 and (self.prints is None or re.search(self.prints, done.stdout) is not None)
        return Observation(passed, expected, f"exit code {done.returncode}: {quoted}")
