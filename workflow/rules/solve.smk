# Case and mesh -> one record per case (layout: solver/record.py).
#
#   in   the case, from the plan; its mesh; solver/ and what of geometry/ it imports
#   out  results/cases/<key>.h5    states, fields, status; also when the solve failed
#        results/cost/<key>.json   seconds and memory
#
# A case is named by its content: it is solved once, also after a value was changed and changed back.
# Limits are no parameter of a case: raising one does not solve anything again.
MODEL_SOURCES = {
    # of all sources of the solver, those that only one model reads
    "geometric": sources("solver/geometric.py"),
    "cylinder": sources("solver/cylinder.py"),
    "membrane": sources("solver/edp/membrane*"),
    "solid": sources("solver/edp/solid*", "solver/edp/ends_*"),
}


def solver_sources(wildcards):
    """Sources that decide the result of a case; a meshed model has its geometry in the mesh."""
    model = PLAN.cases[wildcards.case].case.model
    others = {path for name, files in MODEL_SOURCES.items() if name != model for path in files}
    edp = sources("solver/edp/*.edp", "solver/edp/*.idp") if PLAN.cases[wildcards.case].mesh else []
    shared = sources("solver/*.py", "geometry/muscle.py", "geometry/refusal.py")
    return [path for path in shared + edp if path not in others]


def mesh_of(wildcards):
    mesh = PLAN.cases[wildcards.case].mesh
    return f"results/meshes/{mesh}" if mesh else []


rule solve:
    input:
        mesh=mesh_of,
        sources=solver_sources,
    output:
        record="results/cases/{case}.h5",
        cost="results/cost/{case}.json",
    log:
        "results/logs/cases/{case}.log",
    params:
        case=lambda wildcards: PLAN.cases[wildcards.case].case.canonical(),
        mesh=lambda wildcards, input: ["--mesh", input.mesh] if input.mesh else [],
    message:
        "Solving {LABEL:{wildcards.case}}"
    shell:
        "{PYTHON} -m solver --case {params.case:q} {params.mesh:q} --record {output.record:q}"
        " --cost {output.cost:q} --log {log:q}"
        " --wall-time {PLAN.study.wall_time} --memory {PLAN.study.memory}"
