"""Runs a command and says what it cost: shared by the benchmark scripts."""
import os
import signal
import subprocess
import time


class Cost:
    """CPU and wall seconds, peak resident memory in MB; `failure` is None or one line."""

    def __init__(self, cpu, wall, megabytes, failure):
        self.cpu, self.wall, self.megabytes, self.failure = cpu, wall, megabytes, failure


def run(command, timeout=900, log=None):
    """Runs `command` (a list) to its end. Figures are the kernel's, for the process and the children it waited for."""
    start = time.monotonic()
    with open(log or os.devnull, "wb") as output:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=output, stderr=output,
                                   start_new_session=True)
        previous = signal.signal(signal.SIGALRM, lambda *_: os.killpg(process.pid, signal.SIGKILL))
        signal.alarm(timeout)
        try:
            _, status, usage = os.wait4(process.pid, 0)
        finally:
            signal.alarm(0)
            signal.signal(signal.SIGALRM, previous)
    wall = time.monotonic() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    failure = None
    if wall >= timeout:
        failure = f"stopped after {timeout} s"
    elif process.returncode:
        failure = f"failed (exit {process.returncode})"
    return Cost(usage.ru_utime + usage.ru_stime, wall, usage.ru_maxrss / 1024, failure)


def table(head, rows):
    """A markdown table whose columns line up in a terminal too: the first two columns left, numbers right."""
    cells = [head] + [[str(c) for c in row] for row in rows]
    widths = [max(len(row[i]) for row in cells) for i in range(len(head))]
    lines = []
    for number, row in enumerate(cells):
        lines.append("| " + " | ".join(c.ljust(w) if i < 2 else c.rjust(w)
                                       for i, (c, w) in enumerate(zip(row, widths))) + " |")
        if number == 0:
            lines.append("|" + "|".join("-" * (w + 2) if i < 2 else "-" * (w + 1) + ":"
                                        for i, w in enumerate(widths)) + "|")
    return "\n".join(lines)
