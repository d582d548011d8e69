# Records of a scene -> the data sheets of its muscles, of scenes with quantities: [sheet].
#
#   in   the records of the study; what its muscles are built into; the reference maps
#   out  results/sheets/<scene>.html, .png, .svg, .csv and .json
from workflow.study.schema import SHEET


wildcard_constraints:
    scene="|".join(map(re.escape, PLAN.study.scenes)) or "none",


def sheets():
    """Pages of all scenes that ask for sheets."""
    asking = [name for name, asked in PLAN.study.scenes.items() if SHEET in asked.quantities]
    return [f"{RESULTS}/sheets/{scene}.html" for scene in asking]


rule sheet:
    input:
        solved("study"),
    output:
        multiext(f"{RESULTS}/sheets/{{scene}}", ".html", ".png", ".svg", ".csv", ".json"),
    log:
        f"{RESULTS}/logs/sheets/{{scene}}.log",
    params:
        study=lambda _: STUDY,  # as it is, braces and all
        scene=lambda wildcards: PLAN.digest(wildcards.scene),
        code=lambda _: code("workflow.programs.sheets"),
    message:
        "Writing the sheets of {wildcards.scene}"
    shell:
        "python -m workflow sheets --study {params.study:q} --scene {wildcards.scene:q}"
        " --output {output[0]:q} > {log:q} 2>&1"
