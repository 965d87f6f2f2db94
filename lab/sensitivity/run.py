#!/usr/bin/env python3
"""Measures which numbers of a scene matter, for the scenes of templates.

python3 lab/sensitivity/run.py STOCHC RUNS TEMPLATE...

Each number is set to 75 % and to 125 % of its value. An elasticity of -1 means that a number which is 1 % larger makes
completion 1 % faster. ± is the 95 % confidence interval. Prints the numbers of docs/guides/scene.md.
"""
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

STOCHC = str(pathlib.Path(sys.argv[1]).resolve())
RUNS = sys.argv[2]
LOWER, UPPER = 0.75, 1.25
NUMBERS = {
    "magnets": [
        "free=40", "fluid.viscosity=1 mPa s", "agitation.speed=10 cm/s", "agitation.length=5 cm",
        "contact.restitution=30%", "contact.friction=0.3", "bond.pull=20 mN", "bond.pull.within=2 cm",
        "bond.align=2 mN", "bond.align.within=1 cm", "bond.anchor=1 mm", "bond.anchor.tilt=26 deg",
        "enclosure.wall=20 N/m",
    ],
    "planar": [
        "block.mass=20 g", "free=40", "agitation.speed=3 cm/s", "drag.rate=0.5 Hz",
        "contact.restitution=50%", "contact.friction=0.1", "bond.pull=50 mN", "bond.pull.within=3 cm",
        "bond.align=5 mN", "bond.align.within=1.5 cm", "bond.anchor=1 mm", "bond.anchor.tilt=20 deg",
        "enclosure.wall=50 N/m",
    ],
    "suction": [
        "free=100", "fluid.viscosity=1.1 mPa s", "flow.rate=60 rev/min", "flow.follow=15%", "agitation.intensity=15%",
        "agitation.length=5 cm", "contact.restitution=30%", "contact.friction=0.3", "bond.head=200 Pa",
        "bond.opening=8 mm", "enclosure.wall=20 N/m",
    ],
}


def completion(program, number, value, folder):
    """Returns the mean completion time [ticks], its standard error, and the number of stopped runs."""
    setting = [] if number is None else ["--set", f"{number}={value}"]
    command = [STOCHC, "simulate", program, *setting, "--runs", RUNS, "--max-ticks", "20000", "--json", "--quiet"]
    made = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if made.returncode not in (0, 3):
        sys.exit(made.stderr)
    result = json.loads(made.stdout)["programs"][0]
    time = result["time"]
    return time["mean"], (time["sd"] or 0) / math.sqrt(int(RUNS)), result["censored"]


def elasticity(program, setting, folder):
    number, value = setting.split("=")
    amount, unit = re.fullmatch(r"([\d.]+)(.*)", value).groups()
    amounts = [float(amount) * factor for factor in (LOWER, UPPER)]
    if number == "free":
        amounts = [round(it) for it in amounts]
    (low, low_error, low_stopped), (high, high_error, high_stopped) = (
        completion(program, number, f"{it:g}{unit}", folder) for it in amounts
    )
    step = math.log(amounts[1] / amounts[0])
    error = 1.96 * math.hypot(low_error / low, high_error / high) / step
    stopped = f" ({low_stopped} and {high_stopped} stopped)" if low_stopped + high_stopped else ""
    return f"{math.log(high / low) / step:+.2f} ± {error:.2f}{stopped}"


def main():
    with tempfile.TemporaryDirectory() as folder:
        for template, numbers in ((it, NUMBERS[it]) for it in sys.argv[3:]):
            subprocess.run([STOCHC, "new", template, "--template", template, "--quiet"], cwd=folder, capture_output=True)
            mean, error, _ = completion(f"{template}.sa", None, None, folder)
            print(f"\n{template}: {mean:.0f} ± {1.96 * error:.0f} ticks\n\n| number | elasticity |\n|---|--:|", flush=True)
            for setting in numbers:
                print(f"| `{setting.split('=')[0]}` | {elasticity(f'{template}.sa', setting, folder)} |", flush=True)


if __name__ == "__main__":
    main()
