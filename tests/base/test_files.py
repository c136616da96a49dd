"""Files are whole or not there; folders of other things are left alone."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from costeer.base.files import prepare_folder, read_whole, replacing, write_text


def test_a_file_is_replaced_whole_and_nothing_else_is_left(tmp_path: Path) -> None:
    file = tmp_path / "table.csv"
    file.write_text("old")
    write_text(file, "a\nα\n")
    assert file.read_bytes() == "a\nα\n".encode()
    assert list(tmp_path.iterdir()) == [file]


def test_a_write_that_fails_leaves_the_old_file(tmp_path: Path) -> None:
    file = tmp_path / "table.csv"
    file.write_text("old")

    def write_half() -> None:
        with replacing(file) as partial:
            partial.write_text("half")
            assert file.read_text() == "old"
            raise OSError("No space left on device")

    with pytest.raises(OSError, match="No space"):
        write_half()
    assert [path.read_text() for path in tmp_path.iterdir()] == ["old"]


def test_what_might_never_end_is_not_read(tmp_path: Path) -> None:
    (tmp_path / "table").write_bytes(b"12345")
    assert read_whole(tmp_path / "table", 5) == b"12345"
    with pytest.raises(ValueError, match=r"table has 5e-06 MB, at most 4e-06 MB"):
        read_whole(tmp_path / "table", 4)
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "pipe", Path("/dev/zero")):
        with pytest.raises(ValueError, match="is a device or a pipe; give a file"):
            read_whole(path)
    with pytest.raises(IsADirectoryError):
        read_whole(tmp_path)


def test_a_folder_of_other_things_is_refused_and_left_alone(tmp_path: Path) -> None:
    thesis = tmp_path / "thesis.tmp"
    thesis.write_text("years")
    with pytest.raises(ValueError, match=r"holds no report \(it holds thesis\.tmp\)"):
        prepare_folder(tmp_path, "report.html", "report")
    with pytest.raises(ValueError, match="is a file"):
        prepare_folder(thesis, "report.html", "report")
    assert [path.read_text() for path in tmp_path.iterdir()] == ["years"]


def test_what_an_earlier_or_a_killed_run_left_is_taken(tmp_path: Path) -> None:
    (tmp_path / "figures").mkdir()
    (tmp_path / ".lock").touch()
    (tmp_path / "report.html.7.tmp").write_text("half")
    prepare_folder(tmp_path, "report.html", "report", (".lock",))
    (tmp_path / "report.html").touch()
    (tmp_path / "figures" / "notes.txt").touch()
    prepare_folder(tmp_path, "report.html", "report")


def test_a_file_in_the_way_is_named(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("")
    with pytest.raises(OSError, match=r"cannot write in .*report: Not a directory"):
        prepare_folder(tmp_path / "out" / "report", "report.html", "report")


def test_a_folder_that_cannot_be_written_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Root may write anywhere, so the refusal is made up.
    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "touch", refuse)
    with pytest.raises(OSError, match="Permission denied; choose another folder"):
        prepare_folder(tmp_path / "new", "report.html", "report")


def test_a_durable_file_is_on_the_disk_before_it_takes_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file, told = tmp_path / "drive.parquet", []

    def synchronised(descriptor: int) -> None:
        there = Path(f"/proc/self/fd/{descriptor}").readlink()
        told.append((there.suffix, file.exists()))

    monkeypatch.setattr(os, "fsync", synchronised)
    with replacing(file, durable=True) as partial:
        partial.write_text("rows")
    assert told == [(".tmp", False), (tmp_path.suffix, True)]


def test_an_error_of_the_disk_names_the_file(tmp_path: Path) -> None:
    def fill() -> None:
        with replacing(tmp_path / "table.csv"):
            raise OSError(errno.ENOSPC, "PyArrow's own words")

    with pytest.raises(OSError, match=r"No space left on device: '.*table\.csv'"):
        fill()
