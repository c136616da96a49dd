"""Workers of Ray, through joblib's backend. Ray is no dependency of costeer's."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from itertools import islice
from typing import Any

from joblib import Parallel, delayed, parallel_config

from costeer.scale.blocks import Answer, Block
from costeer.scale.worker import Facts, facts

_AHEAD = 2
"""Blocks a worker is sent at a time: joblib gathers those of Ray in whole lists."""


class RayEngine:
    """The workers of a Ray cluster.

    Args:
        ray: The module, connected.
    """

    def __init__(self, ray: Any) -> None:  # Any: Ray need not be installed
        self._ray = ray
        self.facts: Facts = facts()

    @property
    def num_workers(self) -> int:
        """How many processors all workers have."""
        return max(1, int(self._ray.cluster_resources().get("CPU", 1)))

    def answers(
        self, work: Callable[[Block], Answer], blocks: Iterator[Block]
    ) -> Iterator[Answer]:
        """What comes of the blocks, in their order.

        With a single worker joblib does them in this process.
        """
        number = self.num_workers
        with (
            parallel_config(backend="ray"),
            Parallel(n_jobs=number, batch_size=1) as parallel,
        ):
            while chosen := list(islice(blocks, number * _AHEAD)):
                yield from parallel(delayed(work)(block) for block in chosen)

    def lost(self) -> str:
        """Why no answer will come any more; empty while one may."""
        return "" if self._ray.is_initialized() else "the Ray cluster is lost"


@contextmanager
def ray_workers(cluster: str) -> Iterator[RayEngine]:
    """Workers here for `ray:N`, else those of `ray:auto` or `ray://host:port`.

    Raises:
        ValueError: If nobody answers.
        ModuleNotFoundError: If Ray is not installed.
    """
    try:
        ray: Any = import_module("ray")
        joining: Any = import_module("ray.util.joblib")
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            f"{error.name} is not installed; install Ray with: pip install ray"
        ) from None
    where = cluster.removeprefix("ray:")
    here = where.isdigit()
    options = (
        {"num_cpus": int(where), "include_dashboard": False}
        if here
        else {"address": "auto" if where == "auto" else cluster}
    )
    try:
        ray.init(log_to_driver=False, logging_level="ERROR", **options)
    except (ConnectionError, OSError) as error:
        raise ValueError(
            f"no Ray cluster answers at {cluster}; start one with: ray start --head"
        ) from error
    try:
        joining.register_ray()
        yield RayEngine(ray)
    finally:
        ray.shutdown()
