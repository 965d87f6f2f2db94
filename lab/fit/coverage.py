#!/usr/bin/env python3
"""Measures how often the 95 % intervals of `stochc fit` contain the true value if runs were stopped, for docs/validation/physics.md.

`coverage.py STOCHC TRIALS LIMIT [RUNS]` makes TRIALS measurements of RUNS runs (100) of each program of `examples/fit/small.sa` with
20 free blocks, stops the runs at LIMIT ticks, and fits `free`. Each measurement and each fit has its own seed.
With the LIMIT `mixed`, half of the runs are stopped at 250 ticks and half at 500.
With `--waits` at the end, the fit uses the waiting times of the stopped runs instead of their completion times. LIMIT must then be a number.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

PROGRAMS = pathlib.Path(__file__).resolve().parents[2] / "examples/fit/small.sa"
TRUTH = 20


def simulated(stochc, folder, seed, runs, *options):
    """Returns the results folder of a simulated measurement."""
    truth = folder / "truth.sa"
    truth.write_text(PROGRAMS.read_text().replace("free 8 ", f"free {TRUTH} "))
    out = folder / "measured"
    simulate = [stochc, "simulate", truth, "--runs", str(runs), "--seed", str(seed), "--out", out, "-q", *options]
    done = subprocess.run(simulate, capture_output=True, text=True)
    # The exit status of stopped runs is 3.
    assert done.returncode in (0, 3), done.stderr
    return out


def measured(stochc, folder, seed, runs, limit):
    """Returns the table of a measurement."""
    out = simulated(stochc, folder, seed, runs)
    rows = ["program,ticks,stopped"]
    for line in (out / "journal.jsonl").read_text().splitlines()[1:]:
        line = json.loads(line)
        ticks, number = line["record"]["ticks"], line["record"]["run"]
        end = (250, 500)[number % 2] if limit == "mixed" else int(limit)
        stopped = "true" if ticks > end else "false"
        rows.append(f"{('one', 'two')[line['program']]},{min(ticks, end)},{stopped}")
    return "\n".join(rows) + "\n"


def main():
    words = [word for word in sys.argv[1:] if word != "--waits"]
    stochc, trials, limit = words[0], int(words[1]), words[2]
    runs = int(words[3]) if len(words) > 3 else 100
    if "--waits" in sys.argv and limit == "mixed":
        raise SystemExit("--waits needs a number of ticks as LIMIT")
    held, widths = 0, []
    for trial in range(trials):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            if "--waits" in sys.argv:
                data = simulated(stochc, folder, 10_000 + trial, runs, "--max-ticks", limit)
            else:
                data = folder / "times.csv"
                data.write_text(measured(stochc, folder, 10_000 + trial, runs, limit))
            fit = [stochc, "fit", PROGRAMS, "--data", data, "--vary", "free=8..60 log", "--seed", str(trial), "-q", "--json"]
            number = json.loads(subprocess.run(fit, check=True, capture_output=True, text=True).stdout)["numbers"][0]
            low, high = number["interval"]
            held += low <= TRUTH <= high
            widths.append(high - low)
            print(f"{trial}: {number['median']:.0f} ({low:.1f} .. {high:.1f})", flush=True)
    print(f"{held} of {trials} hold {TRUTH}; mean width {sum(widths) / trials:.1f}")


main()
