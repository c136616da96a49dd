"""Damaged files: each ends a command in one line and exit code 0 or 2, never otherwise.

Files that costeer reads are changed at random: bytes flipped, cut, put in, blocks
repeated, words replaced. `FUZZ=1` in the environment shares 5,000 of them among the
kinds; without it fewer are tried.

    FUZZ=1 pytest tests/cli/test_fuzz.py -m "" -s
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from costeer.cli import main
from costeer.drivers.driver import DriverParameters
from costeer.intention.weights import load_weights, save_weights
from costeer.loop.inputs import write_driver
from costeer.records.record import write_record
from tests.study.synthetic import synthetic_record

WORDS = (b"NaN", b"-1", b"1e400", b"9" * 400, b"[", b"{", b"&a [*a]", b"\x00", b"\xff")
WORDS += (b"time", b"2021-03-01", b",", b";", b"\n", b'"', b"true", b"null", b"-inf")

SHARES = {"car": 1500, "driver": 700, "weights": 1000, "study": 500, "csv": 600}
SHARES |= {"record": 700}
"""How many of 5,000 each kind of file gets."""


def mutated(content: bytes, draw: np.random.Generator) -> bytes:
    """The content with one to four changes."""
    changed = bytearray(content)
    for _ in range(int(draw.integers(1, 5))):
        at = int(draw.integers(0, len(changed) + 1))
        kind = draw.integers(0, 5)
        if kind == 0 and at < len(changed):
            changed[at] ^= 1 << int(draw.integers(0, 8))
        elif kind == 1:
            del changed[at : at + int(draw.integers(1, 200))]
        elif kind == 2:
            changed[at:at] = draw.bytes(int(draw.integers(1, 20)))
        elif kind == 3:
            changed[at:at] = changed[at : at + int(draw.integers(1, 500))]
        else:
            changed[at:at] = WORDS[int(draw.integers(0, len(WORDS)))]
    return bytes(changed)


def write_sources(folder: Path) -> dict[str, Path]:
    """A sound file of each kind."""
    record = synthetic_record("strong-rapid", 1, 1, length=600.0)
    names = ("car.yaml", "driver.yaml", "weights.npz", "study.yaml", "csv.csv")
    files = {name.partition(".")[0]: folder / name for name in names}
    files["record"] = folder / "record.parquet"
    files["car"].write_text("about: loaded\nmass: 1900\nyaw_inertia: 3200\n")
    write_driver(files["driver"], DriverParameters(), {"fitted_to": "x"})
    save_weights(files["weights"], load_weights())
    write_record(files["record"], record)
    columns = map(np.ma.getdata, record.columns.values())
    rows = [list(record.columns), *zip(*columns, strict=True)]
    text = "\n".join(",".join(map(str, row)) for row in rows[:400])
    files["csv"].write_text(text)
    files["study"].write_text("seed: 1\nparticipants: 2\nconditions: [manual]\n")
    return files


def command(kind: str, file: Path, out: Path) -> list[str]:
    """What reads a file of the kind and does little else."""
    simulate = ["simulate", "--engine", "python", "--length", "100", "--out", str(out)]
    return {
        "car": ["parameters", "mass", "--car", str(file)],
        "driver": [*simulate, "--intention", "off", "--driver", str(file)],
        "weights": [*simulate, "--weights", str(file)],
        "study": ["report", str(file.parent)],
        "csv": ["analyse", str(file)],
        "record": ["analyse", str(file)],
    }[kind]


@pytest.mark.slow
@pytest.mark.parametrize("kind", SHARES)
def test_a_damaged_file_ends_in_one_line(
    kind: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    source = write_sources(tmp_path)[kind].read_bytes()
    draw = np.random.default_rng(list(kind.encode()))
    number = SHARES[kind] if os.environ.get("FUZZ") else SHARES[kind] // 20
    place = tmp_path / "tried" / f"{'study' if kind == 'study' else 'file'}"
    suffix = {"csv": ".csv", "record": ".parquet", "weights": ".npz"}.get(kind, ".yaml")
    file = place.with_suffix(suffix)
    file.parent.mkdir()
    file.write_bytes(source)
    assert main(command(kind, file, tmp_path / "t.parquet")) == 2 * (kind == "study")
    capsys.readouterr()
    refused = 0
    for count in range(number):
        file.write_bytes(mutated(source, draw))
        code = main(command(kind, file, tmp_path / "t.parquet"))
        said = capsys.readouterr().err
        last = said.strip().splitlines()[-1] if said.strip() else ""
        assert code in (0, 2), f"{kind} {count}: {code}: {last}"
        assert "Traceback" not in said
        refused += code == 2
    with capsys.disabled():
        print(
            f"\n{kind}: {number} damaged files, {refused} refused, none broke costeer"
        )


@pytest.mark.parametrize(
    "words",
    [
        ["analyse", "/dev/zero"],
        ["evaluate", "/dev/zero"],
        ["export", "/dev/zero", "--to", "mcap", "--out", "x.mcap"],
        ["replay", "/dev/zero"],
        ["drivers", "--fit", "/dev/zero"],
        ["parameters", "--parameters", "/dev/zero"],
        ["analyse", "table.csv", "--map", "/dev/zero"],
        ["simulate", "--length", "100", "--out", "t.parquet", "--weights", "/dev/zero"],
    ],
)
def test_what_never_ends_is_not_read(
    words: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(words) == 2
    assert "/dev/zero is a device or a pipe" in capsys.readouterr().err
