"""How large a file of a policy may be."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["LIMITS", "Limits"]


@dataclass(frozen=True)
class Limits:
    """Bounds for files of policies, checked before anything is unpacked or computed.

    Attributes:
        file_bytes: Size of the file.
        unpacked_bytes: Size of all arrays together.
        document_bytes: Size of the JSON document.
        arrays: Number of arrays.
        layers: Number of layers.
        parameters: Number of numbers in all arrays.
        numbers: Numbers that all layers together return for one robot.
        work: Multiplications of one decision of one robot, roughly.
    """

    file_bytes: int = 64_000_000
    unpacked_bytes: int = 128_000_000
    document_bytes: int = 1_000_000
    arrays: int = 2_000
    layers: int = 500
    parameters: int = 16_000_000
    numbers: int = 1_000_000
    work: int = 100_000_000


LIMITS = Limits()
"""The usual limits."""
