#!/usr/bin/env python3
"""Compares the optima of `stochc optimize` with the best point of a fine grid, for docs/validation/physics.md.

`study.py STOCHC PARAMETERS SEEDS` uses the assembly `two` of `examples/fit/small.sa`. PARAMETERS is 2 or 4. The five points of the grid with
the smallest means, and each optimum, are simulated 1,000 times with another seed.
"""
import itertools
import json
import pathlib
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2] / "examples/fit/small.sa"
RANGES = [
    ("agitation.speed", "0.1..1.2", "m/s", 8),
    ("bond.pull", "12..80", "N", 8),
    ("drag.rate", "0.3..6", "s^-1", 4),
    ("bond.pull.within", "20..60", "cm", 4),
]
LIMIT = ["--max-ticks", "3000", "--quiet"]


def stochc(command, *arguments):
    """Returns the output of a command. The status 3 means that runs were stopped."""
    done = subprocess.run([sys.argv[1], command, *arguments, *LIMIT], capture_output=True, text=True)
    assert done.returncode in (0, 3), done.stderr
    return done.stdout


def mean(program, point):
    """Returns the mean time of 1,000 runs at a point."""
    values = itertools.chain(*(("--set", f"{name}={value} {unit}") for (name, _, unit, _), value in zip(RANGES, point)))
    found = json.loads(stochc("simulate", program, *values, "--runs", "1000", "--seed", "77", "--json"))
    return found["programs"][0]["time"]["mean"]


def grid(program, folder, number):
    """Returns the mean of the best point of the grid."""
    counts = [count if number == 2 else 4 if i < 2 else count for i, (*_, count) in enumerate(RANGES[:number])]
    axes = [f"{name}={ends} {unit}/{count} log" for (name, ends, unit, _), count in zip(RANGES, counts)]
    # A sweep has at most 400 points, so each value of the last parameter has its own sweep.
    *axes, last = axes
    name, ends, unit, count = (*RANGES[number - 1][:3], counts[-1])
    low, high = map(float, ends.split(".."))
    points = []
    for step in range(count):
        value = float(f"{low * (high / low) ** (step / (count - 1)):.4g}")
        varied = itertools.chain(*(("--vary", axis) for axis in [*axes, f"{name}={value} {unit}"]))
        out = folder / f"grid-{step}"
        stochc("sweep", program, *varied, "--runs", "20", "--out", out)
        for point in json.loads((out / "sweep.json").read_text())["points"]:
            points.append((point["time"]["mean"], [it["value"] for it in point["values"]]))
    points.sort()
    best = min((mean(program, point), point) for _, point in points[:5])
    print(f"grid of {len(points)} points: best mean {best[0]:.1f} at {best[1]}", flush=True)
    return best[0]


def main():
    number, seeds = int(sys.argv[2]), int(sys.argv[3])
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        program = folder / "two.sa"
        text = SOURCE.read_text()
        program.write_text(text[: text.index("assembly one")] + text[text.index("assembly two") :])
        best = grid(program, folder, number)
        varied = itertools.chain(*(("--vary", f"{name}={ends} {unit} log") for name, ends, unit, _ in RANGES[:number]))
        varied = list(varied)
        for seed in range(1, seeds + 1):
            found = json.loads(stochc("optimize", program, *varied, "--confirm", "10", "--seed", str(seed), "--json"))["optima"][0]
            point = [it["value"] for it in found["numbers"]]
            at = mean(program, point)
            predicted = found["predicted"]
            inside = predicted["low"] <= at <= predicted["high"]
            print(
                f"seed {seed}: {found['runs']} runs, mean {at:.1f}, {at / best - 1:+.1%}, predicted "
                f"{predicted['low']:.0f} .. {predicted['high']:.0f} ({'contains' if inside else 'misses'} it), at {point}",
                flush=True,
            )


main()
