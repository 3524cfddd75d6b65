"""The closed list of diagnostic and error codes: name, one-line title, explanation shown by ``irsim describe CODE``."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["CODES", "Code"]


class Code(NamedTuple):
    """A documented code."""

    title: str
    explanation: str


CODES: dict[str, Code] = {
    # the file
    "file-not-found": Code("scenario file not found", "No file of that name in the places searched; the message lists them."),
    "not-a-file": Code("not a regular file", "The path names a directory, a device or something else that holds no text."),
    "not-text": Code("not a text file", "The file holds bytes that are not UTF-8 text."),
    # names
    "unknown-key": Code("unknown key", "The key is not part of the language at this place."),
    "unknown-behavior": Code("unknown behavior", "No behavior of that name is registered."),
    # engine
    "not-yet-simulated": Code("valid, but not simulated yet", "The language knows the feature; this version's engine does not run it."),
    "placement-crowded": Code("random placement found no room", "No free pose was found within the attempts."),
}
