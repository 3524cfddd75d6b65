"""A release, tried on this machine: ``nox -s release-check``, or ``… -- --tag v0.2.0`` for a tag.

The version is the same everywhere and the changelog has it; the source distribution is built, and from it, in two
folders, the same wheel for all versions of Python; that wheel passes the checks of PyPI and of its stable interface.
Then it lies on an index of this machine, from which ``uvx`` installs it with an empty cache for each Python: the server
answers, the demo runs in an empty folder, and a recorded episode is repeated bit by bit.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import threading
import time
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import places

MAX_WHEEL_BYTES = 8_000_000
MAX_SERVER_S, MAX_DEMO_S = 10.0, 20.0
"""Seconds from nothing to the first answer of the server, and to the picture of the demo, packages downloaded."""
INITIALIZE = {
    "jsonrpc": "2.0",
    "id": 1,
    "method": "initialize",
    "params": {"protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": {"name": "check", "version": "0"}},
}


def run(*command: str | Path, cwd: Path | None = None, **variables: str) -> str:
    """Standard output of a program, which must succeed."""
    environment = {**os.environ, **variables}
    done = subprocess.run([*map(str, command)], cwd=cwd, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, command))}\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return done.stdout


def say(what: str, start: float) -> None:
    """A line of the report, with the seconds that a step took."""
    print(f"{what}: {time.perf_counter() - start:.1f} s", flush=True)


def check_texts(tag: str | None) -> None:
    """Version and changelog; without a tag the section may still be the one of unreleased changes."""
    now = places.check_tag(tag) if tag else places.version()
    others = places.unlisted()
    if others:
        raise SystemExit("lines with the version that .ci/release/places.py does not know:\n" + "\n".join(others))
    if tag is None:
        try:
            places.check_changelog(now)
        except SystemExit as error:
            print(f"not yet: {error}")
    print(f"version {now}, owner {places.owner()}")


def build(folder: Path) -> tuple[Path, Path]:
    """Source distribution and wheel; the wheel is built twice, in two folders, and the bytes are compared."""
    epoch = run("git", "log", "-1", "--format=%ct", cwd=places.ROOT).strip()
    frontend = (sys.executable, "-m", "build", "--no-isolation")
    start = time.perf_counter()
    run(*frontend, "--sdist", "--outdir", folder / "dist", places.ROOT, SOURCE_DATE_EPOCH=epoch)
    [sdist] = folder.glob("dist/*.tar.gz")
    say(sdist.name, start)
    wheels = []
    for name in ("one", "another-folder"):
        start = time.perf_counter()
        with tarfile.open(sdist) as archive:
            archive.extractall(folder / name, **({"filter": "data"} if hasattr(tarfile, "data_filter") else {}))
        [source] = (folder / name).iterdir()
        options = ("--wheel", "-C", "wheel.py-api=cp310", "--outdir", folder / name / "wheel")
        run(*frontend, *options, source, SOURCE_DATE_EPOCH=epoch)
        wheels += (folder / name / "wheel").iterdir()
        say(f"{wheels[-1].name}, {wheels[-1].stat().st_size / 1e6:.2f} MB", start)
    if wheels[0].read_bytes() != wheels[1].read_bytes():
        raise SystemExit(f"two builds differ: {differences(*wheels)}")
    print("two builds in two folders are equal")
    return sdist, Path(shutil.copy(wheels[0], folder / "dist"))


def differences(one: Path, other: Path) -> list[str]:
    """Names of the entries of two archives that are not the same."""
    with zipfile.ZipFile(one) as first, zipfile.ZipFile(other) as second:
        names = sorted({*first.namelist(), *second.namelist()})
        both = {*first.namelist()} & {*second.namelist()}
        return [name for name in names if name not in both or first.read(name) != second.read(name)] or ["dates, order"]


def check_wheel(sdist: Path, wheel: Path) -> None:
    """Name, size, module, and the checks of abi3audit and twine."""
    if "-cp310-abi3-" not in wheel.name:
        raise SystemExit(f"{wheel.name} is not for all versions of Python")
    if wheel.stat().st_size > MAX_WHEEL_BYTES:
        raise SystemExit(f"{wheel.name} has {wheel.stat().st_size} bytes; at most {MAX_WHEEL_BYTES} are allowed")
    with zipfile.ZipFile(wheel) as archive:
        modules = [name for name in archive.namelist() if name.startswith("irsim/_core.") and not name.endswith(".pyi")]
    if modules not in (["irsim/_core.abi3.so"], ["irsim/_core.pyd"]):
        raise SystemExit(f"the compiled module has the name of one version of Python: {modules}")
    run(sys.executable, "-m", "abi3audit", "--strict", wheel)
    run(sys.executable, "-m", "twine", "check", "--strict", sdist, wheel)
    print("abi3audit and twine have no complaints")


@contextmanager
def index(folder: Path, wheel: Path) -> Iterator[str]:
    """An index of packages on this machine that has this one wheel; its address."""
    project = folder / "simple" / "irsim-mcp"
    project.mkdir(parents=True)
    shutil.copy(wheel, project)

    class Quiet(SimpleHTTPRequestHandler):
        def log_message(self, *_: object) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(folder))) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/simple"
        server.shutdown()


def processor_s() -> float:
    """Seconds of a processor that programs started from here have taken so far; always 0 on Windows."""
    taken = os.times()
    return taken.children_user + taken.children_system


def first_answer(command: list[str], folder: Path, variables: dict[str, str]) -> str:
    """Name and version that the server gives itself when a client begins to talk."""
    environment = {**os.environ, **variables}
    with subprocess.Popen(
        command, cwd=folder, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as server:
        assert server.stdin is not None
        assert server.stdout is not None
        server.stdin.write(json.dumps(INITIALIZE) + "\n")
        server.stdin.flush()
        answer = json.loads(server.stdout.readline() or '{"result": {"serverInfo": {"name": "no answer"}}}')
        server.stdin.close()
    return " ".join(str(answer["result"]["serverInfo"].get(key, "")) for key in ("name", "version"))


def check_install(python: str, address: str, folder: Path) -> list[str]:
    """Install by ``uvx`` with an empty cache, ask the server, run the demo and the recorded episode; what was too slow.

    Args:
        python: The interpreter.
        address: The index that has the wheel; all other packages come from the usual one.
        folder: An empty folder.
    """
    variables = {"UV_CACHE_DIR": str(folder / "cache"), "UV_TOOL_DIR": str(folder / "tools"), "UV_NO_CONFIG": "1"}
    uvx = [sys.executable, "-m", "uv", "--quiet", "tool", "run", "--python", python, "--index", address]
    work = folder / "work"
    work.mkdir(parents=True)
    start, busy = time.perf_counter(), processor_s()
    answer = first_answer([*uvx, "irsim-mcp", "--workspace", str(work)], work, variables)
    server_s, server_busy_s = time.perf_counter() - start, processor_s() - busy
    if answer != f"irsim {places.version()}":
        raise SystemExit(f"the server calls itself {answer!r}")
    again = time.perf_counter()
    run(*uvx, "--from", "irsim-mcp", "irsim", "demo", cwd=work, **variables)
    demo_s, demo_busy_s = server_s + time.perf_counter() - again, processor_s() - busy
    if [path.suffix for path in work.iterdir()] != [".gif"]:
        raise SystemExit(f"the demo left {[path.name for path in work.iterdir()]} and not one picture")
    run(*uvx, "--from", "irsim-mcp", "irsim", "new", "crossing", "-o", "scene.yaml", cwd=work, **variables)
    golden = Path(__file__).with_name("golden.py")
    episode = run(*uvx, "--from", "irsim-mcp", "python", golden, "scene.yaml", cwd=work, **variables)
    times = f"server {server_s:.1f} s ({server_busy_s:.1f} s of a processor), demo {demo_s:.1f} s ({demo_busy_s:.1f} s)"
    print(f"{episode.strip()}; {times}", flush=True)
    slow = [(server_s, MAX_SERVER_S, "the server answered"), (demo_s, MAX_DEMO_S, "the demo was ready")]
    load = (
        f", at a load of {os.getloadavg()[0]:.0f} on {os.cpu_count()} processors" if hasattr(os, "getloadavg") else ""
    )
    return [f"{python}: {what} after {took:.1f} s, not {most:.0f} s{load}" for took, most, what in slow if took > most]


def main() -> None:
    """Check everything; the exit status is 1 if anything is wrong or too slow."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("pythons", nargs="+", help="interpreters that the one wheel must run on")
    parser.add_argument("--tag", help="the tag that would be pushed, such as v0.2.0")
    parser.add_argument("--keep", type=Path, help="folder for the packages that were built")
    given = parser.parse_args()
    check_texts(given.tag)
    with tempfile.TemporaryDirectory(prefix="irsim-release-") as name:
        folder = Path(name)
        sdist, wheel = build(folder)
        check_wheel(sdist, wheel)
        if given.keep:
            shutil.copytree(folder / "dist", given.keep, dirs_exist_ok=True)
        with index(folder / "index", wheel) as address:
            slow = [
                line for i, one in enumerate(given.pythons) for line in check_install(one, address, folder / f"p{i}")
            ]
    if slow:
        raise SystemExit("\n".join(slow))


if __name__ == "__main__":
    main()
