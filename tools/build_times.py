#!/usr/bin/env python3
"""build_times.py [FOLDER] [--count N] [--by object|module]: which objects took longest to build, from ninja's log.

FOLDER is a build folder with a .ninja_log (default: build/release). Times are wall seconds of the last time that each
target was built, while as many compilers ran as ninja starts at a time: what the compiler cache had counts as quick.

Examples:
  tools/build_times.py
  tools/build_times.py build/dev --count 40
  tools/build_times.py build/release --by module
"""
import argparse
import re
import sys
from pathlib import Path


def last_builds(log):
    """{target: seconds} of the newest entry of each target."""
    lines = log.read_text().splitlines()
    if not lines or not lines[0].startswith("# ninja log v"):
        sys.exit(f"build_times: {log} is no log of ninja")
    times = {}
    for line in lines[1:]:
        parts = line.split("\t")
        if len(parts) == 5:
            times[parts[3]] = (int(parts[1]) - int(parts[0])) / 1000
    return times


def module_of(target):
    """The CMake target whose object, library or program it is."""
    match = re.search(r"CMakeFiles/([^/]+)\.dir/", target)
    return match[1] if match else "(links and generated files)"


def main():
    parser = argparse.ArgumentParser(description="Which objects took longest to build, from ninja's log.",
                                     epilog="Example: tools/build_times.py build/dev --count 40")
    parser.add_argument("folder", nargs="?", type=Path, default=Path("build/release"), help="build folder (default: build/release)")
    parser.add_argument("--count", type=int, default=20, help="how many lines (default: 20)")
    parser.add_argument("--by", choices=["object", "module"], default="object", help="what is added up (default: object)")
    options = parser.parse_args()
    log = options.folder / ".ninja_log"
    if not log.exists():
        sys.exit(f"build_times: {log} is not there; build with ninja first (cmake --preset release)")
    times = last_builds(log)
    summed = {}
    for target, seconds in times.items():
        name = target if options.by == "object" else module_of(target)
        summed[name] = summed.get(name, 0) + seconds
    print(f"{sum(summed.values()):9.1f} s  all {len(times)} targets")
    for name, seconds in sorted(summed.items(), key=lambda entry: -entry[1])[:options.count]:
        print(f"{seconds:9.1f} s  {name}")


if __name__ == "__main__":
    main()
