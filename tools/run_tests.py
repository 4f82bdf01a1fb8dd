#!/usr/bin/env python3
"""run_tests.py FOLDER [CTEST OPTION ...]: ctest, with the twenty slowest tests before its summary."""
import re
import subprocess
import sys

SLOWEST = 20
PASSED_LINE = re.compile(r"^\d+% tests passed")
TEST_LINE = re.compile(r"^\s*\d+/\d+ Test\s+#\d+: (.*?) \.*\**\s*(?:Passed|Failed|Skipped|\*\*\*.*?)\s+([\d.]+) sec")


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
    print("".join(summary), end="", flush=True)
    return code


if __name__ == "__main__":
    sys.exit(main())
