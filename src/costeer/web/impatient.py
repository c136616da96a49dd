"""HTTP as uvicorn speaks it, but half a request keeps no connection open."""

from __future__ import annotations

import asyncio
from typing import Any

from uvicorn.protocols.http.auto import AutoHTTPProtocol

PATIENCE = 10.0
"""A request that is not whole after so long is dropped with its connection [s]."""

# Any: uvicorn chooses one of two implementations when it is imported.
_Base: Any = AutoHTTPProtocol


class ImpatientProtocol(_Base):  # type: ignore[misc]  # see above
    """One connection; it ends when a request is begun and not finished in time."""

    _limit: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:
        """Begin to wait for the first request."""
        super().connection_made(transport)
        self._wait()

    def data_received(self, data: bytes) -> None:
        """Wait for the rest of what has begun to come; drop what is no HTTP."""
        self._wait()
        super().data_received(data)

    def send_400_response(self, msg: str) -> None:
        """Refuse what is no HTTP; an answer that was under way is not sent any more."""
        if self.cycle is not None:
            self.cycle.disconnected = True
        super().send_400_response(msg)

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait no more."""
        if self._limit is not None:
            self._limit.cancel()
        super().connection_lost(exc)

    def _wait(self) -> None:
        if self._limit is None:
            self._limit = self.loop.call_later(PATIENCE, self._look)

    def _look(self) -> None:
        """Close what has not become a request, a response or a socket."""
        self._limit = None
        is_http = self.transport.get_protocol() is self
        answers = self.cycle is not None and not self.cycle.response_complete
        if is_http and not answers:
            self.transport.close()
