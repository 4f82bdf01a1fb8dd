#!/usr/bin/env python3
"""run_tests.py FOLDER [CTEST OPTION ...]: ctest, with the twenty slowest tests, and why cases were skipped, before
its summary. A test of several cases passes when some of them ran; the others are named here all the same."""
import re
import subprocess
import sys
from pathlib import Path

SLOWEST = 20
PASSED_LINE = re.compile(r"^\d+% tests passed")
TEST_LINE = re.compile(r"^\s*\d+/\d+ Test\s+#\d+: (.*?) \.*\**\s*(?:Passed|Failed|Skipped|\*\*\*.*?)\s+([\d.]+) sec")


def skipped(folder):
    """(test, reason) of every case that was skipped, as ctest's log has them. A reason ends with (in 'case') where
    the test has several cases."""
    log, test, found = Path(folder) / "Testing/Temporary/LastTest.log", "", []
    for line in log.read_text(errors="replace").splitlines() if log.exists() else []:
        title = re.match(r"\d+/\d+ Test: (.*)", line)
        if title:
            test = title[1]
        elif line.startswith("SKIPPED: "):
            reason = re.sub(r" \(in '(.*)'\)$", lambda case: "" if test.endswith(case[1]) else case[0], line)
            found.append((test, reason.removeprefix("SKIPPED: ")))
    return sorted(found)


def main():
    times, summary = [], []
    ctest = subprocess.Popen(["ctest", "--test-dir", *sys.argv[1:]], stdout=subprocess.PIPE, text=True,
                             errors="replace")
    for line in ctest.stdout:
        if summary or PASSED_LINE.match(line):
            summary.append(line)
            continue
        print(line, end="", flush=True)
        match = TEST_LINE.match(line)
        if match:
            times.append((float(match[2]), match[1].rstrip(" .")))
    code = ctest.wait()
    if len(times) > SLOWEST:
        print(f"The slowest {SLOWEST}, s:")
        for seconds, name in sorted(times, reverse=True)[:SLOWEST]:
            print(f"{seconds:8.1f}  {name}")
        print()
    reasons = skipped(sys.argv[1])
    if reasons:
        print("Skipped, and why:")
        for test, reason in reasons:
            print(f"  {test}: {reason}")
        print()
    print("".join(summary), end="", flush=True)
    return code


if __name__ == "__main__":
    sys.exit(main())
