#!/usr/bin/env python3
"""Measures the error of completion times with few steps per tick: the table of docs/validation/speed-and-accuracy.md.

The paper's five programs, and five others, run with every number of steps per tick. The reference uses 32 steps for all blocks.
Every program at every setting has its own seeds, so all samples are independent. Runs are made in rounds of all programs.
Existing samples of the file are not repeated, so the script can be stopped at any time and resumed. Samples of a file belong to
one contact law and one scene. Use a new file after a change of these.
"""
import argparse
import csv
import json
import math
import pathlib
import subprocess

PAPER = [f"examples/{name}.sa"
         for name in ["line", "open_platform", "closed_platform", "five_tower", "five_tower_reconfigured"]]
OTHERS = ["lab/rates/comb.sa", "lab/rates/ring_of_posts.sa", "lab/rates/sixteen.sa", "lab/rates/twins.sa",
          "examples/planned/five_towers.sa"]
# Steps per tick, and the number of runs in a round. Seeds depend on the position in this list.
SETTINGS = [("32", 50), ("1/8", 150), ("2/8", 150), ("1", 30), ("2", 30), ("4", 30), ("2/4", 150)]
REFERENCE = SETTINGS[0][0]


class Sample:
    """Summary of completion times: their number and mean, and the variance of the mean."""

    def __init__(self, parts):
        self.runs = sum(n for n, *_ in parts)
        self.mean = sum(n * mean for n, mean, _ in parts) / self.runs
        square = sum((n - 1) * sd**2 + n * (mean - self.mean) ** 2 for n, mean, sd in parts)
        self.variance = square / max(self.runs - 1, 1) / self.runs

    def half_width(self):
        return 1.96 * math.sqrt(self.variance)

    def bias(self, reference):
        """Returns the ratio of the means minus one, and the half-width of its 95 % interval."""
        ratio = self.mean / reference.mean
        width = ratio * math.hypot(self.half_width() / self.mean, reference.half_width() / reference.mean)
        return ratio - 1, width


def read(options):
    """Returns the existing samples by (program, steps, seed): runs, mean and standard deviation."""
    if not options.samples.exists():
        return {}
    with options.samples.open() as rows:
        return {(row["program"], row["steps"], int(row["seed"])): (int(row["runs"]), float(row["mean"]), float(row["sd"]))
                for row in csv.DictReader(rows)}


def simulate(options, program, steps, runs, number):
    place = [name for name, _ in SETTINGS].index(steps)
    seed = 100_000 * (place + 1) + 1000 * (PAPER + OTHERS).index(program) + number
    if (program, steps, seed) in read(options):
        return
    command = [options.stochc, "simulate", program, "--runs", str(runs), "--seed", str(seed), "--substeps", steps,
               "--threads", "1", "--quiet", "--json"]
    time = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["programs"][0]["time"]
    if time["incomplete"]:
        raise SystemExit(f"{program} at {steps}, seed {seed}: {time['incomplete']} runs were stopped before they completed")
    begins = not options.samples.exists()
    with options.samples.open("a") as rows:
        row = csv.writer(rows, lineterminator="\n")
        if begins:
            row.writerow(["program", "steps", "seed", "runs", "mean", "sd"])
        row.writerow([program, steps, seed, time["completed"], f"{time['mean']:.2f}", f"{time['sd']:.2f}"])


def show(options):
    parts = {}
    for (program, steps, _), part in read(options).items():
        parts.setdefault((program, steps), []).append(part)
    samples = {key: Sample(found) for key, found in parts.items()}
    settings = [steps for steps, _ in SETTINGS if steps != REFERENCE and any(key[1] == steps for key in samples)]

    def runs(steps):
        """Returns the smallest and the largest number of runs at a setting."""
        counts = [sample.runs for (_, other), sample in samples.items() if other == steps]
        return f"n = {min(counts)} to {max(counts)}"

    heads = [f"`{steps}` bias \\[%\\], {runs(steps)}" for steps in settings]
    heads.append(f"`{REFERENCE}` \\[ticks\\], {runs(REFERENCE)}")
    print("| program | " + " | ".join(heads) + " |")
    print("|---|" + "--:|" * len(heads))
    biases = {steps: [] for steps in settings}
    for program in PAPER + OTHERS:
        reference = samples.get((program, REFERENCE))
        if not reference:
            continue
        cells = []
        for steps in settings:
            sample = samples.get((program, steps))
            if not sample:
                cells.append("")
                continue
            bias, width = sample.bias(reference)
            biases[steps].append((bias, width))
            cells.append(f"{100 * bias:+.1f} ± {100 * width:.1f}")
        cells.append(f"{reference.mean:.0f} ± {reference.half_width():.0f}")
        print(f"| {pathlib.Path(program).stem} | " + " | ".join(cells) + " |")
    means = []
    for steps in settings:
        weight = sum(1 / width**2 for _, width in biases[steps])
        mean = sum(bias / width**2 for bias, width in biases[steps]) / weight
        means.append(f"{100 * mean:+.1f} ± {100 / math.sqrt(weight):.1f}")
    print("| all, weighted | " + " | ".join(means) + " | |")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--stochc", default="target/release/stochc")
    parser.add_argument("--samples", type=pathlib.Path, default=pathlib.Path(__file__).parent / "samples.csv")
    parser.add_argument("--settings", default="32,1/8,2/8", help="steps a tick, divided by commas")
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--show", action="store_true", help="print the table of the samples that are there, and run nothing")
    options = parser.parse_args()
    wanted = options.settings.split(",")
    for number in range(0 if options.show else options.rounds):
        for program in PAPER + OTHERS:
            for steps, runs in SETTINGS:
                if steps in wanted:
                    simulate(options, program, steps, runs, number)
    show(options)


if __name__ == "__main__":
    main()
