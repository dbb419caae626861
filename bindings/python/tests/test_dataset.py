"""Data sets of many logs, encoded in threads, in processes, and by Dask and Ray while a worker dies."""

import filecmp
import json
import os
import signal
import subprocess
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest
import spikewire as sw

SCHEME = sw.StepForward(threshold=0.05)


@pytest.fixture
def logs(tmp_path):
    """Twelve tables, of which one cannot be read."""
    directory = tmp_path / "logs"
    directory.mkdir()
    for number in range(12):
        x = np.sin(np.arange(40_000) * 0.01 * (number + 1))
        np.savetxt(directory / f"{number}.csv", x, header="gyro_x", comments="", fmt="%.6f")
    (directory / "5.csv").write_text("gyro_x\none\ntwo\n")
    return directory


def files(directory: Path) -> list[str]:
    return sorted(str(own.relative_to(directory)) for own in directory.rglob("*") if own.is_file())


def are_equal(one: Path, other: Path) -> bool:
    names = files(one)
    return names == files(other) and filecmp.cmpfiles(one, other, names, shallow=False) == (names, [], [])


def test_the_program_writes_the_same_bytes(logs, tmp_path):
    counts = sw.dataset(logs, SCHEME, tmp_path / "own", channels=["gyro_x"], jobs=2)
    assert (counts["logs"], counts["refused"], counts["train"] + counts["test"]) == (12, 1, 11)
    program = os.environ.get("SPIKEWIRE")
    if program is None:
        pytest.skip("SPIKEWIRE names no program")
    options = "dataset --scheme sf --threshold 0.05 --columns gyro_x -o".split()
    subprocess.run([program, *options, tmp_path / "program", logs], check=True)
    assert are_equal(tmp_path / "own", tmp_path / "program")
    assert sw.dataset(logs, SCHEME, tmp_path / "own", channels=["gyro_x"])["done_before"] == 12


def test_a_flight_and_processes(logs, tmp_path):
    flight = tmp_path / "flight.toml"
    channel = '[[channel]]\nname = "gyro_x"\n'
    flight.write_text('version = 1\nscheme = "sf"\nperiod = 2000\nparameters = { threshold = 0.05 }\n' + channel)
    told = []
    sw.dataset([logs], flight, tmp_path / "own", progress=lambda *done: told.append(done))
    assert told == [(done, 12) for done in range(1, 13)]
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as processes:
        sw.dataset([logs], flight, tmp_path / "other", client=processes)
    with get_context("spawn").Pool(2) as pool:
        sw.dataset([logs], flight, tmp_path / "pool", client=pool)
    assert are_equal(tmp_path / "own", tmp_path / "other")
    assert are_equal(tmp_path / "own", tmp_path / "pool")


def test_mistakes_are_told(logs, tmp_path):
    with pytest.raises(sw.Error, match="none that matches"):
        sw.dataset("no/*.csv", SCHEME, tmp_path / "own")
    with pytest.raises(sw.Error, match="test.* must be from 0 to 1"):
        sw.dataset(logs, SCHEME, tmp_path / "own", test=2)
    with pytest.raises(ValueError, match="flight.toml"):
        sw.dataset(logs, tmp_path / "flight.toml", tmp_path / "own")


def test_a_worker_that_is_killed_leaves_no_hole(logs, tmp_path):
    distributed = pytest.importorskip("distributed")
    sw.dataset(logs, SCHEME, tmp_path / "own", channels=["gyro_x"])
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        pids = client.run(os.getpid)
        assert len(set(pids.values())) == 2
        killed = []

        def kill(done, total):
            # While the other logs are under way.
            if not killed:
                killed.append(done)
                os.kill(next(iter(pids.values())), signal.SIGKILL)

        counts = sw.dataset(logs, SCHEME, tmp_path / "dask", channels=["gyro_x"], client=client, progress=kill)
        assert killed and killed[0] < 12
        start = time.monotonic()
        while set(client.run(os.getpid).values()) <= set(pids.values()):
            assert time.monotonic() - start < 30
    assert (counts["logs"], counts["done_before"]) == (12, 0)
    assert are_equal(tmp_path / "own", tmp_path / "dask")
    rows = [json.loads(line) for line in (tmp_path / "dask/manifest.jsonl").read_text().splitlines()]
    assert len({row["log"] for row in rows}) == len(rows) == 12


def test_a_worker_of_ray_that_is_killed_leaves_no_hole(logs, tmp_path):
    """Run by `cargo verify fleet`, which installs Ray."""
    ray = pytest.importorskip("ray")
    from ray.util.multiprocessing import Pool

    sw.dataset(logs, SCHEME, tmp_path / "own", channels=["gyro_x"])
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    killed = []
    try:
        with Pool(2, ray_remote_args={"max_restarts": -1, "max_task_retries": -1}) as pool:
            pid = pool.apply(os.getpid)

            def kill(done, total):
                if not killed:
                    killed.append(done)
                    os.kill(pid, signal.SIGKILL)

            counts = sw.dataset(logs, SCHEME, tmp_path / "ray", channels=["gyro_x"], client=pool, progress=kill)
            assert killed
    finally:
        ray.shutdown()
    assert (counts["logs"], counts["done_before"]) == (12, 0)
    assert are_equal(tmp_path / "own", tmp_path / "ray")
