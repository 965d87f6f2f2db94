#!/usr/bin/env python3
"""How far off the means of the paper's programs are at few steps a tick: the table of docs/trade.md.

Every program runs at every number of steps, each with seeds of its own, so that samples are independent; the last column
of SETTINGS is the reference. What is in the folder already is not run again.
"""
import argparse
import json
import math
import pathlib
import subprocess

PROGRAMS = ["line", "open_platform", "closed_platform", "five_tower", "five_tower_reconfigured"]
SETTINGS = [("1/8", 150, 201), ("2/8", 150, 301), ("32", 100, 101)]


def measure(stochc, folder, program, steps, runs, seed):
    file = folder / f"{program}-{steps.replace('/', '_')}-{seed}.json"
    if not file.exists() or not file.stat().st_size:
        command = [stochc, "simulate", f"examples/{program}.sa", "--runs", str(runs), "--seed", str(seed),
                   "--substeps", steps, "--threads", "1", "--quiet", "--format", "json"]
        file.write_text(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    time = json.loads(file.read_text())["programs"][0]["time"]
    return time["mean"], time["half_width"], time["completed"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--stochc", default="target/release/stochc")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("results/steps"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    print("| program | " + " | ".join(f"`{steps}`, bias" for steps, *_ in SETTINGS[:-1])
          + f" | `{SETTINGS[-1][0]}`, ticks |")
    print("|---|" + "--:|" * len(SETTINGS))
    squares = {}
    for program in PROGRAMS:
        rows = [measure(options.stochc, options.out, program, *setting) for setting in SETTINGS]
        reference, half, n = rows[-1]
        cells = []
        for (steps, *_), (mean, own, count) in zip(SETTINGS, rows[:-1]):
            ratio = mean / reference
            width = ratio * math.hypot(own / mean, half / reference)
            squares.setdefault(steps, []).append((ratio - 1, width))
            cells.append(f"{100 * (ratio - 1):+.1f} ± {100 * width:.1f} % (n = {count})")
        print(f"| {program} | " + " | ".join(cells) + f" | {reference:.0f} ± {half:.0f} (n = {n}) |")
    means = []
    for found in squares.values():
        weight = sum(1 / width**2 for _, width in found)
        mean = sum(bias / width**2 for bias, width in found) / weight
        means.append(f"{100 * mean:+.1f} ± {100 / math.sqrt(weight):.1f} %")
    print("| all five, weighted | " + " | ".join(means) + " | |")


if __name__ == "__main__":
    main()
