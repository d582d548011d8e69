"""Measured forces as people write them: read right, or refused with the reason in one line."""

import numpy as np
import pytest

from workflow.data import bench
from workflow.study.errors import StudyError

LENGTH = 200.0  # mm
TRUE = [  # MPa, 1, N
    (0.2, 0.0, 620.0),
    (0.2, 0.05, 410.5),
    (0.2, 0.1, 251.0),
    (0.4, 0.0, 1240.0),
    (0.4, 0.05, 900.5),
    (0.4, 0.1, 640.0),
]


def written(head: str, row, points=TRUE, end: str = "") -> str:
    return head + "".join(f"{row(*point)}\n" for point in points) + end


def comma(text: str) -> str:
    return text.replace(".", ",")


def crlf(text: str) -> str:
    return text.replace("\n", "\r\n")


def right(p, e, f):
    return f"{p:g},{e:g},{f:g}"


HEAD_OF_PROJECT = "pressure_MPa,contraction,force_N\n"
SERIES_TIME = np.arange(4000) * 0.01
FILES = {  # name: text or bytes
    "project": written("pressure_MPa,contraction,force_N\n", right),
    "semicolon, decimal comma": written(
        "Druck [bar];Kontraktion [%];Kraft [N]\n",
        lambda p, e, f: comma(f"{10 * p:.1f};{100 * e:.1f};{f:.1f}"),
    ),
    "tab, byte-order mark": "\ufeff"
    + written("p_kPa\tstroke_mm\tForce (N)\n", lambda p, e, f: f"{1e3 * p:g}\t{LENGTH * e:g}\t{f}"),
    "tab, decimal comma": written(
        "p_kPa\tlength_mm\tF/N\n",
        lambda p, e, f: comma(f"{1e3 * p:.2f}\t{LENGTH * (1 - e):.2f}\t{f:.2f}"),
    ),
    "units in a row, comments": written(
        "# bench 3, muscle A\n# 2024-05-01\nPressure,Contraction,Force\nbar,%,N\n",
        lambda p, e, f: f"{10 * p:g}, {100 * e:g}, {f:g}",
    ),
    "quotes": written(
        '"Pressure (psi)","Contraction (-)","Force (lbf)"\n',
        lambda p, e, f: f'"{p / 0.00689475729:.8f}","{e}","{f / 4.4482216153:.8f}"',
    ),
    "thousands": written(
        "Pressure [mbar];Length [mm];Force [N]\n",
        lambda p, e, f: f"{1e4 * p:,.1f};{LENGTH * (1 - e):g};{f:,.1f}",
    ),
    "thousands of Germans": written(
        "Druck in mbar;L\u00e4nge in mm;Kraft in N\n",
        lambda p, e, f: f"{1e4 * p:,.2f};{LENGTH * (1 - e):.2f};{f:,.2f}".translate(
            str.maketrans(",.", ".,")
        ),
    ),
    "thousands of the Swiss": written(
        "Druck in mbar;Hub in mm;Kraft in N\n",
        lambda p, e, f: f"{1e4 * p:,.1f};{LENGTH * e:g};{f:,.1f}".replace(",", "'"),
    ),
    "trailing separators, empty lines": written(
        "pressure_MPa;contraction_%;force_N;;\n\n",
        lambda p, e, f: f"{p};{100 * e:g};{f};;\n",
        end="\n;;;;\n",
    ),
    "kilonewtons, other columns": written(
        "No.;Time [s];Temperature [\u00b0C];Force [kN];Pressure [MPa];Contraction [%];Remark\n",
        lambda p, e, f: f"1;12:30:01;21,5;{f / 1e3:g};{p};{100 * e:g};ok".replace(".", ","),
    ),
    "windows line ends": crlf(written("pressure_MPa,contraction,force_N\n", right)),
    "spaces": written(
        "Pressure [bar]  Contraction [%]   Force [N]\n",
        lambda p, e, f: f"  {10 * p:<9g} {100 * e:<8g}   {f:g}",
    ),
    "a comment is the header": written(
        "# p[MPa] contraction[-] F[N]\n", lambda p, e, f: f"{p:.18e} {e:.18e} {f:.18e}"
    ),
    "the sign line of a spreadsheet": written(
        "sep=;\nPressure (bar(g));Shortening [mm];Axial force N\n",
        lambda p, e, f: f"{10 * p:g};{LENGTH * e:g};{f:g}",
    ),
    "lines about the specimen": written(
        "Specimen;A12\nOperator;M. M\u00fcller\nLength;200;mm\n\np [bar];\u03b5 [%];F [N]\n",
        lambda p, e, f: f"{10 * p:g};{100 * e:g};{f:g}",
    ),
    "not a number": written(
        "pressure_MPa,contraction,force_N\n", right, end="0.4,0.15,NaN\n0.4,,300\n"
    ),
    "suspect, slack": written(
        "pressure_MPa,length_mm,force_N,suspect\n",
        lambda p, e, f: f"{p},{LENGTH * (1 - e):g},{f},0",
        end="0.4,150,800,1\n0.2,150,0,\n",
    ),
    "units in cells": written(
        "Pressure;Contraction;Force\n", lambda p, e, f: f"{10 * p:g} bar;{100 * e:g} %;{f:g} N"
    ),
    "set and measured": written(
        "set pressure [bar];measured pressure [bar];contraction [%];force [N]\n",
        lambda p, e, f: f"{10 * p + 0.5:g};{10 * p:g};{100 * e:g};{f:g}",
    ),
    "strain": written(
        "pressure (kPa)|strain (%)|force (N)\n", lambda p, e, f: f"{1e3 * p:g}|{-100 * e:g}|{f:g}"
    ),
    "inches, pounds": written(
        "pressure psig,length in,load lbs\n",
        lambda p, e, f: (
            f"{p / 0.00689475729:.9g},{LENGTH * (1 - e) / 25.4:.9g},{f / 4.4482216153:.9g}"
        ),
    ),
    "minus signs of typesetters": written(
        "pressure_MPa;extension_mm;force_N\n",
        lambda p, e, f: f"{p};{-LENGTH * e:g};{f}".replace("-", "\u2212"),
    ),
    "a date, a temperature": written(
        "Datum;T [\u00b0C];p [bar];% contraction;F [N]\n",
        lambda p, e, f: "01.05.2024;21,5;" + comma(f"{10 * p:.1f};{100 * e:g};{f:g}"),
    ),
    "scatter": written(
        "Pressure (bar),Contraction rate [%],Force_kN_mean,Force std (kN)\n",
        lambda p, e, f: f"{10 * p:g},{100 * e:g},{f / 1e3:g},0.01",
    ),
    "kilograms, units in brackets in a row": written(
        "Load\tPressure\tPosition\n(kg)\t(bar)\t(mm)\n",
        lambda p, e, f: f"{f / 9.80665:.9g}\t{10 * p:g}\t{LENGTH * e:g}\t",
    ),
    "Portuguese": written(
        "Press\u00e3o (bar);Contra\u00e7\u00e3o (%);For\u00e7a (N)\n",
        lambda p, e, f: comma(f"{10 * p:g};{100 * e:g};{f}"),
    ),
    "French": written(
        "Pression [kPa];Course [mm];Effort [N]\n", lambda p, e, f: f"{1e3 * p:g};{LENGTH * e:g};{f}"
    ),
    "Polish": written(
        "Ci\u015bnienie [bar];Skok [mm];Si\u0142a [N]\n",
        lambda p, e, f: comma(f"{10 * p:g};{LENGTH * e:g};{f}"),
    ),
    "Japanese": written(
        "\u5727\u529b[MPa],\u53ce\u7e2e\u7387[%],\u5f35\u529b[N]\n",
        lambda p, e, f: f"{p},{100 * e:g},{f}",
    ),
    "names without gaps": written(
        "PressureBar,ContractionPercent,ForceN\n", lambda p, e, f: f"{10 * p:g},{100 * e:g},{f}"
    ),
    "words between": written(
        "pressure_MPa,contraction,force_N\n", right, TRUE[:3], "second run,,\n"
    )
    + written("pressure_MPa,contraction,force_N\n", right, TRUE[3:], "end of test\n"),
}

PAIRS = [(e, low, high) for (_, e, low), (_, _, high) in zip(TRUE[:3], TRUE[3:], strict=True)]


def table(head: str, row) -> str:
    """With a column for each of both pressures."""
    return head + "".join(f"{row(*each)}\n" for each in PAIRS)


FILES |= {
    "a column for each pressure": table(
        "contraction,0.2 MPa,0.4 MPa\n", lambda e, low, high: f"{e},{low},{high}"
    ),
    "forces at pressures": table(
        "Contraction (%);F at 2 bar;F at 4 bar\n",
        lambda e, low, high: comma(f"{100 * e:g};{low};{high}"),
    ),
    "pressures with a decimal comma, empty cells": table(
        "Hub [mm];0,2 MPa;0,4 MPa;0,6 MPa\n",
        lambda e, low, high: comma(f"{LENGTH * e:.1f};{low};{high};"),
    ),
    "columns for pressures, units in a row": table(
        "No.;Length;p = 200 kPa;p = 400 kPa;Remark\n;mm;kN;kN;\n",
        lambda e, low, high: f"1;{LENGTH * (1 - e):g};{low / 1e3:g};{high / 1e3:g};ok",
    ),
    "pressures above the names": table(
        "Pressure [bar];2;4\nContraction [%];Force [N];Force [N]\n",
        lambda e, low, high: f"{100 * e:g};{low};{high}",
    ),
    "pressures above pairs of columns": table(
        "2 bar;;4 bar\nh [%];F [N];h [%];F [N]\n",
        lambda e, low, high: f"{100 * e:g};{low};{100 * e:g};{high}",
    ),
    "a corner for both": table(
        "h [%] \\ p [bar]\t2\t4\n", lambda e, low, high: f"{100 * e:g}\t{low}\t{high}"
    ),
    "a column for each contraction": "Pressure [bar];0 %;5 %;10 %\n"
    "2;620;410.5;251\n4;1240;900.5;640\n",
    "one pressure in a name, and words below": "# A\nstroke_mm\tF_0.2MPa_N\tF_0.4MPa_N\n"
    "0\t620\t1240\n10\t410.5\t900.5\n20\t251\t640\nend of test\n",
    "an exported measurement": "LabVIEW Measurement\nSeparator\tTab\n***End_of_Header***\n\n"
    + written(
        "X_Value\tPressure (bar)\tForce (N)\tContraction (%)\tComment\n",
        lambda p, e, f: comma(f"1\t{10 * p:.3f}\t{f:.3f}\t{100 * e:.3f}"),
    ),
    "relative lengths": written(
        "Pressure [bar];L/L0 [-];Force [N]\n", lambda p, e, f: f"{10 * p:g};{1 - e:g};{f}"
    ),
    "a table of a text": written(
        "| pressure [bar] | contraction [%] | force [N] |\n|---|---|---|\n",
        lambda p, e, f: f"| {10 * p:g} | {100 * e:g} | {f} |",
    ),
    "old line ends": written(HEAD_OF_PROJECT, right).replace("\n", "\r"),
}


def read(tmp_path, text):
    path = tmp_path / "forces.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return bench.read(str(path), LENGTH)


@pytest.mark.parametrize("name", FILES)
def test_a_file_is_read_right(tmp_path, name):
    found = read(tmp_path, FILES[name])
    np.testing.assert_allclose(sorted(map(tuple, found.measured)), TRUE, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(sorted(map(tuple, found.points)), TRUE, rtol=1e-7, atol=1e-9)
    assert any("pressure: " in line for line in found.said)
    assert any(" of " in line and "points used" in line for line in found.said)


HEAD = "pressure_MPa,contraction,force_N\n"
REFUSED = {  # text, what the line says
    "contraction in percent": (
        written("pressure_MPa,contraction,force_N\n", lambda p, e, f: f"{p},{100 * e:g},{f}"),
        "0 to 10 under 'contraction'; perhaps %",
    ),
    "pushing": (written(HEAD, lambda p, e, f: f"{p},{e},{-f}"), "sign is the other"),
    "shortening negative": (
        written("p_MPa,stroke_mm,F_N\n", lambda p, e, f: f"{p},{-200 * e:g},{f}"),
        "sign is the other",
    ),
    "kPa under MPa": (
        written(HEAD, lambda p, e, f: f"{1e3 * p:g},{e},{f}"),
        "would be 400 MPa; perhaps they are in kPa, that is 0.4 MPa",
    ),
    "bar under MPa": (
        written(HEAD, lambda p, e, f: f"{10 * p:g},{e},{f}"),
        "would be 4 MPa; perhaps they are in bar, that is 0.4 MPa",
    ),
    "MPa under kPa": (
        written("p_kPa,contraction,F_N\n", lambda p, e, f: f"{p},{e},{f}"),
        "perhaps they are in MPa, that is 0.4 MPa",
    ),
    "no unit": (
        written("pressure,contraction,force\n", lambda p, e, f: f"{1e3 * p:g},{e},{f}"),
        "perhaps they are in kPa",
    ),
    "a header twice": ("force_N," + HEAD + "1,0.2,0,1\n", "2 columns are called 'force_N'"),
    "two decimal signs": (
        "p_bar;e_%;F_N\n2,0;0;620.5\n2,0;5;410.25\n",
        ":2: not all of it are numbers; '620.5' stands under 'F_N', and decimals follow a comma",
    ),
    "two forces": ("F [N],pressure_MPa,contraction,force_N\n1,0.2,0,1\n", "both 'F \\[N\\]' and"),
    "no header": ("0.2,0,620\n0.2,0.1,251\n", "no line above the numbers names the columns"),
    "unknown headers": ("a,b,c\n0.2,0,620\n0.2,0.1,251\n", "there are a, b, c"),
    "a column for each pressure, without a unit": (
        "contraction [%];0.2;0.4\n0;620;1240\n5;410;900\n",
        "forces.csv:1: numbers stand among the names of columns; in a table with a column for each",
    ),
    "a column for each pressure over time": (
        "time [s];2 bar;4 bar\n0;620;1240\n5;410;900\n",
        "these have their unit, as 1 bar, beside a column of contraction, stroke or length",
    ),
    "a column for each pressure, of another unit": (
        "contraction [%];200 MPa;400 MPa\n0;620;1240\n5;410;900\n",
        "would be 400 MPa; perhaps they are in kPa, that is 0.4 MPa",
    ),
    "decimal commas between columns for pressures": (
        "contraction [%],2 bar,4 bar\n0,620,5,1240,5\n5,410,900\n",
        "forces.csv:2: there are 5 values for 3 columns; are decimal commas",
    ),
    "relative lengths that are contractions": (
        "p [bar];L/L0;F [N]\n2;0;620\n2;0.1;251\n",
        "lengths of 0 to 0.1 of that at rest .* perhaps contractions",
    ),
    "no force": (
        "pressure_MPa,contraction,mass\n0.2,0,620\n",
        "the column force is missing; there are 'pressure_MPa', 'contraction', 'mass'",
    ),
    "no contraction": (
        "pressure_MPa,force_N\n0.2,620\n",
        "contraction, stroke or length is missing",
    ),
    "decimal commas between commas": (
        "p [bar],F [N],contraction\n2,0,620,5,0,1\n",
        "forces.csv:2: there are 6 values for 3 columns; are decimal commas",
    ),
    "thousands or decimals": (
        "p [bar];F [N];contraction [%]\n2;1,240;5\n",
        "1,240 may be 1.240 or 1240",
    ),
    "a word": (
        HEAD + "0.2,x,620\n",
        ":2: not all of it are numbers; 'x' stands under 'contraction'",
    ),
    "absolute pressure": (
        "p_abs [bar],contraction,F [N]\n3,0,620\n4,0,820\n",
        "is an absolute pressure",
    ),
    "an unknown unit": ("p [inHg],contraction,F [N]\n3,0,620\n", "unit 'inHg' of 'p \\[inHg\\]'"),
    "another unit in a cell": (
        "p [bar],contraction,F [N]\n3 kPa,0,620\n",
        ":2: '3 kPa' under 'p \\[bar\\]' has a unit that is not of this column",
    ),
    "another muscle": (
        written("p_MPa,length_mm,F_N\n", lambda p, e, f: f"{p},{300 * (1 - e):g},{f}"),
        "lengths of 270 to 300 mm .* are not of a muscle 200 mm long; perhaps of another muscle",
    ),
    "lengths in cm": (
        written("p_MPa,length_mm,F_N\n", lambda p, e, f: f"{p},{20 * (1 - e):g},{f}"),
        "not of a muscle 200 mm long; perhaps they are in cm",
    ),
    "strokes called lengths": (
        written("p_MPa,length_mm,F_N\n", lambda p, e, f: f"{p},{200 * e:g},{f}"),
        "perhaps strokes",
    ),
    "UTF-16": (written(HEAD, right).encode("utf-16"), "it is UTF-16"),
    "UTF-16 without a mark": (written(HEAD, right).encode("utf-16-le"), "it is UTF-16"),
    "Latin-1": (
        written("Druck [bar];\u00b0C;Kraft [N];Hub [mm]\n", lambda p, e, f: "2;20;1;0").encode(
            "latin-1"
        ),
        "forces.csv:1: .*no text in UTF-8; perhaps Latin-1, with '\u00b0'",
    ),
    "packed": (b"\x1f\x8b\x08\x00rest", "a file of a spreadsheet or an archive"),
    "a spreadsheet": (b"PK\x03\x04rest", "a file of a spreadsheet"),
    "empty": ("", "there is no force in it"),
    "a head of a table only": ("h [%] \\ p [bar],1,80,\n", "no line below the headers"),
    "words only": ("nothing\nhere\n", "no line has two numbers"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_looks_wrong_is_refused_in_a_line(tmp_path, name):
    text, said = REFUSED[name]
    with pytest.raises(StudyError, match=said) as caught:
        read(tmp_path, text)
    assert "\n" not in str(caught.value)
    assert "forces.csv" in str(caught.value)


def test_a_loop_in_a_table_with_a_column_for_each_pressure(tmp_path):
    """Rows go up and down again; what was written is named."""
    rows = [*PAIRS, *[(e, low - 20, high - 30) for e, low, high in PAIRS[-2::-1]]]
    text = "contraction [%];F at 2 bar;F at 4 bar\n"
    text += "".join(f"{100 * e:g};{low};{high}\n" for e, low, high in rows)
    found = read(tmp_path, text)
    assert len(found.measured) == 10
    assert found.loops == pytest.approx({0.2: 20, 0.4: 30})
    assert "forces in a column for each pressure" in found.said[0]


def test_noise_in_set_pressures(tmp_path):
    noise = [(0.3028, 0.0, 900), (0.3035, 0.05, 700), (0.3031, 0.1, 480), (0.5, 0.0, 1500)]
    found = read(tmp_path, written(HEAD, right, noise))
    np.testing.assert_allclose(found.pressures, [0.3, 0.5])
    np.testing.assert_allclose(found.measured[:, 0], [0.3028, 0.3035, 0.3031, 0.5])
    assert any("0.3 MPa, set at 0.3028 to 0.3035: 3 points" in line for line in found.said)


def test_a_loop_is_reported_and_halved(tmp_path):
    """Up and down, and points twice: all are used, the map is their mean."""
    at = np.array([0.0, 0.05, 0.1, 0.15, 0.2])
    way = [(0.3, e, 900 - 4000 * e) for e in at] + [
        (0.3, e, 900 - 4000 * e - 30) for e in at[-2::-1]
    ]
    found = read(tmp_path, written(HEAD, right, [*way, *way]))
    assert len(found.measured) == 18
    np.testing.assert_allclose(found.points[:, 1], at)
    np.testing.assert_allclose(found.force(at[:-1], 0.3), 885 - 4000 * at[:-1])
    assert found.loops[0.3] == pytest.approx(30)
    assert any("4 ways, up to 30 N apart, 3.3 % of its largest" in line for line in found.said)


def test_a_time_series_of_a_loop(tmp_path):
    """Noisy in everything; its two ways are found, and its mean within the noise."""
    rng = np.random.default_rng(3)
    e = 0.1 * (1 - np.cos(2 * np.pi * SERIES_TIME / 40))
    force = 900 - 4000 * e - 15 * np.sign(SERIES_TIME - 20)
    rows = np.column_stack(
        [
            SERIES_TIME,
            3 + 0.01 * rng.standard_normal(e.size),
            100 * e + 0.02 * rng.standard_normal(e.size),
            force + 2 * rng.standard_normal(e.size),
        ]
    )
    text = "Time [s];p_set [bar];p [bar];h [%];F [N]\n"
    text += "".join(f"{t:.2f};3.00;{p:.4f};{h:.4f};{f:.3f}\n" for t, p, h, f in rows)
    found = read(tmp_path, text)
    assert len(found.measured) == 4000
    np.testing.assert_allclose(found.pressures, [0.3])
    assert len(found.points) <= bench.GRID
    inside = np.linspace(0.01, 0.19, 10)
    np.testing.assert_allclose(found.force(inside, 0.3), 900 - 4000 * inside, atol=5)
    assert found.loops[0.3] == pytest.approx(30, abs=8)


def test_a_time_series_of_several_pressures(tmp_path):
    """Length up and down at each pressure, and ramps of the pressure between."""
    rng = np.random.default_rng(5)
    rows, last = [], 0.0
    for p in (1.0, 2.0, 4.0):
        rows += [(q, 0.0, 300 * q) for q in np.linspace(last, p, 15)]
        e = 0.08 * (1 - np.cos(np.linspace(0, 2 * np.pi, 300)))
        rows += [(p, x, 300 * p * (1 - 5 * x)) for x in e]
        last = p
    text = "t [s]\tp [bar]\tstroke [mm]\tF [N]\n"
    for k, (p, e, f) in enumerate(rows):
        noise = rng.standard_normal(3)
        text += f"{k / 10}\t{p + 0.01 * noise[0]:.4f}\t{200 * e + 0.02 * noise[1]:.3f}\t"
        text += f"{f + noise[2]:.2f}\n"
    found = read(tmp_path, text)
    np.testing.assert_allclose(found.pressures, [0.1, 0.2, 0.4])
    assert 900 <= len(found.measured) < 930
    np.testing.assert_allclose(found.force([0.05, 0.1], 0.2), [450, 300], atol=5)
    assert any("between set pressures, not used" in line for line in found.said)


def test_sweeps_of_the_pressure_at_set_lengths(tmp_path):
    points = [
        (p + e / 20, e, 2000 * (p + e / 20) * (1 - 4 * e))
        for e in (0, 0.05, 0.1)
        for p in np.arange(0, 0.61, 0.013)
    ]
    found = read(tmp_path, written(HEAD, right, points))
    np.testing.assert_allclose(found.pressures, np.arange(1, 7) * 0.1)
    np.testing.assert_allclose(found.force([0, 0.05, 0.1], 0.3), [600, 480, 360], rtol=1e-4)
    assert any("contraction 0.05: 47 points, pressure swept" in line for line in found.said)
