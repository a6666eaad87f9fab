"""How long does a long record take to read and cut, and how much memory?

`python -m benchmarks.records [--rows 10000000] [--json]`: a CSV file of so many rows with a push test every 7.5 s,
read and cut into releases in a process of its own.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from spear_pin.studies.laboratory import synthesize
from spear_pin.studies.push_test import WITH_MOTOR, spear_ii

MEASURED = """
import json, resource, sys, time
from spear_pin.studies.identification import Calibration, cut, read_record
begin = time.perf_counter()
record = read_record(sys.argv[1], calibration=Calibration(1.06, 0.4))
read = time.perf_counter()
releases = len(cut(record)[0])
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
times = {"read": read - begin, "cut": time.perf_counter() - read}
print(json.dumps(times | {"rows": record.t.size, "releases": releases, "megabytes": peak}))
"""


def write(path: Path, rows: int) -> None:
    """A synthetic push test of 20 releases, again and again."""
    made = synthesize(spear_ii(), WITH_MOTOR, repeats=20)
    with path.open("w", encoding="utf-8") as file:
        file.write("# SYNTHETIC\ntime_s,knee_V\n")
        for first in range(0, rows, made.t.size):
            count = min(made.t.size, rows - first)
            columns = np.column_stack([(first + np.arange(count)) / 1000.0, made.voltage[:count]])
            np.savetxt(file, columns, fmt=("%.3f", "%.5f"), delimiter=",")


def main() -> None:
    """Write, measure, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rows", type=int, default=10_000_000)
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "long.csv"
        write(path, arguments.rows)
        command = [sys.executable, "-c", MEASURED, str(path)]
        found = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    if arguments.json:
        print(json.dumps(found))
        return
    print(
        f"{found['rows']} rows: read in {found['read']:.1f} s, {found['releases']} releases cut in {found['cut']:.1f} s"
    )
    print(f"at most {found['megabytes']:.0f} MB")


if __name__ == "__main__":
    main()
