#!/usr/bin/env python3
"""Runs commands of docs/validation/performance.md, and prints their output.

python3 lab/performance.py [SECTION...]    takes an hour; the comparisons need the packages that lab/peers/README.md lists
"""
import datetime
import os
import pathlib
import platform
import resource
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
STOCHC = "target/release/stochc"
LAB = "cargo run --quiet --release --locked --manifest-path lab/Cargo.toml --bin"
PEERS = f"{sys.executable} lab/peers/run.py --sizes 300"

COMMANDS = {
    "start-up": [f"{STOCHC} check examples/five_tower.sa", f"{STOCHC} simulate examples/five_tower.sa --runs 1 --model rate", "true"],
    "check": [f"{LAB} compile"],
    "language server": ["python3 lab/lsp/run.py"],
    "other engines": [PEERS, f"{PEERS} --kick 0.044"],
    "terms": ["python3 lab/terms/run.py"],
    "planar worlds": [f"python3 lab/planar/run.py {STOCHC}"],
    "growth": [f"{LAB} scaling"],
    "control": [f"{LAB} control"],
    "rate model": [
        f"{sys.executable} lab/peers/events.py",
        f"{STOCHC} simulate examples/line.sa --model rate --runs 100000 --quiet",
        f"{STOCHC} simulate examples/line.sa --model rate --runs 100000 --quiet --out {{folder}}/line",
    ],
    "ensembles": [f"{STOCHC} simulate examples/five_tower_reconfigured.sa --runs 24 --threads {it} --quiet" for it in (1, 2)],
}
REPEATED = {"start-up": 15}


def cpu():
    """Returns the CPU time of all finished child processes [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(section, command):
    """Runs a command. Returns its output, its CPU time and its wall-clock time [s], as medians if it is repeated."""
    times = []
    for _ in range(REPEATED.get(section, 1)):
        before, began = cpu(), time.monotonic()
        done = subprocess.run(command, shell=True, cwd=ROOT, stdout=subprocess.PIPE, text=True)
        times.append((cpu() - before, time.monotonic() - began))
        if done.returncode:
            sys.exit(f"`{command}` failed with status {done.returncode}")
    # The output of stochc itself says nothing about its speed.
    output = "" if command.startswith(STOCHC) else done.stdout
    return output, *map(statistics.median, zip(*times))


def machine():
    names = [line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")]
    rust = subprocess.run(["rustc", "--version"], capture_output=True, text=True).stdout.strip()
    stochc = subprocess.run([ROOT / STOCHC, "--version"], capture_output=True, text=True).stdout.strip()
    return f"{len(os.sched_getaffinity(0))} x {names[0] if names else platform.processor()}, {platform.release()}, {rust}, {stochc}"


def main():
    subprocess.run(["cargo", "build", "--release", "--locked", "--bin", "stochc"], cwd=ROOT, check=True)
    print(f"{datetime.date.today()}, {machine()}")
    with tempfile.TemporaryDirectory() as folder:
        for section in sys.argv[1:] or COMMANDS:
            print(f"\n## {section}")
            for command in COMMANDS[section]:
                output, used, elapsed = run(section, command.format(folder=folder))
                print(f"\n`{command}`: {used:.3f} s of CPU time, {elapsed:.3f} s\n\n{output}", flush=True)


if __name__ == "__main__":
    main()
