"""Zip files of the schemas and the templates, which a release offers beside the packages: ``assets.py FOLDER``.

The same files make the same bytes: entries are sorted and carry the date of ``SOURCE_DATE_EPOCH``, else of 1980.
"""

from __future__ import annotations

import os
import sys
import time
import zipfile
from pathlib import Path

from places import ROOT, version


def pack(folder: Path, archive: Path) -> None:
    """Put the files of a folder, except bytecode, into an archive under the folder's name."""
    date = time.gmtime(int(os.environ.get("SOURCE_DATE_EPOCH", "315532800")))[:6]
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as target:
        for path in sorted(folder.rglob("*")):
            if path.is_file() and path.suffix != ".pyc":
                entry = zipfile.ZipInfo(path.relative_to(folder.parent).as_posix(), date)
                entry.external_attr = 0o644 << 16
                target.writestr(entry, path.read_bytes(), zipfile.ZIP_DEFLATED)


def main(target: Path) -> None:
    """Write both archives into a folder."""
    for name, source in (("schemas", "schema"), ("templates", "templates")):
        archive = target / f"irsim-{name}-{version()}.zip"
        pack(ROOT / source, archive)
        print(f"{archive.name}: {archive.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
