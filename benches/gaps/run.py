#!/usr/bin/env python3
"""How long a block takes to come into a gap one cell wide: a table of docs/rates.md.

`run.py STOCHC FOLDER [RUNS]` makes RUNS runs (200) of each program below with the model `rigid`, in the default scene and some of them in other
scenes with a fifth of the runs, and writes a row for each: what the last capture waits for its block, and what rates say of that (2000 runs). Runs
are stopped after 20,000 ticks. Runs that the folder has already are not made again.
"""
import json
import math
import pathlib
import subprocess
import sys

POSTS = "A.up ->> T[1..3]   B.up ->> U[1..3]"
# What it is, what stands before, and the capture: A west, B east, N north and S south of M.
PLACES = {
    "arm": ("at the end of an arm", "A.up ->> T[1..3]", "T[3].east -> X"),
    "beam": ("between the face and a block ahead", POSTS, "T[3].east -> X"),
    "floor": ("the same, with a block below", f"{POSTS}   M.up ->> F[1..2]", "T[3].east -> X"),
    "corner": ("the same, with blocks below and beside", f"{POSTS}   M.up ->> F[1..2]   N.up ->> V[1..3]", "T[3].east -> X"),
    "roof": ("upwards, a block ahead and one beside", "A.up ->> T[1..3].east -> R   M.up -> F", "F.up -> X"),
    "channel": ("the same, between two walls", "A.up ->> T[1..3].east -> R   M.up -> F   B.up ->> U[1..2]", "F.up -> X"),
    "slot": ("upwards, between two walls", "A.up ->> T[1..2]   B.up ->> U[1..2]", "M.up -> X"),
    "three": ("upwards, between three walls", "A.up -> T[1]   B.up -> U[1]   N.up -> V[1]", "M.up -> X"),
    "pit": ("upwards, between four walls", "A.up -> T[1]   B.up -> U[1]   N.up -> V[1]   S.up -> W[1]", "M.up -> X"),
}
SEEDS = {"A": (0, 1), "B": (2, 1), "M": (1, 1), "N": (1, 2), "S": (1, 0)}
ELSEWHERE = [(scene, place) for scene in ("hemisphere_soft", "hemisphere_2005") for place in ("arm", "beam")]
SEED, RATE_SEED, RATE_RUNS, MAX_TICKS = 9402, 77, 2000, 20_000


def program(name, scene):
    """A program that builds what stands before in one phase, and makes the capture in another."""
    _, before, capture = PLACES[name]
    seeds = "   ".join(f"{seed} at {at}" for seed, at in SEEDS.items() if f"{seed}.up" in before + capture)
    return f"""assembly {name} in {scene} {{
    seed plate 3 x 3 {{ {seeds} }}
    phase before {{ {before} }}
    phase into {{ {capture} }}
}}
"""


def waits(stochc, path, folder, *options):
    """The waits of the last capture, sorted, and the runs that were stopped."""
    if not folder.exists():
        command = [stochc, "simulate", path, *options, "--max-ticks", MAX_TICKS, "--out", folder, "--quiet"]
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
        if done.returncode not in (0, 3):
            raise SystemExit(done.stderr)
    found, stopped = [], 0
    for line in (folder / "journal.jsonl").read_text().splitlines():
        record = json.loads(line).get("record")
        if record and record["outcome"]["kind"] == "completed":
            found.append(record["bonds"][-1]["docked"] - record["bonds"][-1]["magnetized"])
        elif record:
            stopped += 1
    return sorted(found), stopped


def told(found, stopped):
    """Mean with half of its interval, 90 % quantile and maximum; of runs that were stopped, only how many."""
    if stopped:
        return f"{stopped} of {stopped + len(found)} stopped | | "
    mean = sum(found) / len(found)
    deviation = math.sqrt(sum((wait - mean) ** 2 for wait in found) / (len(found) - 1))
    half = 1.96 * deviation / math.sqrt(len(found))
    return f"{mean:.0f} ± {half:.0f} | {found[9 * len(found) // 10]} | {found[-1]}"


def main():
    stochc, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    runs = int(sys.argv[3]) if len(sys.argv) > 3 else 200
    folder.mkdir(parents=True, exist_ok=True)
    print("| scene | the cell | mean wait | 90 % | longest | by rates | `check` |")
    print("|---|---|--:|--:|--:|--:|---|")
    for scene, name in [("hemisphere", name) for name in PLACES] + ELSEWHERE:
        path = folder / f"{name}_{scene}.sa"
        path.write_text(program(name, scene))
        count = runs if scene == "hemisphere" else max(runs // 5, 2)
        simulated = waits(stochc, path, path.with_suffix(""), "--runs", count, "--seed", SEED, "--model", "rigid")
        by_rates = "not known"
        if scene == "hemisphere":
            rates, _ = waits(stochc, path, folder / f"{name}_rate", "--runs", RATE_RUNS, "--seed", RATE_SEED, "--model", "rate")
            by_rates = f"{sum(rates) / len(rates):.0f}"
        check = subprocess.run([stochc, "check", path, "--format", "json"], capture_output=True, text=True)
        is_tight = "`X` comes in through" in check.stdout + check.stderr
        print(f"| {scene} | {PLACES[name][0]} | {told(*simulated)} | {by_rates} | {'warns' if is_tight else 'is content'} |", flush=True)


main()
