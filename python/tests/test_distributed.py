"""Tests shards that run on a Dask cluster."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import pytest
from dask.distributed import Client, LocalCluster

import stochc


@pytest.mark.filterwarnings("ignore")
def test_two_workers_of_dask_make_the_pieces(tower: str, tmp_path: Path) -> None:
    folder = tmp_path / "cut"
    stochc.prepare(tower, folder, 4, runs=8, model="shuffle")
    with (
        LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        Client(cluster) as client,  # type: ignore[no-untyped-call, unused-ignore]
    ):
        pieces = client.map(lambda piece: stochc.shard(folder, piece, threads=1), range(4))  # pyright: ignore
        assert client.gather(pieces) == [2, 2, 2, 2]  # pyright: ignore
    whole = stochc.simulate(tower, runs=8, model="shuffle")
    assert stochc.merge(folder).results() == whole.results()


def test_processes_of_the_standard_library_make_the_pieces(tower: str, tmp_path: Path) -> None:
    folder = tmp_path / "cut"
    stochc.prepare(tower, folder, 3, runs=7, model="shuffle")
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        made = [pool.submit(stochc.shard, folder, piece) for piece in range(3)]
        assert sum(it.result() for it in made) == 7
    assert stochc.merge(folder).complete
