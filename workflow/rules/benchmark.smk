# Where the time goes on this machine: snakemake --cores 2 benchmark
#
#   out  results/tables/times.csv       whole runs: from scratch, with nothing to do, a thousand
#                                       muscles of one sweep; and a curve by the solid
#        results/cost.csv               what accuracy costs, which the analysis of accuracy draws
#        results/tables/benchmark.csv   how cost grows
#        results/tables/time_steps.csv  what a step of time costs, with memory and without
#
# It has no outputs for Snakemake: whoever asks for it wants it measured again.


rule benchmark:
    log:
        f"{RESULTS}/logs/benchmark.log",
    # Nothing else runs beside it. Asked late, since --report names no cores.
    threads: lambda _: workflow.cores
    params:
        study=lambda _: STUDY,  # as it is, braces and all
    message:
        "Measuring where the time goes"
    shell:
        "python -m workflow benchmark --study {params.study:q} --cores {threads} 2> >(tee {log:q} >&2)"
