"""Many logs as a data set of Parquet files, encoded on one machine or many."""

from __future__ import annotations

import json
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor, as_completed
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Any

from . import _native, _progress
from ._errors import checked
from ._flight import Flight
from ._scheme import Scheme


@checked
def dataset(
    paths: str | Path | Sequence[str | Path],
    flight: str | Path | Scheme,
    out: str | Path,
    *,
    client: Any = None,
    channels: Sequence[str] = (),
    channels_of: Sequence[str] = (),
    time: str | None = None,
    time_unit: str | None = None,
    delimiter: str | None = None,
    header: int | None = None,
    rate: float | None = None,
    gap: float | None = None,
    skip_non_finite: bool = False,
    accept_cut: bool = False,
    test: float = 0.2,
    by_directory: bool = False,
    jobs: int | None = None,
    progress: bool | Callable[[int, int], object] | None = None,
) -> dict[str, int]:
    """Encodes many logs to Parquet files with a manifest, as ``spikewire dataset`` does; returns the counts.

    `paths` are files, directories and patterns such as ``"logs/**/*.ulg"``. `flight` is a flight's file, or a scheme whose
    `channels` to read are named; ``channels_of=["ulog=sensor_combined.gyro_rad[0]"]`` names those of one kind of log.
    `test` is the share of the flights for testing, and `by_directory` makes all logs of a directory one flight. The other
    keywords are those of :func:`~spikewire.read`.

    `client` is a ``dask.distributed.Client``, a ``ray.util.multiprocessing.Pool`` or another pool with
    ``imap_unordered``, or an executor of :mod:`concurrent.futures`; without one, `jobs` threads of this process work. A
    task is a log, or with Dask up to 16 logs if there are many; the workers need the same files under the same paths.
    Dask gives the tasks of a worker that died to another one, and so does Ray, if the pool has
    ``ray_remote_args={"max_restarts": -1, "max_task_retries": -1}``. A ``multiprocessing.Pool`` waits for ever for the
    task of a worker that was killed; a ``ProcessPoolExecutor`` raises. After an error a pool goes on with its tasks: end it
    before the call is repeated. Whoever encodes, the bytes of all files are the same. A call that was ended is continued
    by the same call.

    For many short logs, set before a Dask cluster starts
    ``dask.config.set({"distributed.worker.multiprocessing-method": "forkserver",
    "distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": 1 << 27})``: otherwise each worker imports Dask anew.

    >>> import pathlib, tempfile, spikewire as sw
    >>> place = pathlib.Path(tempfile.mkdtemp())
    >>> for name in ["one", "two"]:
    ...     _ = (place / f"{name}.csv").write_text("time,gyro_x\\n0.000,0\\n0.005,1\\n0.010,2\\n")
    >>> sw.dataset(place, sw.StepForward(threshold=0.5), place / "spikes", channels=["gyro_x"])["events"]
    4
    """
    flight = flight if isinstance(flight, Scheme) else Path(flight)
    if isinstance(flight, Path):
        # An error names file and line.
        Flight(flight)
    keywords = {
        "logs": [str(path) for path in ([paths] if isinstance(paths, (str, Path)) else paths)],
        "flight": flight.read_text() if isinstance(flight, Path) else None,
        "scheme": flight if isinstance(flight, Scheme) else None,
        "input": {
            "columns": list(channels),
            "fields": [],
            "topic": None,
            "time": time,
            "time_unit": time_unit,
            "delimiter": delimiter,
            "header": header,
            "rate": rate,
            "gap": gap,
            "skip_non_finite": skip_non_finite,
            "accept_cut": accept_cut,
        },
        "channels_of": list(channels_of),
        "output": str(Path(out).absolute()),
        "test": test,
        "by_directory": by_directory,
    }
    run = _native.Dataset(_told(keywords))
    left = run.left()
    # A task carries only its own log, not the list of all.
    task = partial(_encoded, {**keywords, "logs": []})
    logs = [str(log) for log in left]
    if hasattr(client, "get_executor"):
        rows = _by_dask(client, task, logs)
    elif hasattr(client, "imap_unordered"):
        rows = (row for row in client.imap_unordered(task, logs))
    else:
        rows = _by_executor(client, jobs, task, logs)
    with _progress.bar(progress, "dataset") as tell, closing(rows):
        for done, row in enumerate(rows, 1):
            run.add(row)
            if tell:
                tell(done, len(left))
    return json.loads(run.finish())


def _by_executor(
    client: Executor | None, jobs: int | None, task: Callable[[str], str], logs: list[str]
) -> Generator[str, None, None]:
    """The rows of logs, in the order in which they are done."""
    executor = ThreadPoolExecutor(jobs) if client is None else client
    futures = [executor.submit(task, log) for log in logs]
    try:
        for future in as_completed(futures):
            yield future.result()
    finally:
        for future in futures:
            future.cancel()
        if client is None:
            executor.shutdown()


def _by_dask(client: Any, task: Callable[[str], str], logs: list[str]) -> Generator[str, None, None]:
    """The rows of logs, in the order in which Dask's workers have done them."""
    import distributed

    # A task costs Dask some milliseconds, which short logs share if there are many for each worker.
    size = min(16, max(1, len(logs) // (8 * max(1, sum(client.nthreads().values())))))
    batches = [logs[start : start + size] for start in range(0, len(logs), size)]
    # Dask must not reuse the result of an earlier equal task, because the files of that task may be gone.
    futures = client.map(partial(_each, task), batches, pure=False)
    try:
        for future, rows in distributed.as_completed(futures, with_results=True):
            # Releases the rows at once: otherwise Dask would compute them anew if their worker died.
            future.release()
            yield from rows
    finally:
        client.cancel(futures)


def _told(keywords: dict[str, Any]) -> dict[str, Any]:
    """The keywords as the compiled half takes them. What it knows of a scheme does not go to another process."""
    scheme = keywords["scheme"]
    return {**keywords, "coder": None if scheme is None else scheme._coder}


def _encoded(keywords: dict[str, Any], log: str) -> str:
    """A task: encodes one log, and returns its row of the manifest."""
    return _native.encode_log(_told(keywords), log)


def _each(task: Callable[[str], str], logs: list[str]) -> list[str]:
    """A task for Dask: encodes some logs, and returns their rows."""
    return [task(log) for log in logs]
