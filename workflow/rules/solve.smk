# Cases -> meshes -> one record per case (layout: solver/record.py), many cases in one job.
#
#   in   the cases of the study, of one scene or of an analysis; solver/, geometry/
#   out  results/meshes/<digest>.mesh   curve mesh of the membrane, periodic cell of the braid
#        results/meshes/<digest>.msh    wall section of the solid
#        (why, where it cannot be meshed: the solve makes that the status mesh_failed)
#        results/cases/<key>.h5         states, fields, status; also when the solve failed
#        results/cost/<key>.json        seconds and memory
#        results/solved/<asked>/<batch>.txt
#
# A case is named by its content: it is solved once, also after a value was changed and changed back.
# Only the last of these files is Snakemake's, which deletes the files of a job that it stops or that
# fails: what is solved stays solved (workflow/run/batches.py says what is solved again).
# A case belongs to one of --config batches=N by its key. On one machine one batch is enough, which
# takes all cores; a cluster wants as many as there shall be jobs, and snakemake --set-threads solve=N.
# Limits are resources and no parameters: raising one does not solve anything again.
# Cases go before figures, since one process gathers them all in the end, beside which these fit.


rule solve:
    output:
        f"{RESULTS}/solved/{{asked}}/{{batch}}of{BATCHES}.txt",
    log:
        f"{RESULTS}/logs/solved/{{asked}}_{{batch}}of{BATCHES}.log",
    priority: 1
    threads: cores_of_batch
    resources:
        wall_time=PLAN.study.wall_time,
        memory=PLAN.study.memory,
        mem_mb=lambda _, threads: threads * PLAN.study.memory,  # of the job, for a cluster
    params:
        study=lambda _: STUDY,  # as it is, braces and all
        asked=lambda wildcards: program_option(wildcards.asked),
        batches=BATCHES,
        wanted=lambda wildcards: batches.wanted(cases_of_batch(wildcards)),
    message:
        "Solving {BATCH:{wildcards.asked} {wildcards.batch}}"
    shell:
        "python -m workflow solve --study {params.study:q} {params.asked:q}"
        " --batch {wildcards.batch} --batches {params.batches} --cores {threads}"
        " --wall-time {resources.wall_time} --memory {resources.memory}"
        " --log {log:q} --stamp {output:q}"
