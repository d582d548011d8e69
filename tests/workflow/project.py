"""A small copy of the project with its own study and two figures of a few points."""

import os
import re
import shutil
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

ROOT = Path(__file__).parents[2]
TRACE = """\
import json, pathlib, sys
opened = set()


def hook(event, given):
    # what is read to find out whether something has changed makes no result
    frame = sys._getframe(1) if event == "open" else None
    asked = False
    while frame and not asked:
        asked = frame.f_code.co_filename.endswith("solver/sources.py")
        frame = frame.f_back
    if event == "open" and not asked:
        opened.add(str(given[0]))


sys.addaudithook(hook)
"""  # the head of a program that is told which files it opens, in ``opened``
PARTS = ("Snakefile", "config", "geometry", "profiles", "pyproject.toml", "solver", "workflow")
STUDY = """\
materials:
  nbr: {c10: 0.345083, c01: 0.083805}
  silicone: {c10: 0.028, c01: 0.018}
muscles:
  one:
    inner_diameter: 20
    wall_thickness: 2
    length: 60
    layer_depths: [0.3, 0.9]
    threads: 60
    lead: 144
    thread_stiffness: 315
    material: nbr
  soft: {base: one, material: silicone}
numerics:
  section: {cap_step: 2, growth: 2}
limits: {wall_time: 60, memory: 2000}
scenes:
  fig90:
    path: isobaric
    muscles: [one, soft]
    pressure: [0.2]
    contraction: [0, 0.05]
    models: [geometric, cylinder]
  fig91:
    path: isobaric
    muscles: [one]
    pressure: [0.2]
    contraction: [0, 0.05]
    models: [membrane, solid]
"""
FIGURE = '''\
"""Some points."""
import pandas as pd
from matplotlib.figure import Figure


def table(data):
    return pd.DataFrame([(model, held) for _, model, _, held, _, _ in data.solutions])


def draw(table):
    return Figure()
'''


def end(process):
    """End a run that has not ended, with all of its group; what has is let alone."""
    if process.poll() is None:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


class Project:
    """A copy of the project."""

    def __init__(self, folder):
        self.folder = folder
        folder.mkdir(parents=True)
        for part in PARTS:
            ignored = shutil.ignore_patterns("fig[0-9]*")  # what is compiled comes along
            source = ROOT / part
            if source.is_dir():
                shutil.copytree(source, folder / part, ignore=ignored)
            else:
                shutil.copy(source, folder / part)
        for name in ("fig90", "fig91"):
            self.write(f"workflow/figures/{name}.py", FIGURE)
        self.write("config/config.yaml", STUDY)

    def write(self, path, text):
        (self.folder / path).write_text(text)

    def read(self, path):
        return (self.folder / path).read_text()

    def copy(self, folder):
        """A project in the same state, as far as Snakemake can tell."""
        shutil.copytree(self.folder, folder)
        return Project.at(folder)

    @classmethod
    def at(cls, folder):
        """A project that was made before."""
        made = object.__new__(cls)
        made.folder = folder
        return made

    def results(self):
        """Bytes of all results that must be the same each time."""
        found = (p for p in (self.folder / "results").rglob("*") if p.is_file())
        names = {str(p.relative_to(self.folder / "results")): p for p in found}
        return {
            name: path.read_bytes()
            for name, path in names.items()
            if not name.startswith(("logs/", "cost/", "sources/closures"))
        }

    def clear(self):
        """As before the first run."""
        for name in ("results", ".snakemake"):
            shutil.rmtree(self.folder / name, ignore_errors=True)

    def start(self, *arguments, program=("snakemake", "--cores", "2"), path=None, **options):
        """A run; ``path`` comes first on PATH."""
        search = f"{path}:{os.environ['PATH']}" if path else os.environ["PATH"]
        return subprocess.Popen(
            [sys.executable, "-m", *program, *arguments],
            cwd=self.folder,
            env=os.environ | {"PATH": search},
            **options,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )

    def run(self, *arguments, **options):
        """Exit status and output."""
        process = self.start(*arguments, **options)
        try:
            output, _ = process.communicate(timeout=300)
        finally:
            end(process)
        return process.returncode, output

    def planned(self):
        """What would run, by the messages of the jobs: of a batch its cases and meshes."""
        status, output = self.run("--dry-run", "--quiet", "host")
        assert status == 0, output
        jobs = re.findall(r"^Job \d+: (.*)$", output, re.MULTILINE)
        assert jobs or "Nothing to be done" in output, output
        found = set()
        for job in jobs:
            verb, _, rest = job.partition(" ")
            if verb == "Solving":
                parts = (part.rpartition(" (")[0] for part in rest.split("; ")[1:])
                found |= {re.sub("^Solving the mesh of", "Meshing", f"Solving {p}") for p in parts}
            elif verb == "Drawing":
                found |= {f"Drawing {scene}" for scene in rest.split(", ")}
            elif verb != "All":
                found.add(job)
        return found

    def reasons(self):
        """What would be solved, meshed and drawn, and the sources that are the reason for it."""
        status, output = self.run("explain", program=("workflow",))
        assert status == 0, output
        verbs = {"solve": "Solving", "mesh": "Meshing", "draw": "Drawing"}
        lines = re.findall(r"^  (solve|mesh|draw) +(.*?): changed: (.*)$", output, re.MULTILINE)
        return {f"{verbs[verb]} {label}": set(why.split(", ")) for verb, label, why in lines}
