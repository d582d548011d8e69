# Records of a scene -> the data sheets of its muscles, of scenes with quantities: [sheet].
#
#   in   the records that the scene asks for; what its muscles are built into; the reference maps
#   out  results/sheets/<scene>.html, .png, .svg, .csv and .json
from workflow.study.schema import SHEET


wildcard_constraints:
    scene="|".join(map(re.escape, PLAN.study.scenes)) or "none",


def sheets():
    """Pages of all scenes that ask for sheets."""
    asking = [name for name, asked in PLAN.study.scenes.items() if SHEET in asked.quantities]
    return [f"results/sheets/{scene}.html" for scene in asking]


rule sheet:
    input:
        records=lambda wildcards: map(
            record_of, sorted(set(PLAN.scenes.get(wildcards.scene, {}).values()))
        ),
        sources=lambda _: sources("workflow.programs.sheets"),
    output:
        multiext("results/sheets/{scene}", ".html", ".png", ".svg", ".csv", ".json"),
    log:
        "results/logs/sheets/{scene}.log",
    params:
        study=lambda _: STUDY,  # as it is, braces and all
        scene=lambda wildcards: PLAN.digest(wildcards.scene),
    message:
        "Writing the sheets of {wildcards.scene}"
    shell:
        "python -m workflow sheets --study {params.study:q} --scene {wildcards.scene:q}"
        " --output {output[0]:q} > {log:q} 2>&1"
