#!/usr/bin/env python3
"""A study on two worker processes, one of which is killed in the middle: no sample is lost, none counts twice.

COREHBOT_LAB names the command.
"""

import contextlib
import csv
import errno
import io
import os
import signal
import stat
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path
from unittest import mock

from distributed import Client, LocalCluster

import study

LAB = str(Path(os.environ.get("COREHBOT_LAB", "corehbot-lab")).absolute())

SAMPLES = 24

STUDY = f"""
compute = ["stiffness", "run"]
method = "latin-hypercube"
samples = {SAMPLES}
seed = 5
[vary]
belt_EA_N = {{ from = 20000, to = 56000 }}
preload_N = {{ from = 30, to = 50 }}
[run]
file = "corner.gcode"
assume_homed = [100, 100, 0]
"""

# The command, which notes who begins what and takes its time, so that a worker that is killed has something to do.
NOTING = """#!/bin/sh
case "$*" in *--sample*) echo "$PPID $*" >> "{log}"; sleep 0.2;; esac
exec "{command}" "$@"
"""


class OnTwoWorkers(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.study = self.folder / "study.toml"
        self.study.write_text(STUDY)
        (self.folder / "corner.gcode").write_text("G1 X120 F9000\nG1 Y120\nM400\n")
        self.log = self.folder / "begun"
        self.command = self.folder / "noting"
        self.command.write_text(NOTING.format(log=self.log, command=LAB))
        self.command.chmod(self.command.stat().st_mode | stat.S_IXUSR)
        self.output = self.folder / "out.csv"
        self.journal = self.folder / "out.csv.journal"
        study.run(LAB, self.study, "-o", self.folder / "alone.csv")
        self.alone = (self.folder / "alone.csv").read_bytes()

    def begun(self):
        """The process that began each sample, and the sample's number."""
        words = [line.split() for line in self.log.read_text().splitlines()] if self.log.exists() else []
        return [(int(line[0]), int(line[-1])) for line in words]

    def test_a_worker_is_killed_in_the_middle(self):
        lines = []
        keep = study.Journal.keep

        def watched(journal, line):
            lines.append(line)
            keep(journal, line)

        study.Journal.keep = watched
        self.addCleanup(setattr, study.Journal, "keep", keep)
        failures = []

        def compute(client):
            try:
                study.compute(client, str(self.command), self.study, self.output)
            except Exception as failure:
                failures.append(failure)

        with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
            pids = client.run(os.getpid)
            self.assertEqual(len(set(pids.values())), 2)
            work = threading.Thread(target=compute, args=[client])
            work.start()
            while len(lines) < SAMPLES // 3 and work.is_alive():
                time.sleep(0.01)
            begun = len(self.begun())
            while len(self.begun()) == begun and work.is_alive():
                time.sleep(0.01)
            worker, _ = self.begun()[-1]
            self.assertIn(worker, pids.values())
            os.kill(worker, signal.SIGKILL)
            finished = len(lines)
            work.join()
        self.assertEqual(failures, [])
        self.assertLess(finished, SAMPLES, "it was killed too late to matter")
        # What the killed worker was at was begun again, and yet every sample was kept once.
        numbers = [number for _, number in self.begun()]
        self.assertGreater(len(numbers), SAMPLES)
        self.assertEqual(set(numbers), set(range(SAMPLES)))
        numbers = [study.entries(line)["sample"] for line in lines]
        self.assertEqual(sorted(numbers), list(range(SAMPLES)))
        self.assertEqual(self.output.read_bytes(), self.alone)
        with open(self.output, newline="") as table:
            self.assertEqual([int(row["sample"]) for row in csv.DictReader(table)], list(range(SAMPLES)))
        self.assertFalse(self.journal.exists())

    def test_the_script_goes_on_where_a_journal_was_cut_and_writes_parquet(self):
        plan = study.run(LAB, self.study, "--plan")
        lines = [study.sample(LAB, self.study, i) for i in (7, 3, 5)]
        self.journal.write_text(plan + "".join(lines) + lines[0] + lines[1][:40])
        parquet = self.folder / "out.parquet"
        script = [sys.executable, "-B", study.__file__, self.study, "-o", self.output, "--parquet", parquet]
        script += ["--command", self.command, "--workers", "2"]
        done = subprocess.run(script, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(self.begun()), SAMPLES - 3)
        self.assertEqual(self.output.read_bytes(), self.alone)
        from pyarrow.parquet import read_table

        columns = read_table(parquet).to_pydict()
        with open(self.output, newline="") as table:
            rows = list(csv.DictReader(table))
        self.assertEqual(columns["contour_max_mm"], [float(row["contour_max_mm"]) for row in rows])
        self.assertEqual(columns["machine"], ["corehbot"] * SAMPLES)

    def test_another_study_s_journal_and_a_second_process_are_refused(self):
        plan = study.run(LAB, self.study, "--plan").strip()
        with self.assertRaisesRegex(study.StudyError, "no journal of this study"):
            self.journal.write_text(plan.replace("24", "25") + "\n")
            study.Journal(self.journal, plan)
        self.journal.unlink()
        journal = study.Journal(self.journal, plan)
        self.addCleanup(journal.close)
        with self.assertRaisesRegex(study.StudyError, "another process"):
            study.Journal(self.journal, plan)
        self.study.write_text(STUDY.replace("seed = 5", "seed = 6"))
        with self.assertRaisesRegex(study.StudyError, "computes another study"):
            journal.keep(study.sample(LAB, self.study, 0).strip())

    def test_where_files_cannot_be_locked_it_is_said_and_gone_on(self):
        plan = study.run(LAB, self.study, "--plan").strip()
        said = io.StringIO()
        refused = OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))
        with mock.patch.object(study.fcntl, "flock", side_effect=refused), contextlib.redirect_stderr(said):
            journal = study.Journal(self.journal, plan)
        self.addCleanup(journal.close)
        self.assertIn("out.csv.journal cannot be locked", said.getvalue())
        self.assertEqual(self.journal.read_text(), plan + "\n")


if __name__ == "__main__":
    unittest.main()
