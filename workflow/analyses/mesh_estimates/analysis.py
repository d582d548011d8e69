"""What the analysis of reported errors is and writes."""

from workflow.analyses.analysis import Analysis

ANALYSIS = Analysis(
    name="mesh_estimates",
    title="Reported errors of meshes",
    chapter="4 Effects",
    takes_hours=True,
    tables={"mesh_estimates": None, "mesh_estimates_summary": "%.4g"},
    page=("mesh_estimates_summary",),
)
