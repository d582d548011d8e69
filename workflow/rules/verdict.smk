# Dataset -> how far it is from what was measured, and from what the paper says.
#
#   in   results/dataset.nc; the reference maps
#   out  results/tables/deviation.csv    of the muscles of fig04, which the maps are of


rule deviation:
    input:
        dataset="results/dataset.nc",
        reference=sources("config/reference/*.csv"),
        sources=sources("workflow/deviation.py", "workflow/reference.py", "workflow/aside.py"),
    output:
        "results/tables/deviation.csv",
    log:
        "results/logs/deviation.log",
    params:
        muscles=lambda wildcards: list(PLAN.study.scenes["fig04"].muscles),
    message:
        "Comparing with the reference maps"
    shell:
        "python -m workflow deviation --dataset {input.dataset:q} --muscles {params.muscles:q}"
        " --table {output:q} 2> {log:q}"
