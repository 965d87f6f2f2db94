#!/usr/bin/env python3
"""Compares the waiting times and narrow access paths that `check` reports with simulated waiting times.

`run.py STOCHC FOLDER` makes 20 runs of each program (some minutes on one core), and writes a row of the table in
docs/validation/proofs-executed.md for each. Existing runs of the folder are not repeated.
"""
import csv
import math
import pathlib
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
EXAMPLES = ["five_tower", "line", "open_platform", "closed_platform", "five_tower_reconfigured"]
PROGRAMS = [HERE.parent.parent / f"examples/{name}.sa" for name in EXAMPLES] + sorted(HERE.glob("*.sa"))


def ranks(values):
    """Returns the rank of each value. Equal values share their mean rank."""
    return [sum(other < value for other in values) + (values.count(value) - 1) / 2 for value in values]


def spearman(a, b):
    a, b = ranks(a), ranks(b)
    mean_a, mean_b = sum(a) / len(a), sum(b) / len(b)
    both = sum((x - mean_a) * (y - mean_b) for x, y in zip(a, b))
    squares = sum((x - mean_a) ** 2 for x in a) * sum((y - mean_b) ** 2 for y in b)
    return both / math.sqrt(squares) if squares else math.nan


def row(stochc, program, where):
    def run(*command):
        return subprocess.run([stochc, *map(str, command)], capture_output=True, text=True, check=True)

    folder = where / program.stem
    options = ["--runs", 20, "--seed", 7, "--model", "rigid", "--threads", 1, "--max-ticks", 150000, "--out", folder]
    run("simulate", program, *options)
    run("report", folder, "--out", where / f"{program.stem}.html")
    checked = run("check", program, "--cost=1000")
    # `A.up -> B   8.1 %   621`: share of the time, and waiting time.
    found = re.findall(r"^  (\S.*? -> \S.*?)\s\s+[\d.]+ %\s+(\d+)$", checked.stdout, re.MULTILINE)
    expected = {name: int(wait) for name, wait in found}
    narrow = set(re.findall(r"`([^`]+)`: \d of 5", checked.stderr))
    with open(where / f"{program.stem}-figures/waits.csv") as file:
        waits = {line["capture"]: float(line["wait"]) for line in csv.DictReader(file)}
    names = [name for name in waits if name in expected]
    correlation = spearman([expected[name] for name in names], [waits[name] for name in names])
    longest = max(names, key=waits.get)

    def means(names):
        """Returns the measured and the expected mean."""
        both = [[of[name] for name in names] for of in (waits, expected)]
        return " | ".join(f"{sum(values) / len(values):.0f}" if values else "" for values in both)

    ways = [means([name for name in names if (name.split(" -> ")[1] in narrow) == is_narrow]) for is_narrow in (True, False)]
    return f"| {program.stem} | {correlation:.2f} | `{longest}` | {ways[0]} | {ways[1]} |"


def main():
    stochc, where = sys.argv[1], pathlib.Path(sys.argv[2])
    print("| program | rank correlation | longest mean wait | narrow ways in | expected | others | expected |")
    print("|---|--:|---|--:|--:|--:|--:|")
    for program in PROGRAMS:
        print(row(stochc, program, where), flush=True)


main()
