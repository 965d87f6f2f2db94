#!/usr/bin/env python3
"""Measures the places of jams: the tables of docs/validation/rates.md on gaps and on adjacent faces.

`run.py STOCHC FOLDER gaps|faces [RUNS]` makes RUNS runs (200 for gaps, 1000 for faces) of each program below with the model
`rigid` in the default scene, and a fifth or a tenth of that in other scenes. A row of the table lists the duration of the
captures of the last phase, from the first open face to the last capture, and the prediction of the rate model (2000 runs).
Runs are stopped after 20,000 ticks and count with that time. Existing runs of the folder are not repeated.
"""
import json
import math
import pathlib
import re
import subprocess
import sys

POSTS = "A.up ->> T[1..3]   B.up ->> U[1..3]"
# Description, structure that is built first, and captures. A is west, B east, N north and S south of M.
GAPS = {
    "arm": ("at the end of an arm", "A.up ->> T[1..3]", "T[3].east -> X"),
    "beam": ("between the face and a block ahead", POSTS, "T[3].east -> X"),
    "ground": ("the same, on the plate", "A.up -> T   B.up -> U", "T.east -> X"),
    "floor": ("in a beam, with a block below", f"{POSTS}   M.up ->> F[1..2]", "T[3].east -> X"),
    "corner": ("the same, with blocks below and next to it", f"{POSTS}   M.up ->> F[1..2]   N.up ->> V[1..3]", "T[3].east -> X"),
    "roof": ("upwards, a block ahead and one next to it", "A.up ->> T[1..3].east -> R   M.up -> F", "F.up -> X"),
    "channel": ("the same, between two walls", "A.up ->> T[1..3].east -> R   M.up -> F   B.up ->> U[1..2]", "F.up -> X"),
    "slot": ("upwards, between two walls", "A.up ->> T[1..2]   B.up ->> U[1..2]", "M.up -> X"),
    "three": ("upwards, between three walls", "A.up -> T[1]   B.up -> U[1]   N.up -> V[1]", "M.up -> X"),
    "pit": ("upwards, between four walls", "A.up -> T[1]   B.up -> U[1]   N.up -> V[1]   S.up -> W[1]", "M.up -> X"),
}
# D is west of N.
TOWERS = {seed: f"{seed}.up ->> {seed}T[1..2]" for seed in "AMND"}
FACES = {
    "one_low": ("one of the plate", "", "M.up -> X"),
    "two_low": ("two of the plate, side by side", "", "A.up -> X   M.up -> Y"),
    "row_low": ("three of the plate in a row", "", "A.up -> X   M.up -> Y   B.up -> Z"),
    "corner_low": ("two of the plate, across a corner around a block", "A.up -> F", "M.up -> X   D.up -> Y"),
    "three_low": ("three of a square on the plate", "", "A.up -> X   M.up -> Y   N.up -> Z"),
    "square_low": ("a square on the plate", "", "A.up -> X   M.up -> Y   N.up -> Z   D.up -> W"),
    "one": ("one on a tower", TOWERS["M"], "MT[2].up -> X"),
    "two": ("two on towers, side by side", f"{TOWERS['A']}   {TOWERS['M']}", "AT[2].up -> X   MT[2].up -> Y"),
    "corner": (
        "two on towers, across a corner around a block",
        f"A.up ->> AT[1..3]   {TOWERS['M']}   {TOWERS['D']}",
        "MT[2].up -> X   DT[2].up -> Y",
    ),
    "corner_side": (
        "the same, one of them sideways from the block",
        f"A.up ->> AT[1..3]   {TOWERS['D']}",
        "AT[3].east -> X   DT[2].up -> Y",
    ),
    "three": ("three of a square on towers", "   ".join(TOWERS[it] for it in "AMN"), "AT[2].up -> X   MT[2].up -> Y   NT[2].up -> Z"),
    "square": (
        "a square on towers",
        "   ".join(TOWERS.values()),
        "AT[2].up -> X   MT[2].up -> Y   NT[2].up -> Z   DT[2].up -> W",
    ),
}
# Each table: programs, number of runs, programs for other scenes, and the divisor of their number of runs.
TABLES = {
    "gaps": (GAPS, 200, ("arm", "beam"), 5),
    "faces": (FACES, 1000, ("one_low", "two_low", "one", "two", "corner", "corner_side", "three"), 10),
}
SEEDS = {"A": (0, 1), "B": (2, 1), "M": (1, 1), "N": (1, 2), "S": (1, 0), "D": (0, 2)}
SCENES = ("hemisphere_soft", "hemisphere_2005")
SEED, RATE_SEED, RATE_RUNS, MAX_TICKS, LONG = 9402, 77, 2000, 20_000, 6000


def program(name, scene, before, captures):
    """Returns a program that builds the first structure in one phase, and makes the captures in another."""
    seeds = "   ".join(f"{seed} at {at}" for seed, at in SEEDS.items() if re.search(rf"\b{seed}\.", f"{before} {captures}"))
    first = f"phase before {{ {before} }}" if before else ""
    return f"""assembly {name} in {scene} {{
    seed plate 3 x 3 {{ {seeds} }}
    {first}
    phase into {{ {captures} }}
}}
"""


def waits(stochc, path, folder, captures, *options):
    """Returns the sorted durations of the last captures, and the number of stopped runs."""
    if not folder.exists():
        command = [stochc, "simulate", path, *options, "--max-ticks", MAX_TICKS, "--out", folder, "--quiet"]
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
        if done.returncode not in (0, 3):
            raise SystemExit(done.stderr)
    found, stopped = [], 0
    for line in (folder / "journal.jsonl").read_text().splitlines():
        record = json.loads(line).get("record")
        if record and record["outcome"]["kind"] == "completed":
            last = sorted(record["bonds"], key=lambda bond: bond["magnetized"])[-captures:]
            found.append(max(bond["docked"] for bond in last) - min(bond["magnetized"] for bond in last))
        elif record:
            found.append(MAX_TICKS)
            stopped += 1
    return sorted(found), stopped


def told(found, stopped):
    """Returns a row: runs, mean ± half-width, 90 % quantile, slow runs, longest. Omits statistics of stopped runs."""
    count = len(found)
    over = sum(wait > LONG for wait in found)
    if stopped > count // 20:
        return f"{count} | {stopped} stopped | | {over} | "
    mean = sum(found) / count
    deviation = math.sqrt(sum((wait - mean) ** 2 for wait in found) / (count - 1))
    half = 1.96 * deviation / math.sqrt(count)
    longest = f"{stopped} stopped" if stopped else found[-1]
    return f"{count} | {mean:.0f} ± {half:.0f} | {found[9 * count // 10]} | {over} | {longest}"


def main():
    stochc, folder, table = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3]
    places, runs, elsewhere, part = TABLES[table]
    runs = int(sys.argv[4]) if len(sys.argv) > 4 else runs
    folder.mkdir(parents=True, exist_ok=True)
    print(f"| scene | {table} | runs | mean wait | 90 % | over {LONG} | longest | rate model | `check` reports |")
    print("|---|---|--:|--:|--:|--:|--:|--:|---|")
    for scene, name in [("hemisphere", name) for name in places] + [(scene, name) for scene in SCENES for name in elsewhere]:
        what, before, captures = places[name]
        path = folder / f"{name}_{scene}.sa"
        path.write_text(program(name, scene, before, captures))
        last = captures.count("->")
        count = runs if scene == "hemisphere" else max(runs // part, 2)
        simulated = waits(stochc, path, path.with_suffix(""), last, "--runs", count, "--seed", SEED, "--model", "rigid")
        by_rates = "not known"
        if scene == "hemisphere":
            options = ["--runs", RATE_RUNS, "--seed", RATE_SEED, "--model", "rate"]
            rates, _ = waits(stochc, path, folder / f"{name}_rate", last, *options)
            by_rates = f"{sum(rates) / len(rates):.0f}"
        print(f"| {scene} | {what} | {told(*simulated)} | {by_rates} | {warned(stochc, path)} |", flush=True)


def warned(stochc, path):
    """Returns the diagnostic codes that `check` reports for the last phase."""
    check = subprocess.run([stochc, "check", path, "--format", "short"], capture_output=True, text=True)
    last = [line for line in (check.stdout + check.stderr).splitlines() if "`into`" in line or "`X`" in line]
    codes = [f"`{code}`" for code in ("tight-approach", "crowded-captures") if any(code in line for line in last)]
    return ", ".join(codes) or "nothing"


main()
