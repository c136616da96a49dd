"""What kind of file it is, told by its content; a name may be wrong."""

from __future__ import annotations

import gzip
import io
import zlib
from pathlib import Path

from costeer.base.files import MOST, read_whole

PARQUET, STREAM, ARROW_FILE, TEXT = "parquet", "arrow stream", "arrow file", "text"

READ = "costeer reads CSV and other text tables, Parquet and Arrow, gzipped too"

_GZIP = b"\x1f\x8b"
_KINDS = (
    (b"PAR1", PARQUET),
    (b"\xff\xff\xff\xff", STREAM),
    (b"ARROW1", ARROW_FILE),
)
_OTHERS = (
    (b"PK\x03\x04", "an Excel workbook or another zip archive"),
    (b"\xd0\xcf\x11\xe0", "an old Excel workbook"),
    (b"MATLAB", "a MATLAB file"),
    (b"\x89HDF", "an HDF5 or MATLAB 7.3 file"),
    (b"BZh", "compressed with bzip2"),
    (b"\xfd7zXZ", "compressed with xz"),
    (b"\x28\xb5\x2f\xfd", "compressed with zstd"),
    (b"\x93NUMPY", "a NumPy array"),
    (b"\x80\x04\x95", "a Python pickle"),
    (b"\x80\x05\x95", "a Python pickle"),
    (b"\x89MCAP", "an MCAP file"),
    (b"%PDF", "a PDF"),
)
_UTF_16 = (b"\xff\xfe", b"\xfe\xff")


def unpacked(path: Path) -> bytes:
    """Content of a file, unpacked if it is gzipped.

    Raises:
        ValueError: If it is a damaged archive.
        OSError: If it cannot be read.
    """
    content = read_whole(path)
    if not content.startswith(_GZIP):
        return content
    try:
        with gzip.open(io.BytesIO(content)) as packed:
            content = packed.read(MOST + 1)
    except (OSError, EOFError, zlib.error) as error:
        raise ValueError(
            f"{path} is no CSV table: gzipped, and damaged or cut short ({error}); "
            "copy it anew"
        ) from error
    if len(content) > MOST:
        raise ValueError(f"{path} unpacks to more than {MOST / 1e9:g} GB; cut it")
    return content


def kind_of(content: bytes, path: Path) -> str:
    """The kind of a file.

    Args:
        content: Of it, unpacked.
        path: Its name decides where the content does not.

    Raises:
        ValueError: If it is of a kind that is not read, saying which are.
    """
    for start, kind in _KINDS:
        if content.startswith(start):
            return kind
    for start, other in _OTHERS:
        if content.startswith(start):
            raise ValueError(f"{path} is {other}; {READ}: save the table as CSV")
    if path.suffix.lower() == ".arrow":
        return STREAM
    if path.suffix.lower() == ".parquet" and not _is_table(content):
        return PARQUET
    if not content.strip():
        raise ValueError(f"{path} is no CSV table: it is empty; {READ}")
    if b"\0" in content[:4096] and not content.startswith(_UTF_16):
        raise ValueError(f"{path} is no text and of no kind that is known; {READ}")
    return TEXT


def _is_table(content: bytes) -> bool:
    """Whether it has lines of text with something between columns."""
    head = content[:4096]
    return b"\0" not in head and b"\n" in head and any(c in head for c in b",;\t")
