"""The server of a study that is rehearsed: started again when it was killed."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import urllib.error
import urllib.request
from contextlib import suppress
from http.client import HTTPException
from pathlib import Path
from typing import Any

# Any, in this file: of JSON.


class RehearsalServer:
    """The server of the study, started again when it is gone."""

    def __init__(self, folder: Path, haste: float) -> None:
        self._command = [
            *(sys.executable, "-m", "costeer", "session", "run", str(folder)),
            *("--wheel", "simulated:virtual", "--haste", f"{haste:g}"),
            *("--no-browser", "--port", "0"),
        ]
        self._log = folder / "rehearsal.log"
        self._process: subprocess.Popen[str] | None = None
        self.address = self.token = ""

    def start(self) -> None:
        """Start it and wait for its addresses.

        Raises:
            ValueError: If it does not come.
        """
        self._forget()
        log = self._log.open("a", encoding="utf-8")
        self._process = subprocess.Popen(
            self._command, stdout=subprocess.PIPE, stderr=log, text=True
        )
        log.close()
        assert self._process.stdout is not None  # it was asked for
        for line in self._process.stdout:
            where = line.partition("at:")[2].strip()
            if line.startswith("participant"):
                self.address = where.rstrip("/")
            if line.startswith("console"):
                self.token = where.partition("experimenter=")[2]
                return
        raise ValueError(f"the server did not start; see {self._log}")

    @property
    def pid(self) -> int:
        """Of the server."""
        return self._process.pid if self._process else 0

    @property
    def is_alive(self) -> bool:
        """Whether it runs."""
        return self._process is not None and self._process.poll() is None

    def stop(self) -> None:
        """End it as Ctrl-C does."""
        if self._process is not None and self.is_alive:
            self._process.send_signal(signal.SIGINT)
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(60)
        if self.is_alive and self._process is not None:
            self._process.kill()
        self._forget()

    def _forget(self) -> None:
        """Let a server that has ended go."""
        if self._process is not None:
            self._process.wait()
            if self._process.stdout is not None:
                self._process.stdout.close()

    def ask(self, path: str, body: dict[str, Any] | None = None) -> dict[str, Any]:
        """What the server answers.

        Raises:
            OSError: If it does not answer, or refuses.
        """
        request = urllib.request.Request(
            self.address + path,
            None if body is None else json.dumps(body).encode(),
            {"Content-Type": "application/json"},
        )
        try:
            with urllib.request.urlopen(request, timeout=30) as answer:
                found: dict[str, Any] = json.load(answer)
        except urllib.error.HTTPError as error:
            error.close()
            raise
        except (HTTPException, json.JSONDecodeError) as error:  # killed in mid-answer
            raise ConnectionError(f"{path} was cut off") from error
        return found

    def console(self, action: str = "", **given: Any) -> dict[str, Any]:
        """What the console sees, after an action."""
        path = f"/api/console{'/' if action else ''}{action}"
        secret = f"?experimenter={self.token}"
        return self.ask(path + secret, given if action else None)
