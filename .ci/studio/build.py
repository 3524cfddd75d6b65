"""Build the text editor of the studio from locked packages: ``python .ci/studio/build.py [--check]``.

It writes ``irsim/studio/web/vendor/codemirror.js``, CodeMirror as one module, and ``LICENSES.txt`` beside it, with the
licence of every package that is in it. ``--check`` compares them with what is there, byte by byte. It needs npm; the
packages of irsim hold what it has made.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
OUT = HERE.parents[1] / "irsim" / "studio" / "web" / "vendor"
SOURCES = ("package.json", "package-lock.json", "editor.js")
TOOLS = ("esbuild",)
"""Packages that build and leave nothing in the module."""
OPTIONS = ("--bundle", "--format=esm", "--minify", "--legal-comments=none", "--charset=utf8", "--target=es2022")


def built(folder: Path) -> dict[str, bytes]:
    """The files, by name, as the packages of the lock file make them in an empty folder.

    Raises:
        CalledProcessError: npm or esbuild has failed, and has said why.
    """
    for name in SOURCES:
        shutil.copy(HERE / name, folder)
    subprocess.run(["npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund", "--silent"], cwd=folder, check=True)
    esbuild = folder / "node_modules" / "esbuild" / "bin" / "esbuild"
    subprocess.run(
        [str(esbuild), "editor.js", *OPTIONS, "--outfile=made.js", "--log-level=warning"], cwd=folder, check=True
    )
    return {"codemirror.js": (folder / "made.js").read_bytes(), "LICENSES.txt": licences(folder).encode()}


def licences(folder: Path) -> str:
    """The packages in the module with their versions and licences, and then the text of each licence."""
    lock = json.loads((folder / "package-lock.json").read_text(encoding="utf-8"))["packages"]
    names = sorted(name for name, facts in lock.items() if name and not facts.get("optional") and not is_tool(name))
    lines = ["codemirror.js is made of these packages, each under its own licence:", ""]
    texts = list[str]()
    for name in names:
        [text] = {path.read_text(encoding="utf-8") for path in (folder / name).glob("LICENSE*")}
        short = name.removeprefix("node_modules/")
        lines.append(f"- {short} {lock[name]['version']}: {lock[name]['license']}")
        texts.append(f"{'-' * 72}\n{short}\n\n{text.strip()}\n")
    return "\n".join([*lines, "", *texts])


def is_tool(name: str) -> bool:
    """Whether a package of the lock file only builds."""
    return any(name == f"node_modules/{tool}" or name.startswith(f"node_modules/@{tool}/") for tool in TOOLS)


def main(*, check: bool) -> int:
    """Write the files, or compare them."""
    with tempfile.TemporaryDirectory() as folder:
        files = built(Path(folder))
    if not check:
        OUT.mkdir(parents=True, exist_ok=True)
        for name, content in files.items():
            (OUT / name).write_bytes(content)
            print(f"wrote {OUT / name} ({len(content) / 1000:.0f} kB)")
        return 0
    wrong = [name for name, content in files.items() if (OUT / name).read_bytes() != content]
    for name in wrong:
        print(f"{OUT / name} is not what the locked packages make: run this without --check")
    print("the editor is what the locked packages make" if not wrong else "")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main(check="--check" in sys.argv[1:]))
