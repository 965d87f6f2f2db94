#!/usr/bin/env python3
"""Measures how often the 95 % intervals of `stochc fit` contain the true value if runs were stopped, for docs/validation/physics.md.

`coverage.py STOCHC TRIALS LIMIT [RUNS]` makes TRIALS measurements of RUNS runs (100) of each program of `examples/fit/small.sa` with
20 free blocks, stops the runs at LIMIT ticks, and fits `free`. Each measurement and each fit has its own seed.
With the LIMIT `mixed`, half of the runs are stopped at 250 ticks and half at 500.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

PROGRAMS = pathlib.Path(__file__).resolve().parents[2] / "examples/fit/small.sa"
TRUTH = 20


def measured(stochc, folder, seed, runs, limit):
    """Returns the table of a measurement."""
    truth = folder / "truth.sa"
    truth.write_text(PROGRAMS.read_text().replace("free 8 ", f"free {TRUTH} "))
    out = folder / "measured"
    subprocess.run([stochc, "simulate", truth, "--runs", str(runs), "--seed", str(seed), "--out", out, "-q"], check=True, capture_output=True)
    rows = ["program,ticks,stopped"]
    for line in (out / "journal.jsonl").read_text().splitlines()[1:]:
        line = json.loads(line)
        ticks, number = line["record"]["ticks"], line["record"]["run"]
        end = (250, 500)[number % 2] if limit == "mixed" else int(limit)
        stopped = "true" if ticks > end else "false"
        rows.append(f"{('one', 'two')[line['program']]},{min(ticks, end)},{stopped}")
    return "\n".join(rows) + "\n"


def main():
    stochc, trials, limit = sys.argv[1], int(sys.argv[2]), sys.argv[3]
    runs = int(sys.argv[4]) if len(sys.argv) > 4 else 100
    held, widths = 0, []
    for trial in range(trials):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            data = folder / "times.csv"
            data.write_text(measured(stochc, folder, 10_000 + trial, runs, limit))
            fit = [stochc, "fit", PROGRAMS, "--data", data, "--vary", "free=8..60 log", "--seed", str(trial), "-q", "--json"]
            number = json.loads(subprocess.run(fit, check=True, capture_output=True, text=True).stdout)["numbers"][0]
            low, high = number["interval"]
            held += low <= TRUTH <= high
            widths.append(high - low)
            print(f"{trial}: {number['median']:.0f} ({low:.0f} .. {high:.0f})", flush=True)
    print(f"{held} of {trials} hold {TRUTH}; mean width {sum(widths) / trials:.1f}")


main()
