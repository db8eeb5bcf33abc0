# SPDX-License-Identifier: Apache-2.0
"""What tools/soak.sh runs: soak.py MORSEL MINUTES SEED FOLDER. See there."""
import json
import os
import pathlib
import random
import signal
import subprocess
import sys
import time

import random_scene

morsel, minutes, seed, folder = sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), pathlib.Path(sys.argv[4])
chance = random.Random(seed)
counts = {"scenes": 0, "commands": 0, "interrupted": 0, "killed": 0, "resumed": 0}
failures = []


def run(arguments, end=None, after=0.0, allowed=(0,)):
    """Runs the command, ends it by the signal `end` after so many seconds; returns (exit code, peak MiB)."""
    counts["commands"] += 1
    with open(folder / "stderr", "wb") as err:
        process = subprocess.Popen([morsel, *map(str, arguments)], cwd=folder, stdout=subprocess.DEVNULL, stderr=err)
        if end is not None:
            time.sleep(after)
            os.kill(process.pid, end)  # send_signal would wait for one that has ended, and wait4 then find none
        _, status, usage = os.wait4(process.pid, 0)
    process.returncode = code = os.waitstatus_to_exitcode(status)
    if code not in allowed:
        failures.append(f"exit code {code} of: morsel {' '.join(map(str, arguments))}\n" + (folder / "stderr").read_text(errors="replace"))
    return code, usage.ru_maxrss / 1024


def pixels(file):
    """What an EXR file has after its header, which has times in it."""
    data = (folder / file).read_bytes()
    at = 8
    while data[at]:
        at = data.index(0, data.index(0, at) + 1) + 1
        at += 4 + int.from_bytes(data[at:at + 4], "little")
    return data[int.from_bytes(data[at + 1:at + 9], "little"):]


def soak_scene(number):
    scene = random_scene.scene(seed * 1000003 + number)
    name = f"s{number}.json"
    (folder / name).write_text(json.dumps(scene))
    quiet = ["--quiet"]
    cache = ["cache", "build", name, *quiet, "-o", "s.topo"]
    # A build that is interrupted or killed, then one that is not.
    end = chance.choice([signal.SIGINT, signal.SIGKILL])
    code, _ = run(cache, end, chance.uniform(0.01, 0.4), allowed=(0, 130, -signal.SIGKILL, -signal.SIGINT))
    counts["interrupted" if end == signal.SIGINT else "killed"] += code != 0
    run(cache)
    run(["cache", "verify", "s.topo", name, *quiet])
    render = ["render", name, "--cache", "s.topo", "--no-png", *quiet]
    run([*render, "-o", "whole.exr"])
    # The same by way of interruptions.
    parts = [*render, "-o", "parts.exr", "--checkpoint", "s.checkpoint", "--checkpoint-interval", "0.02s", "--resume"]
    for _ in range(3):
        end = chance.choice([signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
        code, _ = run(parts, end, chance.uniform(0.02, 0.5), allowed=(0, 130, -signal.SIGKILL, -signal.SIGINT, -signal.SIGTERM))
        counts["killed" if end == signal.SIGKILL else "interrupted"] += code != 0
        counts["resumed"] += 1
    code, _ = run(parts)
    if code == 0 and pixels("whole.exr") != pixels("parts.exr"):
        failures.append(f"{name}: after interruptions the picture is another")
    for file in folder.glob("s.*"):
        file.unlink()


def growth(repeats):
    """MiB that a process that renders one scene after another grows by with each scene."""
    (folder / "fixed.json").write_text(json.dumps(random_scene.scene(1)))
    run(["cache", "build", "fixed.json", "--quiet"])
    (folder / "out").mkdir(exist_ok=True)
    names = []
    for i in range(repeats):
        copy = folder / f"fixed_{i}.json"
        copy.write_text((folder / "fixed.json").read_text())
        names.append(copy.name)
    first = run(["render", *names[:2], "--quiet", "-o", "out/"])[1]
    last = run(["render", *names, "--quiet", "-o", "out/"])[1]
    return first, last, (last - first) / (repeats - 2)


start, number = time.time(), 0
slope = growth(24)
while time.time() - start < minutes * 60 and len(failures) < 5:
    soak_scene(number)
    number += 1
    counts["scenes"] = number
for stray in folder.glob("s*.json"):
    stray.unlink()
print(f"{(time.time() - start) / 60:.1f} minutes, seed {seed}: " + ", ".join(f"{v} {k}" for k, v in counts.items()))
print(f"memory of one process: {slope[0]:.1f} MiB after 2 scenes, {slope[1]:.1f} after 24: {slope[2]:.3f} MiB a scene")
if slope[2] > 1.0:
    failures.append(f"memory grows by {slope[2]:.3f} MiB a scene")
for failure in failures:
    print("FAILED: " + failure)
sys.exit(1 if failures else 0)
