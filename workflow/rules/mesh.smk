# Muscle and mesh settings -> mesh. Cases that differ in load, material or threads share one.
# Muscle -> the whole muscle in three dimensions, for other programs.
#
#   in   what shapes the mesh, from the plan; geometry/
#   out  results/meshes/<digest>.mesh    curve mesh of the membrane
#        results/meshes/<digest>.msh     wall section of the solid
#        results/muscles/<muscle>.step   tube, caps and threads, of muscles that a scene shows


rule mesh:
    input:
        sources=mesh_sources,
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


rule muscle:
    input:
        sources=sources("geometry/*.py", without=["geometry/meridian.py", "geometry/section.py"]),
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
