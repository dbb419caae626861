"""Encodes many logs with two Dask workers; one is killed after 300 logs, and one after 700.

    fleet.py [LOGS OUT KIND=CHANNELS...]

Without arguments the two workers start, are killed and end without logs, to know what Dask takes by itself. `cargo verify
fleet` compares OUT with what `spikewire dataset` writes.
"""

import multiprocessing.forkserver
import multiprocessing.resource_tracker
import os
import resource
import signal
import sys
import time

import dask

dask.config.set(
    {
        # Workers, also those that replace others, are forked from one process that has imported Dask.
        "distributed.worker.multiprocessing-method": "forkserver",
        # By default a worker gives memory back to the system whenever 64 kB are free, and soon asks for it again.
        "distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": 1 << 27,
        # Watches loops, functions and memory of the workers less, as no dashboard shows them.
        "distributed.admin.tick.interval": "1s",
        "distributed.admin.system-monitor.interval": "10s",
        "distributed.worker.profile.enabled": False,
    }
)

import distributed

import spikewire as sw


def most() -> float:
    """Largest amount of memory that this process used, in MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000


def kill_one(client: distributed.Client) -> None:
    os.kill(next(iter(client.run(os.getpid).values())), signal.SIGKILL)


def main() -> None:
    kills = [700, 300]
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        if not sys.argv[1:]:
            for _ in kills:
                kill_one(client)
                time.sleep(2)
                client.wait_for_workers(2)
            return
        logs, out, *channels_of = sys.argv[1:]

        def kill(done: int, total: int) -> None:
            if kills and done >= kills[-1]:
                kills.pop()
                kill_one(client)

        scheme = sw.StepForward(threshold=0.05)
        counts = sw.dataset(
            logs,
            scheme,
            out,
            client=client,
            channels_of=channels_of,
            skip_non_finite=True,
            accept_cut=True,
            progress=kill,
        )
        print(f"{counts}; workers {[*client.run(most).values()]} MB, the caller {most()} MB", flush=True)
    assert not kills and counts["done_before"] == counts["refused"] == 0


if __name__ == "__main__":
    main()
    # Ends and awaits the processes that Python would leave behind, so that their time, and the workers', counts.
    multiprocessing.forkserver._forkserver._stop()
    multiprocessing.resource_tracker._resource_tracker._stop()
