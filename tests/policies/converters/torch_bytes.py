"""Files as ``torch.save`` writes them, put together by hand, so that no test of the reader needs torch."""

from __future__ import annotations

import io
import pickle
import struct
import zipfile
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

ORDERED = b"ccollections\nOrderedDict\n)R"


def name(module: str, what: str) -> bytes:
    return f"c{module}\n{what}\n".encode()


def text(value: str) -> bytes:
    return b"X" + struct.pack("<I", len(value.encode())) + value.encode()


def number(value: int) -> bytes:
    raw = value.to_bytes(value.bit_length() // 8 + 1, "little", signed=True)
    return b"\x8a" + bytes([len(raw)]) + raw if len(raw) < 256 else b"\x8b" + struct.pack("<i", len(raw)) + raw


def group(*items: bytes) -> bytes:
    return b"(" + b"".join(items) + b"t"


def mapping(items: Mapping[str, bytes]) -> bytes:
    return b"}(" + b"".join(text(key) + value for key, value in items.items()) + b"u"


def storage(key: str, count: int, kind: str = "FloatStorage") -> bytes:
    return group(text("storage"), name("torch", kind), text(key), text("cuda:0"), number(count)) + b"Q"


def tensor(
    key: str, size: Sequence[int], *, stride: Sequence[int] | None = None, offset: int = 0, count: int | None = None,
    kind: str = "FloatStorage",
) -> bytes:  # fmt: skip
    if stride is None:
        stride = [int(np.prod(size[side + 1 :])) for side in range(len(size))]
    numbers = int(np.prod(size)) if count is None else count
    arguments = [storage(key, numbers, kind), number(offset), group(*map(number, size)), group(*map(number, stride))]
    return name("torch._utils", "_rebuild_tensor_v2") + group(*arguments, b"\x89", ORDERED) + b"R"


def parameter(*arguments: object, **options: object) -> bytes:
    made = tensor(*arguments, **options)  # type: ignore[arg-type]
    return name("torch._utils", "_rebuild_parameter") + group(made, b"\x88", ORDERED) + b"R"


def module(kind: str, parameters: Mapping[str, bytes], modules: Mapping[str, bytes]) -> bytes:
    """A pickled module of a class that exists nowhere."""
    state = mapping({"training": b"\x89", "_parameters": mapping(parameters), "_buffers": ORDERED,
                     "_modules": mapping(modules)})  # fmt: skip
    return name("nowhere.policies", kind) + b")\x81" + state + b"b"


def closed(body: bytes) -> bytes:
    return b"\x80\x02" + body + b"."


def zip_file(body: bytes, storages: Mapping[str, bytes], **others: bytes) -> bytes:
    """The format since version 1.6."""
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_STORED) as archive:
        archive.writestr("net/data.pkl", closed(body))
        for key, content in storages.items():
            archive.writestr(f"net/data/{key}", content)
        for key, content in {"version": b"3\n", **others}.items():
            archive.writestr(f"net/{key}", content)
    return target.getvalue()


def old_file(body: bytes, storages: Mapping[str, tuple[int, bytes]]) -> bytes:
    """The format before: pickles one after the other, then each storage after the number of its numbers."""
    head = [pickle.dumps(one, 2) for one in (0x1950A86A20F9469CFC6C, 1001, {"little_endian": True, "type_sizes": {}})]
    rest = [struct.pack("<q", count) + content for count, content in storages.values()]
    return b"".join([*head, closed(body), pickle.dumps(list(storages), 2), *rest])


def as_files(arrays: Mapping[str, NDArray[np.float32]]) -> list[bytes]:
    """A state dictionary of these arrays, in both formats."""
    items = {key: tensor(str(k), array.shape) for k, (key, array) in enumerate(arrays.items())}
    raw = {str(k): array.astype("<f4").tobytes() for k, array in enumerate(arrays.values())}
    counted = {key: (len(content) // 4, content) for key, content in raw.items()}
    return [zip_file(mapping(items), raw), old_file(mapping(items), counted)]
