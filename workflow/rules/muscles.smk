# Muscle -> the whole muscle in three dimensions, for other programs.
#
#   in   the muscle, from the plan
#   out  results/muscles/<muscle>.step   tube, caps and threads, of muscles that a scene shows


rule muscle:
    output:
        f"{RESULTS}/muscles/{{muscle}}.step",
    log:
        f"{RESULTS}/logs/muscles/{{muscle}}.log",
    params:
        spec=lambda wildcards: PLAN.shown[wildcards.muscle],
        code=lambda _: sources.digest(sources.of_mesh("whole")),
    message:
        "Building {wildcards.muscle} in three dimensions"
    shell:
        "python -m geometry - {output:q} <<< {params.spec:q} > {log:q} 2>&1"
