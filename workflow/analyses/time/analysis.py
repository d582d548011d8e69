"""What the analysis of time is and writes."""

from workflow.analyses.analysis import PAPERS, Analysis

ANALYSIS = Analysis(
    name="time",
    title="Time",
    chapter="6 Time",
    muscles=PAPERS[:1],
    tables={"time": None, "time_curves": "%.8g", "time_vibrations": "%.8g"},
    figures=("time_loops", "time_response", "time_shape"),
    page=("time",),
)
