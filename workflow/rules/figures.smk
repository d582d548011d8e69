# Records -> the figures of the scenes, and fields for ParaView where a scene asks for stress or the
# deformed shape, all states of a record as one series: all in one process, each if something that it
# is made of has changed (workflow/figures/update.py). One that fails leaves the others as they are,
# so these files are not Snakemake's, which would delete them all.
#
#   in   the records; workflow/figures/<scene>.py and what all figures share
#   out  results/figures/<scene>.png, .svg and .csv, the plotted numbers
#        results/fields/<muscle>_<model>_<variant>_<path>_<held>.pvd, and a folder of the same name
#        results/drawn.txt
#
# By its name one of them is made alone, of its own cases: snakemake results/figures/fig04.png


rule figures:
    input:
        solved("study"),
    output:
        f"{RESULTS}/drawn.txt",
    log:
        f"{RESULTS}/logs/figures.log",
    params:
        study=lambda _: STUDY,  # as it is, braces and all
        wanted=lambda _: update.wanted(PLAN),
    message:
        "Drawing {FIGURES:all}"
    shell:
        "python -m workflow draw --study {params.study:q} --stamp {output:q} 2> {log:q}"


rule figure:
    input:
        lambda wildcards: solved(f"scene-{wildcards.figure}"),
    output:
        multiext(f"{RESULTS}/figures/{{figure}}", ".png", ".svg", ".csv"),
    log:
        f"{RESULTS}/logs/figures/{{figure}}.log",
    params:
        study=lambda _: STUDY,  # as it is, braces and all
        wanted=lambda _: update.wanted(PLAN),
    message:
        "Drawing {wildcards.figure}"
    shell:
        "python -m workflow draw --study {params.study:q} --scene {wildcards.figure:q} 2> {log:q}"
