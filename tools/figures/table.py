#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Table 1 in Markdown. Usage: table.py L=COMPARISON.json..., of `morsel cache compare --engine certified,morse --json`."""
import json
import pathlib
import sys

PAPER = {"1": (214, 304, 58), "2": (1006, 1585, 182), "3": (8408, 4567, 418)}
print("| L | maxima | 2-saddles | components, certified | components, Morse | seconds | the paper: maxima | 2-saddles | components |")
print("|---" * 9 + "|")
for argument in sys.argv[1:]:
    layers, _, file = argument.partition("=")
    rows = {row["engine"]: row for row in json.loads(pathlib.Path(file).read_text())}
    certified, morse = rows["certified"], rows["morse"]
    if not certified["certified"] or morse["unresolved_boxes"] or morse["lost_ascents"]:
        sys.exit(f"table.py: {file}: something is undecided")
    if certified["components"] != morse["components"]:
        sys.exit(f"table.py: {file}: the engines disagree: {certified['components']} and {morse['components']} components")
    print("| " + " | ".join(map(str, (layers, morse["maxima"], morse["saddles2"], certified["components"], morse["components"],
                                      f"{certified['seconds'] + morse['seconds']:.1f}", *PAPER[layers]))) + " |")
