# Settings become cases, a case becomes a mesh and a solve, solves become one labelled dataset, the
# dataset becomes figures. Files are in the order in which things run.
#
#   snakemake --cores 2                                         the study of the paper
#   snakemake --cores 2 --config study=config/smoke/study.yaml  another study
#   snakemake --cores 2 everything                              all analyses and pages as well
#   snakemake --report results/report.html                      the pages in one file
from snakemake.utils import min_version

min_version("9.0")


include: "workflow/rules/common.smk"
include: "workflow/rules/run.smk"
include: "workflow/rules/solve.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/gather.smk"
include: "workflow/rules/muscles.smk"
include: "workflow/rules/answers.smk"
include: "workflow/rules/analyses.smk"
include: "workflow/rules/benchmark.smk"
include: "workflow/rules/pages.smk"
include: "workflow/rules/report.smk"


# What a cluster is not asked for: light, or made of what has been solved.
localrules:
    all,
    everything,
    figures,
    figure,
    gather,
    partial,
    complete,
    muscle,
    sheet,


rule all:
    default_target: not REPORTING
    input:
        rules.figures.output,
        [f"{RESULTS}/muscles/{muscle}.step" for muscle in PLAN.shown],
        sheets(),
        f"{RESULTS}/dataset.nc",
        f"{RESULTS}/explorer.html",
        deviations(),
        f"{RESULTS}/complete.txt",
    message:
        f"All is there: {RESULTS}/figures, {RESULTS}/dataset.nc, {RESULTS}/explorer.html"


rule everything:
    default_target: REPORTING
    input:
        rules.all.input,
        REPORTED if REPORTING else [f"{RESULTS}/report/{page}.html" for page in USUAL],
    message:
        "All is there; snakemake --report results/report.html makes the report"
