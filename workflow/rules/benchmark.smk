# What the analysis of accuracy costs on this machine: snakemake --cores 2 benchmark
#
#   in   the table of the analysis, so that its figure has both
#   out  results/cost.csv               medians of several runs one after the other
#        results/tables/benchmark.csv   how cost grows
#        results/tables/time_steps.csv  what a step of time costs, with memory and without
#        results/tables/times.csv       where the time of whole runs goes: from scratch, with nothing
#                                       to do, a thousand muscles of one sweep; and a
#                                       curve by the solid
#        results/figures/accuracy.png   drawn again with these costs
#
# It has no outputs for Snakemake: whoever asks for it wants it measured again.


rule benchmark:
    input:
        f"{RESULTS}/tables/accuracy.csv",
    log:
        f"{RESULTS}/logs/benchmark.log",
    # Nothing else runs beside it. Asked late, since --report names no cores.
    threads: lambda _: workflow.cores
    params:
        study=lambda _: STUDY,  # as it is, braces and all
    message:
        "Measuring what accuracy costs"
    shell:
        "python -m workflow benchmark --study {params.study:q} --cores {threads} 2> >(tee {log:q} >&2)"
        " && python -m workflow analysis --study {params.study:q} --name accuracy"
