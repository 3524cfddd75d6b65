"""Files are read within a limit, and their hashes do not depend on how they are read."""

from __future__ import annotations

import hashlib
import os
import pickle
from pathlib import Path
from types import SimpleNamespace

import pytest

from irsim.common import records
from irsim.common.hashing import digest, file_digest
from irsim.common.records import FileError, read_bytes


def test_a_file_is_read_up_to_its_limit(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_bytes(b"x" * 10)
    assert read_bytes(file, 10) == read_bytes(str(file)) == b"x" * 10
    with pytest.raises(FileError, match="it is too large") as raised:
        read_bytes(file, 9)
    error = pickle.loads(pickle.dumps(raised.value))
    assert (error.code, error.size, error.given, error.allowed) == ("file-too-large", 10, "10 bytes", "up to 9")


def test_a_file_whose_size_is_not_known_is_read_up_to_its_limit() -> None:
    file = Path("/proc/self/status")
    if not file.exists():
        pytest.skip("the system has no /proc")
    assert read_bytes(file).startswith(b"Name:")
    with pytest.raises(FileError, match="it is too large"):
        read_bytes(file, 5)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no pipes with names")
@pytest.mark.parametrize("checked", [True, False])
def test_only_ordinary_files_are_read(checked: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """``checked``: before they are opened; otherwise the file was another one at that time."""
    (tmp_path / "folder").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "file")
    (tmp_path / "file").touch()
    os.mkfifo(tmp_path / "pipe")
    if not checked:
        ordinary = (tmp_path / "file").stat()
        monkeypatch.setattr(records, "os", SimpleNamespace(**{**vars(os), "stat": lambda *_, **__: ordinary}))
    cases = {
        ("folder", True): ("not-a-file", "it is a folder, not a file"),
        ("pipe", True): ("not-a-file", "it is a device or pipe, not a file"),
        ("missing", True): ("file-not-found", "No such file or directory"),
        ("link", False): ("not-a-file", "it is a link, not a file") if checked else ("unreadable", "oo many"),
        ("a\0b", True): ("unreadable", "embedded null"),
    }
    for (name, follow), (code, message) in cases.items():
        with pytest.raises(FileError, match=message) as raised:
            read_bytes(tmp_path / name, follow=follow)
        assert raised.value.code == code


def test_hashes(tmp_path: Path) -> None:
    content = bytes(range(256)) * 5000
    (tmp_path / "file").write_bytes(content)
    expected = hashlib.sha256(content).hexdigest()
    assert file_digest(tmp_path / "file") == digest(content) == digest(content[:7], content[7:]) == expected
    assert digest("é", b"\n") == hashlib.sha256("é\n".encode()).hexdigest()
    assert digest("\ud800") == digest("?")
