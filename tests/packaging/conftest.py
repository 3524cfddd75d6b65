"""Empty environments, and what is built and installed into them."""

from __future__ import annotations

import os
import subprocess
import sysconfig
import venv
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BUILD_REQUIREMENTS = ["build", "scikit-build-core>=1.0", "nanobind>=3.1", "cmake", "ninja"]


@dataclass(frozen=True)
class Environment:
    """A virtual environment and the folder commands run in, which is not the checkout."""

    folder: Path

    @classmethod
    def create(cls, folder: Path) -> Environment:
        """Make an empty virtual environment."""
        venv.create(folder, with_pip=True, symlinks=os.name != "nt")
        return cls(folder)

    @property
    def bin(self) -> Path:
        return self.folder / ("Scripts" if os.name == "nt" else "bin")

    def run(self, *command: str | Path, cwd: Path | None = None, **variables: str) -> str:
        """Standard output of a command of this environment, which must succeed."""
        program = self.bin / command[0]
        inherited = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "COV_"))}
        done = subprocess.run(
            [str(program), *map(str, command[1:])],
            cwd=cwd or self.folder,
            env={**inherited, **variables},
            capture_output=True,
            text=True,
            encoding="utf-8",
            check=False,
        )
        assert done.returncode == 0, f"{command}: exit {done.returncode}\n{done.stdout[-4000:]}\n{done.stderr[-4000:]}"
        return done.stdout

    def share_libraries(self) -> None:
        """Let this environment use what the one of the tests has installed: the irsim in it comes first."""
        [folder] = self.folder.glob("[Ll]ib/**/site-packages")
        libraries = {Path(sysconfig.get_path(kind)) for kind in ("purelib", "platlib")}
        (folder / "zz_shared.pth").write_text("".join(f"{path}\n" for path in sorted(libraries)), encoding="utf-8")

    def pip(self, *arguments: str | Path, **variables: str) -> None:
        self.run("python", "-m", "pip", "--disable-pip-version-check", *arguments, **variables)


@pytest.fixture(scope="session")
def new_environment(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Environment]:
    """Makes empty virtual environments."""

    def make(name: str) -> Environment:
        return Environment.create(tmp_path_factory.mktemp(name))

    return make


@pytest.fixture(scope="session")
def builder(new_environment: Callable[[str], Environment]) -> Environment:
    """An environment that holds what a build needs, so that builds need no network."""
    environment = new_environment("builder")
    environment.pip("install", "-q", *BUILD_REQUIREMENTS)
    return environment


@pytest.fixture(scope="session")
def sdist(builder: Environment, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The source distribution of this checkout."""
    folder = tmp_path_factory.mktemp("sdist")
    builder.run("python", "-m", "build", "--no-isolation", "--sdist", "--outdir", folder, ROOT)
    [archive] = folder.iterdir()
    return archive


@pytest.fixture(scope="session")
def wheel(builder: Environment, sdist: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of a release, built from the source distribution alone, with no package index at hand."""
    folder = tmp_path_factory.mktemp("wheel")
    release = ("--config-settings", "wheel.py-api=cp310")
    builder.pip("wheel", "--no-build-isolation", "--no-index", "--no-deps", *release, "-w", folder, sdist)
    [archive] = folder.iterdir()
    return archive
