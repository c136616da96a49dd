"""Workers of Dask, through joblib's backend."""

from __future__ import annotations

import logging
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

import dask
import distributed
from joblib import Parallel, delayed, parallel_config
from joblib._dask import DaskDistributedBackend

from costeer.scale.blocks import Answer, Block
from costeer.scale.worker import (
    Facts,
    OtherWorkerError,
    differing,
    facts,
    place,
    refusal,
)

_ANSWER_WITHIN = 10
"""How long a scheduler may take to answer [s]."""

_WORKERS_WITHIN = 60
"""How long workers may take to join [s]."""

_PATIENCE = 150
"""Looks at a scheduler that is not there before it is lost; half a minute."""

_IDLE = 20
"""Times that a cluster may be found without a worker, half a minute apart."""

_HERE = {
    # Workers may be killed here as often as somebody likes, and take their time to
    # start on a busy machine: Dask would give up a block, or a place for a worker.
    "distributed.scheduler.allowed-failures": 1000,
    "distributed.deploy.lost-worker-timeout": "1h",
    "distributed.worker.preload": ["costeer.scale.worker"],
}
"""Settings of Dask for workers on this computer."""


class _Calls:
    """Calls that a worker makes; joblib's own would open a connection back each."""

    def __call__(self, tasks: list[tuple[Any, Any, Any]]) -> list[Any]:
        """Their results."""
        return [function(*args, **named) for function, args, named in tasks]

    def __repr__(self) -> str:
        return "costeer"


class _Backend(DaskDistributedBackend):  # type: ignore[misc]  # joblib has no types
    """joblib's, but for three things.

    It would keep what it sends on one worker, and lose it with that worker; wait for
    ever for a block that Dask has given up; and work here if there is one worker.
    """

    def effective_n_jobs(self, n_jobs: int) -> int:
        """How many blocks may be under way; with 1 joblib would do them itself."""
        return max(2, int(super().effective_n_jobs(n_jobs)))

    async def _to_func_args(self, func: Any) -> Any:  # Any: joblib's own
        return _Calls(), list(func.items)

    async def _collect(self) -> None:
        import asyncio

        while self._continue:
            async for future, result in self.waiting_futures:
                told = self._results.pop(future)
                callback = self._callbacks.pop(future)
                if future.status != "finished":
                    error = result[1] if isinstance(result, tuple) else result
                    result = _GivenUp(error)
                told.set_result(result)
                callback(result)
            await asyncio.sleep(0.01)

    def retrieve_result_callback(self, out: Any) -> Any:  # Any: joblib's own
        if isinstance(out, _GivenUp):
            raise ConnectionError(f"the cluster has given up a block: {out.error}")
        return super().retrieve_result_callback(out)


class _GivenUp:
    """A block that Dask does not finish.

    Args:
        error: Why.
    """

    def __init__(self, error: object) -> None:
        self.error = " ".join(str(error).split()) or type(error).__name__


class DaskEngine:
    """The workers of a Dask cluster.

    Args:
        client: Of its scheduler.
    """

    def __init__(self, client: Any) -> None:  # Any: its types are not whole
        self.client = client
        self.facts: Facts = facts()
        self._address = client.scheduler.address
        self._absent = self._looks = self._alone = 0

    @property
    def num_workers(self) -> int:
        """How many threads all workers have."""
        return int(sum(self.client.ncores().values()))

    def answers(
        self, work: Callable[[Block], Answer], blocks: Iterator[Block]
    ) -> Iterator[Answer]:
        """What comes of the blocks, in any order."""
        make: Any = _Backend  # joblib has no types
        backend = make(
            client=self.client, wait_for_workers_timeout=_WORKERS_WITHIN, pure=False
        )
        with (
            parallel_config(backend=backend),
            Parallel(
                n_jobs=-1,
                batch_size=1,
                pre_dispatch="2*n_jobs",
                return_as="generator_unordered",
            ) as parallel,
        ):
            yield from parallel(delayed(work)(block) for block in blocks)

    def lost(self) -> str:
        """Why no answer will come any more; empty while one may."""
        status = self.client.status
        if status == "running":
            self._absent = 0
            return self._deserted()
        self._absent += 1
        if status == "connecting" and self._absent < _PATIENCE:
            return ""
        return f"the scheduler at {self._address} is lost"

    def _deserted(self) -> str:
        """Whether there has been no worker for long; asked every half minute."""
        self._looks += 1
        if self._looks % _PATIENCE:
            return ""
        self._alone = 0 if self.num_workers else self._alone + 1
        return "" if self._alone < _IDLE else f"{self._address} has no worker any more"


@contextmanager
def dask_workers(cluster: str) -> Iterator[DaskEngine]:
    """Workers here for `local:N`, else those of the scheduler at an address.

    Raises:
        ValueError: If nobody answers, nobody works, or a worker has another costeer.
    """
    _hush()
    with dask.config.set(_HERE if cluster.startswith("local:") else {}):
        client, own = _connected(cluster)
        try:
            engine = DaskEngine(client)
            _check_workers(engine, cluster)
            yield engine
        finally:
            with suppress(TimeoutError, OSError):
                client.close(timeout=_ANSWER_WITHIN)
            if own is not None:
                with suppress(TimeoutError, OSError):
                    own.close(timeout=_WORKERS_WITHIN)


def _hush() -> None:
    """Let costeer say what happens, not the loggers of Dask."""
    for name in (
        "distributed",
        "distributed.client",
        "distributed.gc",
        "tornado.application",
        "asyncio",
    ):
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)


def _connected(cluster: str) -> tuple[Any, Any]:  # Any: of Dask, types are not whole
    """A client of the cluster, and the cluster itself if it is this process's own."""
    make: Any = distributed
    kind, _, number = cluster.partition(":")
    if kind != "local":
        try:
            client = make.Client(cluster, timeout=_ANSWER_WITHIN, set_as_default=False)
            return client, None
        except (OSError, TimeoutError) as error:
            raise ValueError(
                f"no Dask scheduler answers at {cluster} within {_ANSWER_WITHIN} s; "
                "start one with: dask scheduler"
            ) from error
    own = make.LocalCluster(
        n_workers=int(number),
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        dashboard_address=None,
        memory_limit=0,
        silence_logs=logging.CRITICAL + 1,
    )
    return make.Client(own, set_as_default=False), own


def _check_workers(engine: DaskEngine, cluster: str) -> None:
    """Refuse workers that have another costeer.

    Raises:
        ValueError: If there is none, or one has.
    """
    client = engine.client
    try:
        client.wait_for_workers(1, timeout=_WORKERS_WITHIN)
    except TimeoutError:
        raise ValueError(
            f"no worker joined {cluster} within {_WORKERS_WITHIN} s; start some with: "
            "dask worker ADDRESS --nthreads 1"
        ) from None
    found = client.run(facts, on_error="return")
    for worker, told in sorted(found.items()):
        if not isinstance(told, tuple):
            version = f"{sys.version_info.major}.{sys.version_info.minor}"
            words = f"it cannot say which ({told}); here is Python {version}"
        else:
            words = differing(engine.facts, Facts(*told))
        if words:
            raise OtherWorkerError(f"{refusal(worker, words)} ({place()} is here)")
