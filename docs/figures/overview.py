"""The picture of the README, of what a run has drawn: python docs/figures/overview.py."""

from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

ROOT = Path(__file__).parents[2]
FIGURES = ROOT / "results/figures"
PARTS = {  # figure: what of it is shown, from the left, top, right, bottom as shares; its title
    "fig03": (0.0, 0.40, 0.43, 0.99, "a muscle from a table of settings"),
    "fig05": (0.0, 0.183, 0.85, 0.316, "largest principal stress in its wall"),
}
COLOURS = {0.2: "#0072b2", 0.3: "#d55e00", 0.4: "#009e73"}  # MPa


def main() -> None:
    """Draw it beside this file."""
    plt.rcParams["font.size"] = 10
    figure = plt.figure(figsize=(11, 4.7), dpi=120)
    grid = figure.add_gridspec(2, 2, width_ratios=[1.25, 1], height_ratios=[1.35, 1])
    for row, (name, (left, top, right, bottom, title)) in enumerate(PARTS.items()):
        picture = plt.imread(FIGURES / f"{name}.png")
        height, width = picture.shape[:2]
        rows = slice(int(top * height), int(bottom * height))
        part = picture[rows, int(left * width) : int(right * width)]
        axes = figure.add_subplot(grid[row, 0])
        axes.imshow(part, interpolation="antialiased")
        axes.set_title(title, loc="left", fontweight="bold", fontsize=10)
        axes.axis("off")
    curves(figure.add_subplot(grid[:, 1]))
    figure.subplots_adjust(0.01, 0.11, 0.95, 0.93, wspace=0.14, hspace=0.2)
    figure.savefig(Path(__file__).with_suffix(".png"))


def curves(axes: plt.Axes) -> None:
    """Force against contraction by the solid, by Eq. (1), and as the maker tabulates it."""
    table = pd.read_csv(FIGURES / "fig04.csv")
    for pressure, rows in table.groupby("pressure [MPa]"):
        colour = COLOURS[pressure]
        for source, look in {"solid": "-", "geometric": "--"}.items():
            line = rows[(rows["source"] == source) & (rows["point"] == "stop")]
            axes.plot(100 * line["contraction [1]"], line["force [N]"], look, color=colour)
        points = rows[(rows["source"] == "festo_musclesim") & (rows["status"] == "reference")]
        points = points[(points["point"] == "tabulated") & (points["contraction [1]"] >= 0)]
        axes.plot(100 * points["contraction [1]"], points["force [N]"], "o", color=colour)
        end = (25.4, line["force [N]"].iloc[-1])  # of Eq. (1), the last of both
        axes.annotate(f"{pressure:g} MPa", end, color=colour, va="center", annotation_clip=False)
    axes.set_title("force: solid, Eq. (1) dashed, the maker's points", loc="left")
    axes.title.set(fontsize=10, fontweight="bold")
    axes.set_xlabel("contraction [%]")
    axes.set_ylabel("force [N]")
    axes.axhline(0, color="black", linewidth=0.8)
    axes.grid(alpha=0.3)
    axes.spines[["top", "right"]].set_visible(False)


if __name__ == "__main__":
    main()
