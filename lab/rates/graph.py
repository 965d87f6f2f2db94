#!/usr/bin/env python3
"""Measures the deviation of `stochc estimate` without runs from runs of the rate model, by the random choices of a program.

`graph.py STOCHC [RUNS]` estimates the programs of this folder, of races/, releases/, scarce/ and examples/ in both ways, with
RUNS runs (6000) and a separate seed each. It writes the table of docs/validation/rates.md.
"""
import json
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
EXAMPLES = ["line", "open_platform", "closed_platform", "five_tower", "five_tower_reconfigured"]


def estimate(stochc, program, *options):
    command = [stochc, "estimate", program, "--json", "--quiet", "--threads", 1, *options]
    return json.loads(subprocess.run(list(map(str, command)), capture_output=True, text=True, check=True).stdout)["estimates"][0]


def main(stochc, runs=6000):
    others = [program for folder in ("races", "releases", "scarce") for program in sorted((HERE / folder).glob("*.sa"))]
    examples = [HERE.parent.parent / "examples" / f"{name}.sa" for name in EXAMPLES]
    rows = {}
    for seed, program in enumerate(sorted(HERE.glob("*.sa")) + others + examples, 77):
        drawn, run = estimate(stochc, program), estimate(stochc, program, "--runs", runs, "--seed", seed)
        off = {name: drawn["total"][name] / run["total"][name] - 1 for name in ("mean", "p10", "median", "p90")}
        chance = (drawn["total"]["half_width"] ** 2 + run["total"]["half_width"] ** 2) ** 0.5 / run["total"]["mean"]
        rows.setdefault(drawn["method"]["interaction"], []).append((drawn["program"], off, chance))
        print(program.stem, drawn["method"]["interaction"], {name: f"{value:+.1%}" for name, value in off.items()}, f"{chance:.1%}", file=sys.stderr)
    print("| captures | programs | mean off by, at most | 10 % | median | 90 % | chance, ± |\n|---|--:|--:|--:|--:|--:|--:|")
    for kind in ("apart", "releases", "racing"):
        found = rows.get(kind, [])
        worst = {name: max((abs(off[name]) for _, off, _ in found), default=0) for name in ("mean", "p10", "median", "p90")}
        cells = " | ".join(f"{100 * value:.1f} %" for value in worst.values())
        print(f"| {kind} | {len(found)} | {cells} | {100 * max((it[2] for it in found), default=0):.1f} % |")


main(*sys.argv[1:])
