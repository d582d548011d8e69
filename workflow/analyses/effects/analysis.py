"""What the analysis of effects is and writes."""

from workflow.analyses.analysis import PAPERS, Analysis

ANALYSIS = Analysis(
    name="effects",
    title="Effects",
    chapter="4 Effects",
    muscles=(*PAPERS, "dmsp20_t3_silicone"),
    tables={"effects": None},
    figures=("effects",),
)
