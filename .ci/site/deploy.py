"""Lays a built version of the site beside the others: ``deploy.py HTML PAGES VERSION --address URL``.

``PAGES`` is what a server of static files serves: one folder a version, ``dev`` for the main branch, ``latest`` for the
newest release, and ``switcher.json``, which the selector of versions on each page reads. Links to old versions stay.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
from pathlib import Path

from redirects import STUB, write_stubs

__all__ = ["deploy"]

_VERSION = re.compile(r"v\d+(\.\d+)*")


def deploy(html: Path, pages: Path, version: str, address: str) -> None:
    """Lay a version beside the others.

    Args:
        html: The built site.
        pages: The folder that is served; it keeps the other versions.
        version: ``dev``, or the tag of a release, such as ``v0.1.0``.
        address: Where the pages are served, for the selector.
    """
    if version != "dev" and not _VERSION.fullmatch(version):
        raise SystemExit(f"{version!r} is neither dev nor the tag of a release, such as v0.1.0")
    pages.mkdir(parents=True, exist_ok=True)
    _replace(html, pages / version)
    releases = sorted((one.name for one in pages.iterdir() if _VERSION.fullmatch(one.name)), key=_order, reverse=True)
    if releases and releases[0] == version:
        _replace(html, pages / "latest")
    newest = releases[0] if releases else None
    entries = [
        {"name": f"{one} (latest)" if one == newest else one, "version": one, "url": f"{address}/{one}/"}
        | ({"preferred": True} if one == newest else {})
        for one in ([*releases, "dev"] if (pages / "dev").is_dir() else releases)
    ]
    (pages / "switcher.json").write_text(json.dumps(entries, indent=1) + "\n", encoding="utf-8")
    start = "latest" if newest else "dev"
    (pages / "index.html").write_text(STUB.format(to=f"{start}/index.html"), encoding="utf-8")
    (pages / "404.html").write_text(STUB.format(to=f"{address}/{start}/index.html"), encoding="utf-8")
    (pages / ".nojekyll").write_text("", encoding="utf-8")


def _order(version: str) -> tuple[int, ...]:
    return tuple(map(int, version[1:].split(".")))


def _replace(html: Path, target: Path) -> None:
    """Put a site where an older one is; addresses that are gone now, or were gone before, lead on."""
    older = target.with_name(f".{target.name}.older")
    shutil.rmtree(older, ignore_errors=True)
    if target.exists():
        target.rename(older)
    shutil.copytree(html, target)
    if older.exists():
        write_stubs(older, target)
        shutil.rmtree(older)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("html", type=Path)
    parser.add_argument("pages", type=Path)
    parser.add_argument("version")
    parser.add_argument("--address", default="", help="where the pages are served, such as https://example.org/irsim")
    given = parser.parse_args()
    deploy(given.html, given.pages, given.version, given.address.rstrip("/"))
