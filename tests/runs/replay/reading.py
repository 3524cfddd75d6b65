"""Packed runs, read in Python as the page reads them."""

from __future__ import annotations

import base64
import json
import re
import zlib
from typing import Any

import numpy as np


def unpacked(data: bytes) -> tuple[dict[str, Any], dict[str, Any]]:
    """Head and columns of a block."""
    block = zlib.decompress(data)
    length = int.from_bytes(block[:4], "little")
    head = json.loads(block[4 : 4 + length])
    at, columns = 4 + length, {}
    for column in head["columns"]:
        count = int(np.prod(column["shape"], dtype=np.int64))
        planes = np.frombuffer(block, np.uint8, 4 * count, at).reshape(4, count).astype(np.uint32)
        folded = planes[0] | planes[1] << 8 | planes[2] << 16 | planes[3] << 24
        values = ((folded >> 1) ^ -(folded & 1).astype(np.int64)).astype(np.int32).reshape(column["shape"])
        for _ in range(column["order"]):
            values = np.cumsum(values, axis=-1, dtype=np.int32)
        columns[column["name"]] = values
        at += 4 * count
    assert at == len(block)
    return head, columns


def data_in(page: str) -> bytes:
    """The packed run in a page."""
    match = re.search(r'<script type="application/octet-stream" id="data">([A-Za-z0-9+/=]*)</script>', page)
    assert match is not None
    return base64.b64decode(match[1])
