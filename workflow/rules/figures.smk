# Records of a scene -> its figure.
#
#   in   the records that the scene asks for; workflow/figures/<scene>.py and what all figures share
#   out  results/figures/<scene>.png, .svg and .csv, the plotted numbers


def records_of_scene(wildcards):
    return [record_of(key) for key in dict.fromkeys(PLAN.scenes.get(wildcards.figure, {}).values())]


def figure_sources(wildcards):
    """A figure's own module, what figures share, and what reads the records."""
    shared = sources("workflow/figures/[!f]*.py", "workflow/figures/f[!i]*.py", "workflow/*.py")
    return [f"workflow/figures/{wildcards.figure}.py", *shared]


rule figure:
    input:
        records=records_of_scene,
        reference=sources("config/reference/*.csv"),
        sources=figure_sources,
    output:
        multiext("results/figures/{figure}", ".png", ".svg", ".csv"),
    log:
        "results/logs/figures/{figure}.log",
    params:
        scene=lambda wildcards: PLAN.digest(wildcards.figure),
    message:
        "Drawing {wildcards.figure}"
    shell:
        "{PYTHON} -m workflow figure --study {STUDY:q} --scene {wildcards.figure:q}"
        " --output {output[0]:q} > {log:q} 2>&1"
