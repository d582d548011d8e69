# Muscle and mesh settings -> mesh. Cases that differ in load, material or threads share one.
# Muscle -> the whole muscle in three dimensions, for other programs.
#
#   in   what shapes the mesh, from the plan; geometry/
#   out  results/meshes/<digest>.mesh    curve mesh of the membrane, periodic cell of the braid
#        results/meshes/<digest>.msh     wall section of the solid
#        (why, where it cannot be meshed: the solve makes that the status mesh_failed)
#        results/muscles/<muscle>.step   tube, caps and threads, of muscles that a scene shows


rule mesh:
    input:
        sources=mesh_sources,
    output:
        "results/meshes/{mesh}",
    log:
        "results/logs/meshes/{mesh}.log",
    priority: 1
    resources:
        wall_time=PLAN.study.wall_time,
        memory=PLAN.study.memory,
    params:
        spec=spec_of_mesh,
    message:
        "Meshing {wildcards.mesh}"
    shell:
        "python -m geometry - {output:q} --or-why {resources.wall_time} {resources.memory}"
        " <<< {params.spec:q} > {log:q} 2>&1"


rule muscle:
    input:
        sources=[of_checkout(file) for file in closure.of_mesh("whole")],
    output:
        "results/muscles/{muscle}.step",
    log:
        "results/logs/muscles/{muscle}.log",
    params:
        spec=lambda wildcards: PLAN.shown[wildcards.muscle],
    message:
        "Building {wildcards.muscle} in three dimensions"
    shell:
        "python -m geometry - {output:q} <<< {params.spec:q} > {log:q} 2>&1"
