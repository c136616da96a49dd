"""The workers that `--cluster` names: of Dask or Ray, through joblib."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager

from costeer.base.extras import install_command
from costeer.scale.blocks import Engine
from costeer.scale.jobs import MOST_JOBS, Pool, default_jobs

_LOCAL = re.compile(r"(local|ray):(\d+)")
_DASK = re.compile(r"((tcp|tls|ucx|ws|wss)://)?[^\s/:]+:\d{1,5}")
_RAY = re.compile(r"ray:auto|ray://[^\s/:]+:\d{1,5}")

WAYS = (
    "give local:N for N processes here, the address of a Dask scheduler as "
    "tcp://host:8786, or ray:N, ray:auto, ray://host:10001 for Ray"
)


def check_cluster(cluster: str) -> str:
    """Return what `--cluster` was given, if it can be.

    Raises:
        ValueError: If it names no cluster.
    """
    local = _LOCAL.fullmatch(cluster)
    if local and not 1 <= int(local[2]) <= MOST_JOBS:
        raise ValueError(
            f"cluster {cluster} has {local[2]} workers; give 1 to {MOST_JOBS}"
        )
    known = local or _RAY.fullmatch(cluster) or _DASK.fullmatch(cluster)
    if cluster and not known:
        raise ValueError(f"cluster {cluster!r} is not known; {WAYS}")
    return cluster


@contextmanager
def workers(jobs: int | None = None, cluster: str = "") -> Iterator[Pool]:
    """The pool for `run_jobs`: threads, or the checked workers of a cluster.

    Args:
        jobs: Threads; as many as processors if None. Of a cluster all workers work.
        cluster: As in `--cluster`; empty for threads.

    Raises:
        ValueError: If a number is out of range, no scheduler answers, or a worker has
            another costeer than this computer.
        ModuleNotFoundError: If the engine is not installed.
    """
    check_cluster(cluster)
    if not cluster:
        yield check_jobs(jobs)
        return
    if jobs is not None:
        raise ValueError(
            f"jobs is {jobs} and cluster {cluster}: all workers of a cluster work; "
            "leave jobs out"
        )
    with _engine(cluster) as engine:
        yield engine


def check_jobs(jobs: int | None) -> int:
    """Return a number of threads.

    Raises:
        ValueError: If it is out of range.
    """
    if jobs is None:
        return default_jobs()
    if isinstance(jobs, bool) or not isinstance(jobs, int):
        raise ValueError(f"jobs must be a whole number, not {jobs!r}")
    if not 1 <= jobs <= MOST_JOBS:
        raise ValueError(f"jobs is {jobs}; give a whole number 1 to {MOST_JOBS}")
    return jobs


def _engine(cluster: str) -> AbstractContextManager[Engine]:
    """The workers of an engine; it is imported only if it is wanted.

    Raises:
        ModuleNotFoundError: If it is not installed, with what installs it.
    """
    try:
        if cluster.startswith("ray:"):
            from costeer.scale.ray_engine import ray_workers

            return ray_workers(cluster)
        from costeer.scale.dask_engine import dask_workers
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            f"{error.name} is not installed, which --cluster needs; install it with: "
            f"{install_command('cluster')}"
        ) from None
    return dask_workers(cluster)
