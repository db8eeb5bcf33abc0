#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The schema that `morsel scene schema` prints accepts every scene of the repository and refuses
what the loader refuses. Usage: check_schema.py MORSEL SCENES_FOLDER. Run by an interpreter without
jsonschema, it hands over to /usr/bin/python3, which has it with Debian's python3-jsonschema. Exits
77 (skipped) where that has none either."""
import copy
import json
import os
import pathlib
import subprocess
import sys

try:
    import jsonschema
except ImportError:
    other = "/usr/bin/python3"
    if sys.executable != other and os.access(other, os.X_OK) and "MORSEL_TRIED_PYTHON" not in os.environ:
        os.environ["MORSEL_TRIED_PYTHON"] = sys.executable
        os.execv(other, [other] + sys.argv)
    print("jsonschema is not installed (Debian: python3-jsonschema)")
    sys.exit(77)

morsel, scenes = sys.argv[1], pathlib.Path(sys.argv[2])
schema = json.loads(subprocess.run([morsel, "scene", "schema"], check=True, capture_output=True).stdout)
jsonschema.Draft7Validator.check_schema(schema)
validator = jsonschema.Draft7Validator(schema)

files = sorted(f for f in scenes.rglob("*.json") if ".cache" not in str(f))
assert len(files) > 10, files
failed = False
for file in files:
    for error in validator.iter_errors(json.loads(file.read_text())):
        print(f"{file}: {error.json_path}: {error.message}"[:400])
        failed = True

good = json.loads((scenes / "default.json").read_text())


def refused(change, what):
    bad = copy.deepcopy(good)
    change(bad)
    if validator.is_valid(bad):
        print(f"the schema accepts {what}")
        return True
    return False


rock = next(i for i, g in enumerate(good["geometries"]) if g["type"] == "hypertexture")
failed |= refused(lambda s: s.update(morsl=1), "an unknown key")
failed |= refused(lambda s: s.pop("morsel"), "a scene without its version")
failed |= refused(lambda s: s["camera"].update(vertical_fov=400), "an angle out of range")
failed |= refused(lambda s: s["camera"].update(vertical_fov="wide"), "a text for a number")
failed |= refused(lambda s: s["render"].update(filter="sinc"), "an unknown choice")
failed |= refused(lambda s: s["materials"][0].update(type="wood"), "an unknown material")
failed |= refused(lambda s: s["materials"][0].pop("name"), "a material without a name")
failed |= refused(lambda s: s["geometries"][rock].pop("field"), "a hypertexture without a field")
failed |= refused(lambda s: s["geometries"][rock]["field"]["density"].update(type="cube"), "an unknown density")
failed |= refused(lambda s: s["instances"][0].update(translate=[0, 1]), "a short vector")
failed |= refused(lambda s: s["lights"].append({"type": "sphere", "radius": -1}), "a negative radius")
print(f"{len(files)} scenes")
sys.exit(1 if failed else 0)
