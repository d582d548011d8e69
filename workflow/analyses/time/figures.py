"""Figures of time: loops and their width; rates, a step and vibrations; the wall on both ways."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from workflow.analyses import undrawn
from workflow.analyses.analysis import Solved
from workflow.analyses.time.cases import AT, CONTACTS, FREQUENCIES, RATES
from workflow.analyses.time.table import widths
from workflow.data import stress
from workflow.data.stress import LARGEST
from workflow.figures import curves, style

GAP = (0.66, 0.66)
LINES = ("-", (0, (5, 2)), (0, (1, 1)))  # of rates, which lie on each other
ELEMENTS = {"color": "0.45", "linestyle": (0, (4, 2)), "linewidth": 1.1}
SURFACES: dict[str, dict[str, Any]] = {
    "inner surface": {"color": "black"},
    "outer surface": {"color": "#0072b2"},
}
MEASURED = 12.7  # N, half width of a 10 mm muscle (Hunt 2017), 15.6 kPa
FAR = 20.0  # N: widths of the three elements beyond it are said, not drawn
CONTRACTION, PRESSURE, FORCE = "contraction [1]", "pressure [MPa]", "force [N]"


def draw(solved: Sequence[Solved], tables: Mapping[str, pd.DataFrame]) -> dict[str, Figure]:
    """All three."""
    return {
        "time_loops": loops(tables["time"], tables["time_curves"]),
        "time_response": response(tables["time_curves"], tables["time_vibrations"]),
        "time_shape": shape(solved),
    }


def loops(table: pd.DataFrame, found: pd.DataFrame) -> Figure:
    """A loop; its width along it at three rates; its width against pressure."""
    figure, axes = style.panels(style.FULL, 2.9, 1, 3, gap=GAP)
    whole, along, width = axes[0]
    for k, rate in enumerate(RATES):
        label = f"{100 * rate:g} %/s"
        curve = found[(found["set"] == "rate") & (found["label"] == label)]
        look = style.series(k) | {"marker": "", "linestyle": LINES[k]}
        if rate == RATES[1]:
            whole.plot(curve[CONTRACTION], curve[FORCE], color=look["color"])
        along.plot(*widths(curve), label=label, **look)
    elements = table.loc[table["set"] == "rate", ["label", "three elements, width [N]"]].dropna()
    for label, value in elements.itertuples(index=False):
        if value < FAR:
            along.plot([0, 0.2], [value] * 2, label="three elements", **ELEMENTS)
            along.text(0.2, value, label, ha="right", va="bottom", fontsize=7, color="0.45")
    whole.set_title(f"third loop, {100 * RATES[1]:g} %/s, 0.3 MPa")
    whole.set(ylabel="force [N]")
    along.set_title("its width")
    along.set(ylabel="width of the loop [N]")
    for ax in (whole, along):
        ax.set_xlabel("contraction [%]")
        style.percent(ax.xaxis)
    rows = table[table["set"] == "pressure"].sort_values(PRESSURE)
    width.plot(rows[PRESSURE], rows["width"], label="rubber (assumed)", color="black", marker="o")
    for k, contact in enumerate(CONTACTS):
        own = (table["set"] == "sleeve") & (table["contact [mm]"] == contact)
        rubs = table[own].sort_values(PRESSURE)
        look = style.series(3) | {"linestyle": ("-", (0, (1, 1)))[k], "marker": ""}
        label = f"sleeve, contacts {contact:g} mm (guess)"
        width.plot(rubs[PRESSURE], rubs["width"], label=label, **look)
    width.axhline(2 * MEASURED, color="#d55e00", linewidth=1, label="measured, another muscle")
    width.set(xlabel="pressure [MPa]", ylabel="width of the loop [N]")
    width.set_title(f"width at {100 * AT:g} %")
    style.legend(figure, style.labelled(axes[:, :2]), style.labelled(axes[:, 2:]))
    drawn = table[table["set"].isin(["rate", "pressure", "wall", "sleeve"])]
    far = drawn["three elements, width [N]"] >= FAR
    beyond = sorted(set(drawn.loc[far & (drawn["set"] == "rate"), "label"]))
    cut = f"Three elements, fitted at {100 * RATES[1]:g} %/s, are beyond {FAR:g} N at "
    text = [
        undrawn.sentence(undrawn.without_value(drawn, "width", ["set", "label"])),
        f"{cut}{', '.join(beyond)}." if beyond else "",
        "Measured: twice 12.7 N (15.6 kPa) of a 10 mm muscle, whatever its pressure (Hunt 2017).",
    ]
    curves.note(figure, " ".join(filter(None, text)))
    return figure


def response(found: pd.DataFrame, answers: pd.DataFrame) -> Figure:
    """Contraction by pressure under load, after a step of the supply; stiffness and loss factor."""
    figure, axes = style.panels(style.FULL, 5.2, 2, 2, gap=GAP)
    (load, step), (stiffness, loss) = axes
    for k, frequency in enumerate(FREQUENCIES):
        label = f"{frequency:g} Hz"
        curve = found[(found["set"] == "frequency") & (found["label"] == label)]
        look = style.series(k) | {"marker": ""}
        load.plot(curve[PRESSURE], curve[CONTRACTION], label=label, **look)
    load.set(xlabel="pressure [MPa]", ylabel="contraction [%]")
    load.set_title("under 200 N")
    looks: dict[str, dict[str, Any]] = {
        "without memory": {"color": "0.45", "linestyle": (0, (4, 2))},
        "with memory": {"color": "black"},
    }
    for label, look in looks.items():
        curve = found[(found["set"] == "step") & (found["label"] == label)]
        step.plot(curve["time [s]"], curve[CONTRACTION], label=label, **look)
    step.set(xlabel="time [s]")
    step.set_title("5 kg, a valve opens to 0.3 MPa")
    for ax in (load, step):
        style.percent(ax.yaxis)
    for k, (label, rows) in enumerate(answers.groupby("label")):
        look = style.series(k + 3) | {"markersize": 3}
        stiffness.plot(rows["frequency [Hz]"], rows["storage [N/mm]"], label=label, **look)
        loss.plot(rows["frequency [Hz]"], rows["loss factor [1]"], **look)
    stiffness.set(xscale="log", xlabel="frequency [Hz]", ylabel="K' [N/mm]")
    stiffness.set_title("storage stiffness at 10 %")
    loss.set(xscale="log", xlabel="frequency [Hz]", ylabel="K''/K'")
    loss.set_title("loss factor at 10 %")
    style.legend(figure, style.labelled(axes[:1]), style.labelled(axes[1:]))
    names = undrawn.without_value(found, CONTRACTION, ["set", "label"])
    text = undrawn.sentence(name for name in names if not name.startswith("rate"))
    if text:
        curves.note(figure, text)
    return figure


def shape(solved: Sequence[Solved]) -> Figure:
    """Radius and stress at equal contraction, lengthening less shortening, along the muscle."""
    figure, axes = style.panels(style.FULL, 2.6, 1, 2, gap=GAP)
    radius, bears = axes[0]
    missing = []
    membrane = _both_ways(solved, "rate", "meridian")
    if membrane:
        there, back = membrane
        look = {"color": "0.45", "linestyle": (0, (4, 2)), "label": "membrane"}
        radius.plot(there[:, 3], 1000 * (back[:, 2] - there[:, 2]), **look)
    else:
        missing.append("membrane")
    solid = _both_ways(solved, "wall", "corners", "stress")
    if solid:
        there, back = (stress.along_meridian(corners) for corners in solid)
        for where, look in SURFACES.items():
            own = there["where"] == where
            along = there.loc[own, "z [mm]"]
            wider, more = (back.loc[own, x] - there.loc[own, x] for x in ("r [mm]", LARGEST))
            radius.plot(along, 1000 * wider, label=f"solid, {where}", **look)
            bears.plot(along, 1000 * more, **look)
    else:
        missing.append("solid")
    for ax, said in ((radius, "difference of radius [µm]"), (bears, "difference [kPa]")):
        ax.axhline(0, color=style.SOFT, linewidth=0.8)
        ax.set(xlabel="distance from mid-length [mm]", ylabel=said)
    radius.set_title("radius")
    bears.set_title("largest principal stress")
    style.legend(figure, style.labelled(axes))
    text = f"Lengthening less shortening, both at {100 * AT:g} %, third loop, 10 %/s, 0.3 MPa."
    curves.note(figure, " ".join(filter(None, [text, undrawn.sentence(missing, "No picture of")])))
    return figure


def _both_ways(solved: Sequence[Solved], of: str, *names: str) -> list[Any]:
    """The last two fields of the loop of a set, on the way there and back; empty without."""
    for one in solved:
        fields = one.solution.fields
        last = [k for k in sorted(fields) if set(names) <= set(fields[k])][-2:]
        if one.asked.tags["set"] == of and len(last) == 2:
            ways = [fields[k] for k in last]
            return [stress.wall(way) if "corners" in names else way[names[0]] for way in ways]
    return []
