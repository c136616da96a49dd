"""Files of the page: which may be asked for, and where they are."""

from __future__ import annotations

import re
from importlib.resources import files
from pathlib import Path

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import FileResponse, Response

_TYPES = {
    ".css": "text/css",
    ".html": "text/html",
    ".ico": "image/x-icon",
    ".jpg": "image/jpeg",
    ".js": "text/javascript",
    ".json": "application/json",
    ".mjs": "text/javascript",
    ".png": "image/png",
    ".svg": "image/svg+xml",
    ".txt": "text/plain",
    ".wasm": "application/wasm",
    ".webp": "image/webp",
    ".woff2": "font/woff2",
}
"""Type by ending. Not the system's: Windows may call scripts plain text, and browsers
then refuse to run them."""

_PATH = re.compile(r"[A-Za-z0-9_-][A-Za-z0-9._-]*(/[A-Za-z0-9_-][A-Za-z0-9._-]*)*")
"""Names of letters, digits, dots and dashes; none begins with a dot."""

_NO_PAGE = "The page is missing. Install costeer again, or run: make page\n"


def static_folder() -> Path:
    """The folder of the page's files."""
    return Path(str(files("costeer.web"))) / "static"


def file_in(folder: Path, path: str) -> Path | None:
    """The file that a path of the page names; None if there is none that is served.

    Args:
        folder: Where the page's files are.
        path: Below it, with slashes, already decoded.
    """
    if not _PATH.fullmatch(path):
        return None
    try:
        file = (folder / path).resolve()
        inside = file.is_relative_to(folder.resolve())
        return file if inside and file.is_file() else None
    except OSError:  # a name that is longer than any file's
        return None


def start_page(folder: Path) -> Path | None:
    """The page to begin with: one that says so where its libraries are missing."""
    complete = (folder / "vendor").is_dir()
    return file_in(folder, "index.html" if complete else "missing.html")


def file_response(file: Path) -> FileResponse:
    """A file with the type of its ending."""
    kind = _TYPES.get(file.suffix.lower(), "application/octet-stream")
    return FileResponse(file, media_type=kind)


async def answer_file(request: Request) -> Response:
    """Answer with the file that the address names."""
    file = file_in(request.app.state.folder, request.path_params["path"])
    if file is None:
        raise HTTPException(404)
    return file_response(file)


async def answer_page(request: Request) -> Response:
    """Answer with the page."""
    page = start_page(request.app.state.folder)
    if page is None:
        return Response(_NO_PAGE, 503, media_type="text/plain")
    return file_response(page)
