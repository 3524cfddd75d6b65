"""Ways in which files are damaged: bytes, ends, tokens, types of values, entries of archives, checksums."""

from __future__ import annotations

import io
import random
import re
import struct
import zipfile
import zlib
from collections.abc import Callable

__all__ = ["damaged"]

_TOKEN = re.compile(rb"[A-Za-z0-9_.+-]+")
_VALUES = (
    b"", b"[[]]", b"[]", b"{}", b"null", b"~", b"true", b"NaN", b".nan", b"-.inf", b"Infinity", b"1e999", b"1.0e+308",
    b"-1.0e+308", b"5.0e-324", b"0", b"-1", b"1e5", b"9007199254740993", b"-9223372036854775809", b"9" * 39,
    b"9" * 350, b"9" * 5000, b"0x" + b"f" * 300, b"0b", b"0o9", b"1:1:1", b"2020-01-01", b"2020-99-99",
    b"2020-01-01 00:00:00 +99:99", b"!!python/object/apply:os.system [echo]", b"!!int x", b"!!int .inf",
    b"!!timestamp x", b"!!binary '%'", b"!x y", b"&a [*a]", b"*b", b"<<: 1", b"? [1]", b"[" * 300, b"{a: " * 100,
    b'"\\ud800"', b'"', b"'", b"\xff\xfe", b"\xef\xbb\xbf", b"\0", b"\t", b"---", b"%YAML 9", b"{'a': [1]}",
    b'[["a", 1], {"b": null}]', "é".encode(), b"../../etc/passwd", b"/", b"x" * 5000, b"$%s{}",
)  # fmt: skip
"""Texts that take the place of a token."""
_BYTES = bytes((0, 1, 10, 13, 32, 34, 39, 45, 58, 91, 123, 127, 128, 255))


def damaged(content: bytes, draw: random.Random) -> bytes:
    """The content with one to three damages.

    Args:
        content: The file.
        draw: The source of chance.
    """
    ways = _CONTAINERS.get(content[:4], _ANYWHERE if _is_text(content) else _BINARY)
    for _ in range(draw.choice((1, 1, 1, 2, 3))):
        content = draw.choice(ways)(content, draw)
    return content


def _is_text(content: bytes) -> bool:
    return b"\0" not in content[:1000]


def _flip(content: bytes, draw: random.Random) -> bytes:
    if not content:
        return b"\0"
    k = draw.randrange(len(content))
    return content[:k] + bytes([content[k] ^ 1 << draw.randrange(8)]) + content[k + 1 :]


def _set(content: bytes, draw: random.Random) -> bytes:
    k = draw.randrange(len(content) + 1)
    return content[:k] + bytes([draw.choice(_BYTES)]) + content[k + 1 :]


def _cut(content: bytes, draw: random.Random) -> bytes:
    return content[: draw.randrange(len(content) + 1)]


def _remove(content: bytes, draw: random.Random) -> bytes:
    k = draw.randrange(len(content) + 1)
    return content[:k] + content[k + draw.choice((1, 2, 4, 8, 100, 1000)) :]


def _insert(content: bytes, draw: random.Random) -> bytes:
    k = draw.randrange(len(content) + 1)
    return content[:k] + draw.randbytes(draw.choice((1, 2, 4, 64))) + content[k:]


def _repeat(content: bytes, draw: random.Random) -> bytes:
    k = draw.randrange(len(content) + 1)
    part = content[k : k + draw.choice((4, 40, 400))]
    return content[:k] + part * draw.choice((2, 3, 20)) + content[k:]


def _word(content: bytes, draw: random.Random) -> bytes:
    """Four or eight bytes as a number that is very small, large or not finite."""
    k = draw.randrange(len(content) + 1)
    numbers = [struct.pack("<i", draw.choice((-1, 0, 1, 2**31 - 1, -(2**31)))), struct.pack("<q", 2**62)]
    numbers += [
        struct.pack(kind, float(draw.choice(("nan", "inf", "1e30", "-1e30", "1e-40")))) for kind in ("<f", "<d")
    ]
    word = draw.choice(numbers)
    return content[:k] + word + content[k + len(word) :]


def _value(content: bytes, draw: random.Random) -> bytes:
    """A token becomes a value of another type."""
    tokens = list(_TOKEN.finditer(content))
    if not tokens:
        return draw.choice(_VALUES)
    token = draw.choice(tokens)
    return content[: token.start()] + draw.choice(_VALUES) + content[token.end() :]


def _swap(content: bytes, draw: random.Random) -> bytes:
    """A token becomes another token of the file."""
    tokens = list(_TOKEN.finditer(content))
    if not tokens:
        return content
    token, other = draw.choice(tokens), draw.choice(tokens)
    return content[: token.start()] + other.group() + content[token.end() :]


def _lines(content: bytes, draw: random.Random) -> bytes:
    """A line goes, comes twice, or changes its depth."""
    lines = content.split(b"\n")
    k = draw.randrange(len(lines))
    lines[k : k + 1] = draw.choice(([], [lines[k]] * 2, [b"  " + lines[k]], [lines[k].lstrip()], [draw.choice(lines)]))
    return b"\n".join(lines)


def _whole(content: bytes, draw: random.Random) -> bytes:
    """Another file takes its place."""
    return draw.choice((*_VALUES, b"\xef\xbb\xbf" + content, content.decode("latin-1").encode("utf-16"), content * 2))


def _entry(content: bytes, draw: random.Random) -> bytes:
    """An entry of an archive is damaged, lost or added, and the archive is sound."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            entries = {name: archive.read(name) for name in archive.namelist()}
    except Exception:  # it is damaged already
        return content
    if not entries:
        return content
    name, target = draw.choice(sorted(entries)), io.BytesIO()
    change = draw.randrange(8)
    if change == 0:
        del entries[name]
    elif change == 1:
        entries[draw.choice(sorted(entries))] = entries[name]
    elif change == 2 and entries[name].startswith(b"\x93NUMPY"):
        head, data = entries[name][10:].split(b"\n", 1)
        head = _anywhere(head, draw) + b"\n"
        entries[name] = entries[name][:8] + struct.pack("<H", len(head) & 0xFFFF) + head + data
    else:
        entries[name] = _anywhere(entries[name], draw)
    with zipfile.ZipFile(target, "w") as archive:
        for key, data in entries.items():
            archive.writestr(key, data)
    return target.getvalue()


def _part(content: bytes, draw: random.Random) -> bytes:
    """A part of a PNG picture is damaged, and its checksum is right."""
    parts, k = [], 8
    while k + 12 <= len(content):
        size = int.from_bytes(content[k : k + 4], "big")
        parts.append((content[k + 4 : k + 8], content[k + 8 : k + 8 + size]))
        k += 12 + size
    if not parts:
        return content
    k = draw.randrange(len(parts))
    parts[k] = parts[k][0], _anywhere(parts[k][1], draw)
    packed = (
        len(data).to_bytes(4, "big") + kind + data + zlib.crc32(kind + data).to_bytes(4, "big") for kind, data in parts
    )
    return content[:8] + b"".join(packed)


Way = Callable[[bytes, random.Random], bytes]
_BINARY: tuple[Way, ...] = (_flip, _flip, _set, _cut, _remove, _insert, _repeat, _word, _word, _whole)
_ANYWHERE: tuple[Way, ...] = (_value, _value, _value, _value, _swap, _swap, _lines, *_BINARY)
_CONTAINERS = {b"PK\x03\x04": (_entry, _entry, _entry, *_BINARY), b"\x89PNG": (_part, _part, _part, *_BINARY)}


def _anywhere(content: bytes, draw: random.Random) -> bytes:
    return draw.choice(_ANYWHERE if _is_text(content) else _BINARY)(content, draw)
