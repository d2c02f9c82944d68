#!/usr/bin/env python3
"""Runs a study of the belt's twin on a Dask cluster, one task a sample.

A task is `corehbot-lab sweep STUDY.toml --sample I`, which prints a line with a check in it. The lines are kept in the
journal of the result, as `corehbot-lab sweep STUDY.toml -o OUT.csv` keeps its own, and that command makes the table of
them: the same bytes, whichever of the computers computed a sample, if all have one build and one kind of machine.
"""

import argparse
import fcntl
import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

import cloudpickle
from distributed import Client, LocalCluster, as_completed

# A task that fails (its worker has no memory left, a network drive is away) is tried so often again.
RETRIES = 3

# Workers need not have this file.
cloudpickle.register_pickle_by_value(sys.modules[__name__])


class StudyError(Exception):
    """What a user can do something about."""


def run(command, *words):
    """The standard output of `corehbot-lab sweep`."""
    try:
        done = subprocess.run([command, "sweep", *map(str, words)], capture_output=True, text=True)
    except OSError as error:
        raise StudyError(f"cannot run {command}: {error.strerror}") from error
    if done.returncode != 0:
        raise StudyError(done.stderr.strip() or f"{command} ended with status {done.returncode}")
    return done.stdout


def sample(command, study, number):
    """The task: the line of one sample."""
    return run(command, study, "--sample", number)


def entries(line):
    """What a line says, or None if it is cut or damaged: its last entry is a check of what stands before."""
    body, mark, rest = line.rpartition(',"check":"')
    if not mark or rest != hashlib.sha256(body.encode()).hexdigest()[:8] + '"}':
        return None
    return json.loads(line)


def number_of(line, plan):
    """The number of a line's sample, or None if it is no sample of this study."""
    said = entries(line)
    if not said or said["study"] != plan["study"] or "sample" not in said:
        return None
    return said["sample"]


class Journal:
    """The samples that are finished, a line each; nobody else writes while it is open, where files can be locked."""

    def __init__(self, path, head):
        self.plan = entries(head)
        self.file = open(path, "a+b")
        try:
            self.done = self.read(path, head)
        except BaseException:
            self.close()
            raise

    def read(self, path, head):
        """The numbers of the samples that are there; what was cut at the end is taken away."""
        try:
            fcntl.flock(self.file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise StudyError(f"{path}: another process computes these samples") from error
        except OSError as error:
            why = f"{path} cannot be locked ({error.strerror}); see to it that no other process computes these samples"
            print(f"study.py: {why}", file=sys.stderr)
        self.file.seek(0)
        text = self.file.read()
        whole = text.rfind(b"\n") + 1
        lines = text[:whole].decode(errors="replace").splitlines()
        if lines and lines[0] != head or not lines and not head.encode().startswith(text):
            raise StudyError(f"{path}: is no journal of this study; remove it, or name another output")
        self.file.truncate(whole)
        if not lines:
            self.write(head)
        return {number_of(line, self.plan) for line in lines[1:]} - {None}

    def write(self, line):
        self.file.write(line.encode() + b"\n")
        self.file.flush()

    def keep(self, line):
        """Keeps the line of a sample, which counts once however often it was computed."""
        number = number_of(line, self.plan)
        if number is None:
            raise StudyError("a worker computes another study: it has other files, another version of corehbot-lab, or is another kind of machine")
        if number not in self.done:
            self.write(line)
            self.done.add(number)

    def close(self):
        self.file.close()


def compute(client, command, study, output, told=lambda done, of: None):
    """Computes what is missing of a study, and writes its table."""
    study, output = Path(study).resolve(), Path(output)
    journal = Journal(f"{output}.journal", run(command, study, "--plan").strip())
    try:
        samples = journal.plan["samples"]
        missing = [i for i in range(samples) if i not in journal.done]
        # One task a sample: what a worker takes with it when it dies, the scheduler gives to another one.
        futures = client.map(lambda i: sample(command, study, i), missing, pure=False, retries=RETRIES)
        for future, line in as_completed(futures, with_results=True):
            journal.keep(line.strip())
            told(len(journal.done), samples)
            future.release()
        lost = set(range(samples)) - journal.done
        if lost:
            raise StudyError(f"{len(lost)} samples were lost, the first is {min(lost)}")
    finally:
        journal.close()
    # Nothing is left to be computed; the command holds every line to its check once more and makes the table.
    return run(command, study, "-o", output)


def to_parquet(table, path):
    """The same table as Parquet."""
    from pyarrow import csv, parquet

    text = csv.ConvertOptions(strings_can_be_null=True, quoted_strings_can_be_null=False)
    parquet.write_table(csv.read_csv(table, convert_options=text), path)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("study", help="STUDY.toml, at this path on every worker")
    parser.add_argument("-o", "--output", required=True, help="OUT.csv; its journal stands beside it until it is whole")
    parser.add_argument("--parquet", help="the same table as Parquet")
    parser.add_argument("--command", default="corehbot-lab", help="the corehbot-lab command, at this path on every worker")
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--scheduler", help="address of a Dask scheduler, as tcp://192.168.1.10:8786")
    where.add_argument("--workers", type=int, default=os.cpu_count(), help="without one: processes on this computer")
    return parser.parse_args()


def main():
    args = arguments()

    def told(done, of):
        if sys.stderr.isatty():
            print(f"\r{done}/{of} samples", end="\n" if done == of else "", file=sys.stderr, flush=True)

    def on(address):
        with Client(address) as client:
            print(compute(client, args.command, args.study, args.output, told), end="")
        if args.parquet:
            to_parquet(args.output, args.parquet)

    try:
        if args.scheduler:
            on(args.scheduler)
        else:
            # No page of figures: it would want a port.
            with LocalCluster(n_workers=args.workers, threads_per_worker=1, dashboard_address=None) as cluster:
                on(cluster)
    except StudyError as error:
        sys.exit(f"study.py: {error}")
    except KeyboardInterrupt:
        print(f"study.py: interrupted; {args.output}.journal keeps what is finished", file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    main()
