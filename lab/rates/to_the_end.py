#!/usr/bin/env python3
"""Compares runs of the rate model with physics for weak pulls. Runs continue to the end.

`to_the_end.py STOCHC FOLDER [RUNS]` makes RUNS runs (16) of ten programs with the model `rigid`, in the default scene with two
thirds of its pull and a separate seed each. It calibrates the scene and writes the table of docs/validation/rates.md. Existing
runs of the folder are not repeated.
"""
import json
import math
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
EXAMPLES = HERE.parent.parent / "examples"
SCENE = "scene weak from hemisphere { bond attract { pull 12 N within 20cm  align 0.803 N within 10cm  anchor centres 1mm tilt 26 deg } }\n"
# The order determines the seeds.
PROGRAMS = [EXAMPLES / name for name in ["line.sa", "closed_platform.sa", "open_platform.sa", "five_tower_reconfigured.sa"]] + [
    HERE / name for name in ["ring_of_posts.sa", "comb.sa", "hand_over.sa", "bridge.sa", "gallows.sa", "chimney.sa"]
]
FIRST_SEED, MAX_TICKS = 52016, 1_000_000


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode not in (0, 3):
        raise SystemExit(f"{command}: {done.stderr}")


def times(stochc, program, folder, *options):
    line = ["resume", folder] if folder.exists() else ["simulate", program, "--max-ticks", MAX_TICKS, "--allow", "warnings", "--out", folder, *options]
    run(stochc, *line, "--quiet")
    with open(folder / "journal.jsonl") as file:
        lines = (json.loads(line) for line in file)
        return [line["record"]["ticks"] for line in lines if "record" in line]


def main():
    stochc, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    runs = sys.argv[3] if len(sys.argv) > 3 else "16"
    folder.mkdir(parents=True, exist_ok=True)
    rates = folder / "weak.rates"
    print("| program | `rigid`, ticks | rate model | mean |\n|---|--:|--:|--:|")
    errors = []
    for place, source in enumerate(PROGRAMS):
        name = source.stem
        program = folder / f"{name}.sa"
        text = source.read_text().replace(f"assembly {name} {{", f"assembly {name} in weak {{")
        program.write_text(SCENE + text)
        if not rates.exists():
            run(stochc, "calibrate", program, "--out", rates, "--quiet", "--allow", "warnings")
        physics = times(stochc, program, folder / name, "--runs", runs, "--seed", FIRST_SEED + place)
        by_rates = times(stochc, program, folder / f"{name}-rate", "--model", "rate", "--runs", 2000, "--seed", 77, "--rates", rates)
        mean, expected = sum(physics) / len(physics), sum(by_rates) / len(by_rates)
        sd = math.sqrt(sum((ticks - mean) ** 2 for ticks in physics) / (len(physics) - 1))
        errors.append(expected / mean - 1)
        print(f"| {name} | {mean:.0f} ± {1.96 * sd / math.sqrt(len(physics)):.0f} | {expected:.0f} | {100 * errors[-1]:+.1f} % |", flush=True)
    sizes = [abs(error) for error in errors]
    print(f"\nThe error of the mean is {100 * sum(sizes) / len(sizes):.1f} % on average and {100 * max(sizes):.1f} % at most.")


main()
