#!/usr/bin/env python3
"""Measures whether retries would shorten planned programs, for docs/decisions/language.md.

`retries.py STOCHC FOLDER MODEL RUNS` makes RUNS runs of each planned program with the model `rigid` or `rate`. The phase of a
program takes D ticks. With a timeout of T ticks and free retries, its mean time is E[min(D, T)] / P(D <= T). A row lists the
shortest mean time over all T that a tenth of the runs reach, divided by the mean of D. Existing plans and runs are kept.
"""
import json
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
EXAMPLES = ("chair", "five_towers")
SHAPES = "comb hollow_cube_with_door letter_a letter_o pyramid room_with_door stairs table vault well".split()
SEED, MAX_TICKS = 6302, 100_000


def command(*words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if done.returncode not in (0, 3):
        raise SystemExit(done.stderr)


def shortest(durations):
    """Returns the shortest mean time with retries, relative to the mean time without."""
    durations = sorted(durations)
    count, total, best = len(durations), 0, float("inf")
    for number, duration in enumerate(durations, 1):
        total += duration
        if number * 10 >= count:
            best = min(best, (total + (count - number) * duration) / number)
    return best * count / total


def main():
    stochc, folder, model, runs = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3], sys.argv[4]
    folder.mkdir(parents=True, exist_ok=True)
    programs = [HERE.parents[1] / "examples" / "planned" / f"{name}.sa" for name in EXAMPLES]
    for shape in SHAPES:
        programs.append(folder / f"{shape}.sa")
        if not programs[-1].exists():
            command(stochc, "plan", HERE / "shapes" / f"{shape}.txt", "--out", programs[-1], "--quiet")
    print("| program | runs | stopped | mean | slowest | with retries |\n|---|--:|--:|--:|--:|--:|")
    for program in programs:
        out = folder / f"{program.stem}_{model}"
        if not out.exists():
            options = ["--runs", runs, "--seed", SEED, "--model", model, "--max-ticks", MAX_TICKS]
            command(stochc, "simulate", program, *options, "--out", out, "--quiet")
        lines = (out / "journal.jsonl").read_text().splitlines()
        records = [record for line in lines if (record := json.loads(line).get("record"))]
        times = [record["ticks"] for record in records]
        stopped = sum(record["outcome"]["kind"] != "completed" for record in records)
        mean = sum(times) / len(times)
        print(f"| {program.stem} | {len(times)} | {stopped} | {mean:.0f} | {max(times)} | {shortest(times):.3f} |", flush=True)


main()
