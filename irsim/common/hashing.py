"""SHA-256 of texts, bytes and files. Callers keep as many characters as their files and results have."""

from __future__ import annotations

import hashlib
from pathlib import Path

__all__ = ["digest", "file_digest"]

_BLOCK_BYTES = 1 << 20


def digest(*parts: bytes | str) -> str:
    """SHA-256 of parts after one another, in hexadecimal; texts are encoded as UTF-8, half characters as ``?``."""
    result = hashlib.sha256()
    for part in parts:
        result.update(part.encode(errors="replace") if isinstance(part, str) else part)
    return result.hexdigest()


def file_digest(path: Path) -> str:
    """SHA-256 of a file, in hexadecimal; the file may be larger than memory."""
    result = hashlib.sha256()
    with path.open("rb") as stream:
        while block := stream.read(_BLOCK_BYTES):
            result.update(block)
    return result.hexdigest()
