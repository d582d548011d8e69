"""A map as an FMU 2.0 in plain C: ``fmu.c`` with the tables, compiled where that can be.

Inputs are pressure and length, outputs force, volume, the derivatives of the force, and whether the
state is valid; all in SI units. Without a C compiler it holds the source alone, which simulators
that compile take.
"""

import platform
import shutil
import subprocess
import tempfile
import zipfile
from pathlib import Path

import numpy as np

from geometry.files import atomic_write
from solver.case import digest
from workflow.answers.maps.table import FORCE, PARTS, VOLUME, Map

SOURCE = Path(__file__).with_name("fmu.c")
DATA = ("workflow/answers/maps/fmu.c",)
NAME = "muscle"
PLATFORMS = {("Linux", "x86_64"): ("linux64", ".so"), ("Darwin", "x86_64"): ("darwin64", ".dylib")}
LONGEST = 120.0  # s, of compiling
THEN = (2000, 1, 1, 0, 0, 0)  # date of files in an archive: of the same map the same bytes
UNITS = {  # in SI base units
    "1": "",
    "N": 'kg="1" m="1" s="-2"',
    "N/Pa": 'm="2"',
    "N/m": 'kg="1" s="-2"',
    "Pa": 'kg="1" m="-1" s="-2"',
    "m": 'm="1"',
    "m3": 'm="3"',
}
VARIABLES = (  # name, unit, causality, what it is; in the order of fmu.c
    ("p", "Pa", "input", "pressure above that of the air around"),
    ("l", "m", "input", "length between the fittings"),
    ("F", "N", "output", "force, positive where the muscle pulls"),
    ("V", "m3", "output", "enclosed volume"),
    ("dF_dl", "N/m", "output", "derivative of the force by the length, at constant pressure"),
    ("dF_dp", "N/Pa", "output", "derivative of the force by the pressure, at constant length"),
    ("valid", "1", "output", "1 where the solver has found the states around, else 0"),
)


def write(made: Map, output: Path) -> bool:
    """Write it, whole or not at all; whether it holds a compiled library."""
    text = source(made)
    files = {"modelDescription.xml": description(made).encode(), f"sources/{NAME}.c": text.encode()}
    library = _compiled(text)
    if library is not None:
        folder, suffix = PLATFORMS[platform.system(), platform.machine()]
        files[f"binaries/{folder}/{NAME}{suffix}"] = library
    with atomic_write(output) as beside, zipfile.ZipFile(beside, "w") as archive:
        for name, content in files.items():
            entry = zipfile.ZipInfo(name, THEN)
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, content, zipfile.ZIP_DEFLATED)
    return library is not None


def source(made: Map) -> str:
    """The program with the tables of a map."""
    tables = _tables(made)
    guid = f'static const char *GUID = "{_guid(tables)}";'
    return SOURCE.read_text(encoding="utf-8").replace("/*TABLES*/", f"{guid}\n{tables}")


def _tables(made: Map) -> str:
    def numbers(values: np.ndarray) -> str:
        flat = [repr(float(value)) for value in np.ravel(values)]
        return ",\n".join(", ".join(flat[k : k + 4]) for k in range(0, len(flat), 4))

    def stacked(quantity: str) -> np.ndarray:
        return np.stack([made.tables[quantity + part] for part in PARTS], axis=-1)

    found = ", ".join(str(int(each)) for each in made.valid.ravel())
    return "\n".join(
        (
            f"enum {{ NP = {made.pressure.size}, NE = {made.contraction.size} }};",
            f"static const double LENGTH_AT_REST = {float(made.length)!r}; /* mm */",
            f"static const double P[NP] = {{{numbers(made.pressure)}}};",
            f"static const double E[NE] = {{{numbers(made.contraction)}}};",
            f"static const double FORCES[4*NP*NE] = {{{numbers(stacked(FORCE))}}};",
            f"static const double VOLUMES[4*NP*NE] = {{{numbers(stacked(VOLUME))}}};",
            f"static const unsigned char FOUND[NP*NE] = {{{found}}};",
        )
    )


def _guid(tables: str) -> str:
    """Of the tables: another map is another FMU."""
    return f"{digest(tables)}-muscle"


def description(made: Map) -> str:
    """Its modelDescription.xml."""
    starts = {"p": made.pressure[0] * 1e6, "l": made.length * 1e-3}
    units = "".join(
        f'<Unit name="{unit}"><BaseUnit {base}/></Unit>' for unit, base in UNITS.items()
    )
    variables = "\n".join(
        f'    <ScalarVariable name="{name}" valueReference="{k}" causality="{causality}" '
        f'variability="continuous" description="{said}"><Real unit="{unit}"'
        + (f' start="{float(starts[name])!r}"' if name in starts else "")
        + "/></ScalarVariable>"
        for k, (name, unit, causality, said) in enumerate(VARIABLES)
    )
    outputs = [k + 1 for k, each in enumerate(VARIABLES) if each[2] == "output"]
    listed = "".join(f'<Unknown index="{k}" dependencies="1 2"/>' for k in outputs)
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="{made.muscle}" guid="{_guid(_tables(made))}"
    description="Pneumatic muscle {made.muscle}, by {made.model}" license="MIT"
    generationTool="muscle map" variableNamingConvention="flat" numberOfEventIndicators="0">
  <CoSimulation modelIdentifier="{NAME}" canHandleVariableCommunicationStepSize="true">
    <SourceFiles><File name="{NAME}.c"/></SourceFiles>
  </CoSimulation>
  <UnitDefinitions>{units}</UnitDefinitions>
  <LogCategories>
    <Category name="outside" description="states that the table has not"/>
  </LogCategories>
  <ModelVariables>
{variables}
  </ModelVariables>
  <ModelStructure>
    <Outputs>{listed}</Outputs>
    <InitialUnknowns>{listed}</InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""


def _compiled(text: str) -> bytes | None:
    """The shared library; None without a compiler, or for a platform that is not known here."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None or (platform.system(), platform.machine()) not in PLATFORMS:
        return None
    with tempfile.TemporaryDirectory() as folder:
        program, library = Path(folder, f"{NAME}.c"), Path(folder, NAME)
        program.write_text(text)
        words = [compiler, "-std=c99", "-O1", "-shared", "-fPIC", program.name, "-o", library.name]
        try:
            done = subprocess.run(
                words, cwd=folder, capture_output=True, timeout=LONGEST, check=False
            )
        except (OSError, subprocess.TimeoutExpired):
            return None
        return library.read_bytes() if done.returncode == 0 else None
