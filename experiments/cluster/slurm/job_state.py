#!/usr/bin/env python3
"""Says to Snakemake how a job of Slurm is doing: running, success or failed. usage: job_state.py JOB

scontrol knows jobs for some minutes after their end, sacct for longer where accounting runs.
"""

import re
import subprocess
import sys

UNDER_WAY = {"PENDING", "CONFIGURING", "RUNNING", "COMPLETING", "SUSPENDED", "REQUEUED", "RESIZING", "STOPPED"}


def state_of(job):
    asked = subprocess.run(["scontrol", "show", "job", "--oneliner", job], capture_output=True, text=True, check=False)
    found = re.search(r"JobState=(\w+)", asked.stdout)
    if found:
        return found.group(1)
    asked = subprocess.run(["sacct", "--jobs", job, "--noheader", "--parsable2", "--allocations", "--format", "State"],
                           capture_output=True, text=True, check=False)
    return (asked.stdout.split() or [""])[0]


def main():
    state = state_of(sys.argv[1])
    if state == "COMPLETED":
        print("success")
    elif state in UNDER_WAY:
        print("running")
    else:  # a job that nobody knows any more is run again: what it has done stays
        print("failed")


if __name__ == "__main__":
    main()
