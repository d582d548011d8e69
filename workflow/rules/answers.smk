# Records of a scene -> the data sheets of its muscles, of scenes with quantities: [sheet].
#
#   in   the records of the study; what its muscles are built into; the reference maps
#   out  results/sheets/<scene>.html, .png, .svg, .csv and .json


wildcard_constraints:
    design="|".join(map(re.escape, PLAN.study.design)) or "none",
    map="|".join(map(re.escape, PLAN.study.maps)) or "none",
    pair="|".join(map(re.escape, PLAN.study.pairs)) or "none",
    scene="|".join(map(re.escape, PLAN.study.scenes)) or "none",


rule sheet:
    input:
        solved("study"),
    output:
        multiext(f"{RESULTS}/sheets/{{scene}}", ".png", ".svg", ".csv", ".json"),
        html=f"{RESULTS}/sheets/{{scene}}.html",
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
        " --output {output.html:q} > {log:q} 2>&1"


# Requirements of the study file -> the muscle that meets them, or what stands in the way.
#
#   in   what the study file says of it; solver/ and workflow/answers/design/
#   out  results/design/<design>.yaml     an entry to paste; .json, .csv, .png, .svg, .html
#
# What is solved on the way is kept in results/cases: a design that was broken off goes on.
rule design_of:
    output:
        multiext(f"{RESULTS}/design/{{design}}", ".yaml", ".json", ".csv", ".png", ".svg", ".html"),
    log:
        f"{RESULTS}/logs/design/{{design}}.log",
    params:
        study=lambda _: STUDY,  # as it is, braces and all
        asked=design_digest,
        code=lambda _: code("workflow.programs.design"),
        folder=lambda wildcards, output: str(Path(output[0]).parent),
    message:
        "Designing {wildcards.design}"
    shell:
        "python -m workflow design {wildcards.design:q} --study {params.study:q}"
        " --folder {params.folder:q} > {log:q} 2>&1"


rule design:
    input:
        expand(f"{RESULTS}/design/{{design}}.yaml", design=PLAN.study.design),
    message:
        "Designs are in results/design"


# Muscles of the study file -> tables of force and volume for controllers and simulators.
#
#   in   what the study file says of it; solver/ and workflow/answers/maps/
#   out  results/maps/<map>.nc    and .csv, .mat, .json (its error), .png, .svg, .html
rule map_of:
    output:
        multiext(
            f"{RESULTS}/maps/{{map}}",
            ".nc",
            ".csv",
            ".mat",
            ".fmu",
            ".json",
            ".png",
            ".svg",
            ".html",
        ),
    log:
        f"{RESULTS}/logs/maps/{{map}}.log",
    params:
        study=lambda _: STUDY,  # as it is, braces and all
        asked=map_digest,
        code=lambda _: code("workflow.programs.map"),
        folder=lambda wildcards, output: str(Path(output[0]).parent),
    message:
        "Making the map {wildcards.map}"
    shell:
        "python -m workflow map {wildcards.map:q} --study {params.study:q}"
        " --folder {params.folder:q} > {log:q} 2>&1"


# Two maps on a pulley -> torque and stiffness of the joint.
#
#   in   what the study file says of it and of its maps; workflow/answers/maps/
#   out  results/pairs/<pair>.csv, .png, .svg, .html
rule pair_of:
    input:
        maps_of_pair,  # what they have solved is in the store
    output:
        multiext(f"{RESULTS}/pairs/{{pair}}", ".csv", ".png", ".svg", ".html"),
    log:
        f"{RESULTS}/logs/pairs/{{pair}}.log",
    params:
        study=lambda _: STUDY,  # as it is, braces and all
        asked=lambda wildcards: repr(PLAN.study.pairs[wildcards.pair]),
        code=lambda _: code("workflow.programs.pair"),
        folder=lambda wildcards, output: str(Path(output[0]).parent),
    message:
        "Drawing the pair {wildcards.pair}"
    shell:
        "python -m workflow pair {wildcards.pair:q} --study {params.study:q}"
        " --folder {params.folder:q} > {log:q} 2>&1"


rule maps:
    input:
        expand(f"{RESULTS}/maps/{{map}}.nc", map=PLAN.study.maps),
        expand(f"{RESULTS}/pairs/{{pair}}.csv", pair=PLAN.study.pairs),
    message:
        "Maps are in results/maps, pairs of them in results/pairs"
