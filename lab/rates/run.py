#!/usr/bin/env python3
"""Compares runs of the rate model with runs with physics, for programs that no calibration used, in the default scene and in others.

`run.py STOCHC FOLDER [RUNS [SEED]]` makes RUNS runs (200) of each program of this folder with the model `rigid`, and of some of
them in five other scenes. It writes the tables of docs/validation/rates.md (with the seed 9101). Existing runs of the folder
are not repeated.
"""
import itertools
import json
import math
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
SCENES = {
    "half": ("half as many blocks", "free 150 uniform"),
    "double": ("twice as many blocks", "free 600 uniform"),
    "calm": ("random impulses of three quarters", "agitation kicks { speed 0 .. 0.6 m/s }"),
    "weak": ("a pull of two thirds", "bond attract { pull 12 N within 20cm  align 0.803 N within 10cm  anchor centres 1mm tilt 26 deg }"),
    "small": ("a radius of 4 m", "enclosure hemisphere { radius 4m  wall 250 N/m }"),
}
ELSEWHERE = ["bridge", "chimney", "gallows", "hand_over", "ring_of_posts", "comb"]
RATE_SEED, RATE_RUNS, MAX_TICKS = 77, 2000, 100000


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode not in (0, 3):
        raise SystemExit(f"{command}: {done.stderr}")


def records(folder):
    with open(folder / "journal.jsonl") as file:
        lines = (json.loads(line) for line in file)
        return [line["record"] for line in lines if "record" in line]


def simulate(stochc, program, folder, *options):
    line = ["resume", folder] if folder.exists() else ["simulate", program, "--max-ticks", MAX_TICKS, "--out", folder, *options]
    run(stochc, *line, "--quiet")
    return records(folder)


class Times:
    def __init__(self, runs):
        values = sorted(run["ticks"] for run in runs)
        n = len(values)
        self.values, self.n, self.mean = values, n, sum(values) / n
        self.sd = math.sqrt(sum((value - self.mean) ** 2 for value in values) / (n - 1))
        self.half = 1.96 * self.sd / math.sqrt(n)
        self.median, self.p90 = values[n // 2], values[min(n - 1, int(0.9 * n))]
        self.stopped = sum(run["outcome"]["kind"] != "completed" for run in runs)


def ranks(values):
    return [sum(other < value for other in values) + (values.count(value) - 1) / 2 for value in values]


def correlation(a, b):
    mean_a, mean_b = sum(a) / len(a), sum(b) / len(b)
    both = sum((x - mean_a) * (y - mean_b) for x, y in zip(a, b))
    squares = sum((x - mean_a) ** 2 for x in a) * sum((y - mean_b) ** 2 for y in b)
    return both / math.sqrt(squares) if squares else math.nan


def waits(runs):
    sums = {}
    for record in runs:
        for bond in record["bonds"]:
            key = (bond["phase"], bond["parent"], bond["face"], bond["child"])
            total, n = sums.get(key, (0, 0))
            sums[key] = (total + bond["docked"] - bond["magnetized"], n + 1)
    return {key: total / n for key, (total, n) in sums.items()}


def rank_correlation(some, others):
    """Returns the rank correlation of the mean waiting times of captures."""
    both = [key for key in some if key in others]
    return correlation(ranks([some[key] for key in both]), ranks([others[key] for key in both])) if len(both) > 2 else math.nan


def reachable(runs, size):
    """Returns the agreement of `size` runs of a model with its other runs, an upper limit for any prediction."""
    pieces = [slice(start, start + size) for start in range(0, len(runs) - size + 1, size)]
    found = [rank_correlation(waits(runs[piece]), waits(runs[: piece.start] + runs[piece.stop :])) for piece in pieces]
    return sum(found) / len(found)


def compare(rows):
    """Prints a table of programs with a summary."""
    print("| program | `rigid`, ticks | rate model | mean | median | 90 % | rank correlation of waiting times | best possible |\n|---|--:|--:|--:|--:|--:|--:|--:|")
    errors, pairs = [], []
    for name, (physics, physics_runs), (rate, rate_runs) in rows:
        rank = rank_correlation(waits(physics_runs), waits(rate_runs))
        off = [rate.mean / physics.mean - 1, rate.median / physics.median - 1, rate.p90 / physics.p90 - 1]
        errors.append(off)
        pairs.append((physics, rate))
        shown = " | ".join(f"{100 * value:+.1f} %" for value in off)
        print(f"| {name} | {physics.mean:.0f} ± {physics.half:.0f} | {rate.mean:.0f} | {shown} | {rank:.2f} | {reachable(rate_runs, len(physics_runs)):.2f} |", flush=True)
    print("\n| error of the | average size | largest size | average with sign |\n|---|--:|--:|--:|")
    for place, what in enumerate(["mean", "median", "90 % quantile"]):
        size = [abs(error[place]) for error in errors]
        print(f"| {what} | {100 * sum(size) / len(size):.1f} % | {100 * max(size):.1f} % | "
              f"{100 * sum(error[place] for error in errors) / len(errors):+.1f} % |")
    means = [(a.mean, b.mean) for a, b in pairs]
    apart = right = 0
    for (a, x), (b, y) in itertools.combinations(pairs, 2):
        if abs(a.mean - b.mean) > 1.96 * math.hypot(a.sd / math.sqrt(a.n), b.sd / math.sqrt(b.n)):
            apart += 1
            right += (a.mean < b.mean) == (x.mean < y.mean)
    print(f"\nThe rank correlation of the means is {correlation(ranks([a for a, _ in means]), ranks([b for _, b in means])):.3f}. "
          f"{apart} pairs of programs differ significantly. The rate model predicts the correct order for {right} of these pairs.")


def main():
    stochc, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    runs = sys.argv[3] if len(sys.argv) > 3 else "200"
    seed = sys.argv[4] if len(sys.argv) > 4 else "9101"
    folder.mkdir(parents=True, exist_ok=True)

    def both(program, name, rates):
        physics = simulate(stochc, program, folder / name, "--runs", runs, "--seed", seed)
        by_rates = simulate(stochc, program, folder / f"{name}-rate", "--model", "rate", "--runs", RATE_RUNS, "--seed", RATE_SEED, *rates)
        return (Times(physics), physics), (Times(by_rates), by_rates)

    print("\nthe default scene\n")
    compare([(program.stem, *both(program, program.stem, [])) for program in sorted(HERE.glob("*.sa"))])
    for name, (what, clause) in SCENES.items():
        print(f"\n{what}\n")
        rates = folder / f"{name}.rates"
        rows = []
        for stem in ELSEWHERE:
            text = (HERE / f"{stem}.sa").read_text().replace(f"assembly {stem} {{", f"assembly {stem} in {name} {{")
            program = folder / f"{name}-{stem}.sa"
            program.write_text(f"scene {name} from hemisphere {{ {clause} }}\n{text}")
            if not rates.exists():
                run(stochc, "calibrate", program, "--out", rates, "--quiet")
            rows.append((stem, *both(program, program.stem, ["--rates", rates])))
        compare(rows)


main()
