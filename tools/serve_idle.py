"""Processor time and processes of `sunatlas serve` while nobody asks it anything.

`python -m tools.serve_idle [SECONDS]` starts the service on a free port, waits until it is ready
and 5 s more, reads /proc over SECONDS (60 by default), and prints both; the exit status is 1 where
the service takes 1 s of a processor a minute or more, or is more than one process.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

LIMIT_S_A_MINUTE = 1.0
SETTLING_S = 5.0


def processes(session: int) -> dict[int, float]:
    """Return the processor time of each live process of a session, in seconds, by its id."""
    found = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rpartition(")")[2].split()
        except (FileNotFoundError, ProcessLookupError):
            continue
        if int(fields[3]) == session and fields[0] != "Z":
            ticks = int(fields[11]) + int(fields[12])
            found[int(stat.parent.name)] = ticks / os.sysconf("SC_CLK_TCK")
    return found


def main() -> int:
    """Measure, print, and say whether the limits hold."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0
    started = time.perf_counter()
    command = (sys.executable, "-m", "api.cli.command_line", "serve", "--port", "0")
    with subprocess.Popen(command, stdout=subprocess.PIPE, start_new_session=True) as service:
        try:
            address = service.stdout.readline().split()[3].decode() if service.stdout else ""
            with urllib.request.urlopen(f"{address}/healthz", timeout=600) as answer:
                answer.read()  # connections wait until it is ready
            ready = time.perf_counter() - started
            time.sleep(SETTLING_S)
            before, counts = processes(service.pid), set()
            since = time.perf_counter()
            while time.perf_counter() - since < seconds:
                counts.add(len(processes(service.pid)))
                time.sleep(0.5)
            after, taken = processes(service.pid), time.perf_counter() - since
        finally:
            service.terminate()
    used = sum(after.values()) - sum(before.get(one, 0.0) for one in after)
    a_minute = used * 60.0 / taken
    loading = sum(before.values())
    sys.stdout.write(
        f"ready after {ready:.1f} s; {loading:.1f} s of a processor until {SETTLING_S:g} s later\n"
        f"idle for {taken:.0f} s: {used:.2f} s of a processor, {a_minute:.2f} s a minute "
        f"(limit {LIMIT_S_A_MINUTE:g}); {max(counts)} process(es)\n"
    )
    return 0 if a_minute < LIMIT_S_A_MINUTE and max(counts) == 1 else 1


if __name__ == "__main__":
    sys.exit(main())
