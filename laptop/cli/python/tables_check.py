"""Compares what `spikewire` reads of tables in other formats than CSV with what NumPy, pandas and pyarrow wrote, and what they
read of a data set with what `encode` writes.

Every format holds the same recording, so that its spikes must be those of the CSV table, byte for byte below the header.
Run by `cargo verify logs`: tables_check.py SPIKEWIRE RECORDING.csv DIRECTORY
"""

import bz2
import json
import lzma
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet as parquet

CODE = ["--scheme", "sf", "--threshold", "0.05", "--columns", "gyro_x,gyro_y,gyro_z"]


def run(spikewire, *words):
    return subprocess.run([spikewire, *map(str, words)], check=True, capture_output=True, text=True).stdout


def write(directory, recording):
    """The recording in every format: the path of each, and what reads it."""
    table = pd.read_csv(recording)
    at = directory.joinpath
    for packing in ("none", "snappy", "lz4", "gzip"):
        table.to_parquet(at(f"{packing}.parquet"), compression=packing, index=False)
        yield at(f"{packing}.parquet"), []
    table.to_json(at("lines.jsonl"), orient="records", lines=True, double_precision=15)
    if pd.read_json(at("lines.jsonl"), lines=True, precise_float=True).equals(table):
        yield at("lines.jsonl"), []
    nested = ({"time_us": row.pop("time_us"), "gyro": {own: row[f"gyro_{own}"] for own in "xyz"}} for row in table.to_dict("records"))
    at("nested.json").write_text("".join(json.dumps(own) + "\n" for own in nested))
    yield at("nested.json"), ["--columns", "gyro.x,gyro.y,gyro.z"]
    np.save(at("fields.npy"), table.to_records(index=False))
    yield at("fields.npy"), []
    np.save(at("swapped.npy"), table.to_records(index=False).astype([(own, ">f8") for own in table.columns]))
    yield at("swapped.npy"), []
    np.save(at("plain.npy"), np.ascontiguousarray(table.to_numpy()))
    np.save(at("turned.npy"), np.asfortranarray(table.to_numpy()))
    places = [str(1 + table.columns.get_loc(f"gyro_{own}")) for own in "xyz"]
    time = ["--time", str(1 + table.columns.get_loc("time_us")), "--time-unit", "us"]
    for name in ("plain.npy", "turned.npy"):
        yield at(name), ["--columns", ",".join(places), *time]
    np.savez(at("arrays.npz"), **{own: table[own].to_numpy() for own in table.columns})
    yield at("arrays.npz"), []
    np.savez_compressed(at("packed.npz"), time_us=table.time_us.to_numpy(), gyro=table[["gyro_x", "gyro_y", "gyro_z"]].to_numpy())
    yield at("packed.npz"), ["--columns", "gyro[0],gyro[1],gyro[2]"]
    text = table.to_csv(index=False)
    at("table.csv.bz2").write_bytes(bz2.compress(text[:9999].encode()) + bz2.compress(text[9999:].encode()))
    yield at("table.csv.bz2"), []
    at("table.csv.xz").write_bytes(lzma.compress(text[:9999].encode()) + lzma.compress(text[9999:].encode(), preset=9))
    yield at("table.csv.xz"), []
    at("aligned.txt").write_text(table.to_string(index=False, float_format=lambda own: repr(float(own))))
    yield at("aligned.txt"), []
    table.to_csv(at("bare.csv"), index=False, header=False)
    yield at("bare.csv"), ["--columns", ",".join(places), *time]


def below(text):
    """The spikes, without the header that names the columns."""
    return [line for line in text.splitlines() if not line.startswith("# column=")]


def main():
    spikewire, recording, directory = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    shutil.rmtree(directory, ignore_errors=True)
    directory.mkdir(parents=True)
    told = below(run(spikewire, "encode", *CODE, recording))
    assert len(told) > 1000
    for path, options in write(directory, recording):
        code = CODE[:-2] + options if "--columns" in options else CODE + options
        assert below(run(spikewire, "encode", *code, path)) == told, path
        print(f"{path.name}: {len(told)} lines of spikes agree")
    run(spikewire, "dataset", *CODE, recording, "-o", directory / "dataset")
    row = pd.read_json(directory / "dataset/manifest.jsonl", lines=True).iloc[0]
    events = parquet.read_table(directory / "dataset" / row.events).to_pandas()
    spikes = pd.DataFrame([line.split(",") for line in told if line[0].isdigit()], columns=["index", "channel", "polarity", "time_us"])
    assert (events == spikes.astype(events.dtypes)).all(axis=None) and len(events) == sum(row.spikes)
    values = parquet.read_table(directory / "dataset" / row["values"]).to_pandas()
    table = pd.read_csv(recording)
    assert values.equals(table[values.columns])
    print(f"the data set: {len(events)} spikes and {values.size} values agree")


if __name__ == "__main__":
    main()
