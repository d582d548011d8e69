# Case and mesh -> one record per case (layout: solver/record.py).
#
#   in   the case, from the plan; its mesh; solver/ and what of geometry/ it imports
#   out  results/cases/<key>.h5    states, fields, status; also when the solve failed
#        results/cost/<key>.json   seconds and memory
#
# A case is named by its content: it is solved once, also after a value was changed and changed back.
# Limits are resources and no parameters: raising one does not solve anything again.
# Cases go before figures, since one process gathers them all in the end, beside which these fit.


rule solve:
    input:
        mesh=mesh_of,
        sources=solver_sources,
    output:
        record="results/cases/{case}.h5",
        cost="results/cost/{case}.json",
    log:
        "results/logs/cases/{case}.log",
    priority: 1
    resources:
        wall_time=PLAN.study.wall_time,
        memory=PLAN.study.memory,
    params:
        case=lambda wildcards: case_of(wildcards.case).case.canonical(),
        code=code_of,
        mesh=lambda wildcards, input: ["--mesh", input.mesh] if input.mesh else [],
    message:
        "Solving {LABEL:{wildcards.case}}"
    shell:
        "python -m solver --case {params.case:q} {params.mesh:q} --code {params.code} --record {output.record:q}"
        " --cost {output.cost:q} --log {log:q}"
        " --wall-time {resources.wall_time} --memory {resources.memory}"
