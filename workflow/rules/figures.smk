# Records of a scene -> its figure.
#
#   in   the records that the scene asks for; workflow/figures/<scene>.py and what all figures share
#   out  results/figures/<scene>.png, .svg and .csv, the plotted numbers


rule figure:
    input:
        records=records_of_scene,
        sources=lambda wildcards: sources(
            "workflow.programs.figure", f"workflow.figures.{wildcards.figure}"
        ),
    output:
        png="results/figures/{figure}.png",
        svg="results/figures/{figure}.svg",
        csv="results/figures/{figure}.csv",
    log:
        "results/logs/figures/{figure}.log",
    params:
        study=lambda _: STUDY,  # as it is, braces and all
        scene=lambda wildcards: PLAN.digest(wildcards.figure),
    message:
        "Drawing {wildcards.figure}"
    shell:
        "python -m workflow figure --study {params.study:q} --scene {wildcards.figure:q}"
        " --output {output.png:q} > {log:q} 2>&1"
