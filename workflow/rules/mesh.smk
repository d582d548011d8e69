# Muscle and mesh settings -> mesh. Cases that differ in load, material or threads share one.
#
#   in   what shapes the mesh, from the plan; geometry/
#   out  results/meshes/<digest>.mesh   curve mesh of the membrane
#        results/meshes/<digest>.msh    wall section of the solid


rule mesh:
    input:
        sources=sources("geometry/*.py"),
    output:
        "results/meshes/{mesh}",
    log:
        "results/logs/meshes/{mesh}.log",
    params:
        spec=lambda wildcards: PLAN.meshes[wildcards.mesh],
    message:
        "Meshing {wildcards.mesh}"
    shell:
        "python -m geometry - {output:q} <<< {params.spec:q} > {log:q} 2>&1"
